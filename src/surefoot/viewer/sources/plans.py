"""Finds what a picture needs: a plan's grid, a run's plan, scenario and map."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from surefoot.compute import sha256_of
from surefoot.errors import InputError
from surefoot.frames import Cell
from surefoot.missions.biped.run_log import Run, read_run
from surefoot.missions.plans.document import read_plan_document
from surefoot.missions.scenario.file import Scenario, read_scenario
from surefoot.navigation import NavigationStrategy, load_navigation_strategy
from surefoot.world import CoarseGrid, OccupancyMap, read_occupancy_map


@dataclass(frozen=True, slots=True)
class PlanSource:
    """A plan with its scenario and map.

    Attributes:
        folder: of the plan.
        document: the content of plan.json.
        grid: the coarse grid that it was made on.
        scenario: what was asked for.
        occupancy: the map's pixels.
    """

    folder: Path
    document: Mapping[str, Any]
    grid: CoarseGrid
    scenario: Scenario
    occupancy: OccupancyMap

    def cells(self, *keys: str | int) -> tuple[Cell, ...]:
        """Return the cells, or the one cell, in the document under some keys; none if there are no such keys."""
        value: Any = self.document
        try:
            for key in keys:
                value = value[key]
            several = value if isinstance(value[0], list) else [value]
            return tuple(Cell(int(row), int(column)) for row, column in several)
        except (KeyError, IndexError, TypeError, ValueError):
            return ()


@dataclass(frozen=True, slots=True)
class RunSource:
    """A run with its plan."""

    run: Run
    plan: PlanSource


def read_plan_source(folder: Path) -> PlanSource:
    """Read a plan and what it was made from.

    Raises:
        InputError: if something is missing or unreadable.
    """
    document = read_plan_document(folder)
    path = folder / "plan.json"
    try:
        grid = _grid(document["grid"])
        scenario_path = folder / document["scenario"]["path"]
    except (KeyError, TypeError, ValueError, IndexError) as problem:
        raise InputError(f"lacks {problem} or holds another type there; plan again", source=path) from problem
    scenario = read_scenario(scenario_path)
    occupancy = read_occupancy_map(scenario.map_path, scenario.map_resolution_m)
    _check_fresh(path, document, scenario_path, occupancy)
    return PlanSource(folder, document, grid, scenario, occupancy)


def _check_fresh(path: Path, document: Mapping[str, Any], scenario: Path, occupancy: OccupancyMap) -> None:
    """Refuse a plan whose scenario or map was changed since it was made: what it says would be drawn on another map."""
    recorded = document["map"]
    for file, digest in (
        (scenario, document["scenario"].get("sha256")),
        (occupancy.path, recorded.get("sha256")),
        (occupancy.image_path, recorded.get("image_sha256")),
    ):
        if sha256_of(file) != digest:
            message = f"{file} was changed since this plan was made; plan and run again, or restore the file"
            raise InputError(message, source=path)


def read_run_source(folder: Path, *, growing: bool = False) -> RunSource:
    """Read a run and the plan that it walked.

    Args:
        folder: of the run.
        growing: whether a last line without its end is passed over, because it is still being written.

    Raises:
        InputError: if something is missing, unreadable, or made for another scenario.
    """
    run = read_run(folder, growing=growing)
    plan_path = run.folder / run.header.plan.path
    plan = read_plan_source(plan_path.parent if plan_path.suffix == ".json" else plan_path)
    if plan.document["scenario"].get("sha256") != run.header.scenario.sha256:
        raise InputError(
            f"was made with another scenario than the run {run.folder}; plan and run again", source=plan.folder
        )
    return RunSource(run, plan)


def _grid(content: Mapping[str, Any]) -> CoarseGrid:
    rows, columns = int(content["rows"]), int(content["columns"])
    if not (0 < rows <= 10_000 and 0 < columns <= 10_000):
        raise ValueError("grid.rows and grid.columns from 1 to 10000")
    free = np.zeros((rows, columns), np.bool_)
    for row, column in content["free"]:
        if not (0 <= row < rows and 0 <= column < columns):
            raise ValueError("grid.free cells inside the grid")
        free[row, column] = True
    free.setflags(write=False)
    origin, corner = content["origin_m"], content["north_west_m"]
    return CoarseGrid(
        cell_size_m=float(content["cell_size_m"]),
        origin_m=(float(origin[0]), float(origin[1])),
        rotation_rad=float(content["rotation_rad"]),
        rows=rows,
        columns=columns,
        north_west_m=(float(corner[0]), float(corner[1])),
        free=free,
    )


def strategy_of(source: PlanSource) -> NavigationStrategy:
    """Return the navigation strategy of a plan."""
    goals = tuple(source.grid.index(cell) for cell in source.cells("goals"))
    kinds = tuple(tuple(int(number) for number in kind) for kind in source.document.get("kinds", ()))
    return load_navigation_strategy(source.folder / "navigation.npz", goals, kinds)

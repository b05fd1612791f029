"""Writes a plan folder (docs/formats.md, section 2), whole or not at all."""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from surefoot import __version__
from surefoot.compute import check_writable, sha256_of, write_text_whole
from surefoot.errors import InputError
from surefoot.frames import Direction
from surefoot.missions.obstacles.bodies import bodies_of
from surefoot.missions.plans.document import read_plan_document
from surefoot.missions.references import reference
from surefoot.missions.scenario.scene import BipedScene
from surefoot.navigation import (
    STOP_ORDER,
    ActionRules,
    ActionStrategy,
    FineStart,
    NavigationStrategy,
    save_arrays,
)
from surefoot.robots import Biped
from surefoot.world import Profile

DRAWN = ("plan.png", "play.png")
PLAN_FILES = frozenset({"plan.json", "navigation.npz", "action.npz", *DRAWN})
"""What a plan folder holds; a folder with anything else is not replaced."""


def write_plan(
    folder: Path,
    scene: BipedScene,
    rules: ActionRules,
    navigation: NavigationStrategy,
    action: ActionStrategy,
    start: FineStart,
    statistics: dict[str, int],
) -> None:
    """Write the strategies and plan.json into a folder that exists."""
    arrays = {"navigation.npz": navigation.arrays(), "action.npz": action.arrays()}
    for name, content in arrays.items():
        save_arrays(folder / name, content)
    image = reference(scene.occupancy.image_path, folder)
    document = {
        "kind": "biped-plan",
        "format": 1,
        "surefoot": __version__,
        "made": datetime.now(UTC).isoformat(timespec="seconds"),
        "scenario": reference(scene.path, folder),
        "map": {
            **reference(scene.occupancy.path, folder),
            "image_path": image["path"],
            "image_sha256": image["sha256"],
        },
        "realizable": True,
        "verified": True,
        **_scene(scene, start),
        "contexts": [
            {"here": here, "order": "stop" if order == STOP_ORDER else Direction(order).name.lower(), "there": there}
            for here, order, there in rules.contexts
        ],
        "statistics": statistics,
        "files": {name: sha256_of(folder / name) for name in arrays},
    }
    write_text_whole(folder / "plan.json", json.dumps(document, indent=1) + "\n")


def _scene(scene: BipedScene, start: FineStart) -> dict[str, Any]:
    """Return what plan.json says of the scenario on its map."""
    grid, problem = scene.grid, scene.problem

    def cells(indices: Iterable[int]) -> list[list[int]]:
        return [list(grid.cell(index)) for index in indices]

    return {
        "grid": {
            "rows": grid.rows,
            "columns": grid.columns,
            "north_west_m": list(grid.north_west_m),
            "cell_size_m": grid.cell_size_m,
            "origin_m": list(grid.origin_m),
            "rotation_rad": grid.rotation_rad,
            "free": [list(cell) for cell in grid.free_cells()],
        },
        "walking": asdict(scene.walking),
        "robot": _robot(scene.robot),
        "profiles": [None if profile is None else _profile(profile) for profile in scene.heights.profiles],
        "start": {
            "cell": list(grid.cell(problem.start)),
            "heading": problem.heading.name.lower(),
            "fine": {"row": start.row, "column": start.column},
            "moved_m": start.moved_cells * scene.walking.fine_cell_m,
        },
        "goals": cells(problem.goals),
        "obstacles": [
            {
                "start": list(grid.cell(body.start)),
                "domain": cells(body.domain),
                "speed_cells": body.kind.speed_cells,
            }
            for body in bodies_of(problem)
        ],
        "belief": {
            "abstraction": problem.belief,
            "regions": [cells(sorted(region)) for region in problem.regions] if problem.belief == "regions" else [],
        },
        "kinds": [list(kind.obstacles) for kind in problem.obstacle_kinds],
    }


def _robot(robot: Biped) -> dict[str, Any]:
    return {
        "name": robot.name,
        "apex_height_m": robot.apex_height_m,
        "omega_radps": robot.omega_radps,
        "foot_radius_m": robot.foot_radius_m,
        "foot_half_length_m": robot.foot_half_length_m,
        "foot_half_width_m": robot.foot_half_width_m,
    }


def _profile(profile: Profile) -> dict[str, Any]:
    return {
        "up": profile.up.name.lower(),
        "heights_m": list(profile.heights_m),
        "gain_m": profile.gain_m,
        "admissible": list(profile.admissible),
    }


def check_plan_folder(out: Path) -> None:
    """Refuse to plan into a folder that holds something else than an older plan, or that cannot be written."""
    if out.exists() and not out.is_dir():
        raise InputError("is a file; name a folder for the plan", source=out)
    others = sorted({path.name for path in out.iterdir()} - PLAN_FILES) if out.is_dir() else []
    if others:
        raise InputError(
            f"holds other files, such as {others[0]}; name a new folder or one with an older plan", source=out
        )
    if (out / "plan.json").exists():
        read_plan_document(out)
    check_writable(out / "plan.json")


@contextmanager
def replaced_plan_folder(out: Path) -> Iterator[Path]:
    """Give a new folder beside ``out``; its files take their places when the block ends without an error.

    plan.json comes last, so that a plan that was only half replaced does not fit its own hashes.
    """
    place = out.resolve()
    new = [parent for parent in place.parents if not parent.exists()]
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        folder = Path(tempfile.mkdtemp(dir=place.parent, prefix=f".{place.name}."))
    except OSError as problem:
        raise InputError(f"cannot be written: {problem.strerror}", source=out) from problem
    try:
        yield folder
        place.mkdir(exist_ok=True)
        for picture in DRAWN:
            (place / picture).unlink(missing_ok=True)
        for path in sorted(folder.iterdir(), key=lambda path: path.name == "plan.json"):
            path.replace(place / path.name)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        for parent in new if not place.exists() else ():
            with suppress(OSError):
                parent.rmdir()

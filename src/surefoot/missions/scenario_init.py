"""A starting scenario for a map: a grid that fits it, places to go to, an obstacle, and comments that explain them."""

from __future__ import annotations

import json
import math
import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from surefoot.compute import write_text_whole
from surefoot.errors import InputError, LimitExceeded
from surefoot.frames import Cell, Direction
from surefoot.missions._init_layout import Layout, best_grid, lay_out, looping_cells, quarters, square
from surefoot.world import CoarseGrid, OccupancyMap, Rectangle, read_occupancy_map

_LEAST_LOOP = 4
_EXACT_BELIEF_CELLS = 12
_TIME_LIMIT_S = 60.0
_SMALLER = 0.9
_SIZES_TRIED = 12
_SHIFTS_TRIED = 8
_NEAR = 0.05
_SIZES_NEAR = 5
_MUCH_MORE = 1.2


@dataclass(frozen=True, slots=True)
class InitAnswer:
    """What was written.

    Attributes:
        scenario: the file.
        free_cells: free cells of the grid.
        obstacle: whether the scenario has a moving obstacle.
        checked: whether a plan exists for it; None when that took too long to find out.
        notes: what the user should know.
    """

    scenario: Path
    free_cells: int
    obstacle: bool
    checked: bool | None
    notes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _Draft:
    """One way to populate a layout: where the obstacle starts, which cells it never enters, and why."""

    obstacle: Cell | None
    forbidden: tuple[Cell, ...]
    why: str


def init_scenario(
    map_path: Path,
    out: Path,
    *,
    cell_size_m: float = 2.70351,
    resolution_m: float | None = None,
    robot: str = "digit",
    replace: bool = False,
    progress: Callable[[str], None] = lambda _: None,
    time_limit_s: float = _TIME_LIMIT_S,
) -> InitAnswer:
    """Write a starting scenario for a map; it is planned once to make sure that it can be.

    Args:
        map_path: ROS map_server YAML, or a picture.
        out: the scenario file to write.
        cell_size_m: side of a coarse cell.
        resolution_m: metres per pixel, for a picture.
        robot: a name in `surefoot.robots`.
        replace: whether an existing file may be replaced.
        progress: is told what happens.
        time_limit_s: how long an attempt to plan may take.

    Raises:
        InputError: if the map cannot be used, or has no loop of free cells of this size.
    """
    if out.exists() and not replace:
        raise InputError("exists already; choose another name, or replace it with --force", source=out)
    if out.suffix.lower() not in {".yaml", ".yml"}:
        raise InputError("has to end in .yaml or .yml", source=out)
    occupancy = read_occupancy_map(map_path, resolution_m)
    progress("laying the grid")
    layout = _layout(occupancy, cell_size_m, robot)
    draft, checked = _first_that_plans(layout, map_path, resolution_m, robot, progress, time_limit_s)
    reference = os.path.relpath(map_path.resolve(), out.resolve().parent)
    write_text_whole(out, _text(layout, draft, reference, resolution_m, robot))
    notes = [draft.why] if draft.why else []
    better = _better_size(occupancy, layout, robot)
    if better:
        notes.append(better)
    if checked is None:
        notes.append(f"whether it can be planned was not found out within {time_limit_s:g} s")
    return InitAnswer(out, int(layout.grid.free.sum()), draft.obstacle is not None, checked, tuple(notes))


def _layout(occupancy: OccupancyMap, cell_size_m: float, robot: str) -> Layout:
    grid = best_grid(occupancy, cell_size_m, _inflation_m(cell_size_m, robot))
    loops = looping_cells(grid)
    if len(loops) < _LEAST_LOOP:
        free = int(grid.free.sum())
        lack = "none of them on a loop, which a robot needs that makes no U-turn" if free else "far too few to walk"
        raise InputError(
            f"has {free} free cells of {cell_size_m:g} m, {lack}; {_advice(occupancy, cell_size_m, robot)}",
            source=occupancy.path,
        )
    return lay_out(grid, loops)


def _inflation_m(cell_size_m: float, robot: str) -> float:
    from surefoot.missions.scenario.scene import inflation_m
    from surefoot.robots import biped
    from surefoot.walking import step_library, walking_parameters

    walking, numbers = walking_parameters(cell_size_m), biped(robot)
    step_library(walking, numbers)
    return inflation_m(walking, numbers)


def _advice(occupancy: OccupancyMap, cell_size_m: float, robot: str) -> str:
    """Return a cell size that would do, in words; sizes for which there are no steps are passed over."""
    for attempt in range(1, _SIZES_TRIED + 1):
        smaller = round(cell_size_m * _SMALLER**attempt, 2)
        try:
            grid = best_grid(occupancy, smaller, _inflation_m(smaller, robot), most_shifts=_SHIFTS_TRIED)
        except InputError:
            continue
        if len(looping_cells(grid)) >= _LEAST_LOOP:
            return f"smaller cells would do: --cell-size {smaller:g}"
    return "cells small enough for this map are too small for the steps of this robot"


def _better_size(occupancy: OccupancyMap, layout: Layout, robot: str) -> str:
    """Return in words that cells of about the same size would cover much more of the map; empty if none would."""
    found = [layout.grid]
    for size_m in _sizes_near(layout.grid.cell_size_m, occupancy.resolution_m):
        with suppress(InputError):
            found.append(best_grid(occupancy, size_m, _inflation_m(size_m, robot), most_shifts=_SHIFTS_TRIED))
    best = max(found, key=_covers)
    if _covers(best) <= _MUCH_MORE * _covers(layout.grid):
        return ""
    free, own, size_m = int(best.free.sum()), int(layout.grid.free.sum()), best.cell_size_m
    return f"of cells of {size_m:g} m, {free} would be free instead of {own}: --cell-size {size_m:g}"


def _sizes_near(size_m: float, pixel_m: float) -> list[float]:
    """Return the nearest sizes of whole pixels, and of whole decimetres, that differ by a few per cent at most."""
    low, high = (1 - _NEAR) * size_m, (1 + _NEAR) * size_m
    pixels = range(math.ceil(low / pixel_m), math.floor(high / pixel_m) + 1)
    near = {round(count * pixel_m, 6) for count in pixels} | {round(size_m, 1)}
    return sorted((other for other in near if low <= other <= high), key=lambda other: abs(other - size_m))[
        :_SIZES_NEAR
    ]


def _covers(grid: CoarseGrid) -> float:
    return float(grid.free.sum()) * grid.cell_size_m**2


def _drafts(layout: Layout) -> Iterator[_Draft]:
    """Yield ways to place an obstacle, the most demanding first, and at last none."""
    places = (layout.start, *layout.goals)
    if layout.obstacle is not None:
        yield _Draft(layout.obstacle, (), "")
        why = "the obstacle keeps off the start and the goals: anywhere else, it could stop the robot for ever"
        yield _Draft(layout.obstacle, tuple(cell for cell in places if cell != layout.obstacle), why)
        wide = {near for cell in places for near in (cell, *(cell.neighbour(way) for way in Direction))}
        cells = tuple(sorted(cell for cell in wide if layout.grid.is_free(cell) and cell != layout.obstacle))
        why = "the obstacle keeps off start, goals and the cells beside them: it could stop the robot for ever there"
        yield _Draft(layout.obstacle, cells, why)
    yield _Draft(None, (), "there is no obstacle: wherever one was tried, it could stop the robot for ever")


def _first_that_plans(
    layout: Layout,
    map_path: Path,
    resolution_m: float | None,
    robot: str,
    progress: Callable[[str], None],
    time_limit_s: float,
) -> tuple[_Draft, bool | None]:
    """Return the first draft for which there is a plan, or the last one, and whether there is one for it."""
    from surefoot.missions.plans.planning import plan_mission

    drafts = tuple(_drafts(layout))
    with tempfile.TemporaryDirectory(prefix="surefoot-") as name:
        path = Path(name) / "scenario.yaml"
        for number, draft in enumerate(drafts, 1):
            progress(f"trying scenario {number} of {len(drafts)}")
            path.write_text(_text(layout, draft, str(map_path.resolve()), resolution_m, robot), encoding="utf-8")
            try:
                if plan_mission(path, Path(name) / "plan", lambda _: None, time_limit_s=time_limit_s).realizable:
                    return draft, True
            except LimitExceeded:
                return draft, None
    return drafts[-1], False


def _text(layout: Layout, draft: _Draft, map_name: str, resolution_m: float | None, robot: str) -> str:
    """Return the scenario as commented YAML."""
    grid = layout.grid
    size = grid.cell_size_m
    lines = [
        "# A biped's mission. Positions are in metres of the map; the picture beside this file shows them.",
        "# Every key: docs/formats.md; for editors: surefoot scenario schema",
        "format: 1",
        "kind: biped",
        f"map: {json.dumps(map_name, ensure_ascii=False)}",
        *([f"map_resolution_m: {resolution_m!r}    # metres per pixel"] if resolution_m is not None else []),
        f"grid: {{cell_size_m: {size:.10g}, origin_m: {_pair(grid.origin_m, 7)}, "
        f"rotation_rad: {grid.rotation_rad!r}, unknown: blocked}}",
        f"robot: {robot}",
        f"start: {{position_m: {_center(layout, layout.start)}, heading: {layout.heading.name.lower()}}}",
        "goals:    # visited in this order, for ever",
        *(f"  - {{position_m: {_center(layout, goal)}}}" for goal in layout.goals),
        *_obstacle_lines(layout, draft),
        f"sensor: {{range_m: {math.ceil(400 * size) / 100:g}}}    # four cells",
        *_region_lines(layout),
        "heights: {floors: [], stairs: []}    # everything at height 0",
        "walking: {}    # the step library, safety distance, speeds and costs have defaults",
    ]
    return "\n".join(lines) + "\n"


def _obstacle_lines(layout: Layout, draft: _Draft) -> list[str]:
    comment = [f"# {draft.why[:1].upper()}{draft.why[1:]}."] if draft.why else []
    if draft.obstacle is None:
        return [*comment, "obstacles: []"]
    lines = [*comment, "obstacles:", f"  - start_m: {_center(layout, draft.obstacle)}    # then it moves as it likes"]
    if not draft.forbidden:
        return [*lines, "    forbidden: []    # rectangles that it never enters: [{rectangle_m: [x0, y0, x1, y1]}]"]
    squares = (square(layout.grid, cell) for cell in draft.forbidden)
    return [*lines, "    forbidden:", *(f"      - {{rectangle_m: {_rectangle(area)}}}" for area in squares)]


def _region_lines(layout: Layout) -> list[str]:
    """Return the belief regions: none on a small map, where every cell is tracked, else a few parts of the map."""
    free = layout.grid.free_cells()
    if len(free) <= _EXACT_BELIEF_CELLS:
        return ["belief_regions: []    # none: a hidden obstacle is tracked cell by cell"]
    areas = quarters(layout.grid, free)
    return [
        "belief_regions:    # how coarsely a hidden obstacle is tracked; the rest is one more region",
        *(f"  - {{rectangles_m: [{_rectangle(area)}]}}" for area in areas),
    ]


def _center(layout: Layout, cell: Cell) -> str:
    return _pair(layout.grid.center_m(cell), 4)


def _pair(point: tuple[float, float], decimals: int) -> str:
    return f"[{round(point[0], decimals):.10g}, {round(point[1], decimals):.10g}]"


def _rectangle(area: Rectangle) -> str:
    return f"[{', '.join(f'{value:.10g}' for value in area)}]"

"""A biped scenario brought onto its map: the values that planning and walking share."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from heapq import heappop, heappush
from pathlib import Path
from typing import Any

from surefoot.errors import InputError
from surefoot.frames import Cell, Direction
from surefoot.missions.scenario.file import Scenario, read_scenario
from surefoot.navigation import (
    BeliefKind,
    CoarseMap,
    NavigationProblem,
    Obstacle,
    automatic_regions,
    coarse_map,
)
from surefoot.navigation.automatic_regions import PRECISION
from surefoot.robots import Biped, biped
from surefoot.walking import StepLibrary, WalkingParameters, step_library, walking_parameters
from surefoot.world import (
    CoarseGrid,
    Floor,
    HeightMap,
    OccupancyMap,
    Rectangle,
    Stairs,
    make_grid,
    make_heights,
    read_occupancy_map,
)

LARGEST_SMALL_CELL_M = 4
"""The smallest cells that steps fit are looked for up to this size."""
MOST_CELLS_FOR_EXACT_BELIEF = 40
"""Beyond, the sets in which an obstacle may hide are too many to tell apart, unless the scenario asks for it."""


@dataclass(frozen=True, slots=True)
class BipedScene:
    """A scenario on its map.

    Attributes:
        path: the scenario file.
        scenario: what it says.
        occupancy: the map's pixels.
        robot: the biped's numbers.
        walking: the walking parameters with their defaults filled in.
        library: the steps, checked against the theorems.
        coarse: cells, moves and views.
        problem: the navigation problem.
    """

    path: Path
    scenario: Scenario
    occupancy: OccupancyMap
    robot: Biped
    walking: WalkingParameters
    library: StepLibrary
    coarse: CoarseMap
    problem: NavigationProblem

    @property
    def grid(self) -> CoarseGrid:
        """Return the coarse grid."""
        return self.coarse.grid

    @property
    def heights(self) -> HeightMap:
        """Return floors and stairs."""
        return self.coarse.heights


def read_biped_scene(path: Path) -> BipedScene:
    """Read a scenario and everything that it names.

    Raises:
        InputError: with the file and key, if anything in it cannot be used.
    """
    scenario = read_scenario(path)
    if not scenario.map_path.exists():
        raise InputError(f"{scenario.map_path} does not exist; name a map", **scenario.place("map"))
    occupancy = read_occupancy_map(scenario.map_path, scenario.map_resolution_m)
    with _placed(scenario):
        robot = biped(scenario.robot)
        given = scenario.walking.model_dump(exclude_none=True)
        walking = walking_parameters(scenario.grid.cell_size_m, **given)
        library = _library(walking, robot, given)
        inflated_m = inflation_m(walking, robot)
        grid = make_grid(
            occupancy,
            cell_size_m=scenario.grid.cell_size_m,
            origin_m=scenario.grid.origin_m,
            rotation_rad=scenario.grid.rotation_rad,
            unknown=scenario.grid.unknown,
            inflation_m=inflated_m,
        )
        heights = scenario_heights(scenario, grid, walking.fine_cells)
        coarse = coarse_map(grid, heights, scenario.sensor.range_m, scenario.navigation.corners)
        problem = _problem(scenario, coarse, inflated_m)
    return BipedScene(path, scenario, occupancy, robot, walking, library, coarse, problem)


def _library(walking: WalkingParameters, robot: Biped, given: Mapping[str, Any]) -> StepLibrary:
    """Return the step library; where no key of the walking block is to blame, the size of the cells is.

    Raises:
        InputError: naming the key, or the smallest cells with the default numbers.
    """
    try:
        return step_library(walking, robot)
    except InputError as problem:
        if (problem.key or "").removeprefix("walking.").split("[")[0] in given or "fine_cells" in given:
            raise
        size_m = walking.fine_cell_m * walking.fine_cells
        allowed = smallest_cell_m(robot, given, size_m)
        advice = f"cells from {allowed:g} m on are large enough" if allowed else problem.message
        message = f"{size_m:g} is not allowed: the steps of this robot do not fit cells of that size; {advice}"
        raise InputError(message, key="grid.cell_size_m") from problem


def smallest_cell_m(robot: Biped, given: Mapping[str, Any], above_m: float) -> float | None:
    """Return the smallest cell above a size, in centimetres, for which all steps satisfy the theorems; None for none.

    Args:
        robot: the biped.
        given: the keys of the walking block.
        above_m: where to begin.
    """
    for hundredths in range(math.floor(100 * above_m) + 1, 100 * LARGEST_SMALL_CELL_M):
        with suppress(InputError):
            step_library(walking_parameters(hundredths / 100, **given), robot)
            return hundredths / 100
    return None


def scenario_heights(scenario: Scenario, grid: CoarseGrid, fine_cells: int) -> HeightMap:
    """Return the heights of a scenario's floors and stairs on its grid."""
    return make_heights(grid, fine_cells, _floors(scenario), _stairs(scenario))


def inflation_m(walking: WalkingParameters, robot: Biped) -> float:
    """Return by how much the reach of a footprint from the waypoint exceeds the side band [m] (rules.md 1)."""
    band_m = (walking.side_band_cells + 0.5) * walking.fine_cell_m
    return max(0.0, walking.safety_distance_m + robot.foot_radius_m - band_m)


@contextmanager
def _placed(scenario: Scenario) -> Iterator[None]:
    """Add the scenario's file and line to input errors that name a key of it."""
    try:
        yield
    except InputError as problem:
        if problem.source is not None:
            raise
        parts = re.findall(r"[^.\[\]]+", problem.key or "")
        where = scenario.place(*(int(part) if part.isdigit() else part for part in parts))
        raise InputError(problem.message, **where) from problem


def _floors(scenario: Scenario) -> tuple[Floor, ...]:
    return tuple(Floor(tuple(floor.rectangles_m), floor.height_m) for floor in scenario.heights.floors)


def _stairs(scenario: Scenario) -> tuple[Stairs, ...]:
    return tuple(
        Stairs(
            stairs.rectangle_m,
            Direction[stairs.up.upper()],
            stairs.risers,
            stairs.riser_m,
            stairs.tread_m,
            stairs.first_riser_m,
        )
        for stairs in scenario.heights.stairs
    )


def _problem(scenario: Scenario, coarse: CoarseMap, inflated_m: float) -> NavigationProblem:
    """Return the navigation problem, having checked every place that the scenario names."""
    grid = coarse.grid
    start = _free_cell(grid, scenario.start.position_m, "start.position_m", inflated_m)
    if coarse.is_stairs(grid.index(start)):
        raise InputError(f"{tuple(start)} is a stairs cell; the robot starts in a flat one", key="start.position_m")
    goals = tuple(
        _free_cell(grid, goal.position_m, f"goals[{number}].position_m", inflated_m)
        for number, goal in enumerate(scenario.goals)
    )
    for number, goal in enumerate(goals):
        _check_reachable(coarse, start, goal, f"goals[{number}].position_m")
    obstacles = _obstacles(scenario, grid, start, inflated_m)
    belief, regions = _belief(scenario, coarse, obstacles)
    return NavigationProblem(
        coarse=coarse,
        start=grid.index(start),
        heading=Direction[scenario.start.heading.upper()],
        goals=tuple(map(grid.index, goals)),
        obstacles=obstacles,
        regions=regions,
        belief=belief,
        view=scenario.navigation.view,
        belief_tracking=scenario.navigation.belief_tracking,
    )


def _belief(
    scenario: Scenario, coarse: CoarseMap, obstacles: tuple[Obstacle, ...]
) -> tuple[BeliefKind, tuple[frozenset[int], ...]]:
    """Return how hidden obstacles are tracked, and the belief regions."""
    asked = scenario.navigation
    regions = _regions(scenario, coarse.grid)
    if asked.belief == "automatic":
        precision = PRECISION if asked.belief_precision is None else asked.belief_precision
        return "regions", automatic_regions(coarse, obstacles, precision)
    if asked.belief is not None:
        return asked.belief, regions
    if regions:
        return "regions", regions
    cells = len(coarse.grid.free_cells())
    few = all(cells - len(obstacle.forbidden) <= MOST_CELLS_FOR_EXACT_BELIEF for obstacle in obstacles)
    return "exact" if len(obstacles) <= 1 and few else "single", regions


def _free_cell(grid: CoarseGrid, position_m: tuple[float, float], key: str, inflated_m: float) -> Cell:
    cell = grid.cell_at(position_m)
    if cell is None:
        raise InputError(f"{tuple(position_m)} is off the grid, which has {_extent(grid)}", key=key)
    if not grid.is_free(cell):
        nearest = min(grid.free_cells(), key=lambda free: _distance(grid, free, position_m), default=None)
        allowed = "the map has no free cell" if nearest is None else f"the nearest free one is {_named(grid, nearest)}"
        if inflated_m > 0:
            allowed += (
                f" (occupied space is inflated by {inflated_m:.2f} m, because walking.safety_distance_m and the foot "
                "reach that much beyond walking.side_band_cells)"
            )
        raise InputError(f"{tuple(position_m)} lies in the blocked cell {tuple(cell)}; {allowed}", key=key)
    return cell


def _extent(grid: CoarseGrid) -> str:
    centers = [grid.center_m(Cell(row, column)) for row in (0, grid.rows - 1) for column in (0, grid.columns - 1)]
    xs, ys = zip(*centers, strict=True)
    return (
        f"{grid.rows} x {grid.columns} cells with centres from ({min(xs):.2f}, {min(ys):.2f}) "
        f"to ({max(xs):.2f}, {max(ys):.2f}) m"
    )


def _named(grid: CoarseGrid, cell: Cell) -> str:
    x, y = grid.center_m(cell)
    return f"{tuple(cell)} with its centre at ({x:.2f}, {y:.2f}) m"


def _distance(grid: CoarseGrid, cell: Cell, position_m: tuple[float, float]) -> float:
    x, y = grid.center_m(cell)
    return (x - position_m[0]) ** 2 + (y - position_m[1]) ** 2


def _check_reachable(coarse: CoarseMap, start: Cell, goal: Cell, key: str) -> None:
    """Refuse a goal that no walk reaches, naming what separates it from the start."""
    reached, queue = {start}, [start]
    grid = coarse.grid
    for cell in queue:
        for direction in Direction:
            near = cell.neighbour(direction)
            if near not in reached and coarse.heights.passable(grid, cell, direction):
                reached.add(near)
                queue.append(near)
    if goal in reached:
        return
    walls = separating_cells(grid, start, goal)
    if walls:
        reason = f"the blocked cells {', '.join(str(tuple(cell)) for cell in walls)} separate them"
    else:
        pairs = [
            f"{tuple(cell)} and {tuple(near)}"
            for cell in sorted(reached)
            for near in map(cell.neighbour, Direction)
            if grid.is_free(near) and near not in reached
        ]
        reason = f"no way leads over the difference in height between {', '.join(pairs[:3])}"
    raise InputError(f"the cell {tuple(goal)} cannot be reached from the start {tuple(start)}: {reason}", key=key)


def separating_cells(grid: CoarseGrid, start: Cell, goal: Cell) -> tuple[Cell, ...]:
    """Return the fewest blocked cells that would have to be free for a way from one cell to another."""
    queue: list[tuple[tuple[int, int], Cell]] = [((0, 0), start)]
    best: dict[Cell, tuple[tuple[int, int], Cell | None]] = {start: ((0, 0), None)}
    while queue:
        (blocked, length), cell = heappop(queue)
        for direction in Direction:
            near = cell.neighbour(direction)
            toll = (blocked + (not grid.is_free(near)), length + 1)
            if grid.has(near) and (near not in best or toll < best[near][0]):
                best[near] = (toll, cell)
                heappush(queue, (toll, near))
    way, place = [], best[goal][1]
    while place is not None:
        way.append(place)
        place = best[place][1]
    return tuple(cell for cell in reversed(way) if not grid.is_free(cell))


def _obstacles(scenario: Scenario, grid: CoarseGrid, start: Cell, inflated_m: float) -> tuple[Obstacle, ...]:
    """Return where the obstacles start, which cells they never enter, and how fast they are."""
    found: list[Obstacle] = []
    for number, obstacle in enumerate(scenario.obstacles):
        key = f"obstacles[{number}].start_m"
        cell = _free_cell(grid, obstacle.start_m, key, inflated_m)
        rectangles: list[Rectangle] = [area.rectangle_m for area in obstacle.forbidden]
        never = frozenset(
            grid.index(place) for area in rectangles for place in grid.wholly_inside(area) if grid.is_free(place)
        )
        if grid.index(cell) in never:
            raise InputError(f"the cell {tuple(cell)} is forbidden to this obstacle; start it outside", key=key)
        if cell == start:
            raise InputError(f"the cell {tuple(cell)} is the robot's; start the obstacle in another", key=key)
        found.append(Obstacle(grid.index(cell), never, obstacle.speed_cells))
    return tuple(found)


def _regions(scenario: Scenario, grid: CoarseGrid) -> tuple[frozenset[int], ...]:
    """Return the belief regions as sets of free cells; they must be disjoint and not empty."""
    free = set(grid.free_cells())
    regions: list[frozenset[int]] = []
    for number, region in enumerate(scenario.belief_regions):
        key = f"belief_regions[{number}].rectangles_m"
        cells = frozenset(grid.index(cell) for area in region.rectangles_m for cell in grid.centered_in(area) & free)
        if not cells:
            raise InputError(
                "no free cell has its centre in this region; rectangles are [x0, y0, x1, y1] in metres", key=key
            )
        for other, earlier in enumerate(regions):
            if common := cells & earlier:
                shared = tuple(grid.cell(min(common)))
                raise InputError(
                    f"overlaps belief_regions[{other}] in the cell {shared}; regions are disjoint", key=key
                )
        regions.append(cells)
    return tuple(regions)

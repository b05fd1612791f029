"""The scene that a scenario and a map describe, derived again; a plan is compared with it, never believed."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.frames import Direction
from surefoot.robots.biped import Biped, biped
from surefoot.verify.scene.grid import GridFrame, free_cells, lay_grid
from surefoot.verify.scene.heights import CellProfile, Terrain, lay_terrain
from surefoot.verify.scene.scenario import Scenario
from surefoot.verify.scene.sight import sight
from surefoot.world.occupancy import OccupancyMap, read_occupancy_map

Cell = tuple[int, int]
Context = tuple[int, int, int]
STOP = 4


@dataclass(frozen=True, slots=True)
class ObstacleKind:
    """Obstacles that nobody tells apart: the same domain and the same speed (rules.md 4, kinds).

    Attributes:
        members: numbers of the obstacles, ascending.
        domain: cells that they may be in, ascending.
        speed_cells: how many cells they move in a turn at most.
    """

    members: tuple[int, ...]
    domain: tuple[int, ...]
    speed_cells: int


@dataclass(frozen=True, slots=True)
class Scene:
    """Everything that the two games need, derived from scenario and map alone.

    Attributes:
        solid: pixels that no foot may stand on.
        sees: (cells, cells), by row * columns + column.
        obstacle_kinds: in the order of their first obstacles.
        regions: those of the scenario, cut with the free cells; the rest of the free cells is one more.
        kinds: index of each free cell's profile, 0 for flat; None in ``profiles`` is flat.
        contexts: (profile here, order, profile there), order 4 is stop.
    """

    scenario: Scenario
    robot: Biped
    floor: OccupancyMap
    solid: NDArray[np.bool_]
    frame: GridFrame
    terrain: Terrain
    sees: NDArray[np.bool_]
    obstacle_kinds: tuple[ObstacleKind, ...]
    regions: tuple[frozenset[int], ...]
    profiles: tuple[CellProfile | None, ...]
    kinds: dict[Cell, int]
    contexts: frozenset[Context]

    def index(self, cell: Cell) -> int:
        """Return the number of a cell."""
        return cell[0] * self.frame.columns + cell[1]

    @property
    def obstacles(self) -> int:
        """Return how many obstacles there are."""
        return sum(len(kind.members) for kind in self.obstacle_kinds)

    def inside(self, cell: Cell) -> bool:
        """Return whether a cell lies in the grid's rectangle."""
        return 0 <= cell[0] < self.frame.rows and 0 <= cell[1] < self.frame.columns

    def cell(self, index: int) -> Cell:
        """Return the cell of a number."""
        return divmod(index, self.frame.columns)

    def moves(self, cell: Cell) -> tuple[Direction, ...]:
        """Return the passable moves out of a free cell."""
        return tuple(move for move in Direction if self.terrain.passable(cell, move))

    def target(self, cell: Cell, move: Direction) -> Cell:
        """Return the neighbour of a cell."""
        return cell[0] + move.offset[0], cell[1] + move.offset[1]


def derive_scene(scenario: Scenario) -> Scene:
    """Derive grid, heights, visibility, obstacle domain, belief regions and contexts.

    Raises:
        InputError: the scenario does not fit the map.
    """
    floor = read_occupancy_map(scenario.map_path, scenario.map_resolution_m)
    robot = biped(scenario.robot)
    frame, on_map = lay_grid(floor, scenario.cell_size_m, scenario.origin_m, scenario.rotation_rad)
    free = free_cells(floor, frame, on_map, scenario.unknown_blocked, inflation_m(scenario, robot))
    terrain = lay_terrain(frame, free, whole_of(scenario, "fine_cells"), scenario.floors, scenario.stairs)
    profiles, kinds = _kinds(free, terrain)
    return Scene(
        scenario=scenario,
        robot=robot,
        floor=floor,
        solid=floor.occupied | floor.unknown if scenario.unknown_blocked else floor.occupied,
        frame=frame,
        terrain=terrain,
        sees=sight(free, scenario.cell_size_m, scenario.range_m, scenario.corners_hide),
        obstacle_kinds=_obstacle_kinds(scenario, frame, free),
        regions=_regions(scenario, frame, free),
        profiles=profiles,
        kinds=kinds,
        contexts=_contexts(terrain, kinds),
    )


def inflation_m(scenario: Scenario, robot: Biped) -> float:
    """Return how far occupied space is inflated (rules.md 1)."""
    fine_m = scenario.cell_size_m / number_of(scenario, "fine_cells")
    band_m = (number_of(scenario, "side_band_cells") + 0.5) * fine_m
    return max(0.0, number_of(scenario, "safety_distance_m") + robot.foot_radius_m - band_m)


def number_of(scenario: Scenario, name: str) -> float:
    """Return one number of the walking block."""
    value = scenario.walking[name]
    if isinstance(value, tuple):
        raise TypeError(name)
    return float(value)


def whole_of(scenario: Scenario, name: str) -> int:
    """Return one whole number of the walking block."""
    return round(number_of(scenario, name))


def _kinds(free: NDArray[np.bool_], terrain: Terrain) -> tuple[tuple[CellProfile | None, ...], dict[Cell, int]]:
    """Return the distinct profiles and which cell has which."""
    profiles: list[CellProfile | None] = [None]
    kinds = {}
    for row, column in np.argwhere(free):
        cell = (int(row), int(column))
        own = terrain.profiles.get(cell)
        if own is None:
            kinds[cell] = 0
            continue
        known = [index for index, profile in enumerate(profiles) if profile is not None and profile.same(own)]
        if not known:
            profiles.append(own)
        kinds[cell] = known[0] if known else len(profiles) - 1
    return tuple(profiles), kinds


def _contexts(terrain: Terrain, kinds: dict[Cell, int]) -> frozenset[Context]:
    """Return one context for every passable move between two kinds of cell, and stop in a flat cell."""
    found = {(0, STOP, 0)} if 0 in kinds.values() else set()
    for cell, kind in kinds.items():
        for move in Direction:
            if terrain.passable(cell, move):
                target = (cell[0] + move.offset[0], cell[1] + move.offset[1])
                found.add((kind, int(move), kinds[target]))
    return frozenset(found)


def _obstacle_kinds(scenario: Scenario, frame: GridFrame, free: NDArray[np.bool_]) -> tuple[ObstacleKind, ...]:
    """Return the obstacles by kind; with separate beliefs every obstacle is told apart from all others."""
    members: dict[tuple[tuple[int, ...], int, int], list[int]] = {}
    for number, part in enumerate(scenario.obstacles):
        allowed = free.copy()
        for corners in part.forbidden:
            allowed &= ~frame.wholly_inside(corners)
        domain = tuple(int(index) for index in np.flatnonzero(allowed))
        apart = number if scenario.tell_apart else 0
        members.setdefault((domain, part.speed_cells, apart), []).append(number)
    return tuple(ObstacleKind(tuple(found), domain, speed) for (domain, speed, _), found in members.items())


def _regions(scenario: Scenario, frame: GridFrame, free: NDArray[np.bool_]) -> tuple[frozenset[int], ...]:
    """Return the belief regions, cut with the free cells."""
    taken = np.zeros_like(free)
    found = []
    for number, rectangles in enumerate(scenario.regions):
        part = np.zeros_like(free)
        for corners in rectangles:
            part |= frame.centered_in(corners)
        part &= free
        if bool((part & taken).any()):
            raise InputError("overlaps another region", source=scenario.path, key=f"belief_regions[{number}]")
        taken |= part
        found.append(frozenset(int(index) for index in np.flatnonzero(part)))
    return tuple(found)


def fine_center_m(scene: Scene, cell: Cell, fine: Cell) -> tuple[float, float]:
    """Return the centre of a fine cell in the grid frame."""
    fine_m = scene.frame.cell_size_m / whole_of(scene.scenario, "fine_cells")
    west, _, _, north = scene.frame.square(*cell)
    return west + (fine[1] + 0.5) * fine_m, north - (fine[0] + 0.5) * fine_m


def fine_distance_m(scene: Scene, cell: Cell, fine: Cell, point_m: tuple[float, float]) -> float:
    """Return how far a world point is from the centre of a fine cell."""
    x, y = scene.frame.to_grid(np.array(point_m))
    center = fine_center_m(scene, cell, fine)
    return math.hypot(float(x) - center[0], float(y) - center[1])

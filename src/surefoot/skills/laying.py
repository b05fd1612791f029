"""How cells are laid over scanned ground, so that the edges of steps and stones fall on the sides of cells.

Headings, sides and offsets are proposed from the edges (``lattice_fit``); the most promising lattices are measured by
the rules of the classes, and that one is taken in which the most ground can be walked on without a break. Everything is
in order of merit and of the proposals, so the same ground gives the same cells.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import product, zip_longest

import numpy as np

from surefoot.errors import InputError
from surefoot.footholds.terrain import Polygon, polygon
from surefoot.skills.classes import ClassSet
from surefoot.skills.crevices import crevices
from surefoot.skills.laid_cells import Lay
from surefoot.skills.lattice_fit import Edges, ground_edges, headings_rad, offsets
from surefoot.skills.quadruped_terrain import Laid, Point, QuadrupedTerrain
from surefoot.skills.values import Cell, Direction

_HEADINGS = 3
_SIDES = 8
_OFFSETS = 3
_MOST_MEASURED = 3_000
_LEAST_TRIED = 4
_SIDE_STEP_M = 0.01
_MOST_CELLS = 10_000
_NEARLY = 0.9
_LEVEL_M = 0.05


@dataclass(frozen=True, slots=True)
class Wish:
    """What a lattice is for.

    Attributes:
        sets: classes to choose among.
        cell_m: side of a cell; None: what the classes serve.
        yaw_rad: heading of the robot on the scan; None: from the edges.
        start_m, goal_m: on the scan; None: anywhere.
        grid: rows and columns of a local grid.
        name: of the terrain.
    """

    sets: tuple[ClassSet, ...]
    cell_m: float | None = None
    yaw_rad: float | None = None
    start_m: Point | None = None
    goal_m: Point | None = None
    grid: tuple[int, int] = (3, 3)
    name: str = "terrain"


@dataclass(frozen=True, slots=True)
class _Try:
    """A lattice that is proposed, in a frame turned by less than 45 degrees."""

    gain: float
    classes: ClassSet
    side_m: float
    heading_rad: float
    offset_m: Point


@dataclass(frozen=True, slots=True)
class _Ground:
    """Polygons of a scan, and how they look in frames with other headings."""

    polygons: tuple[Polygon, ...]
    margin_m: float
    known: dict[float, tuple[Polygon, ...]] = field(default_factory=dict)

    def turned(self, heading_rad: float) -> tuple[Polygon, ...]:
        if heading_rad not in self.known:
            self.known[heading_rad] = tuple(_turned(one, heading_rad) for one in self.polygons)
        return self.known[heading_rad]


def lay_cells(polygons: Sequence[Polygon], margin_m: float, wish: Wish) -> tuple[Lay, int]:
    """Return the best lattice over some ground, and how many were measured.

    Args:
        polygons: where a foot may stand.
        margin_m: what was taken off their edges.
        wish: what the lattice is for.

    Raises:
        InputError: start or goal lie beside the ground, or all lattices have too many cells.
    """
    low = crevices(polygons, margin_m)
    ground = _Ground(tuple(one for number, one in enumerate(polygons) if number not in low), margin_m)
    tries = _in_turns(_tries(ground_edges(ground.polygons, margin_m), wish), wish.sets)
    measured: list[Lay] = []
    cells = 0
    for one in tries:
        lay = Lay(_terrain(ground, wish, one))
        rows, columns = lay.terrain.cells
        if rows * columns > _MOST_CELLS:
            continue
        _check_places(lay.terrain)
        measured.append(lay)
        cells += rows * columns
        if cells > _MOST_MEASURED and len(measured) >= _LEAST_TRIED:
            break
    if not measured:
        raise InputError(f"the ground needs more than {_MOST_CELLS} cells; give a larger --cell", key="--cell")
    chosen = _best(measured)
    terrain = _with_ends(Lay(_turned_uphill(chosen, ground, wish)))
    return Lay(terrain, low), len(measured)


def _in_turns(tries: Iterator[_Try], sets: Sequence[ClassSet]) -> list[_Try]:
    """Return lattices by merit, each set of classes in its turn: gains of cells of different size say little."""
    ranked = sorted(tries, key=lambda one: -one.gain)
    turns = [[one for one in ranked if one.classes is classes] for classes in sets]
    return [one for turn in zip_longest(*turns) for one in turn if one is not None]


def _best(lays: Sequence[Lay]) -> Lay:
    """Return the best lattice: with a way to the goal, and of those nearly as good as the best the largest cells.

    Where none has a way, the one that leaves the most ground to stand on tells best what is in it.
    """
    arriving = [one for one in lays if one.arrives]
    if not arriving:
        return max(lays, key=lambda one: len(one.standing) * one.terrain.cell_m**2)
    enough_m2 = _NEARLY * max(one.worth_m2 for one in arriving)
    good = [one for one in arriving if one.worth_m2 >= enough_m2]
    return max(good, key=lambda one: (one.terrain.cell_m, one.worth_m2))


def _tries(edges: Edges, wish: Wish) -> Iterator[_Try]:
    """Yield lattices, for each set and heading those of the sides at which most edges lie on lines."""
    headings = headings_rad(edges, _HEADINGS) if wish.yaw_rad is None else (wish.yaw_rad,)
    for classes, heading in product(wish.sets, headings):
        fits = []
        for side in _sides(classes, wish.cell_m):
            axes = [offsets(edges, heading, axis, side, _OFFSETS) for axis in (0, 1)]
            fits.append((sum(axis[0].gain_m for axis in axes), side, axes))
        for _, side, (along, across) in sorted(fits, key=lambda fit: -fit[0])[:_SIDES]:
            for x, y in product(along, across):
                yield _Try(x.gain_m + y.gain_m, classes, side, heading, (x.offset_m, y.offset_m))


def _sides(classes: ClassSet, given_m: float | None) -> list[float]:
    if given_m is not None or classes.cells_m is None:
        return [given_m or classes.cell_m]
    low, high = classes.cells_m
    return [round(low + k * _SIDE_STEP_M, 6) for k in range(round((high - low) / _SIDE_STEP_M) + 1)]


def _terrain(ground: _Ground, wish: Wish, one: _Try) -> QuadrupedTerrain:
    """Return the ground as a lattice sees it: turned, with its own corner and cells."""
    turned, margin_m = ground.turned(one.heading_rad), ground.margin_m
    points = np.concatenate([each.vertices_m[:, :2] for each in turned])
    low, high = points.min(axis=0) - margin_m, points.max(axis=0) + margin_m
    origin = [_below(float(low[k]), one.offset_m[k], one.side_m) for k in (0, 1)]
    rows, columns = (max(math.ceil((float(high[k]) - origin[k]) / one.side_m - 1e-9), 1) for k in (0, 1))
    return QuadrupedTerrain(
        wish.name,
        one.classes.robot,
        one.classes,
        one.side_m,
        wish.grid,
        (origin[0], origin[1]),
        (rows, columns),
        turned,
        margin_m,
        start_m=_seen(wish.start_m, one.heading_rad),
        goal_m=_seen(wish.goal_m, one.heading_rad),
        laid=Laid(yaw_deg=round(math.degrees(one.heading_rad), 6)),
    )


def _below(low_m: float, offset_m: float, side_m: float) -> float:
    """Return the last line of a lattice that is not above a value."""
    return round(offset_m + math.floor((low_m - offset_m) / side_m + 1e-9) * side_m, 9)


def _seen(place_m: Point | None, heading_rad: float) -> Point | None:
    """Return where a place of the scan is in a frame whose x axis has a heading on the scan."""
    if place_m is None:
        return None
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    x, y = place_m
    return round(c * x + s * y, 9), round(-s * x + c * y, 9)


def _turned(one: Polygon, heading_rad: float) -> Polygon:
    """Return a polygon as it is in such a frame."""
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    matrix = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    return polygon((one.vertices_m @ matrix.T).tolist(), one.friction)


def _check_places(terrain: QuadrupedTerrain) -> None:
    for option, place in (("--start", terrain.start_m), ("--goal", terrain.goal_m)):
        try:
            if place is not None:
                terrain.cell_at(place)
        except InputError as problem:
            raise InputError("lies beside the ground of the scan", key=option) from problem


def _turned_uphill(lay: Lay, ground: _Ground, wish: Wish) -> QuadrupedTerrain:
    """Return the same lattice with x along most of the steps, uphill, or from the start to the goal."""
    terrain = lay.terrain
    quarters = 0 if wish.yaw_rad is not None else _quarters(lay)
    x, y = terrain.origin_m
    side = terrain.cell_m
    for _ in range(quarters):
        x, y = y, -x
    assert terrain.laid is not None
    heading = math.radians(terrain.laid.yaw_deg) + quarters * math.pi / 2
    one = _Try(0.0, terrain.classes, side, math.remainder(heading, math.tau), (x % side, y % side))
    return _terrain(ground, wish, one)


def _quarters(lay: Lay) -> int:
    """Return by how many quarter turns x has to be turned to lead up the steps, or to the goal."""
    terrain, rise = lay.terrain, np.zeros(2)
    climbs = np.zeros(2)
    for cell in sorted(lay.part):
        for axis, way in enumerate((Direction.FORWARD, Direction.LEFT)):
            if (other := way.of(cell)) in lay.part:
                step = terrain.measured[other].height_m - terrain.measured[cell].height_m
                if abs(step) >= _LEVEL_M:
                    rise[axis] += step
                    climbs[axis] += abs(step)
    if terrain.start_m is not None and terrain.goal_m is not None:
        way_m = np.subtract(terrain.goal_m, terrain.start_m)
        climbs = climbs if climbs.any() else np.abs(way_m)
        rise = way_m
    if not climbs.any():
        return 0
    axis = int(np.argmax(climbs))
    return axis + (0 if rise[axis] >= 0 else 2)


def _with_ends(lay: Lay) -> QuadrupedTerrain:
    """Return a lattice with a start and a goal: where nobody gave them, the lowest and the highest cell that count."""
    terrain = lay.terrain
    if not lay.part or (terrain.start_m is not None and terrain.goal_m is not None):
        return terrain
    height = {cell: round(terrain.measured[cell].height_m / _LEVEL_M) for cell in lay.part}
    lowest = max(lay.part, key=lambda cell: (-height[cell], cell))
    start = terrain.start_m or terrain.centre_m(lowest)
    from_cell = terrain.cell_at(start)

    def worth(cell: Cell) -> tuple[int, int, Cell]:
        return height[cell], abs(cell[0] - from_cell[0]) + abs(cell[1] - from_cell[1]), cell

    goal = terrain.goal_m or terrain.centre_m(max(lay.part, key=worth))
    changed = replace(terrain, start_m=start, goal_m=goal)
    vars(changed)["measured"] = terrain.measured  # the cached property
    return changed

"""Heights, kinds of cells and passable moves, transcribed from rules.md 2."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.frames import Direction
from surefoot.verify.scene.grid import SLACK_CELLS, GridFrame
from surefoot.verify.scene.scenario import FloorPart, StairsPart
from surefoot.verify.values import Rectangle

RISER_CLEARANCE_M = 0.10
TOLERANCE_M = 1e-6


@dataclass(frozen=True, slots=True)
class CellProfile:
    """Heights of a stairs cell along its axis.

    Attributes:
        up: the axis.
        heights_m: at the centres of its fine cells, relative to the border where the axis enters.
        gain_m: over the whole cell.
        admissible: whether a foot may stand at each fine index.
    """

    up: Direction
    heights_m: tuple[float, ...]
    gain_m: float
    admissible: tuple[bool, ...]

    def same(self, other: CellProfile) -> bool:
        """Return whether two profiles agree (heights up to 1e-6 m)."""
        return (
            self.up == other.up
            and self.admissible == other.admissible
            and len(self.heights_m) == len(other.heights_m)
            and math.isclose(self.gain_m, other.gain_m, abs_tol=TOLERANCE_M)
            and bool(np.allclose(self.heights_m, other.heights_m, rtol=0, atol=TOLERANCE_M))
        )


@dataclass(frozen=True, slots=True)
class Flight:
    """Stairs in the grid frame."""

    square: Rectangle
    part: StairsPart
    base_m: float = 0.0

    def along(self, x: float, y: float) -> float:
        """Return how far a point is up the stairs from the lower edge."""
        west, south, east, north = self.square
        return {Direction.NORTH: y - south, Direction.EAST: x - west, Direction.SOUTH: north - y}.get(
            self.part.up, east - x
        )

    def length_m(self) -> float:
        """Return the length of the rectangle along the axis."""
        west, south, east, north = self.square
        return north - south if self.part.up in (Direction.NORTH, Direction.SOUTH) else east - west

    def riser_positions(self) -> NDArray[np.float64]:
        """Return where the risers stand, from the lower edge."""
        return (self.part.first_riser_m + np.arange(self.part.risers) * self.part.tread_m).astype(np.float64)

    def height_m(self, x: float, y: float) -> float:
        """Return the height at a point of the rectangle."""
        return self.base_m + self.part.riser_m * int((self.riser_positions() < self.along(x, y)).sum())

    def before_m(self, along_m: float) -> float:
        """Return the height just before a place along the stairs: a riser there belongs to what lies above."""
        risers = self.riser_positions() < along_m - TOLERANCE_M
        return self.base_m + self.part.riser_m * int(risers.sum())


@dataclass(frozen=True, slots=True)
class Terrain:
    """Heights of the floor everywhere, and what each free cell is.

    Attributes:
        frame: the coarse grid.
        free: (rows, columns).
        floors: rectangles in the grid frame with their heights.
        flights: the stairs.
        profiles: of the free stairs cells.
        heights_m: of the flat cells, and of the stairs cells at the border where the axis enters.
    """

    frame: GridFrame
    free: NDArray[np.bool_]
    floors: tuple[tuple[Rectangle, float], ...]
    flights: tuple[Flight, ...]
    profiles: dict[tuple[int, int], CellProfile]
    heights_m: dict[tuple[int, int], float]

    def height_at(self, point_m: tuple[float, float]) -> float:
        """Return the height of the floor under a world point."""
        x, y = self.frame.to_grid(np.array(point_m))
        return _height(self.floors, self.flights, float(x), float(y))

    def riser_gap_m(self, point_m: tuple[float, float]) -> float:
        """Return how far a world point is from the nearest riser, along the stairs; infinite beside them."""
        x, y = (float(value) for value in self.frame.to_grid(np.array(point_m)))
        gaps = [
            float(np.abs(flight.riser_positions() - flight.along(x, y)).min())
            for flight in self.flights
            if _across(flight, x, y)
        ]
        return min(gaps, default=math.inf)

    def passable(self, cell: tuple[int, int], move: Direction) -> bool:
        """Return whether the robot may go from a free cell to its neighbour."""
        target = (cell[0] + move.offset[0], cell[1] + move.offset[1])
        rows, columns = self.free.shape
        if not (0 <= target[0] < rows and 0 <= target[1] < columns) or not self.free[target] or not self.free[cell]:
            return False
        here, there = self._border_m(cell, move), self._border_m(target, move.opposite)
        return here is not None and there is not None and abs(here - there) <= TOLERANCE_M

    def _border_m(self, cell: tuple[int, int], side: Direction) -> float | None:
        """Return the height of a cell at one of its borders; None where stairs have no way through."""
        profile = self.profiles.get(cell)
        if profile is None or side == profile.up.opposite:
            return self.heights_m[cell]
        return self.heights_m[cell] + profile.gain_m if side == profile.up else None


def lay_terrain(
    frame: GridFrame,
    free: NDArray[np.bool_],
    fine_cells: int,
    floor_parts: tuple[FloorPart, ...],
    stairs_parts: tuple[StairsPart, ...],
) -> Terrain:
    """Derive the heights of every free cell.

    Raises:
        InputError: stairs or floors that do not fit the cells.
    """
    floors = tuple((frame.rectangle(corners), part.height_m) for part in floor_parts for corners in part.rectangles_m)
    flights: list[Flight] = []
    for index, part in enumerate(stairs_parts):
        flight = Flight(frame.rectangle(part.rectangle_m), part)
        _check_risers(flight, frame, f"heights.stairs[{index}]")
        flights.append(Flight(flight.square, part, _base_m(flight, floors, frame.cell_size_m)))
    terrain = Terrain(frame, free, floors, tuple(flights), {}, {})
    for row, column in np.argwhere(free):
        cell = (int(row), int(column))
        met = [flight for flight in flights if _overlaps(flight.square, frame.square(*cell), frame.cell_size_m)]
        if len(met) > 1:
            raise InputError(f"two stairs meet in cell {cell}", key="heights.stairs")
        if met:
            terrain.profiles[cell], terrain.heights_m[cell] = _profile(terrain, cell, met[0], fine_cells)
        else:
            terrain.heights_m[cell] = _flat_height(terrain, cell)
    return terrain


def _profile(terrain: Terrain, cell: tuple[int, int], flight: Flight, fine_cells: int) -> tuple[CellProfile, float]:
    """Return the profile of a stairs cell and the height where its axis enters."""
    west, south, east, north = terrain.frame.square(*cell)
    size_m, up = terrain.frame.cell_size_m, flight.part.up
    if not _spans(flight, terrain.frame.square(*cell), size_m):
        raise InputError(f"the stairs do not span cell {cell} across", key="heights.stairs")
    middle = ((west + east) / 2, (south + north) / 2)

    def point(along_m: float) -> tuple[float, float]:
        rows, columns = up.offset
        step = along_m - size_m / 2
        return middle[0] + columns * step, middle[1] - rows * step

    entry, leave = (flight.before_m(flight.along(*point(end))) for end in (0.0, size_m))
    centers = [(index + 0.5) * size_m / fine_cells for index in range(fine_cells)]
    heights = [flight.before_m(flight.along(*point(center))) for center in centers]
    found = [_height(terrain.floors, terrain.flights, *point(center)) for center in centers]
    if not np.allclose(heights, found, rtol=0, atol=TOLERANCE_M):
        raise InputError(f"the floor of cell {cell} beside the stairs does not continue them", key="heights.stairs")
    risers = flight.riser_positions()
    gaps = [float(np.abs(risers - flight.along(*point(center))).min()) for center in centers]
    profile = CellProfile(
        up,
        tuple(height - entry for height in heights),
        leave - entry,
        tuple(gap >= RISER_CLEARANCE_M - 1e-9 for gap in gaps),
    )
    return profile, entry


def _flat_height(terrain: Terrain, cell: tuple[int, int]) -> float:
    """Return the one floor height of a flat cell."""
    west, south, east, north = terrain.frame.square(*cell)
    slack = SLACK_CELLS * terrain.frame.cell_size_m
    inner = (west + slack, south + slack, east - slack, north - slack)
    found = _floor_height(terrain.floors, (west + east) / 2, (south + north) / 2)
    for square, height_m in terrain.floors:
        cut = _cut(square, inner)
        if cut is not None and abs(height_m - found) > TOLERANCE_M:
            raise InputError(f"the floor of cell {cell} has two heights", key="heights.floors")
        covers = cut is not None and max(abs(a - b) for a, b in zip(cut, inner, strict=True)) < 1e-12
        if (
            cut is not None
            and not covers
            and abs(height_m) > TOLERANCE_M
            and not _tiled(terrain.floors, inner, height_m)
        ):
            raise InputError(f"the floor of cell {cell} has two heights", key="heights.floors")
    return found


def _tiled(floors: tuple[tuple[Rectangle, float], ...], inner: Rectangle, height_m: float) -> bool:
    """Return whether floors of one height cover a square together."""
    cuts = [cut for square, height in floors if abs(height - height_m) <= TOLERANCE_M and (cut := _cut(square, inner))]
    xs = sorted({value for cut in [*cuts, inner] for value in (cut[0], cut[2])})
    ys = sorted({value for cut in [*cuts, inner] for value in (cut[1], cut[3])})
    return all(
        any(cut[0] <= (x0 + x1) / 2 <= cut[2] and cut[1] <= (y0 + y1) / 2 <= cut[3] for cut in cuts)
        for x0, x1 in pairwise(xs)
        for y0, y1 in pairwise(ys)
        if x1 - x0 > TOLERANCE_M and y1 - y0 > TOLERANCE_M
    )


def _cut(square: Rectangle, inner: Rectangle) -> Rectangle | None:
    """Return what two rectangles share; None when it has no interior."""
    west, south = max(square[0], inner[0]), max(square[1], inner[1])
    east, north = min(square[2], inner[2]), min(square[3], inner[3])
    return (west, south, east, north) if east - west > TOLERANCE_M and north - south > TOLERANCE_M else None


def _height(floors: tuple[tuple[Rectangle, float], ...], flights: tuple[Flight, ...], x: float, y: float) -> float:
    """Return the height at a point of the grid frame; stairs cover floors."""
    for flight in flights:
        west, south, east, north = flight.square
        if west <= x <= east and south <= y <= north:
            return flight.height_m(x, y)
    return _floor_height(floors, x, y)


def _floor_height(floors: tuple[tuple[Rectangle, float], ...], x: float, y: float) -> float:
    """Return the height of the floor at a point, stairs left aside; 0 outside every rectangle."""
    for (west, south, east, north), height_m in floors:
        if west <= x <= east and south <= y <= north:
            return height_m
    return 0.0


def _base_m(flight: Flight, floors: tuple[tuple[Rectangle, float], ...], size_m: float) -> float:
    """Return the height of the floor just before the lower edge of stairs."""
    west, south, east, north = flight.square
    before = 2 * SLACK_CELLS * size_m
    rows, columns = flight.part.up.offset
    found = set()
    for share in (0.1, 0.5, 0.9):
        x, y = west + share * (east - west), south + share * (north - south)
        if rows:
            y = (south - before) if flight.part.up is Direction.NORTH else (north + before)
        if columns:
            x = (west - before) if flight.part.up is Direction.EAST else (east + before)
        found.add(_floor_height(floors, x, y))
    if len(found) > 1:
        raise InputError("the floor before the lower edge has two heights", key="heights.stairs")
    return found.pop()


def _check_risers(flight: Flight, frame: GridFrame, key: str) -> None:
    """Refuse risers outside the rectangle or close to a border with a cell outside the stairs."""
    risers = flight.riser_positions()
    if risers[-1] > flight.length_m() + TOLERANCE_M:
        raise InputError("the risers do not fit into the rectangle", key=key)
    west, south, east, north = flight.square
    up, size_m = flight.part.up, frame.cell_size_m
    edge = {Direction.NORTH: south, Direction.EAST: west, Direction.SOUTH: -north}.get(up, -east)
    corner = frame.north_west_m[1 if up in (Direction.NORTH, Direction.SOUTH) else 0]
    edge -= corner if up in (Direction.NORTH, Direction.EAST) else -corner
    first = math.floor(edge / size_m + SLACK_CELLS) * size_m - edge
    last = math.ceil((edge + flight.length_m()) / size_m - SLACK_CELLS) * size_m - edge
    if min(risers[0] - first, last - risers[-1]) < RISER_CLEARANCE_M - 1e-9:
        raise InputError("a riser stands closer than 0.10 m to the border with a cell outside the stairs", key=key)


def _overlaps(one: Rectangle, other: Rectangle, size_m: float) -> bool:
    """Return whether two rectangles share more than one per cent of a cell size both ways."""
    slack = SLACK_CELLS * size_m
    wide = min(one[2], other[2]) - max(one[0], other[0])
    high = min(one[3], other[3]) - max(one[1], other[1])
    return wide > slack and high > slack


def _spans(flight: Flight, square: Rectangle, size_m: float) -> bool:
    """Return whether stairs cover a cell across their axis."""
    slack = SLACK_CELLS * size_m
    first, last = (0, 2) if flight.part.up in (Direction.NORTH, Direction.SOUTH) else (1, 3)
    return flight.square[first] <= square[first] + slack and flight.square[last] >= square[last] - slack


def _across(flight: Flight, x: float, y: float) -> bool:
    """Return whether a point lies within the width of the stairs."""
    west, south, east, north = flight.square
    return west <= x <= east if flight.part.up in (Direction.NORTH, Direction.SOUTH) else south <= y <= north

"""A flight of stairs laid over the grid: its cells, its risers and where it starts."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from surefoot.errors import InputError
from surefoot.frames import Cell, Direction
from surefoot.world.floors import FloorPlan, cells_meeting, checked_bounds
from surefoot.world.grid import INSIDE_SHARE, CoarseGrid, Rectangle

CLEARANCE_M = 0.10
"""How far from every riser a foot has to stand, and every riser from a cell outside its flight."""

_ROUNDING_M = 1e-9
_SAME_M = 1e-6
_MOST_RISERS = 10_000


@dataclass(frozen=True, slots=True)
class Stairs:
    """A flight of stairs, as a scenario gives it.

    Attributes:
        rectangle_m: its ground plan.
        up: the direction in which it rises, its axis.
        risers: number of risers.
        riser_m: height of each of them.
        tread_m: distance between two of them.
        first_riser_m: distance of the first one from the rectangle's lower edge.
    """

    rectangle_m: Rectangle
    up: Direction
    risers: int
    riser_m: float
    tread_m: float
    first_riser_m: float


@dataclass(frozen=True, slots=True, eq=False)
class Flight:
    """A flight of stairs in coordinates along its axis, which count from the grid's north-western corner.

    Attributes:
        key: the key of the scenario that it stands in.
        up: its axis.
        cells: its free cells.
        cell_size_m: side of a coarse cell.
        risers_m: positions of the risers along the axis, ascending.
        riser_m: height of each of them.
        foot_m: height of the floor just before the lower edge.
        least_clearance_m: how far feet and the cells outside the flight have to be from every riser.
    """

    key: str
    up: Direction
    cells: tuple[Cell, ...]
    cell_size_m: float
    risers_m: NDArray[np.float64]
    riser_m: float
    foot_m: float
    least_clearance_m: float = CLEARANCE_M - _ROUNDING_M

    def wrong(self, message: str) -> InputError:
        """Return the error that the flight cannot be used."""
        return InputError(message, key=self.key)

    def entry_m(self, cell: Cell) -> float:
        """Return the position along the axis of the border where the axis enters a cell."""
        return _entry(self.up, cell) * self.cell_size_m

    def risers_to(self, positions_m: ArrayLike) -> NDArray[np.intp]:
        """Return how many risers stand at or before positions along the axis."""
        return np.asarray(np.searchsorted(self.risers_m, positions_m, side="right"))

    def risers_before(self, border_m: float) -> int:
        """Return how many risers stand before a border; one that stands on it belongs to the upper cell."""
        return int(np.searchsorted(self.risers_m, border_m - _SAME_M))

    def clearance_m(self, positions_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how far positions along the axis are from the nearest riser."""
        return np.asarray(np.abs(positions_m[..., np.newaxis] - self.risers_m).min(axis=-1))


def flight_of(grid: CoarseGrid, plan: FloorPlan, stairs: Stairs, key: str) -> Flight:
    """Lay stairs over a grid.

    Raises:
        InputError: they cannot be laid; see `make_heights`.
    """
    _check(stairs, key)
    bounds = checked_bounds(grid, stairs.rectangle_m, key)
    covered = cells_meeting(grid, bounds)
    cells = tuple(cell for cell in covered if grid.is_free(cell))
    if not cells:
        raise InputError("the rectangle meets no free cell of the grid", key=key)
    low, high = _along(stairs.up, bounds)
    size_m = grid.cell_size_m
    risers_m = low * size_m + stairs.first_riser_m + stairs.tread_m * np.arange(stairs.risers, dtype=np.float64)
    if risers_m[-1] > high * size_m + _ROUNDING_M:
        raise InputError(
            f"the last riser stands {risers_m[-1] - low * size_m:.3f} m from the lower edge, beyond the upper edge at "
            f"{(high - low) * size_m:.3f} m",
            key=key,
        )
    foot_m = _foot_m(plan, stairs.up, bounds, cells, key)
    flight = Flight(key, stairs.up, cells, size_m, risers_m, stairs.riser_m, foot_m)
    _check_ends(flight, [_entry(stairs.up, cell) for cell in covered])
    for cell in cells:
        _check_cell(plan, flight, cell, bounds)
    return flight


def _check(stairs: Stairs, key: str) -> None:
    """Refuse numbers that no stairs can have."""
    if not 1 <= stairs.risers <= _MOST_RISERS:
        raise InputError(f"risers has to be from 1 to {_MOST_RISERS}, not {stairs.risers!r}", key=key)
    if not (0 < stairs.riser_m < math.inf and 0 < stairs.tread_m < math.inf):
        raise InputError("riser_m and tread_m have to be finite and more than 0", key=key)
    if not 0 <= stairs.first_riser_m < math.inf:
        raise InputError("first_riser_m has to be finite and not negative", key=key)


def _check_ends(flight: Flight, entries: list[int]) -> None:
    """Refuse a riser that stands too near to the border with a cell before or beyond the flight."""
    for border in (min(entries), max(entries) + 1):
        away_m = np.abs(flight.risers_m - border * flight.cell_size_m)
        number = int(np.argmin(away_m))
        if away_m[number] < flight.least_clearance_m:
            raise flight.wrong(
                f"riser {number} stands {away_m[number]:.3f} m from the border with a cell outside the flight, "
                f"at least {CLEARANCE_M:g} m are needed; change first_riser_m or tread_m"
            )


def _check_cell(plan: FloorPlan, flight: Flight, cell: Cell, bounds: Rectangle) -> None:
    """Refuse a flight that leaves a part of a cell beside it, or a step before or beyond it."""
    west, north, east, south = bounds
    spans = (
        north <= cell.row + INSIDE_SHARE and south >= cell.row + 1 - INSIDE_SHARE
        if flight.up in (Direction.EAST, Direction.WEST)
        else west <= cell.column + INSIDE_SHARE and east >= cell.column + 1 - INSIDE_SHARE
    )
    if not spans:
        raise flight.wrong(f"the rectangle has to span the cell {tuple(cell)} (row, column) across")
    low, high = _along(flight.up, bounds)
    entry = _entry(flight.up, cell)
    top_m = flight.foot_m + len(flight.risers_m) * flight.riser_m
    for begin, end, floor_m in ((entry, low, flight.foot_m), (high, entry + 1, top_m)):
        begin, end = max(begin, entry) + INSIDE_SHARE, min(end, entry + 1) - INSIDE_SHARE
        if end - begin <= 0:
            continue
        heights_m = plan.heights_m(_area(flight.up, cell, begin - entry, end - entry))
        if any(abs(height_m - floor_m) > _SAME_M for height_m in heights_m):
            shown = ", ".join(f"{height_m:g}" for height_m in sorted(heights_m))
            raise flight.wrong(
                f"the rest of the cell {tuple(cell)} (row, column) is at {shown} m, "
                f"but the flight meets it at {floor_m:g} m"
            )


def _foot_m(plan: FloorPlan, up: Direction, bounds: Rectangle, cells: tuple[Cell, ...], key: str) -> float:
    """Return the height of the floor just before the lower edge of a flight."""
    low, _ = _along(up, bounds)
    heights_m: set[float] = set()
    for cell in cells:
        begin = low - _entry(up, cell) - 3 * INSIDE_SHARE
        heights_m |= plan.heights_m(_area(up, cell, begin, begin + INSIDE_SHARE))
    if max(heights_m) - min(heights_m) > _SAME_M:
        shown = ", ".join(f"{height_m:g}" for height_m in sorted(heights_m))
        raise InputError(f"the floor before the lower edge has several heights, {shown} m; it needs one", key=key)
    return min(heights_m)


def _along(up: Direction, bounds: Rectangle) -> tuple[float, float]:
    """Return where a rectangle begins and ends along an axis, in cells."""
    west, north, east, south = bounds
    return {
        Direction.NORTH: (-south, -north),
        Direction.EAST: (west, east),
        Direction.SOUTH: (north, south),
        Direction.WEST: (-east, -west),
    }[up]


def _entry(up: Direction, cell: Cell) -> int:
    """Return where an axis enters a cell, in cells."""
    return {
        Direction.NORTH: -(cell.row + 1),
        Direction.EAST: cell.column,
        Direction.SOUTH: cell.row,
        Direction.WEST: -(cell.column + 1),
    }[up]


def _area(up: Direction, cell: Cell, begin: float, end: float) -> Rectangle:
    """Return the part of a cell's lane between two distances from the border where the axis enters."""
    row, column, inset = cell.row, cell.column, INSIDE_SHARE
    across_rows, across_columns = (row + inset, row + 1 - inset), (column + inset, column + 1 - inset)
    return {
        Direction.NORTH: (across_columns[0], row + 1 - end, across_columns[1], row + 1 - begin),
        Direction.EAST: (column + begin, across_rows[0], column + end, across_rows[1]),
        Direction.SOUTH: (across_columns[0], row + begin, across_columns[1], row + end),
        Direction.WEST: (column + 1 - end, across_rows[0], column + 1 - begin, across_rows[1]),
    }[up]

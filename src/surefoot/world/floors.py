"""Flat floors: rectangles at a height over a ground at 0 (docs/rules.md, section 2)."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

from surefoot.errors import InputError
from surefoot.frames import Cell
from surefoot.world.grid import INSIDE_SHARE, CoarseGrid, Rectangle

_SAME_M = 1e-6
_HIGHEST_M = 1e4


@dataclass(frozen=True, slots=True)
class Floor:
    """A floor at a height.

    Attributes:
        rectangles_m: where it lies.
        height_m: above the ground.
    """

    rectangles_m: tuple[Rectangle, ...]
    height_m: float


class FloorPlan:
    """Answers which floor heights there are on a part of a grid; lengths are in cells from its north-western corner."""

    def __init__(self, grid: CoarseGrid, floors: tuple[Floor, ...]) -> None:
        """Sort the floors' rectangles by the cells that they meet.

        Raises:
            InputError: a rectangle has no area or a number is not finite.
        """
        self._floors = floors
        self._near: dict[Cell, list[tuple[Rectangle, int]]] = {}
        self._parts: list[tuple[Rectangle, int]] = []
        for number, floor in enumerate(floors):
            if not abs(floor.height_m) <= _HIGHEST_M:
                raise InputError(
                    f"the height is not a number of at most {_HIGHEST_M:g} m", key=f"heights.floors[{number}]"
                )
            for rectangle_m in floor.rectangles_m:
                bounds = checked_bounds(grid, rectangle_m, f"heights.floors[{number}]")
                self._parts.append((bounds, number))
                for cell in cells_meeting(grid, bounds):
                    self._near.setdefault(cell, []).append((bounds, number))

    def flat_m(self, cell: Cell) -> float:
        """Return the one height of a flat cell.

        Raises:
            InputError: it has several.
        """
        near = self._near.get(cell)
        if near is None:
            return 0.0
        area = (
            cell.column + INSIDE_SHARE,
            cell.row + INSIDE_SHARE,
            cell.column + 1 - INSIDE_SHARE,
            cell.row + 1 - INSIDE_SHARE,
        )
        heights_m = self._heights_m(area, near)
        if max(heights_m) - min(heights_m) > _SAME_M:
            numbers = sorted({number for _, number in near})
            shown = ", ".join(f"{height:g}" for height in sorted(heights_m))
            raise InputError(
                f"the flat cell {tuple(cell)} (row, column) has several heights, {shown} m; "
                "a free cell without stairs needs one",
                key=f"heights.floors[{numbers[0]}]",
            )
        return min(heights_m)

    def center_m(self, cell: Cell) -> float:
        """Return the highest floor at a cell's centre."""
        return max(self.heights_m((cell.column + 0.49, cell.row + 0.49, cell.column + 0.51, cell.row + 0.51)))

    def heights_m(self, area: Rectangle) -> set[float]:
        """Return the floor heights that an area has; slivers thinner than 1 % of a cell do not count."""
        return self._heights_m(area, self._parts)

    def _heights_m(self, area: Rectangle, parts: Iterable[tuple[Rectangle, int]]) -> set[float]:
        """Return the heights on an area that is cut along the sides of the given rectangles."""
        meeting = [(bounds, number) for bounds, number in parts if _overlap(bounds, area)]
        xs = _cuts(area[0], area[2], [edge for bounds, _ in meeting for edge in (bounds[0], bounds[2])])
        ys = _cuts(area[1], area[3], [edge for bounds, _ in meeting for edge in (bounds[1], bounds[3])])
        heights_m: set[float] = set()
        for x in xs:
            for y in ys:
                here = {
                    self._floors[number].height_m
                    for (west, north, east, south), number in meeting
                    if west <= x <= east and north <= y <= south
                }
                heights_m |= here or {0.0}
        return heights_m


def checked_bounds(grid: CoarseGrid, rectangle_m: Rectangle, key: str) -> Rectangle:
    """Return a rectangle in cells (west, north, east, south), refused when it is not finite or has no area."""
    if len(rectangle_m) != 4 or not all(math.isfinite(value) for value in rectangle_m):
        raise InputError("a rectangle needs four finite numbers, [x0, y0, x1, y1] in metres", key=key)
    bounds = grid.bounds(rectangle_m)
    if bounds[2] - bounds[0] < INSIDE_SHARE or bounds[3] - bounds[1] < INSIDE_SHARE:
        raise InputError(f"the rectangle {list(rectangle_m)} has no area; give two opposite corners", key=key)
    return bounds


def cells_meeting(grid: CoarseGrid, bounds: Rectangle) -> list[Cell]:
    """Return the cells whose interior meets a rectangle by more than 1 % of the cell size."""
    columns = _meeting(bounds[0], bounds[2], grid.columns)
    rows = _meeting(bounds[1], bounds[3], grid.rows)
    return [Cell(row, column) for row in rows for column in columns]


def _meeting(begin: float, end: float, count: int) -> range:
    """Return the unit intervals that a longer interval meets by more than 1 %."""
    least = math.floor(min(max(begin + INSIDE_SHARE, 0), count))
    return range(least, math.ceil(min(max(end - INSIDE_SHARE, least), count)))


def _overlap(one: Rectangle, other: Rectangle) -> bool:
    """Return whether two rectangles have common interior points."""
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]


def _cuts(begin: float, end: float, edges: list[float]) -> list[float]:
    """Return the middles of the parts that edges cut an interval into, thin ones left out unless it is thin itself."""
    points = [begin, *sorted(edge for edge in edges if begin < edge < end), end]
    parts = list(pairwise(points))
    wide = [part for part in parts if part[1] - part[0] >= INSIDE_SHARE]
    return [(low + high) / 2 for low, high in wide or [max(parts, key=lambda part: part[1] - part[0])]]

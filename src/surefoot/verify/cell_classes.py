"""Which classes a robot sees about a cell of a map, on ground that changes; written from docs/skills.md, "Classes"."""

from __future__ import annotations

import math

from surefoot.verify.cell_measures import NEAR_M, Box, Plate, measures, without
from surefoot.verify.class_rules import OBSTACLE
from surefoot.verify.quadruped_map import Array, Cell, MapFile
from surefoot.verify.values import Rectangle

Seen = tuple[tuple[frozenset[str], ...], ...]
_BLOCKED = frozenset((OBSTACLE,))
_SIDE_M = 1e-9


def on_map(cell: Cell, offset: Cell, quarter_turns: int) -> Cell:
    """Return the cell of the map at an offset (rows, columns) as a robot in a cell with a heading sees it."""
    row, column = offset
    turned = ((row, column), (-column, row), (-row, -column), (column, -row))[quarter_turns % 4]
    return cell[0] + turned[0], cell[1] + turned[1]


class CellClasses:
    """The classes of the cells of a map.

    Args:
        ground: the map.
        grid: rows and columns of local grids.
    """

    def __init__(self, ground: MapFile, grid: Cell) -> None:
        self.ground, self.grid = ground, grid
        self.corners: list[Array] = [one.vertices_m for one in ground.patches]
        self.plates = self._plates()
        self.obstacles: list[Rectangle] = []
        self.known: dict[Cell, tuple[dict[str, float], float]] = {}

    def _plates(self) -> list[Plate]:
        return [Plate.of(corners, self.ground.margin_m) for corners in self.corners]

    def gone(self, hole: Rectangle) -> None:
        """Take the ground in a rectangle away."""
        self.corners = without(self.corners, hole)
        self.plates = self._plates()
        self.known.clear()

    def stands(self, box: Rectangle) -> None:
        """Put something onto a rectangle: there is no ground below it, and no cell that it touches is free."""
        self.gone(box)
        self.obstacles.append(box)

    def inside(self, cell: Cell) -> bool:
        """Return whether the map has a cell."""
        return 0 <= cell[0] < self.ground.cells[0] and 0 <= cell[1] < self.ground.cells[1]

    def blocked(self, cell: Cell) -> bool:
        """Return whether a cell is outside of the map, or something stands on it."""
        (west, east), (south, north) = self.box(cell)
        return not self.inside(cell) or any(
            w < east - _SIDE_M and west < e - _SIDE_M and s < north - _SIDE_M and south < n - _SIDE_M
            for w, s, e, n in self.obstacles
        )

    def box(self, cell: Cell) -> Box:
        """Return from where to where a cell reaches."""
        (x, y), (rows, columns), side = self.ground.origin_m, self.ground.cells, self.ground.cell_m
        west, south = x + (rows - 1 - cell[0]) * side, y + (columns - 1 - cell[1]) * side
        return (west, west + side), (south, south + side)

    def _measured(self, cell: Cell) -> tuple[dict[str, float], float]:
        if cell not in self.known:
            box, bars = self.box(cell), self.ground.rules.bars
            reach = max(NEAR_M, self.ground.cell_m) if bars else NEAR_M
            (west, east), (south, north) = ((low - reach, high + reach) for low, high in box)
            near = [one for one in self.plates if _near(one.outline.bounds, (west, south, east, north))]
            self.known[cell] = measures(near, box, bars=bars)
        return self.known[cell]

    def labels(self, cell: Cell, quarter_turns: int) -> Seen:
        """Return the classes that each cell of the local grid about a cell may have, as seen with a heading."""
        rows, columns = self.grid
        _, support_m = self._measured(cell)

        def seen(row: int, column: int) -> frozenset[str]:
            there = on_map(cell, (row - rows // 2, column - columns // 2), quarter_turns)
            return self._label(there, quarter_turns, support_m)

        return tuple(tuple(seen(row, column) for column in range(columns)) for row in range(rows))

    def _label(self, cell: Cell, quarter_turns: int, support_m: float) -> frozenset[str]:
        rules = self.ground.rules
        if self.blocked(cell):
            return _BLOCKED
        values, height_m = self._measured(cell)
        if math.isnan(height_m) or math.isnan(support_m):
            return _BLOCKED
        if quarter_turns % 2 and rules.bars:
            values = {**values, "across_m": values["along_m"], "along_m": values["across_m"]}
        return rules.labels({**values, "rise_m": height_m - support_m})


def _near(a: Rectangle, b: Rectangle) -> bool:
    return a[0] <= b[2] and b[0] <= a[2] and a[1] <= b[3] and b[1] <= a[3]

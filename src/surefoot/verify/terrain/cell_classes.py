"""Which classes a robot sees about a cell of a map, on ground that changes; written from docs/skills.md, "Classes"."""

from __future__ import annotations

import math

import numpy as np
import shapely  # type: ignore[import-untyped]

from surefoot.verify.terrain.cell_measures import NEAR_M, Box, Plate, measures, without
from surefoot.verify.terrain.class_rules import OBSTACLE
from surefoot.verify.terrain.map import Array, Cell, MapFile
from surefoot.verify.values import Rectangle

Seen = tuple[tuple[frozenset[str], ...], ...]
_BLOCKED = frozenset((OBSTACLE,))
_SIDE_M = 1e-9
_LEVEL_M, _SOME_M2 = 0.059, 1e-3


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
        support_m = self.height_m(cell)

        def seen(row: int, column: int) -> frozenset[str]:
            there = on_map(cell, (row - rows // 2, column - columns // 2), quarter_turns)
            return self._label(there, quarter_turns, support_m)

        return tuple(tuple(seen(row, column) for column in range(columns)) for row in range(rows))

    def own(self, cell: Cell, quarter_turns: int) -> frozenset[str]:
        """Return the classes that the cell may have in which a robot with a heading is."""
        return self._label(cell, quarter_turns, self.height_m(cell))

    def stands_in(self, cell: Cell, quarter_turns: int) -> bool:
        """Return whether a robot may stand in a cell, as far as classes say."""
        return self.own(cell, quarter_turns) != _BLOCKED

    def height_m(self, cell: Cell) -> float:
        """Return the mean height of the ground in a cell (NaN without any)."""
        return self._measured(cell)[1]

    def edge_m(self, here: Cell, there: Cell) -> float:
        """Return by how much the ground rises or falls between two cells beyond what their mean slopes account for."""
        (here_x, here_y), (there_x, there_y) = (np.mean(self.box(cell), axis=1) for cell in (here, there))
        slope = (self._slope(here) + self._slope(there)) / 2
        rise_m = self.height_m(there) - self.height_m(here)
        return abs(rise_m - float(slope @ (there_x - here_x, there_y - here_y)))

    def _slope(self, cell: Cell) -> Array:
        """Return the mean slope of the ground in a cell, by area."""
        (west, east), (south, north) = self.box(cell)
        square = shapely.box(west, south, east, north)
        areas = np.array([one.outline.intersection(square).area for one in self.plates])
        slopes = np.array([one.plane[:2] for one in self.plates])
        mean: Array = areas @ slopes / max(float(areas.sum()), 1e-12)
        return mean

    def has_level(self, cells: tuple[Cell, Cell], height_m: float) -> bool:
        """Return whether ground in one of two cells is surely at a height."""
        squares = shapely.union_all([shapely.box(*np.array(self.box(cell)).T.ravel()) for cell in cells])
        found = zip(self.corners, self.plates, strict=True)
        near = [plate for corners, plate in found if abs(float(corners[:, 2].mean()) - height_m) < _LEVEL_M]
        return any(plate.outline.intersection(squares).area > _SOME_M2 for plate in near)

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

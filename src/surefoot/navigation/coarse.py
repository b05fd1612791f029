"""The coarse map as the games see it: cells by index, passable moves, what is seen from where."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.frames import Cell, Direction
from surefoot.world import CoarseGrid, HeightMap, visible_pairs


@dataclass(frozen=True, slots=True)
class CoarseMap:
    """A coarse grid with its moves and its views.

    Attributes:
        grid: the cells.
        heights: floors and stairs on them.
        target: (cells, 4) int32, the cell that a move in each direction leads to, -1 where it is not passable.
        sees: (cells, cells) bool, whether the robot in the first cell sees the second.
    """

    grid: CoarseGrid
    heights: HeightMap
    target: NDArray[np.int32]
    sees: NDArray[np.bool_]

    def profile(self, cell: int) -> int:
        """Return the index of a cell's height profile, 0 for flat."""
        place = self.grid.cell(cell)
        return int(self.heights.profile_of[place.row, place.column])

    def is_stairs(self, cell: int) -> bool:
        """Return whether a cell belongs to a flight of stairs."""
        return self.profile(cell) != 0


def coarse_map(grid: CoarseGrid, heights: HeightMap, range_m: float, corners: str = "visible") -> CoarseMap:
    """Return the moves and views of a grid.

    Args:
        grid: the coarse grid.
        heights: its floors and stairs.
        range_m: how far the robot sees [m].
        corners: whether a line of sight that grazes a blocked corner is "visible" or "hidden".
    """
    target = np.full((grid.rows * grid.columns, 4), -1, np.int32)
    for cell in grid.free_cells():
        for direction in Direction:
            if heights.passable(grid, cell, direction):
                target[grid.index(cell), direction] = grid.index(cell.neighbour(direction))
    target.setflags(write=False)
    return CoarseMap(grid, heights, target, visible_pairs(grid, range_m, corners))


def adjacent_free(grid: CoarseGrid, cell: Cell) -> tuple[Cell, ...]:
    """Return the free 4-neighbours of a cell, whatever their height: where an obstacle may go."""
    return tuple(cell.neighbour(direction) for direction in Direction if grid.is_free(cell.neighbour(direction)))

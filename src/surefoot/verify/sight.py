"""Which cells a robot sees from which, transcribed from rules.md 3."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray


def sight(free: NDArray[np.bool_], cell_size_m: float, range_m: float, corners_hide: bool) -> NDArray[np.bool_]:
    """Return (cells, cells) which free cell sees which, by row * columns + column.

    A centre-to-centre segment meets an open square exactly when no line along the square's sides or along the segment
    separates them. Positions are counted in half cells, so every test is one of whole numbers.

    Args:
        free: (rows, columns).
        cell_size_m: side of a cell.
        range_m: range of the sensor, between centres.
        corners_hide: whether touching a blocked square is enough to hide.
    """
    columns = free.shape[1]
    seen = np.zeros((free.size, free.size), bool)
    cells = np.argwhere(free)
    blocked = np.argwhere(~free)
    for row, column in cells:
        gaps = cells - (row, column)
        near = cells[np.hypot(gaps[:, 0], gaps[:, 1]) * cell_size_m <= range_m + 1e-9]
        reach = math.ceil(range_m / cell_size_m) + 1
        walls = blocked[(np.abs(blocked - (row, column)) <= reach).all(axis=1)]
        hidden = _hidden(np.array([row, column]), near, walls, corners_hide)
        seen[row * columns + column, near[:, 0] * columns + near[:, 1]] = ~hidden
    return seen


def _hidden(
    eye: NDArray[np.int64], targets: NDArray[np.int64], walls: NDArray[np.int64], corners_hide: bool
) -> NDArray[np.bool_]:
    """Return which targets some wall hides from the eye."""
    start = 2 * eye + 1
    ends = 2 * targets + 1
    hidden = np.zeros(len(targets), bool)
    along = ends - start
    margin = 0 if corners_hide else 1
    for wall in walls:
        low, high = 2 * wall, 2 * wall + 2
        nearest, farthest = np.minimum(start, ends), np.maximum(start, ends)
        meets = ((farthest - low >= margin) & (high - nearest >= margin)).all(axis=1)
        sides = [
            along[:, 0] * (corner_column - start[1]) - along[:, 1] * (corner_row - start[0])
            for corner_row in (low[0], high[0])
            for corner_column in (low[1], high[1])
        ]
        least, most = np.min(sides, axis=0), np.max(sides, axis=0)
        hidden |= meets & (least <= -margin) & (most >= margin)
    return hidden

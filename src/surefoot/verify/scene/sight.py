"""Which cells a robot sees from which, transcribed from rules.md 3."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

WALLS_AT_ONCE = 64


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
    """Return which targets some wall hides from the eye; walls are taken in blocks to save memory."""
    start = 2 * eye + 1
    ends = 2 * targets[:, None, :] + 1
    along = ends - start
    nearest, farthest = np.minimum(start, ends), np.maximum(start, ends)
    hidden = np.zeros(len(targets), bool)
    margin = 0 if corners_hide else 1
    for block in range(0, len(walls), WALLS_AT_ONCE):
        low = 2 * walls[None, block : block + WALLS_AT_ONCE, :]
        meets = ((farthest - low >= margin) & (low + 2 - nearest >= margin)).all(axis=2)
        gap = low - start
        first = along[..., 0] * gap[..., 1] - along[..., 1] * gap[..., 0]
        right, down = 2 * along[..., 0], -2 * along[..., 1]
        corners = [first, first + right, first + down, first + right + down]
        least, most = np.minimum.reduce(corners), np.maximum.reduce(corners)
        hidden |= (meets & (least <= -margin) & (most >= margin)).any(axis=1)
    return hidden

"""The compiled sweep: least fixpoint of "some omega has every cell that its image touches winning".

Velocities are positive, so positions only grow, and the game is solved column by column from right to left. For every
column and row ``run`` holds the first row at or above that does not win; an image box that touches the rows from jl to
jh wins when run > jh in each of its columns. Slow rows may have boxes that touch their own column or columns to its
left; those rows alone are swept again until nothing changes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Images(NamedTuple):
    """Image boxes of cells in units of cells: one row per omega, one column per coefficient.

    The box of cell (i, j) spans ``x + xi i + xj j -+ xr`` and ``v + vi i + vj j -+ vr``, half a cell added and the
    slack included, so that flooring gives indices of cells.
    """

    x: Floats
    xi: Floats
    xj: Floats
    xr: Floats
    v: Floats
    vi: Floats
    vj: Floats
    vr: Floats


@njit(cache=True)
def sweep(
    target: NDArray[np.bool_], source: NDArray[np.bool_], images: Images, first_only: bool
) -> tuple[NDArray[np.bool_], NDArray[np.uint64]]:
    """Return the winning cells and, per cell, a bit for every omega that wins there (one bit with ``first_only``).

    Bit k stands in word k // 64.
    """
    columns, rows = target.shape
    won = target.copy()
    bits = np.zeros((columns, rows, (images.x.size + 63) // 64), np.uint64)
    run = np.empty((columns, rows), np.int32)
    low = np.full(columns, rows, np.int32)
    high = np.full(columns, -1, np.int32)
    for i in range(columns):
        _note_column(won[i], run[i], low, high, i)
    for i in range(columns - 1, -1, -1):
        _settle(i, rows, target, source, won, bits, run, low, high, images, first_only)
    again = True
    while again:
        again = False
        for i in range(columns - 1, -1, -1):
            limit = min(rows, _rows_touching(i, 0, images))
            if limit > 0:
                changed = _settle(i, limit, target, source, won, bits, run, low, high, images, first_only)
                again = again or changed
    return won, bits


@njit(cache=True)
def _settle(
    i: int,
    limit: int,
    target: NDArray[np.bool_],
    source: NDArray[np.bool_],
    won: NDArray[np.bool_],
    bits: NDArray[np.uint64],
    run: NDArray[np.int32],
    low: NDArray[np.int32],
    high: NDArray[np.int32],
    images: Images,
    first_only: bool,
) -> bool:
    """Sweep the first rows of a column, and those that depend on their own column again until nothing changes."""
    ever = False
    own = min(limit, _rows_touching(i, 1, images))
    while _column(i, limit, target, source, won, bits, run, low, high, images, first_only):
        _note_column(won[i], run[i], low, high, i)
        ever = True
        limit = own
    return ever


@njit(cache=True)
def _rows_touching(i: int, ahead: int, images: Images) -> int:
    """Return how many of the lowest rows of a column have images that begin left of the column ``ahead`` of it."""
    most = 0
    for k in range(images.x.size):
        x = images.x[k] + images.xi[k] * i - images.xr[k]
        most = max(most, int(np.floor((i + ahead - x) / images.xj[k])) + 1)
    return most


@njit(cache=True)
def _note_column(
    won: NDArray[np.bool_], run: NDArray[np.int32], low: NDArray[np.int32], high: NDArray[np.int32], i: int
) -> None:
    """Renew the run lengths and the extent of a column."""
    rows = won.size
    end = rows
    low[i], high[i] = rows, -1
    for j in range(rows - 1, -1, -1):
        if won[j]:
            low[i] = j
            high[i] = max(high[i], j)
        else:
            end = j
        run[j] = end if won[j] else j


@njit(cache=True)
def _column(
    i: int,
    limit: int,
    target: NDArray[np.bool_],
    source: NDArray[np.bool_],
    won: NDArray[np.bool_],
    bits: NDArray[np.uint64],
    run: NDArray[np.int32],
    low: NDArray[np.int32],
    high: NDArray[np.int32],
    images: Images,
    first_only: bool,
) -> bool:
    """Try every omega in the first rows of a column; return whether anything new won."""
    columns, rows = won.shape
    changed = False
    for k in range(images.x.size):
        x, v = images.x[k] + images.xi[k] * i, images.v[k] + images.vi[k] * i
        xj, xr, vj, vr = images.xj[k], images.xr[k], images.vj[k], images.vr[k]
        begin, end = _row_range(x, xj, xr, v, vj, vr, low, high, columns, rows)
        word, bit = k >> 6, np.uint64(1) << np.uint64(k & 63)
        for j in range(begin, min(end, limit)):
            if (bits[i, j, word] & bit) != 0 or not source[i, j] or target[i, j] or (first_only and won[i, j]):
                continue
            il, ih = int(np.floor(x + xj * j - xr)), int(np.floor(x + xj * j + xr))
            jl, jh = int(np.floor(v + vj * j - vr)), int(np.floor(v + vj * j + vr))
            if il < 0 or ih >= columns or jl < 0 or jh >= rows:
                continue
            wins = True
            for c in range(il, ih + 1):
                if run[c, jl] <= jh:
                    wins = False
                    break
            if wins:
                bits[i, j, word] |= bit
                won[i, j] = True
                changed = True
    return changed


@njit(cache=True)
def _row_range(
    x: float,
    xj: float,
    xr: float,
    v: float,
    vj: float,
    vr: float,
    low: NDArray[np.int32],
    high: NDArray[np.int32],
    columns: int,
    rows: int,
) -> tuple[int, int]:
    """Return the rows of a column whose images may lie between the lowest and the highest winning row ahead."""
    first = max(0, int(np.floor(x - xr)))
    last = min(columns - 1, int(np.floor(x + xj * (rows - 1) + xr)))
    least, most = rows, -1
    for c in range(first, last + 1):
        least = min(least, low[c])
        most = max(most, high[c])
    if most < 0:
        return 0, 0
    begin = max(0, int(np.floor((least - v + vr) / vj)) - 1)
    end = min(rows, int(np.floor((most + 1 - v - vr) / vj)) + 2)
    return begin, end

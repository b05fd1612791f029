"""Which cells are seen from which (docs/rules.md, section 3)."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.world.grid import CoarseGrid

CORNER_CHOICES = ("visible", "hidden")
_TOLERANCE_M = 1e-9
_MAX_CELLS = 20_000

Offset = tuple[int, int]


def visible_pairs(grid: CoarseGrid, range_m: float, corners: str = "visible") -> NDArray[np.bool_]:
    """Return which free cells the robot sees from which.

    Cell c is seen from cell r when their centres are at most the range apart and the segment between the centres does
    not meet the open square of a blocked cell (or the closed square, when grazed corners hide). Free cells see
    themselves. Lines of sight are decided in whole numbers, and once per offset of the two cells, so the answer is
    exact and symmetric.

    Args:
        grid: the cells.
        range_m: how far the robot sees.
        corners: whether a line of sight that grazes a blocked square is "visible" or "hidden".

    Returns:
        (cells, cells) by cell number, read-only.

    Raises:
        InputError: the range or the choice is out of range, or the grid has more than 20,000 cells.

    Source: docs/rules.md, section 3.
    """
    if not range_m >= 0:
        raise InputError(f"has to be a number of metres, 0 or more, not {range_m!r}", key="sensor.range_m")
    if corners not in CORNER_CHOICES:
        raise InputError(f"has to be one of {', '.join(CORNER_CHOICES)}, not {corners!r}", key="navigation.corners")
    cells = grid.rows * grid.columns
    if cells > _MAX_CELLS:
        raise InputError(
            f"the grid has {cells:,} cells, at most {_MAX_CELLS:,} are allowed; choose larger ones",
            key="grid.cell_size_m",
        )
    pairs = np.diag(grid.free.ravel())
    for offset in _offsets(grid, range_m):
        viewers = _viewers(grid, offset, _passed(offset, grazed=corners == "hidden"))
        seen = viewers + offset[0] * grid.columns + offset[1]
        pairs[viewers, seen] = True
        pairs[seen, viewers] = True
    pairs.setflags(write=False)
    return pairs


def _offsets(grid: CoarseGrid, range_m: float) -> Iterator[Offset]:
    """Yield (rows, columns) between two cells in range; of an offset and its opposite only one."""
    most = (range_m + _TOLERANCE_M) / grid.cell_size_m
    reach = math.floor(min(most, grid.rows + grid.columns))
    for rows in range(min(reach, grid.rows - 1) + 1):
        width = min(reach, grid.columns - 1)
        for columns in range(-width if rows else 1, width + 1):
            if rows**2 + columns**2 <= most**2:
                yield rows, columns


def _passed(offset: Offset, *, grazed: bool) -> list[Offset]:
    """Return the cells whose squares the segment from (0, 0) to an offset meets, ends left out.

    With the segment along (a, b) = (rows, columns), the square about (i, j) lies astride its line when the four cross
    products of its corners differ in sign, that is |2 (b i - a j)| < |a| + |b|; equality means that the line only
    grazes a corner or, for a = 0 or b = 0, a side.
    """
    a, b = offset
    most = abs(a) + abs(b) + (1 if grazed else 0)
    return [
        (i, j)
        for i in range(a + 1)
        for j in range(min(b, 0), max(b, 0) + 1)
        if abs(2 * (b * i - a * j)) < most and (i, j) not in ((0, 0), offset)
    ]


def _viewers(grid: CoarseGrid, offset: Offset, passed: list[Offset]) -> NDArray[np.intp]:
    """Return the numbers of the free cells that see the free cell at an offset."""
    rows, columns = grid.rows - offset[0], grid.columns - abs(offset[1])
    west = max(-offset[1], 0)

    def shifted(by: Offset) -> NDArray[np.bool_]:
        return grid.free[by[0] : by[0] + rows, west + by[1] : west + by[1] + columns]

    clear = shifted((0, 0)) & shifted(offset)
    for cell in passed:
        clear &= shifted(cell)
    down, across = np.nonzero(clear)
    return down * grid.columns + across + west

"""Neighbours of a contact table: an end of a swing moved, a swing moved, more or less, for one foot or a pair."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from surefoot.footholds.cells import Cells, obeys

_SHIFTS = ((-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (1, 1))


def neighbours(cells: Cells, min_dwell_cells: int) -> Iterator[Cells]:
    """Yield contact tables that differ by few cells, all of them different."""
    seen = {cells.tobytes()}
    for changed in _all(cells, min_dwell_cells):
        if changed.tobytes() not in seen and obeys(changed, min_dwell_cells):
            seen.add(changed.tobytes())
            yield changed


def kicks(cells: Cells, min_dwell_cells: int, rng: np.random.Generator, count: int) -> Iterator[Cells]:
    """Yield contact tables that are two to four random changes away, for when no single change helps any more."""
    for _ in range(count):
        changed = cells
        for _ in range(int(rng.integers(2, 5))):
            near = list(neighbours(changed, min_dwell_cells))
            if near:
                changed = near[int(rng.integers(len(near)))]
        yield changed


def _all(cells: Cells, min_dwell_cells: int) -> Iterator[Cells]:
    moved = [list(_moved(cells, foot)) for foot in range(4)]
    for foot in range(4):
        yield from moved[foot]
        for cell in range(1, len(cells) - min_dwell_cells):
            changed = cells.copy()
            changed[cell : cell + min_dwell_cells, foot] ^= True
            yield changed
    for one, other in combinations(range(4), 2):
        for first, second in zip(moved[one], moved[other], strict=False):
            changed = first.copy()
            changed[:, other] = second[:, other]
            yield changed
    yield from _whole(cells)


def _moved(cells: Cells, foot: int) -> Iterator[Cells]:
    """Yield the tables in which an end, or both ends, of a swing of a foot is moved by one cell."""
    changes = np.flatnonzero(np.diff(cells[:, foot].astype(np.int8))) + 1
    for lift, touch in zip(changes[::2], changes[1::2], strict=False):
        for early, late in _SHIFTS:
            changed = cells.copy()
            changed[lift:touch, foot] = True
            changed[max(lift + early, 1) : min(touch + late, len(cells) - 1), foot] = False
            yield changed
        without = cells.copy()
        without[lift:touch, foot] = True
        yield without


def _whole(cells: Cells) -> Iterator[Cells]:
    """Yield the table moved as a whole, and mirrored left to right."""
    for shift in (-1, 1):
        rolled = np.roll(cells, shift, axis=0)
        rolled[[0, -1]] = True
        yield rolled
    yield cells[:, [1, 0, 3, 2]].copy()

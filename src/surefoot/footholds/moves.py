"""Random changes of a contact table, from a cell to all of it: what annealing proposes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from surefoot.footholds.cells import Cells, obeys

_GROUPS = ((0, 1), (2, 3), (0, 2), (1, 3), (0, 3), (1, 2))
_ONE, _PAIR = 0.5, 0.88
_TRIES = 20
_FAR_CELLS = 2


def proposal(cells: Cells, min_dwell_cells: int, rng: np.random.Generator) -> Cells | None:
    """Return a contact table near another one that obeys the rules, or None when chance found none."""
    for _ in range(_TRIES):
        move = _MOVES[int(np.searchsorted(_UP_TO, rng.random(), side="right"))]
        changed = move(cells, _feet(rng), rng)
        changed[[0, -1]] = True
        if not np.array_equal(changed, cells) and obeys(changed, min_dwell_cells):
            return changed
    return None


def _feet(rng: np.random.Generator) -> list[int]:
    """Return one foot, a pair, or all feet."""
    kind = rng.random()
    if kind < _ONE:
        return [int(rng.integers(4))]
    if kind < _PAIR:
        return list(_GROUPS[int(rng.integers(len(_GROUPS)))])
    return [0, 1, 2, 3]


def _end(cells: Cells, feet: list[int], rng: np.random.Generator) -> Cells:
    """Move the end of a swing, or of a stance, and ends nearby of the other feet with it."""
    changed = cells.copy()
    ends = _changes(cells[:, feet[0]])
    if not len(ends):
        return changed
    end, by = int(rng.choice(ends)), int(rng.choice((-2, -1, 1, 2), p=(0.15, 0.35, 0.35, 0.15)))
    for foot in feet:
        near = [int(one) for one in _changes(cells[:, foot]) if cells[one, foot] == cells[end, feet[0]]]
        here = min(near, key=lambda one: abs(one - end), default=-_FAR_CELLS - 1)
        if abs(here - end) > _FAR_CELLS:
            continue
        since, to = sorted((here, here + by))
        changed[max(since, 0) : to, foot] = cells[here - 1 if by > 0 else here, foot]
    return changed


def _block(cells: Cells, feet: list[int], rng: np.random.Generator) -> Cells:
    """Swing, or stand, for a few cells."""
    changed = cells.copy()
    begin, length = int(rng.integers(1, len(cells) - 1)), int(rng.integers(1, 5))
    changed[begin : begin + length, feet] = bool(rng.integers(2))
    return changed


def _shift(cells: Cells, feet: list[int], rng: np.random.Generator) -> Cells:
    """Move everything by a cell."""
    changed = cells.copy()
    changed[:, feet] = np.roll(cells[:, feet], int(rng.choice((-1, 1))), axis=0)
    return changed


def _warp(cells: Cells, feet: list[int], rng: np.random.Generator) -> Cells:
    """Repeat one cell and leave out another: what lies between moves as a whole."""
    changed = cells.copy()
    again, without = (int(one) for one in rng.integers(0, len(cells), 2))
    order = np.insert(np.delete(np.arange(len(cells)), without), min(again, len(cells) - 1), again)
    changed[:, feet] = cells[order][:, feet]
    return changed


def _exchange(cells: Cells, feet: list[int], rng: np.random.Generator) -> Cells:
    """Give a foot the contacts of another, exchange those of two, or mirror left and right or front and hind."""
    changed = cells.copy()
    if len(feet) == 4:
        order = ((1, 0, 3, 2), (2, 3, 0, 1), (3, 2, 1, 0))[int(rng.integers(3))]
        return cells[:, order].copy()
    one, other = (int(foot) for foot in rng.permutation(4)[:2])
    changed[:, one] = cells[:, other]
    if len(feet) == 2:
        changed[:, other] = cells[:, one]
    return changed


def _changes(held: np.ndarray) -> np.ndarray:
    return np.flatnonzero(held[1:] != held[:-1]) + 1


_MOVES: tuple[Callable[[Cells, list[int], np.random.Generator], Cells], ...] = (_end, _block, _shift, _warp, _exchange)
_UP_TO = (0.5, 0.65, 0.75, 0.9)

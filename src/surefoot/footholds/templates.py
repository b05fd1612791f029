"""Contact templates over some cells, best guesses first: standing, trots, paces, bounds, leaps, pronks and walks."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np

from surefoot.footholds.cells import Cells, obeys

_PAIRS: tuple[tuple[str, tuple[int, ...]], ...] = (
    ("bound", (0, 0, 1, 1)),
    ("trot", (0, 1, 1, 0)),
    ("trot", (1, 0, 0, 1)),
    ("pace", (0, 1, 0, 1)),
    ("pace", (1, 0, 1, 0)),
    ("bound", (1, 1, 0, 0)),
)
"""Which feet (FL, FR, RL, RR) swing first (0) and second (1)."""

_WALKS = ((3, 1, 2, 0), (1, 3, 0, 2), (2, 3, 0, 1), (3, 2, 1, 0), (0, 1, 2, 3), (1, 0, 3, 2))
"""At which place each foot swings, one after the other."""

_MOST_CYCLES = 4
_USUAL_CELLS = 3


def templates(count: int, min_dwell_cells: int) -> Iterator[tuple[str, Cells]]:
    """Yield contact tables with names, all different, best guesses first.

    Args:
        count: of cells.
        min_dwell_cells: how long a stance or a swing is at least.
    """
    seen: set[bytes] = set()
    for name, cells in _all(count):
        if obeys(cells, min_dwell_cells) and cells.tobytes() not in seen:
            seen.add(cells.tobytes())
            yield name, cells


def first_templates(count: int, min_dwell_cells: int) -> Iterator[tuple[str, Cells]]:
    """Yield a coarse selection over all families: swings of a third and half of a period, by turns and overlapping."""
    inner, stand = count - 2, np.ones((count, 4), dtype=bool)
    seen = {stand.tobytes()}
    yield "stand", stand
    for cycles in (2, 1, 3):
        period = inner // cycles
        swings = sorted({max(period // 2, 1), max(period // 3, 1), min(_USUAL_CELLS, period)}) if period else []
        for swing in swings:
            for shift in sorted({min(swing, period - swing), max(min(swing, period - swing) - 1, 0)}, reverse=True):
                for name, order in _PAIRS:
                    cells = paired(count, cycles, period, swing, shift, order)
                    if obeys(cells, min_dwell_cells) and cells.tobytes() not in seen:
                        seen.add(cells.tobytes())
                        yield _named(name, cycles, swing, shift), cells


def _all(count: int) -> Iterator[tuple[str, Cells]]:
    inner = count - 2
    yield "stand", np.ones((count, 4), dtype=bool)
    for cycles in range(1, min(_MOST_CYCLES, inner) + 1):
        period = inner // cycles
        for swing, shift in product(range(1, period + 1), range(period)):
            if swing + shift <= period:
                for name, order in _PAIRS:
                    yield _named(name, cycles, swing, shift), paired(count, cycles, period, swing, shift, order)
        for swing in range(1, period // 2 + 1):
            for order4 in _WALKS:
                yield "walk", walked(count, cycles, period, swing, order4)


def _named(name: str, cycles: int, swing: int, shift: int) -> str:
    if shift == 0:
        return "pronk"
    if name == "bound" and shift < swing:
        return "leap" if cycles == 1 else "double leap" if cycles == 2 else "leaps"
    return name


def paired(count: int, cycles: int, period: int, swing: int, shift: int, order: tuple[int, ...]) -> Cells:
    """Return a table in which two groups of feet swing by turns, the second ``shift`` cells after the first."""
    return _swung(count, cycles, period, swing, [shift * place for place in order], shift + swing)


def walked(count: int, cycles: int, period: int, swing: int, order: tuple[int, ...]) -> Cells:
    """Return a table in which the four feet swing by turns, evenly spread over a period."""
    step = (period - swing) / 3
    begins = [round(place * step) for place in order]
    return _swung(count, cycles, period, swing, begins, max(begins) + swing)


def _swung(count: int, cycles: int, period: int, swing: int, begins: list[int], used: int) -> Cells:
    cells = np.ones((count, 4), dtype=bool)
    first = 1 + (count - 2 - (cycles - 1) * period - used) // 2
    for cycle, (foot, begin) in product(range(cycles), enumerate(begins)):
        at = first + cycle * period + begin
        cells[at : at + swing, foot] = False
    return cells

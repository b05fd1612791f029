"""How time and memory of the navigation game grow with cells, obstacles and belief regions, on halls with pillars."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from surefoot.compute import process_pool
from surefoot.errors import LimitExceeded
from surefoot.navigation.automatic_regions import automatic_regions
from surefoot.navigation.benchmarks import hall, measured

CELLS = ((8, 6), (15, 10), (22, 15), (30, 15), (45, 22), (60, 30))
OBSTACLES = (1, 2, 3)
PRECISIONS = (0.0, 0.25, 0.4, 0.5)
_SMALL, _MIDDLE = (8, 6), (15, 10)


@dataclass(frozen=True, slots=True)
class Growth:
    """One hall.

    Attributes:
        along: what was varied: ``cells``, ``obstacles`` or ``regions``.
        size: how many of them.
        cells: free cells of the hall.
        obstacles: how many moved there.
        turns: of the game; None when a limit was hit.
        total_s: processor time of the game with its strategy [s]; None when a limit was hit.
        peak_mb: largest resident size of a process that did nothing else [MB].
        limit: which limit, and what to change.
    """

    along: str
    size: int
    cells: int
    obstacles: int
    turns: int | None
    total_s: float | None
    peak_mb: float | None
    limit: str | None


def growth(say: Callable[[str], None] = lambda _: None) -> Iterator[Growth]:
    """Measure every hall in a process of its own."""
    asked: list[tuple[str, int, int, int, float | None]] = [("cells", *size, 1, None) for size in CELLS]
    asked += [("obstacles", *_SMALL, count, None) for count in OBSTACLES]
    asked += [("regions", *_MIDDLE, 1, precision) for precision in PRECISIONS]
    for one in asked:
        say(f"{one[0]}: a hall of {one[1]} x {one[2]}, obstacles: {one[3]}")
        with process_pool(1) as pool:
            yield pool.submit(_measure, *one).result()


def _measure(along: str, columns: int, rows: int, obstacles: int, precision: float | None) -> Growth:
    problem = hall(columns, rows, obstacles)
    cells = len(problem.coarse.grid.free_cells())
    if precision is not None:
        regions = automatic_regions(problem.coarse, problem.obstacles, precision)
        problem = replace(problem, belief="regions", regions=regions)
    size = {"cells": cells, "obstacles": obstacles, "regions": len(problem.regions)}[along]
    try:
        figures = measured(problem)
    except LimitExceeded as limit:
        return Growth(along, size, cells, obstacles, None, None, None, str(limit))
    return Growth(along, size, cells, obstacles, figures.turns, figures.total_s, figures.peak_mb, None)

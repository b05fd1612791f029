"""What is in the way between two cells of a map: the fewest obstacles and moves that would have to be others."""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable
from dataclasses import dataclass, field

from surefoot.skills.measures import Measured
from surefoot.skills.obstacles import Excess, excesses, in_words
from surefoot.skills.quadruped_terrain import Point, QuadrupedTerrain
from surefoot.skills.values import OBSTACLE, Cell, Direction

Closed = Callable[[Cell, Cell], str]
"""Why a move that the rules allow cannot be made; empty if it can."""


@dataclass(frozen=True, slots=True)
class Barrier:
    """Something in the way.

    Attributes:
        cell: of the map, which cannot be entered.
        centre_m: of the cell.
        coming_from: the cell from which it cannot be entered; None: nobody can stand in it.
        why: measures that decide; none where a move was refused or failed.
        text: the reason in words.
    """

    cell: Cell
    centre_m: Point
    coming_from: Cell | None
    why: tuple[Excess, ...]
    text: str

    @property
    def sentence(self) -> str:
        """The reason, with the place."""
        x, y = self.centre_m
        place = f"cell {list(self.cell)} about ({x:.4g}, {y:.4g})"
        return f"{place}: {self.text}" if self.coming_from is None else (
            f"{place}, from cell {list(self.coming_from)}: {self.text}"
        )  # fmt: skip


@dataclass(order=True)
class _Reached:
    cost: tuple[int, int]
    cell: Cell
    barriers: tuple[Barrier, ...] = field(compare=False)


def barriers(
    terrain: QuadrupedTerrain, start: Cell, goal: Cell, closed: Closed = lambda _a, _b: ""
) -> tuple[Barrier, ...]:
    """Return what is in the way from one cell to another, along the way with the fewest barriers, ties by length.

    Args:
        terrain: the map.
        start: cell of the map in which the robot stands.
        goal: cell of the map.
        closed: tells why a move that the rules allow cannot be made.

    Returns:
        None of them if the goal can be reached.
    """
    done: set[Cell] = set()
    first = _inside(terrain, start)
    heap = [_Reached((len(first), 0), start, first)]
    while heap:
        now = heapq.heappop(heap)
        if now.cell in done:
            continue
        if now.cell == goal:
            return now.barriers
        done.add(now.cell)
        for way in Direction:
            there = way.of(now.cell)
            if there in terrain.measured and there not in done:
                new = _between(terrain, now.cell, there, closed)
                cost = now.cost[0] + len(new), now.cost[1] + 1
                heapq.heappush(heap, _Reached(cost, there, (*now.barriers, *new)))
    return ()


def _inside(terrain: QuadrupedTerrain, cell: Cell) -> tuple[Barrier, ...]:
    """Return why nobody can stand in a cell, as at most one barrier."""
    measured = terrain.measured[cell]
    why = excesses(terrain.classes, measured.seen_from(measured.height_m))
    return (Barrier(cell, terrain.centre_m(cell), None, why, in_words(why)),) if why else ()


def _between(terrain: QuadrupedTerrain, here: Cell, there: Cell, closed: Closed) -> tuple[Barrier, ...]:
    """Return what forbids a move; what is about one of the cells itself counts there."""
    own = _inside(terrain, there)
    if own or _is_obstacle(terrain, terrain.measured[here], terrain.measured[here].height_m):
        return own
    why = excesses(terrain.classes, terrain.measured[there].seen_from(terrain.measured[here].height_m))
    text = in_words(why) if why else closed(here, there)
    return (Barrier(there, terrain.centre_m(there), here, why, text),) if text else ()


def _is_obstacle(terrain: QuadrupedTerrain, measured: Measured, support_m: float) -> bool:
    return math.isnan(support_m) or terrain.classes.classify(measured.seen_from(support_m)) == OBSTACLE

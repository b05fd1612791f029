"""The fewest new primitives that reach a request: an exact search on the graph of cells.

Every skill has one outcome, so a pair's game is a graph: at hand, an edge is free; a new primitive costs one, however
often it is used. This is a lower bound that reports show beside what the repair suggested. It never answers for it.
"""

from __future__ import annotations

import heapq
from collections.abc import Collection, Iterable
from itertools import count

from surefoot.skills.encoding import Edge
from surefoot.skills.skill_game import every_move
from surefoot.skills.values import Cell, Primitive, TerrainState

_MOST_LABELS = 5_000


def fewest_new(
    state: TerrainState,
    request: Cell,
    at_hand: Collection[Primitive],
    refused: Collection[Primitive] = (),
    disallowed: Iterable[Edge] = (),
) -> int | None:
    """Return the least number of new primitives with which the request can be reached; None if it cannot be.

    Args:
        state: classes of the cells.
        request: the cell to reach.
        at_hand: primitives that cost nothing.
        refused: primitives that must not be used.
        disallowed: moves that must not be made.

    Returns:
        the number; should the search grow beyond bounds, the number that is proved so far, which is a lower bound too.
    """
    leaving = _leaving(state, frozenset(refused), frozenset(disallowed))
    number = count()
    queue: list[tuple[int, int, Cell, frozenset[Primitive]]] = [(0, next(number), state.centre, frozenset())]
    settled: dict[Cell, list[frozenset[Primitive]]] = {cell: [] for cell in state.cells()}
    while queue:
        price, taken, cell, labels = heapq.heappop(queue)
        if cell == request or taken > _MOST_LABELS:
            return price
        if any(other <= labels for other in settled[cell]):
            continue
        settled[cell].append(labels)
        for primitive, target in leaving[cell]:
            after = labels if primitive in at_hand else labels | {primitive}
            heapq.heappush(queue, (len(after), next(number), target, after))
    return None


def _leaving(
    state: TerrainState, refused: frozenset[Primitive], disallowed: frozenset[Edge]
) -> dict[Cell, list[tuple[Primitive, Cell]]]:
    found: dict[Cell, list[tuple[Primitive, Cell]]] = {cell: [] for cell in state.cells()}
    for move in every_move(state):
        if move.skill not in refused and (move.source, move.targets[0]) not in disallowed:
            found[move.source].append((move.skill, move.targets[0]))
    return found

"""The fewest new primitives that reach a request: an exact search on the graph of cells.

Every skill has one outcome, so a pair's game is a graph: at hand, an edge is free; a new primitive costs one, however
often it is used. This is a lower bound that reports show beside what the repair suggested. It never answers for it.
"""

from __future__ import annotations

import heapq
from collections.abc import Collection, Iterable
from itertools import count
from typing import Any

from surefoot.skills.skill_game import CELLS, Frame
from surefoot.skills.values import Cell, Primitive, TerrainState

_MOST_LABELS = 5_000


def fewest_new(
    state: TerrainState,
    request: Cell,
    at_hand: Collection[Primitive],
    refused: Collection[Primitive] = (),
    disallowed: Iterable[tuple[Any, Any]] = (),
    frame: Frame[Any] = CELLS,
) -> int | None:
    """Return the least number of new primitives with which the request can be reached; None if it cannot be.

    Args:
        state: classes of the cells.
        request: the cell to reach.
        at_hand: primitives that cost nothing.
        refused: primitives that must not be used.
        disallowed: moves that must not be made.
        frame: what the robot's states are.

    Returns:
        the number; should the search grow beyond bounds, the number that is proved so far, which is a lower bound too.
    """
    leaving = _leaving(frame, state, frozenset(refused), frozenset(disallowed))
    number, goals = count(), frame.goals(request)
    queue: list[tuple[int, int, Any, frozenset[Primitive]]] = [(0, next(number), frame.start(state), frozenset())]
    settled: dict[Any, list[frozenset[Primitive]]] = {place: [] for place in frame.states(state)}
    while queue:
        price, taken, place, labels = heapq.heappop(queue)
        if place in goals or taken > _MOST_LABELS:
            return price
        if any(other <= labels for other in settled[place]):
            continue
        settled[place].append(labels)
        for primitive, target in leaving[place]:
            after = labels if primitive in at_hand else labels | {primitive}
            heapq.heappush(queue, (len(after), next(number), target, after))
    return None


def _leaving(
    frame: Frame[Any], state: TerrainState, refused: frozenset[Primitive], disallowed: frozenset[tuple[Any, Any]]
) -> dict[Any, list[tuple[Primitive, Any]]]:
    found: dict[Any, list[tuple[Primitive, Any]]] = {place: [] for place in frame.states(state)}
    for move in frame.moves(state):
        if move.skill not in refused and (move.source, move.targets[0]) not in disallowed:
            found[move.source].append((move.skill, move.targets[0]))
    return found

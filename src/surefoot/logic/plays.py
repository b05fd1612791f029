"""Plays of a strategy: the shortest one that a counter-strategy forces, and steps chosen one by one."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

from surefoot.logic.transducer import Transducer

SEARCHED = 300
"""From how many nodes, nearest first, the shortest loop is sought."""


@dataclass(frozen=True, slots=True)
class Lasso:
    """A play of a counter-strategy.

    Attributes:
        nodes: visited in this order.
        loop_from: the place in ``nodes`` where the play returns to after its last node; None: it ends, because the
            system has no answer to the last move.
    """

    nodes: tuple[int, ...]
    loop_from: int | None


def shortest_play(transducer: Transducer) -> Lasso:
    """Return a shortest play of a strategy of the environment that ends, or if none ends, a shortest lasso.

    Among lassos it looks at those that return to one of the ``SEARCHED`` nodes nearest to the start.
    """
    before = _breadth_first(transducer, transducer.initial.tolist())
    for node in before:
        if not len(transducer.after(node)):
            return Lasso(tuple(_path(before, node)), None)
    best: Lasso | None = None
    for node in list(before)[:SEARCHED]:
        stem = _path(before, node)
        if best is not None and len(stem) >= len(best.nodes):
            break
        loop = _loop(transducer, node)
        if loop and (best is None or len(stem) + len(loop) - 1 < len(best.nodes)):
            best = Lasso((*stem, *loop[1:]), len(stem) - 1)
    return best or Lasso((), None)


def _breadth_first(transducer: Transducer, starts: list[int]) -> dict[int, int]:
    """Return every reachable node with the one before it (-1: none), nearest first."""
    before = dict.fromkeys(starts, -1)
    queue = deque(before)
    while queue:
        node = queue.popleft()
        for target in transducer.after(node).tolist():
            if target not in before:
                before[target] = node
                queue.append(target)
    return before


def _path(before: dict[int, int], node: int) -> list[int]:
    path = [node]
    while before[path[-1]] >= 0:
        path.append(before[path[-1]])
    return path[::-1]


def _loop(transducer: Transducer, node: int) -> list[int] | None:
    """Return a shortest path from a node to one that leads back to it, both included; None when none does."""
    before = {node: -1}
    queue = deque([node])
    while queue:
        here = queue.popleft()
        for target in transducer.after(here).tolist():
            if target == node:
                return _path(before, here)
            if target not in before:
                before[target] = here
                queue.append(target)
    return None

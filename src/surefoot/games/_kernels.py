"""Compiled sweeps over the edges of a game graph. Each is linear in the edges that it looks at; none makes objects.

A sweep marks nodes in an array of levels: a level of 0 or more is a node of the set that grows, OPEN one that may still
join it, OUTSIDE one that is not looked at. Importing this module imports numba; compilation happens at the first call
and is kept on disk.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

OUTSIDE = -1
OPEN = -2


class Graph(NamedTuple):
    """The edges of an arena, forward and backward, in compressed rows."""

    system: NDArray[np.bool_]
    first: NDArray[np.int64]
    successors: NDArray[np.int32]
    before: NDArray[np.int64]
    predecessors: NDArray[np.int32]


@njit(cache=True, nogil=True)
def reverse(first: NDArray[np.int64], successors: NDArray[np.int32]) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """Return offsets and nodes of the reversed edges, each node's predecessors in rising order."""
    nodes = first.size - 1
    before = np.zeros(nodes + 1, dtype=np.int64)
    for target in successors:
        before[target + 1] += 1
    for node in range(nodes):
        before[node + 1] += before[node]
    place = before[:-1].copy()
    predecessors = np.empty(successors.size, dtype=np.int32)
    for node in range(nodes):
        for edge in range(first[node], first[node + 1]):
            target = successors[edge]
            predecessors[place[target]] = node
            place[target] += 1
    return before, predecessors


@njit(cache=True, nogil=True)
def explore(first: NDArray[np.int64], successors: NDArray[np.int32], start: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Return which nodes are reachable from the given ones, themselves included."""
    seen = np.zeros(first.size - 1, dtype=np.bool_)
    stack = np.empty(first.size - 1, dtype=np.int32)
    height = start.size
    stack[:height] = start
    seen[start] = True
    while height > 0:
        height -= 1
        node = stack[height]
        for edge in range(first[node], first[node + 1]):
            target = successors[edge]
            if not seen[target]:
                seen[target] = True
                stack[height] = target
                height += 1
    return seen


@njit(cache=True, nogil=True)
def attract(
    graph: Graph,
    level: NDArray[np.int32],
    missing: NDArray[np.int32],
    queue: NDArray[np.int32],
    done: int,
    filled: int,
    enough: int,
    top: int,
) -> tuple[int, int, int]:
    """Grow a set to its attractor: breadth first, a node joins once ``missing`` of its edges lead into the set.

    Args:
        graph: the edges.
        level: (N,) updated: a node that joins gets one level more than those that pulled it in.
        missing: (N,) updated: how many more edges into the set an OPEN node needs, at least 1.
        queue: (N,) updated: the nodes of the set in the order of joining.
        done: how many of them were swept already.
        filled: how many there are.
        enough: stop when there are so many.
        top: the highest level so far.

    Returns:
        the new ``done``, ``filled`` and ``top``.
    """
    while done < filled and filled < enough:
        end = filled
        for position in range(done, end):
            node = queue[position]
            for edge in range(graph.before[node], graph.before[node + 1]):
                other = graph.predecessors[edge]
                if level[other] == OPEN:
                    missing[other] -= 1
                    if missing[other] == 0:
                        level[other] = top + 1
                        queue[filled] = other
                        filled += 1
        done = end
        if filled > end:
            top += 1
    return done, filled, top


@njit(cache=True, nogil=True)
def hold(
    graph: Graph, level: NDArray[np.int32], watch: NDArray[np.int64], candidates: NDArray[np.int32], top: int
) -> NDArray[np.int32]:
    """Add the most candidates from which the system can stay in them, or enter the set, with every move.

    Start with all of them and take away, again and again, those whose next move leads astray. A node of the system
    watches one edge that keeps it in; only when that edge breaks does it look for another, further on. A node of the
    environment has none to spare and watches the end of its edges.

    Args:
        graph: the edges.
        level: (N,) updated: candidates that stay get the level ``top + 1``.
        watch: (N,) work space.
        candidates: OPEN nodes.
        top: the highest level so far.

    Returns:
        the candidates that stay, in their order.
    """
    layer = top + 1
    leaving = np.empty(candidates.size, dtype=np.int32)
    height = 0
    for node in candidates:
        level[node] = layer
    for node in candidates:
        edge, end = graph.first[node], graph.first[node + 1]
        wanted = graph.system[node]
        while edge < end and (level[graph.successors[edge]] >= 0) != wanted:
            edge += 1
        watch[node] = edge
        if (edge < end) != wanted:
            leaving[height] = node
            height += 1
            level[node] = OPEN
    while height > 0:
        height -= 1
        gone = leaving[height]
        for back in range(graph.before[gone], graph.before[gone + 1]):
            node = graph.predecessors[back]
            if level[node] != layer:
                continue
            edge, end = watch[node], graph.first[node + 1]
            while edge < end and level[graph.successors[edge]] < 0:
                edge += 1
            watch[node] = edge
            if edge < end:
                continue
            leaving[height] = node
            height += 1
            level[node] = OPEN
    stay: NDArray[np.int32] = candidates[level[candidates] == layer]
    return stay


@njit(cache=True, nogil=True)
def best_edges(graph: Graph, rank: NDArray[np.int32], after: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return for every winning node of the system its edge of lowest rank, the first of several; -1 elsewhere.

    Args:
        graph: the edges.
        rank: (N,) ranks for the goal pursued, negative where not winning.
        after: (N,) ranks for the next goal; they count where ``rank`` is 0.
    """
    choice = np.full(rank.size, -1, dtype=np.int32)
    for node in range(rank.size):
        if rank[node] < 0 or not graph.system[node]:
            continue
        measure = after if rank[node] == 0 else rank
        lowest = -1
        for edge in range(graph.first[node], graph.first[node + 1]):
            value = measure[graph.successors[edge]]
            if value >= 0 and (lowest < 0 or value < lowest):
                lowest = value
                choice[node] = edge - graph.first[node]
    return choice

"""Two questions about finite graphs: strongly connected components, and from where a set can be reached.

Graphs are in compressed rows: the successors of node v are ``successors[first[v] : first[v + 1]]``.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

Ints = NDArray[Any]
Flags = NDArray[np.bool_]


@njit(cache=True)
def components(first: Ints, successors: Ints, use: Flags) -> Ints:
    """Return the strongly connected component of every node, by edges in use (Tarjan, without recursion).

    Args:
        first: (N + 1,) offsets.
        successors: (E,) targets.
        use: (E,) which edges count.

    Returns:
        (N,) numbers of components.
    """
    nodes = len(first) - 1
    number = np.full(nodes, -1, np.int64)
    low = np.zeros(nodes, np.int64)
    found = np.full(nodes, -1, np.int64)
    place = first[:-1].astype(np.int64)
    open_nodes = np.empty(nodes, np.int64)
    path = np.empty(nodes, np.int64)
    opened, depth, visited, closed = 0, 0, 0, 0
    for root in range(nodes):
        if number[root] >= 0:
            continue
        path[0], depth = root, 1
        number[root] = low[root] = visited
        visited += 1
        open_nodes[opened] = root
        opened += 1
        while depth:
            node = path[depth - 1]
            if place[node] < first[node + 1]:
                edge = place[node]
                place[node] += 1
                target = successors[edge]
                if not use[edge]:
                    continue
                if number[target] < 0:
                    number[target] = low[target] = visited
                    visited += 1
                    open_nodes[opened] = target
                    opened += 1
                    path[depth] = target
                    depth += 1
                elif found[target] < 0:
                    low[node] = min(low[node], number[target])
                continue
            depth -= 1
            if depth:
                low[path[depth - 1]] = min(low[path[depth - 1]], low[node])
            if low[node] == number[node]:
                while True:
                    opened -= 1
                    found[open_nodes[opened]] = closed
                    if open_nodes[opened] == node:
                        break
                closed += 1
    return found


@njit(cache=True)
def cyclic(first: Ints, successors: Ints, use: Flags, component: Ints) -> Flags:
    """Return which components hold a cycle of edges in use: an edge that stays inside."""
    found = np.zeros(component.max() + 1 if len(component) else 0, np.bool_)
    for node in range(len(first) - 1):
        for edge in range(first[node], first[node + 1]):
            if use[edge] and component[successors[edge]] == component[node]:
                found[component[node]] = True
    return found


@njit(cache=True)
def can_reach(first: Ints, successors: Ints, targets: Flags) -> Flags:
    """Return from which nodes a target can be reached."""
    nodes = len(first) - 1
    before = np.zeros(nodes + 1, np.int64)
    for edge in range(len(successors)):
        before[successors[edge] + 1] += 1
    for node in range(nodes):
        before[node + 1] += before[node]
    sources = np.empty(len(successors), np.int64)
    place = before[:-1].copy()
    for node in range(nodes):
        for edge in range(first[node], first[node + 1]):
            sources[place[successors[edge]]] = node
            place[successors[edge]] += 1
    reached = targets.copy()
    queue = np.empty(nodes, np.int64)
    length = 0
    for node in range(nodes):
        if reached[node]:
            queue[length] = node
            length += 1
    done = 0
    while done < length:
        node = queue[done]
        done += 1
        for edge in range(before[node], before[node + 1]):
            if not reached[sources[edge]]:
                reached[sources[edge]] = True
                queue[length] = sources[edge]
                length += 1
    return reached


@njit(cache=True)
def reached_from(first: Ints, successors: Ints, start: int) -> Flags:
    """Return which nodes can be reached from one."""
    reached = np.zeros(len(first) - 1, np.bool_)
    queue = np.empty(len(reached), np.int64)
    queue[0], length, done = start, 1, 0
    reached[start] = True
    while done < length:
        node = queue[done]
        done += 1
        for edge in range(first[node], first[node + 1]):
            target = successors[edge]
            if not reached[target]:
                reached[target] = True
                queue[length] = target
                length += 1
    return reached

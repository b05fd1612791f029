"""A small engine of decision diagrams for the checker alone, compiled: conjunction with quantification, and no more.

A set is an edge ``2 * node + complemented``; node 0 is the constant true. The high edge of a node is never
complemented, so equal sets are equal numbers. Nodes are only ever added; what is no longer needed is dropped from the
end. Importing this module imports numba.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

TRUE, FALSE, FULL = 0, 1, -1
LEAF = np.iinfo(np.int32).max
Column = NDArray[np.int32]


@njit(cache=True, nogil=True)
def place_of(table: Column, nodes: Column, variable: int, low: int, high: int) -> int:
    """Return where in the hash table a node stands, or the free place for it."""
    mask = len(table) - 1
    mixed = np.uint64(variable) * np.uint64(0x9E3779B97F4A7C15)
    mixed = (mixed ^ np.uint64(low)) * np.uint64(0xBF58476D1CE4E5B9)
    mixed = (mixed ^ (mixed >> np.uint64(29)) ^ np.uint64(high)) * np.uint64(0x94D049BB133111EB)
    place: int = np.int64((mixed >> np.uint64(20)) & np.uint64(mask))  # type: ignore[assignment]
    while table[place] != 0:
        node = table[place]
        if nodes[node, 0] == variable and nodes[node, 1] == low and nodes[node, 2] == high:
            return place
        place = (place + 1) & mask
    return place


@njit(cache=True, nogil=True)
def made(nodes: Column, table: Column, count: NDArray[np.int64], variable: int, low: int, high: int) -> int:
    """Return the set "low where the variable is false, high where it is true"; FULL when there is no room.

    Args:
        nodes: (N, 3) variable, low and high of every node.
        table: hash table of nodes, 0 where free.
        count: (1,) how many nodes there are.
        variable: above those of both parts.
        low: where it is false, a set.
        high: where it is true.
    """
    if low == high:
        return low
    flip = high & 1
    low, high = low ^ flip, high ^ flip
    place = place_of(table, nodes, variable, low, high)
    if table[place] == 0:
        if count[0] == len(nodes):
            return FULL
        node = count[0]
        nodes[node, 0], nodes[node, 1], nodes[node, 2] = variable, low, high
        table[place] = node
        count[0] = node + 1
    result: int = 2 * table[place] + flip
    return result


@njit(cache=True, nogil=True)
def rehash(nodes: Column, table: Column, count: int) -> None:
    """Fill an empty hash table with the first nodes."""
    for node in range(1, count):
        table[place_of(table, nodes, nodes[node, 0], nodes[node, 1], nodes[node, 2])] = node


@njit(cache=True, nogil=True)
def loaded(
    nodes: Column,
    table: Column,
    count: NDArray[np.int64],
    variable: Column,
    low: Column,
    high: Column,
    start: int,
    found: Column,
) -> int:
    """Add the rows of a table of diagrams, children first; return the first row that found no room.

    Args:
        nodes: as for ``made``.
        table: as for ``made``.
        count: as for ``made``.
        variable: (T,) of every row; rows 0 and 1 are false and true.
        low: (T,) row where it is false.
        high: (T,) row where it is true.
        start: the first row to add.
        found: (T,) takes the sets of the rows.
    """
    for row in range(start, len(variable)):
        made_set = made(nodes, table, count, variable[row], found[low[row]], found[high[row]])
        if made_set == FULL:
            return row
        found[row] = made_set
    return len(variable)


@njit(cache=True, nogil=True)
def and_exists(
    nodes: Column,
    table: Column,
    count: NDArray[np.int64],
    cache: Column,
    quantified: NDArray[np.bool_],
    operation: int,
    left: int,
    right: int,
) -> int:
    """Return the conjunction of two sets, projected; FULL when there is no room.

    Args:
        nodes: as for ``made``.
        table: as for ``made``.
        count: as for ``made``.
        cache: (C, 4) left, right, operation and result of earlier steps; C is a power of two.
        quantified: (V,) which variables are projected away.
        operation: the number of this set of variables, above 0; 0 stands for none.
        left: a set.
        right: a set.
    """
    depth = 2 * len(quantified) + 8
    frames = np.empty((depth, 6), dtype=np.int64)  # left, right, operation, stage, low, top
    last = -1
    for variable in range(len(quantified)):
        if quantified[variable]:
            last = variable
    frames[0, 0], frames[0, 1], frames[0, 2], frames[0, 3] = left, right, operation, 0
    height, result = 1, 0
    mask = len(cache) - 1
    while height > 0:
        frame = frames[height - 1]
        a, b, kind, stage = frame[0], frame[1], frame[2], frame[3]
        if stage == 0:
            if a == b:
                b = TRUE
            if a < b:
                a, b = b, a
            top = min(nodes[a >> 1, 0], nodes[b >> 1, 0])
            if kind != 0 and top > last:
                kind = 0
            if a == FALSE or b == FALSE or a == b ^ 1:
                result, height = FALSE, height - 1
                continue
            if b == TRUE and (kind == 0 or a == TRUE):
                result, height = a, height - 1
                continue
            frame[0], frame[1], frame[2], frame[5] = a, b, kind, top
            slot = cache[_slot(a, b, kind, mask)]
            if slot[0] == a and slot[1] == b and slot[2] == kind:
                result, height = slot[3], height - 1
                continue
            frame[3] = 1
            _push(frames, height, _part(nodes, a, top, 1), _part(nodes, b, top, 1), kind)
            height += 1
            continue
        top = frame[5]
        projected = kind != 0 and quantified[top]
        if stage == 1:
            frame[4] = result
            if not (projected and result == TRUE):
                frame[3] = 2
                _push(frames, height, _part(nodes, a, top, 2), _part(nodes, b, top, 2), kind)
                height += 1
                continue
        elif stage == 2 and projected:
            frame[3] = 3
            _push(frames, height, frame[4] ^ 1, result ^ 1, 0)
            height += 1
            continue
        elif stage == 2:
            result = made(nodes, table, count, top, frame[4], result)
            if result == FULL:
                return FULL
        else:
            result ^= 1
        slot = cache[_slot(a, b, kind, mask)]
        slot[0], slot[1], slot[2], slot[3] = a, b, kind, result
        height -= 1
    return result


@njit(cache=True, inline="always")
def _slot(a: int, b: int, kind: int, mask: int) -> int:
    mixed = np.uint64(a) * np.uint64(0x9E3779B97F4A7C15) + np.uint64(b) * np.uint64(0xC2B2AE3D27D4EB4F)
    mixed = (mixed ^ (mixed >> np.uint64(31)) ^ np.uint64(kind)) * np.uint64(0x94D049BB133111EB)
    slot: int = np.int64((mixed >> np.uint64(18)) & np.uint64(mask))  # type: ignore[assignment]
    return slot


@njit(cache=True, inline="always")
def _part(nodes: Column, edge: int, top: int, side: int) -> int:
    node = edge >> 1
    return nodes[node, side] ^ (edge & 1) if nodes[node, 0] == top else edge


@njit(cache=True, inline="always")
def _push(frames: NDArray[np.int64], height: int, left: int, right: int, operation: int) -> None:
    frames[height, 0], frames[height, 1], frames[height, 2], frames[height, 3] = left, right, operation, 0


@njit(cache=True, nogil=True)
def shares(nodes: Column, count: int) -> NDArray[np.float64]:
    """Return for every node the share of all valuations that it contains."""
    found = np.ones(count, dtype=np.float64)
    for node in range(1, count):
        low, high = nodes[node, 1], nodes[node, 2]
        part = found[low >> 1] if low & 1 == 0 else 1.0 - found[low >> 1]
        found[node] = 0.5 * (part + found[high >> 1])
    return found


@njit(cache=True, nogil=True)
def below(low: Column, high: Column, kept: NDArray[np.bool_]) -> None:
    """Mark all rows of a table that lie below marked ones; children stand before their parents."""
    for row in range(len(low) - 1, 1, -1):
        if kept[row]:
            kept[low[row]] = True
            kept[high[row]] = True

"""Compiled walks over decision diagrams that were written out as tables.

A table has one row a node: the variable, and the rows for false and true. Rows 0 and 1 are the constants. A set of
diagrams is walked at once, variable by variable; a branch ends where one of them is false. Importing this module
imports numba.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

FREE = 2


@njit(cache=True, nogil=True)
def holds(
    variable: NDArray[np.int32],
    low: NDArray[np.int32],
    high: NDArray[np.int32],
    root: int,
    values: NDArray[np.uint8],
) -> bool:
    """Return whether a diagram is true under a valuation of all its variables."""
    node = root
    while node > 1:
        node = high[node] if values[variable[node]] == 1 else low[node]
    return node == 1


@njit(cache=True, nogil=True)
def complete(
    variable: NDArray[np.int32],
    low: NDArray[np.int32],
    high: NDArray[np.int32],
    roots: NDArray[np.int32],
    values: NDArray[np.uint8],
    most: int,
) -> tuple[NDArray[np.uint8], bool]:
    """Return the ways to complete a valuation so that all diagrams hold, in rising order, the top variable first.

    Args:
        variable: (T,) of every row; a large number for the constants.
        low: (T,) row where the variable is false.
        high: (T,) row where it is true.
        roots: (K,) rows of the diagrams.
        values: (V,) 0, 1, or FREE where the walk chooses.
        most: stop after so many.

    Returns:
        (n, F) the values of the free variables, top first; and whether that is all of them.
    """
    variables, diagrams = values.size, roots.size
    free = np.flatnonzero(values == FREE)
    found = np.empty((16, free.size), dtype=np.uint8)
    number = 0
    at = np.empty((variables + 1, diagrams), dtype=np.int32)
    at[0] = roots
    choice = np.empty(variables, dtype=np.uint8)
    level, fresh = 0, True
    for k in range(diagrams):
        if roots[k] == 0:
            return found[:0], True
    while level >= 0:
        if level == variables:
            if number == most:
                return found[:number], False
            if number == found.shape[0]:
                larger = np.empty((2 * number, free.size), dtype=np.uint8)
                larger[:number] = found
                found = larger
            for f in range(free.size):
                found[number, f] = choice[free[f]]
            number += 1
            level, fresh = level - 1, False
            continue
        if fresh:
            value = values[level] if values[level] != FREE else 0
        elif values[level] == FREE and choice[level] == 0:
            value = 1
        else:
            level -= 1
            continue
        choice[level] = value
        alive = True
        for k in range(diagrams):
            node = at[level, k]
            if node > 1 and variable[node] == level:
                node = high[node] if value == 1 else low[node]
            at[level + 1, k] = node
            if node == 0:
                alive = False
                break
        fresh = alive
        if alive:
            level += 1
    return found[:number], True


@njit(cache=True, nogil=True)
def expand(
    variable: NDArray[np.int32],
    low: NDArray[np.int32],
    high: NDArray[np.int32],
    roots: NDArray[np.int32],
    fixed: NDArray[np.int64],
    keys: NDArray[np.uint64],
    free: NDArray[np.int64],
    most: int,
) -> tuple[NDArray[np.int64], NDArray[np.uint64]]:
    """Complete many packed valuations at once; every diagram mentions fixed and free variables only.

    Args:
        variable: (T,) of every row; a large number for the constants.
        low: (T,) row where the variable is false.
        high: (T,) row where it is true.
        roots: (K,) rows of the diagrams.
        fixed: (A,) the variables given; bit k of a key is the value of ``fixed[k]``.
        keys: (M,) packed valuations.
        free: (B,) the variables chosen; bit k of a result is the value of ``free[k]``.
        most: stop beyond so many results; the offsets then end early with -1.

    Returns:
        (M + 1,) offsets and (n,) packed completions.
    """
    levels = np.concatenate((fixed, free))
    order = np.argsort(levels)
    depth, diagrams = levels.size, roots.size
    first = np.zeros(keys.size + 1, dtype=np.int64)
    found = np.empty(1024, dtype=np.uint64)
    number = 0
    at = np.empty((depth + 1, diagrams), dtype=np.int32)
    choice = np.empty(depth, dtype=np.uint8)
    packed = np.zeros(depth + 1, dtype=np.uint64)
    possible = True
    for k in range(diagrams):
        possible = possible and roots[k] != 0
    for row in range(keys.size):
        at[0] = roots
        level, fresh = 0, possible
        if not possible:
            level = -1
        while level >= 0:
            if level == depth:
                if number == found.size:
                    larger = np.empty(2 * number, dtype=np.uint64)
                    larger[:number] = found
                    found = larger
                found[number] = packed[depth]
                number += 1
                level, fresh = level - 1, False
                continue
            place = order[level]
            given = place < fixed.size
            if fresh:
                value = (keys[row] >> np.uint64(place)) & np.uint64(1) if given else np.uint64(0)
            elif not given and choice[level] == 0:
                value = np.uint64(1)
            else:
                level -= 1
                continue
            choice[level] = value
            alive = True
            here = levels[place]
            for k in range(diagrams):
                node = at[level, k]
                if node > 1 and variable[node] == here:
                    node = high[node] if value == 1 else low[node]
                at[level + 1, k] = node
                if node == 0:
                    alive = False
                    break
            fresh = alive
            if alive:
                packed[level + 1] = packed[level]
                if not given:
                    packed[level + 1] |= value << np.uint64(place - fixed.size)
                level += 1
        first[row + 1] = number
        if number > most:
            first[keys.size] = -1
            break
    return first, found[:number]


@njit(cache=True, nogil=True)
def hold_at(
    variable: NDArray[np.int32],
    low: NDArray[np.int32],
    high: NDArray[np.int32],
    root: int,
    place: NDArray[np.int64],
    keys: NDArray[np.uint64],
) -> NDArray[np.bool_]:
    """Return at which packed valuations a diagram is true; bit ``place[v]`` of a key is the value of variable v."""
    result = np.empty(keys.size, dtype=np.bool_)
    for row in range(keys.size):
        node = root
        while node > 1:
            bit = (keys[row] >> np.uint64(place[variable[node]])) & np.uint64(1)
            node = high[node] if bit == 1 else low[node]
        result[row] = node == 1
    return result

"""Compiled walks over decision diagrams that were written out as tables.

A table has one row a node: the variable, and the rows for false and true. Rows 0 and 1 are the constants. A set of
diagrams is walked at once, variable by variable; a branch ends where one of them is false. Importing this imports numba.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

FREE = 2


@njit(cache=True)
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


@njit(cache=True)
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

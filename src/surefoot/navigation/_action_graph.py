"""Compiled exploration of the action game's graph (docs/rules.md, section 5)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from surefoot.navigation._action_moves import ACHIEVED, LOST, STOP_ORDER, allowed, deviations, move
from surefoot.navigation.action_rules import Tables

STATE, CHOSEN, BOUNDARY = range(3)


@njit(cache=True)
def encode(tables: Tables, row: int, column: int, heading: int, stance: int, mode: int, outer: int) -> int:
    """Return the number of a state; ``outer`` is the context, or what a boundary is made of."""
    n, headings = tables.cells, 4 * tables.turn_steps
    return ((((outer * 7 + mode) * 2 + stance) * headings + heading) * n + row) * n + column


@njit(cache=True)
def decode(tables: Tables, code: int) -> Any:
    """Return (row, column, heading, stance, mode, outer) of a state's number."""
    n, headings = tables.cells, 4 * tables.turn_steps
    code, column = code // n, code % n
    code, row = code // n, code % n
    code, heading = code // headings, code % headings
    code, stance = code // 2, code % 2
    return row, column, heading, stance, code % 7, code // 7


@njit(cache=True)
def grown(array: NDArray[Any], needed: int) -> NDArray[Any]:
    """Return an array that holds at least so many entries, with the old ones copied."""
    if needed <= len(array):
        return array
    larger = np.empty(max(needed, 2 * len(array)), array.dtype)
    larger[: len(array)] = array
    return larger


@njit(cache=True)
def with_node(
    kind: NDArray[Any],
    code: NDArray[Any],
    owner: NDArray[Any],
    count: int,
    new_kind: int,
    new_code: int,
    new_owner: int,
) -> Any:
    """Return the lists of nodes with one more, and their number."""
    kind, code, owner = grown(kind, count + 1), grown(code, count + 1), grown(owner, count + 1)
    kind[count], code[count], owner[count] = new_kind, new_code, new_owner
    return kind, code, owner, count + 1


@njit(cache=True)
def safe_action(
    tables: Tables, row: int, column: int, heading: int, stance: int, mode: int, context: int, action: int
) -> bool:
    """Return whether an action is allowed and none of its outcomes is lost."""
    if not allowed(tables, heading, stance, mode, context, action):
        return False
    far, wide = deviations(tables, row, column, heading, mode, context, action)
    for sagittal in range(-far, far + 1):
        for lateral in range(-wide, wide + 1):
            after = move(tables, row, column, heading, stance, mode, context, action, sagittal, lateral)
            if after[0] == LOST:
                return False
    return True


@njit(cache=True)
def boundary(tables: Tables, heading: int, context: int) -> int:
    """Return what a boundary is made of: the profile of the cell that the robot is in, and its last direction."""
    if tables.order[context] == STOP_ORDER:
        return int(4 * tables.here[context] + heading // tables.turn_steps)
    return int(4 * tables.there[context] + tables.order[context])


@njit(cache=True)
def explore(tables: Tables, starts: NDArray[np.int64]) -> Any:
    """Explore the game graph from states.

    A node is a state (the robot picks an action), an action in a state (the environment picks the outcome) or a
    boundary (an order was achieved: the environment picks the next context). Actions with a lost outcome are left out.

    Returns:
        (kind, code, first, successors): for every node STATE, CHOSEN or BOUNDARY; its number (of a chosen action: the
        action); successor lists.
    """
    actions = len(tables.length)
    space = tables.cells * tables.cells * 4 * tables.turn_steps * 2 * 7
    state_id = np.full(space * len(tables.order), -1, np.int32)
    boundary_id = np.full(space * 4 * len(tables.axis), -1, np.int32)
    kind, code, owner = np.empty(1024, np.int8), np.empty(1024, np.int64), np.empty(1024, np.int32)
    first, successors = np.empty(1025, np.int64), np.empty(4096, np.int32)
    count, edges, node = 0, 0, 0
    for start in starts:
        if state_id[start] < 0:
            state_id[start] = count
            kind, code, owner, count = with_node(kind, code, owner, count, STATE, start, -1)
    first[0] = 0
    while node < count:
        first = grown(first, node + 2)
        # A chosen action is explored through the state that it was chosen in.
        number = code[node] if kind[node] != CHOSEN else code[owner[node]]
        row, column, heading, stance, mode, outer = decode(tables, number)
        if kind[node] == BOUNDARY:
            for i in range(tables.next_first[outer], tables.next_first[outer + 1]):
                number = encode(tables, row, column, heading, stance, mode, tables.next_context[i])
                if state_id[number] < 0:
                    state_id[number] = count
                    kind, code, owner, count = with_node(kind, code, owner, count, STATE, number, -1)
                successors = grown(successors, edges + 1)
                successors[edges] = state_id[number]
                edges += 1
        elif kind[node] == STATE:
            for action in range(actions):
                if safe_action(tables, row, column, heading, stance, mode, outer, action):
                    successors = grown(successors, edges + 1)
                    successors[edges] = count
                    edges += 1
                    kind, code, owner, count = with_node(kind, code, owner, count, CHOSEN, action, node)
        else:
            action = code[node]
            far, wide = deviations(tables, row, column, heading, mode, outer, action)
            for sagittal in range(-far, far + 1):
                for lateral in range(-wide, wide + 1):
                    status, r, c, h, s, m, _ = move(
                        tables, row, column, heading, stance, mode, outer, action, sagittal, lateral
                    )
                    achieved = status == ACHIEVED
                    ids = boundary_id if achieved else state_id
                    number = encode(tables, r, c, h, s, m, boundary(tables, heading, outer) if achieved else outer)
                    if ids[number] < 0:
                        ids[number] = count
                        new_kind = BOUNDARY if achieved else STATE
                        kind, code, owner, count = with_node(kind, code, owner, count, new_kind, number, -1)
                    successors = grown(successors, edges + 1)
                    successors[edges] = ids[number]
                    edges += 1
        node += 1
        first[node] = edges
    return kind[:count], code[:count], first[: count + 1], successors[:edges]

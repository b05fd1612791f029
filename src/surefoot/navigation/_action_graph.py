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
    width: NDArray[Any],
    count: int,
    new_kind: int,
    new_code: int,
    new_width: int,
) -> Any:
    """Return the lists of nodes with one more, and their number."""
    kind, code, width = grown(kind, count + 1), grown(code, count + 1), grown(width, count + 1)
    kind[count], code[count], width[count] = new_kind, new_code, new_width
    return kind, code, width, count + 1


@njit(cache=True)
def permitted(tables: Tables) -> NDArray[np.bool_]:
    """Return (contexts, modes, stances, headings, actions) which actions are allowed; the place does not matter."""
    headings = 4 * tables.turn_steps
    table = np.empty((len(tables.order), 7, 2, headings, len(tables.length)), np.bool_)
    for context, mode, stance, heading, action in np.ndindex(table.shape):
        table[context, mode, stance, heading, action] = allowed(tables, heading, stance, mode, context, action)
    return table


@njit(cache=True)
def outcomes(
    tables: Tables,
    row: int,
    column: int,
    heading: int,
    stance: int,
    mode: int,
    context: int,
    action: int,
    found: NDArray[np.int64],
) -> int:
    """Write what an action can lead to, and return how much that is: nothing when one of the outcomes is lost.

    A state is written as its number, a boundary as -1 - its number.
    """
    count = 0
    far, wide = deviations(tables, row, column, heading, mode, context, action)
    for sagittal in range(-far, far + 1):
        for lateral in range(-wide, wide + 1):
            status, r, c, h, s, m, _ = move(
                tables, row, column, heading, stance, mode, context, action, sagittal, lateral
            )
            if status == LOST:
                return 0
            outer = boundary(tables, heading, context) if status == ACHIEVED else context
            number = encode(tables, r, c, h, s, m, outer)
            found[count] = -1 - number if status == ACHIEVED else number
            count += 1
    return count


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
    may = permitted(tables)
    most = (2 * tables.sagittal + 1) * (2 * tables.lateral + 1)
    widest = max(most, len(tables.length), len(tables.order))
    space = tables.cells * tables.cells * 4 * tables.turn_steps * 2 * 7
    state_id = np.full(space * len(tables.order), -1, np.int32)
    boundary_id = np.full(space * 4 * len(tables.axis), -1, np.int32)
    kind, code, width = np.empty(1024, np.int8), np.empty(1024, np.int64), np.empty(1024, np.int32)
    first, successors = np.empty(1025, np.int64), np.empty(4096, np.int32)
    # What nodes lead to, by number, in the order in which they are explored; ``width`` is how much it is.
    ahead = np.empty(4096, np.int64)
    count, edges, node, filled, taken = 0, 0, 0, 0, 0
    for start in starts:
        if state_id[start] < 0:
            state_id[start] = count
            kind, code, width, count = with_node(kind, code, width, count, STATE, start, 0)
    first[0] = 0
    while node < count:
        first, successors = grown(first, node + 2), grown(successors, edges + widest)
        if kind[node] == CHOSEN:
            for number in ahead[taken : taken + width[node]]:
                ids = state_id if number >= 0 else boundary_id
                place = number if number >= 0 else -1 - number
                if ids[place] < 0:
                    ids[place] = count
                    new_kind = STATE if number >= 0 else BOUNDARY
                    kind, code, width, count = with_node(kind, code, width, count, new_kind, place, 0)
                successors[edges] = ids[place]
                edges += 1
            taken += width[node]
        else:
            row, column, heading, stance, mode, outer = decode(tables, code[node])
            if kind[node] == BOUNDARY:
                for i in range(tables.next_first[outer], tables.next_first[outer + 1]):
                    number = encode(tables, row, column, heading, stance, mode, tables.next_context[i])
                    if state_id[number] < 0:
                        state_id[number] = count
                        kind, code, width, count = with_node(kind, code, width, count, STATE, number, 0)
                    successors[edges] = state_id[number]
                    edges += 1
            else:
                ahead = grown(ahead, filled + len(tables.length) * most)
                for action in range(len(tables.length)):
                    if not may[outer, mode, stance, heading, action]:
                        continue
                    found = outcomes(tables, row, column, heading, stance, mode, outer, action, ahead[filled:])
                    if found:
                        successors[edges] = count
                        edges, filled = edges + 1, filled + found
                        kind, code, width, count = with_node(kind, code, width, count, CHOSEN, action, found)
        node += 1
        first[node] = edges
    return kind[:count], code[:count], first[: count + 1], successors[:edges]

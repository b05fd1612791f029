"""Compiled moves and exploration of the action game; the rules are docs/rules.md, section 5."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from surefoot.navigation.action_rules import Tables

CONTINUE, STOP, STAY, START, PRE_STEP, TURN, STRAIGHT = range(7)
STANDING, WALKING, READY, LEFT_A, RIGHT_A, LEFT_B, RIGHT_B = range(7)
STOP_ORDER = 4
PENDING, ACHIEVED, LOST = range(3)
ROWS = np.array([-1, 0, 1, 0])
COLUMNS = np.array([0, 1, 0, -1])


@njit(cache=True)
def allowed(tables: Tables, heading: int, stance: int, mode: int, context: int, action: int) -> bool:
    """Return whether an action is allowed in a state."""
    order = tables.order[context]
    if mode >= LEFT_A:
        return action == CONTINUE
    ahead = heading // tables.turn_steps
    if order == STOP_ORDER:
        return action == (STAY if mode == STANDING else STOP)
    if mode == STANDING:
        return action == START
    side = 0 if order == (ahead + 3) % 4 else 1 if order == (ahead + 1) % 4 else -1
    if mode == READY:
        return action == TURN
    if action == PRE_STEP:
        return side >= 0 and stance != side
    if action == TURN:
        return side >= 0 and stance != side
    return action >= STRAIGHT


@njit(cache=True)
def deviations(tables: Tables, row: int, column: int, heading: int, mode: int, context: int, action: int) -> Any:
    """Return the largest sagittal and lateral deviation of an action."""
    last = tables.cells - 1
    inside = min(row, column, last - row, last - column) >= tables.band
    if tables.length[action] > 0:
        nominal = tables.axis[tables.here[context]] >= 0
        return (tables.sagittal if inside and not nominal else 0), 0
    if action == STAY:
        return 0, 0
    done = 0
    if action == CONTINUE:
        done = heading % tables.turn_steps if mode in (RIGHT_A, RIGHT_B) else -heading % tables.turn_steps
    return 0, (tables.lateral if done == tables.turn_steps - 1 else 0)


@njit(cache=True)
def height_at(tables: Tables, profile: int, row: int, column: int) -> float:
    """Return the height at a fine cell, relative to the border where its cell's axis enters."""
    if tables.axis[profile] < 0:
        return 0.0
    return float(tables.height[profile, along_axis(tables, profile, row, column)])


@njit(cache=True)
def along_axis(tables: Tables, profile: int, row: int, column: int) -> int:
    """Return the fine index along a stairs cell's axis."""
    last = tables.cells - 1
    axis = tables.axis[profile]
    return last - row if axis == 0 else column if axis == 1 else row if axis == 2 else last - column


@njit(cache=True)
def border_height(tables: Tables, profile: int, direction: int, leaving: bool) -> float:
    """Return the height of the border through which a cell is left or entered in a direction."""
    axis = tables.axis[profile]
    if axis < 0:
        return 0.0
    upward = axis == direction
    return tables.gain[profile] if upward == leaving else 0.0


@njit(cache=True)
def move(
    tables: Tables,
    row: int,
    column: int,
    heading: int,
    stance: int,
    mode: int,
    context: int,
    action: int,
    sagittal: int,
    lateral: int,
) -> Any:
    """Carry out an action with a labelled outcome.

    Returns:
        (status, row, column, heading, stance, mode, height change); status is PENDING, ACHIEVED or LOST.
    """
    n, k = tables.cells, tables.turn_steps
    order, here, there = tables.order[context], tables.here[context], tables.there[context]
    if action == STAY:
        return ACHIEVED, row, column, heading, stance, mode, 0.0
    new_heading, new_mode, rows, columns = heading, WALKING, 0, 0
    if tables.length[action] > 0:
        ahead = heading // k
        distance = tables.length[action] + sagittal
        rows, columns = distance * ROWS[ahead], distance * COLUMNS[ahead]
        new_mode = STANDING if action == STOP else READY if action == PRE_STEP else WALKING
    else:
        if action == TURN:
            side = 0 if order == (heading // k + 3) % 4 else 1
            kind = 0 if mode == WALKING else 1
            done, ahead = 0, heading // k
        else:
            side = (mode - LEFT_A) % 2
            kind = (mode - LEFT_A) // 2
            done = heading % k if side == 1 else -heading % k
            ahead = (heading - done if side == 1 else heading + done) % (4 * k) // k
        rows, columns = tables.turn[kind, side, ahead, done, 0], tables.turn[kind, side, ahead, done, 1]
        new_heading = (heading + (1 if side == 1 else -1)) % (4 * k)
        new_mode = LEFT_A + 2 * kind + side
        if done == k - 1:
            new_mode = WALKING
            left = (new_heading // k + 3) % 4
            rows, columns = rows + lateral * ROWS[left], columns + lateral * COLUMNS[left]
    new_row, new_column = row + rows, column + columns
    lost = (LOST, row, column, heading, stance, mode, 0.0)
    crossed, crossings = -1, 0
    if new_row < 0:
        crossed, crossings = 0, crossings + 1
    if new_row >= n:
        crossed, crossings = 2, crossings + 1
    if new_column >= n:
        crossed, crossings = 1, crossings + 1
    if new_column < 0:
        crossed, crossings = 3, crossings + 1
    if crossings > 1 or (crossings == 1 and crossed != order):
        return lost
    new_row, new_column = new_row % n, new_column % n
    profile = there if crossings == 1 else here
    cardinal = new_heading % k == 0
    if cardinal:
        lateral = new_column if new_heading // k % 2 == 0 else new_row
        if lateral < tables.band or lateral > n - 1 - tables.band:
            return lost
    change = 0.0
    if tables.axis[here] >= 0 or tables.axis[profile] >= 0:
        for part in (here, profile):
            if tables.axis[part] >= 0 and (not cardinal or (new_heading // k - tables.axis[part]) % 2 != 0):
                return lost
        if not tables.admissible[profile, along_axis(tables, profile, new_row, new_column)]:
            return lost
        change = height_at(tables, profile, new_row, new_column) - height_at(tables, here, row, column)
        if crossings == 1:
            change += border_height(tables, here, order, True) - border_height(tables, there, order, False)
        level = tables.length[action] == 0 or action in (START, STOP)
        if abs(change) > (0.0 if level else tables.height_max) + 1e-9:
            return lost
    status = ACHIEVED if crossings == 1 or (order == STOP_ORDER and new_mode == STANDING) else PENDING
    return status, new_row, new_column, new_heading, 1 - stance, new_mode, change


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
def explore(tables: Tables, starts: NDArray[np.int64]) -> Any:
    """Explore the game graph from states.

    A node is a state (the robot picks an action), an action in a state (the environment picks the outcome) or a
    boundary (an order
    was achieved: the environment picks the next context). Actions with a lost outcome are left out.

    Returns:
        (kind, code, first, successors): for every node 0 state, 1 action, 2 boundary; its number (for an action:
        the action);
        successor lists.
    """
    headings = 4 * tables.turn_steps
    space = tables.cells * tables.cells * headings * 2 * 7
    actions = len(tables.length)
    state_id = np.full(space * len(tables.order), -1, np.int32)
    boundary_id = np.full(space * 4 * len(tables.axis), -1, np.int32)
    kind, code = np.empty(1024, np.int8), np.empty(1024, np.int64)
    first, successors = np.empty(1025, np.int64), np.empty(4096, np.int32)
    count, edges = 0, 0
    for start in starts:
        if state_id[start] < 0:
            kind, code = grown(kind, count + 1), grown(code, count + 1)
            state_id[start], kind[count], code[count] = count, 0, start
            count += 1
    node = 0
    spread = (2 * tables.sagittal + 1) * (2 * tables.lateral + 1)
    found = np.empty(spread, np.int64)
    achieved = np.empty(spread, np.bool_)
    # An action node is explored through the state that made it.
    owner = np.empty(1024, np.int32)
    owner = grown(owner, count)
    first[0] = 0
    while node < count:
        first = grown(first, node + 2)
        if kind[node] == 2:
            row, column, heading, stance, mode, outer = decode(tables, code[node])
            begin, end = tables.next_first[outer], tables.next_first[outer + 1]
            successors = grown(successors, edges + end - begin)
            for i in range(begin, end):
                number = encode(tables, row, column, heading, stance, mode, tables.next_context[i])
                if state_id[number] < 0:
                    kind, code, owner = grown(kind, count + 1), grown(code, count + 1), grown(owner, count + 1)
                    state_id[number], kind[count], code[count] = count, 0, number
                    count += 1
                successors[edges] = state_id[number]
                edges += 1
        elif kind[node] == 0:
            row, column, heading, stance, mode, context = decode(tables, code[node])
            for action in range(actions):
                if not allowed(tables, heading, stance, mode, context, action):
                    continue
                sagittal, lateral = deviations(tables, row, column, heading, mode, context, action)
                safe = True
                for e in range(-sagittal, sagittal + 1):
                    for side in range(-lateral, lateral + 1):
                        safe &= move(tables, row, column, heading, stance, mode, context, action, e, side)[0] != LOST
                if safe:
                    kind, code, owner = grown(kind, count + 1), grown(code, count + 1), grown(owner, count + 1)
                    successors = grown(successors, edges + 1)
                    kind[count], code[count], owner[count] = 1, action, node
                    successors[edges] = count
                    edges += 1
                    count += 1
        else:
            action = code[node]
            row, column, heading, stance, mode, context = decode(tables, code[owner[node]])
            sagittal, lateral = deviations(tables, row, column, heading, mode, context, action)
            outcomes = 0
            for e in range(-sagittal, sagittal + 1):
                for side in range(-lateral, lateral + 1):
                    status, r, c, h, s, m, _ = move(
                        tables, row, column, heading, stance, mode, context, action, e, side
                    )
                    outer = context
                    if status == ACHIEVED:
                        order = tables.order[context]
                        last = heading // tables.turn_steps if order == STOP_ORDER else order
                        profile = tables.here[context] if order == STOP_ORDER else tables.there[context]
                        outer = 4 * profile + last
                    found[outcomes], achieved[outcomes] = encode(tables, r, c, h, s, m, outer), status == ACHIEVED
                    outcomes += 1
            successors = grown(successors, edges + outcomes)
            for i in range(outcomes):
                ids = boundary_id if achieved[i] else state_id
                if ids[found[i]] < 0:
                    kind, code, owner = grown(kind, count + 1), grown(code, count + 1), grown(owner, count + 1)
                    ids[found[i]], kind[count], code[count] = count, 2 if achieved[i] else 0, found[i]
                    count += 1
                successors[edges] = ids[found[i]]
                edges += 1
        node += 1
        first[node] = edges
    return kind[:count], code[:count], first[: count + 1], successors[:edges]

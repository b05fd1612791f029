"""Compiled moves of the action game; the rules are docs/rules.md, section 5.

They are inlined where they are called from compiled code: a call would count references to every array of the tables.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from surefoot.navigation.action_rules import Tables

CONTINUE, STOP, STAY, START, PRE_STEP, TURN, STRAIGHT = range(7)
STANDING, WALKING, READY, LEFT_A, RIGHT_A, LEFT_B, RIGHT_B = range(7)
STOP_ORDER = 4
PENDING, ACHIEVED, LOST = range(3)
ROWS = np.array([-1, 0, 1, 0])
COLUMNS = np.array([0, 1, 0, -1])


@njit(cache=True, inline="always")
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


@njit(cache=True, inline="always")
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


@njit(cache=True, inline="always")
def height_at(tables: Tables, profile: int, row: int, column: int) -> float:
    """Return the height at a fine cell, relative to the border where its cell's axis enters."""
    if tables.axis[profile] < 0:
        return 0.0
    return float(tables.height[profile, along_axis(tables, profile, row, column)])


@njit(cache=True, inline="always")
def along_axis(tables: Tables, profile: int, row: int, column: int) -> int:
    """Return the fine index along a stairs cell's axis."""
    last = tables.cells - 1
    axis = tables.axis[profile]
    return last - row if axis == 0 else column if axis == 1 else row if axis == 2 else last - column


@njit(cache=True, inline="always")
def border_height(tables: Tables, profile: int, direction: int, leaving: bool) -> float:
    """Return the height of the border through which a cell is left or entered in a direction."""
    axis = tables.axis[profile]
    if axis < 0:
        return 0.0
    upward = axis == direction
    return tables.gain[profile] if upward == leaving else 0.0


@njit(cache=True, inline="always")
def displacement(
    tables: Tables, heading: int, mode: int, context: int, action: int, sagittal: int, lateral: int
) -> Any:
    """Return where an action with a labelled outcome goes: (rows, columns, next heading, next mode)."""
    k = tables.turn_steps
    if tables.length[action] > 0:
        ahead = heading // k
        distance = tables.length[action] + sagittal
        next_mode = STANDING if action == STOP else READY if action == PRE_STEP else WALKING
        return distance * ROWS[ahead], distance * COLUMNS[ahead], heading, next_mode
    if action == TURN:
        side = 0 if tables.order[context] == (heading // k + 3) % 4 else 1
        kind = 0 if mode == WALKING else 1
        done, ahead = 0, heading // k
    else:
        side = (mode - LEFT_A) % 2
        kind = (mode - LEFT_A) // 2
        done = heading % k if side == 1 else -heading % k
        ahead = (heading - done if side == 1 else heading + done) % (4 * k) // k
    rows, columns = tables.turn[kind, side, ahead, done, 0], tables.turn[kind, side, ahead, done, 1]
    next_heading = (heading + (1 if side == 1 else -1)) % (4 * k)
    if done < k - 1:
        return rows, columns, next_heading, LEFT_A + 2 * kind + side
    left = (next_heading // k + 3) % 4
    return rows + lateral * ROWS[left], columns + lateral * COLUMNS[left], next_heading, WALKING


@njit(cache=True, inline="always")
def border_crossed(tables: Tables, row: int, column: int) -> int:
    """Return the direction of the border that an unwrapped position lies beyond: -1 for none, -2 for two."""
    n = tables.cells
    vertical = 0 if row < 0 else 2 if row >= n else -1
    horizontal = 1 if column >= n else 3 if column < 0 else -1
    if vertical >= 0 and horizontal >= 0:
        return -2
    return max(vertical, horizontal)


@njit(cache=True, inline="always")
def in_side_band(tables: Tables, row: int, column: int, heading: int) -> bool:
    """Return whether a robot with a cardinal heading stands too near to a side of its cell."""
    across = column if heading // tables.turn_steps % 2 == 0 else row
    return across < tables.band or across > tables.cells - 1 - tables.band


@njit(cache=True, inline="always")
def climb(
    tables: Tables,
    row: int,
    column: int,
    context: int,
    action: int,
    end_row: int,
    end_column: int,
    heading: int,
    crossed: int,
) -> Any:
    """Return whether a move that meets stairs is allowed, and its height change."""
    here = tables.here[context]
    profile = here if crossed < 0 else tables.there[context]
    for part in (here, profile):
        along = heading % tables.turn_steps == 0 and (heading // tables.turn_steps - tables.axis[part]) % 2 == 0
        if tables.axis[part] >= 0 and not along:
            return False, 0.0
    if not tables.admissible[profile, along_axis(tables, profile, end_row, end_column)]:
        return False, 0.0
    change = height_at(tables, profile, end_row, end_column) - height_at(tables, here, row, column)
    if crossed >= 0:
        change += border_height(tables, here, crossed, True) - border_height(tables, profile, crossed, False)
    level = tables.length[action] == 0 or action in (START, STOP)
    return abs(change) <= (0.0 if level else tables.height_max) + 1e-9, change


@njit(cache=True, inline="always")
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
    if action == STAY:
        return ACHIEVED, row, column, heading, stance, mode, 0.0
    rows, columns, next_heading, next_mode = displacement(tables, heading, mode, context, action, sagittal, lateral)
    return arrive(tables, row, column, stance, context, action, rows, columns, next_heading, next_mode)


@njit(cache=True, inline="always")
def arrive(
    tables: Tables,
    row: int,
    column: int,
    stance: int,
    context: int,
    action: int,
    rows: int,
    columns: int,
    next_heading: int,
    next_mode: int,
) -> Any:
    """Return what comes of a step that displaces the robot by some cells; see ``move``."""
    order = tables.order[context]
    lost = (LOST, row, column, next_heading, stance, next_mode, 0.0)
    crossed = border_crossed(tables, row + rows, column + columns)
    if crossed == -2 or (crossed >= 0 and crossed != order):
        return lost
    end_row, end_column = (row + rows) % tables.cells, (column + columns) % tables.cells
    if next_heading % tables.turn_steps == 0 and in_side_band(tables, end_row, end_column, next_heading):
        return lost
    change = 0.0
    profile = tables.here[context] if crossed < 0 else tables.there[context]
    if tables.axis[tables.here[context]] >= 0 or tables.axis[profile] >= 0:
        allowed_there, change = climb(tables, row, column, context, action, end_row, end_column, next_heading, crossed)
        if not allowed_there:
            return lost
    achieved = crossed >= 0 or (order == STOP_ORDER and next_mode == STANDING)
    return (
        ACHIEVED if achieved else PENDING,
        end_row,
        end_column,
        next_heading,
        1 - stance,
        next_mode,
        change,
    )

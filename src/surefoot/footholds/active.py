"""The program of a contact table with given polygons, by a dual active-set method that starts near its end, compiled.

Goldfarb and Idnani 1983: from the least cost on some active rows, all of which press, the row that is violated most is
made active, and rows that no longer press are left out, until none is violated. The cost rises with every step, and
never exceeds that of the program. So a table that costs too much is given up as soon as that shows, and one that
differs little from a table that was solved before takes few steps from the rows that were active there.

Feet in contact share the force equally, and friction and torque are rows of their own. Where these press, other shares
may cost less, so that the plan is one, but perhaps not the best with its gait. No bound rests on anything here.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from surefoot.footholds.banded import Flags, Givens, System, solved, system_of
from surefoot.footholds.rows import Array, Index
from surefoot.footholds.table_rows import EQUATIONS, FLIGHT, PLANE, WIDEST, write_row
from surefoot.footholds.violation import worst_row

SOLVED, COSTLY, GIVEN_UP = 0, 1, 2
KEPT_BY_NONE, TOO_MANY = -1, -2

_MORE_ACTIVE, _MORE_CHANGES = 160, 4
_KEPT_M = 1e-7
_LEAST_PIVOT = 1e-10


class Front(NamedTuple):
    """The active rows.

    Attributes:
        names: of the rows, shape (A, 4).
        at: where they have entries, shape (A, 9).
        factor: which, shape (A, 9).
        counts: how many, shape (A,).
        limits: shape (A,).
        gram: what pushing along one row adds to the others; the lower triangle counts, shape (A, A).
        lower: its Cholesky factor, shape (A, A).
        first: the first column with an entry, of every row of these, shape (A,).
        press: multipliers, shape (A,).
    """

    names: Index
    at: Index
    factor: Array
    counts: Index
    limits: Array
    gram: Array
    lower: Array
    first: Index
    press: Array


@numba.njit(cache=True, error_model="numpy")
def _empty(samples: int) -> Front:
    most = 2 * samples + _MORE_ACTIVE
    return Front(
        np.zeros((most, 4), dtype=np.int64), np.zeros((most, WIDEST), dtype=np.int64), np.zeros((most, WIDEST)),
        np.zeros(most, dtype=np.int64), np.zeros(most), np.empty((most, most)), np.empty((most, most)),
        np.zeros(most, dtype=np.int64), np.zeros(most),
    )  # fmt: skip


@numba.njit(cache=True, error_model="numpy")
def solve_table(
    given: Givens, contacts: Flags, polygons: Index, worth: float, warm: Index
) -> tuple[int, float, System, Array, Index, int]:
    """Return what became of a program, its cost, its points, the rows that press at the end, and how many steps.

    Args:
        given: of the problem.
        contacts: shape (N, 4).
        polygons: of every footstep.
        worth: from which cost on a plan is of no interest.
        warm: names of the inequalities to start from, shape (n, 4).
    """
    system, front = system_of(given, contacts), _empty(len(contacts))
    points, right = system.free_m.copy(), np.zeros_like(system.free_m)
    active = _begun(given, system, polygons, front, warm, right)
    changes, most = 0, len(front.press) - 1
    while changes < _MORE_CHANGES * most and 0 <= active < most:
        _place(system, front, active, points)
        value = system.constant + (points * system.linear).sum() / 2 + (front.press * front.limits)[:active].sum() / 2
        if value >= worth:
            return COSTLY, value, system, points, front.names[:active].copy(), changes
        lack, name = worst_row(given, system, polygons, points)
        if lack < _KEPT_M:
            return SOLVED, value, system, points, front.names[:active].copy(), changes
        if not _written(given, system, polygons, front, active, name, right):
            return COSTLY, np.inf, system, points, front.names[:active].copy(), changes
        active, steps = _pressed(front, active, lack)
        changes += steps
    return COSTLY if active == KEPT_BY_NONE else GIVEN_UP, np.inf, system, points, front.names[:0].copy(), changes


@numba.njit(cache=True, error_model="numpy")
def _begun(given: Givens, system: System, polygons: Index, front: Front, warm: Index, right: Array) -> int:
    """Make all equations active, and of other rows those that press together; return how many."""
    active, samples = 0, len(given.turns)
    name = np.zeros(4, dtype=np.int64)
    for place in range(3 * samples + len(polygons)):
        axis, sample = place // samples, place % samples
        if axis < 3 and (sample == 0 or system.carried[sample] > 0):
            continue
        if axis < 3:
            name[:] = (FLIGHT, sample, axis, 0)
        else:
            name[:] = (PLANE, place - 3 * samples, 0, 0)
        if active == len(front.press) - 1:
            return TOO_MANY
        if not _written(given, system, polygons, front, active, name, right) or not _extended(front, active):
            return KEPT_BY_NONE
        active += 1
    for number in range(len(warm)):
        if active < len(front.press) - 1 and _written(given, system, polygons, front, active, warm[number], right):
            active += int(_extended(front, active))
    while True:
        _press(system, front, active)
        kept = _kept(front, active)
        if kept == active:
            return active
        active = kept


@numba.njit(cache=True, error_model="numpy")
def _press(system: System, front: Front, active: int) -> None:
    """Write the multipliers at which all active rows hold exactly."""
    for row in range(active):
        front.press[row] = front.limits[row]
        for entry in range(front.counts[row]):
            at = front.at[row, entry]
            front.press[row] -= front.factor[row, entry] * system.free_m[at // 3, at % 3]
    _solved(front, active, front.press)


@numba.njit(cache=True, error_model="numpy")
def _kept(front: Front, active: int) -> int:
    """Leave out all inequalities that do not press; return how many rows are left."""
    left, order = 0, np.zeros(active, dtype=np.int64)
    for row in range(active):
        if front.names[row, 0] < EQUATIONS or front.press[row] > 0:
            order[left] = row
            left += 1
    begin = 0
    while begin < left and order[begin] == begin:
        begin += 1
    for row in range(begin, left):
        _move(front, order[row], row)
        for column in range(row + 1):
            front.gram[row, column] = front.gram[order[row], order[column]]
    for row in range(begin, left):
        _extended(front, row)
    return left


@numba.njit(cache=True, error_model="numpy")
def _move(front: Front, source: int, row: int) -> None:
    front.names[row], front.at[row], front.factor[row] = front.names[source], front.at[source], front.factor[source]
    front.counts[row], front.limits[row] = front.counts[source], front.limits[source]
    front.press[row] = front.press[source]


@numba.njit(cache=True, error_model="numpy")
def _written(given: Givens, system: System, polygons: Index, front: Front, row: int, name: Index, right: Array) -> bool:
    """Write a row behind the active ones, and how it answers to these; return whether it has any entries."""
    front.names[row] = name
    at, factor = front.at[row], front.factor[row]
    count, front.limits[row] = write_row(given, system, polygons, name, at, factor)
    front.counts[row], front.press[row] = count, 0.0
    right[:] = 0.0
    for entry in range(count):
        right[at[entry] // 3, at[entry] % 3] += factor[entry]
    for entry in range(count):
        point, axis, block = at[entry] // 3, at[entry] % 3, 0
        while system.begins[block + 1] <= point:
            block += 1
        again = False
        for before in range(entry):
            again |= at[before] % 3 == axis and system.begins[block] <= at[before] // 3 < system.begins[block + 1]
        if not again:
            begin, end = system.begins[block], system.begins[block + 1]
            solved(system.pivots, system.near, system.far, right, axis, begin, end)
    for other in range(row + 1):
        value = 0.0
        for entry in range(front.counts[other]):
            there = front.at[other, entry]
            value += front.factor[other, entry] * right[there // 3, there % 3]
        front.gram[row, other] = value
    return count > 0


@numba.njit(cache=True, error_model="numpy")
def _extended(front: Front, row: int) -> bool:
    """Write one more row of the Cholesky factor; return whether it depends on none of those before."""
    gram, lower, begin = front.gram, front.lower, 0
    while begin < row and gram[row, begin] == 0.0:
        begin += 1
    front.first[row] = begin
    rest = gram[row, row]
    for column in range(begin, row):
        value = gram[row, column]
        for inner in range(max(begin, front.first[column]), column):
            value -= lower[row, inner] * lower[column, inner]
        value /= lower[column, column]
        lower[row, column] = value
        rest -= value * value
    lower[row, row] = np.sqrt(max(rest, 0.0))
    return bool(rest > _LEAST_PIVOT * gram[row, row])


@numba.njit(cache=True, error_model="numpy")
def _solved(front: Front, active: int, right: Array) -> None:
    """Solve with the Cholesky factor, in place."""
    lower, first = front.lower, front.first
    for row in range(active):
        value = right[row]
        for column in range(first[row], row):
            value -= lower[row, column] * right[column]
        right[row] = value / lower[row, row]
    for row in range(active - 1, -1, -1):
        right[row] /= lower[row, row]
        for column in range(first[row], row):
            right[column] -= lower[row, column] * right[row]


@numba.njit(cache=True, error_model="numpy")
def _pressed(front: Front, active: int, lack: float) -> tuple[int, int]:
    """Press along the row behind the active ones until it holds, and make it active.

    Return how many rows are active now, ``KEPT_BY_NONE`` where no motion keeps all of them, and how many steps it took.
    """
    steps = 0
    push = np.zeros(active + 1)
    while True:
        steps += 1
        push[:active] = front.gram[active, :active]
        _solved(front, active, push)
        curve = front.gram[active, active] - (front.gram[active, :active] * push[:active]).sum()
        dependent = curve <= _LEAST_PIVOT * front.gram[active, active]
        full, most, drop = np.inf if dependent else lack / curve, np.inf, -1
        for row in range(active):
            if push[row] > 0 and front.names[row, 0] >= EQUATIONS and front.press[row] / push[row] < most:
                most, drop = front.press[row] / push[row], row
        length = min(full, most)
        if length == np.inf:
            return KEPT_BY_NONE, steps
        front.press[:active] -= length * push[:active]
        front.press[active] += length
        if not dependent:
            lack -= length * curve
        if full <= most:
            _extended(front, active)
            return active + 1, steps
        _leave_out(front, active, drop)
        active -= 1


@numba.njit(cache=True, error_model="numpy")
def _leave_out(front: Front, active: int, drop: int) -> None:
    """Leave out an active row; the one behind all of them moves up too."""
    for row in range(drop, active):
        _move(front, row + 1, row)
        for column in range(row + 1):
            front.gram[row, column] = front.gram[row + 1, column + int(column >= drop)]
    for row in range(drop, active - 1):
        _extended(front, row)


@numba.njit(cache=True, error_model="numpy")
def _place(system: System, front: Front, active: int, points: Array) -> None:
    """Write the points of least cost when the rows press so much."""
    points[:] = -system.linear
    for row in range(active):
        for entry in range(front.counts[row]):
            at = front.at[row, entry]
            points[at // 3, at % 3] += front.factor[row, entry] * front.press[row]
    for axis in range(3):
        solved(system.pivots, system.near, system.far, points, axis, 0, len(points))

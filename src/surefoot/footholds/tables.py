"""Plans of contact tables with given polygons, each found from the rows that are active in a plan nearby."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from surefoot.footholds.active import SOLVED, solve_table
from surefoot.footholds.banded import Flags, givens_of, points_of
from surefoot.footholds.cells import Cells, cell_count, cell_samples
from surefoot.footholds.model import Choice
from surefoot.footholds.problem import Problem
from surefoot.footholds.rows import Array, Index
from surefoot.footholds.table_rows import CLEAR, FORCE, REACH, SIDE

_NOTHING: Index = np.zeros((0, 4), dtype=np.int64)


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """A plan.

    Attributes:
        cells: its contact table.
        choice: its polygons.
        value: its cost, without that of the orientation.
        feet: positions, shape (N, 4, 3).
        active: names of the rows that press, shape (n, 4); None where they are not known.
    """

    cells: Cells
    choice: Choice
    value: float
    feet: Array
    active: Index | None = None


class Tables:
    """Tries contact tables of one problem.

    Args:
        problem: its gait is free; collision, moment balance and support are not looked at.
    """

    def __init__(self, problem: Problem) -> None:
        self.given, self.per = givens_of(problem), cell_samples(problem)

    def tried(self, cells: Cells, choice: Choice, worth: float, near: Trial | None = None) -> Trial | None:
        """Return the plan of a contact table with given polygons, or None when it costs as much as ``worth``."""
        contacts, polygons = contacts_of(cells, self.per), _polygons(choice)
        warm = _NOTHING
        if near is not None and near.active is not None:
            before = contacts_of(near.cells, self.per)
            warm = renamed(near.active, before, _polygons(near.choice), contacts, polygons)
        became, value, system, points, active, _ = solve_table(self.given, contacts, polygons, worth, warm)
        if became != SOLVED or not value < worth:
            return None
        feet = np.where(system.points[..., None] >= 0, points[system.points], self.given.start_m)
        return Trial(cells, choice, float(value), feet, active)

    def nearest(self, cells: Cells) -> Choice:
        """Return the polygons nearest to where the feet of a contact table are expected half-way through a stance."""
        found, steps, last = [], points_of(contacts_of(cells, self.per))[3], len(cells) * self.per - 1
        for number, (foot, _, touch) in enumerate(steps):
            leave = steps[number + 1, 1] if number + 1 < len(steps) and steps[number + 1, 0] == foot else last
            point = self.given.feet_m[(touch + leave) // 2, foot]
            beside = np.maximum((self.given.planes @ point - self.given.bounds).max(axis=1), 0.0)
            above = self.given.normals @ point - self.given.offsets
            found.append((int(np.argmin(beside**2 + above**2)),))
        return tuple(found)

    def near(self, plan: Trial, number: int, reach_m: float) -> list[int]:
        """Return the polygons none of whose sides is farther than that from a foothold of a plan."""
        foot, _, touch = points_of(contacts_of(plan.cells, self.per))[3][number]
        past = (self.given.planes @ plan.feet[touch, foot] - self.given.bounds).max(axis=1)
        return [int(one) for one in np.flatnonzero(past < reach_m)]


def warm_up(problem: Problem) -> None:
    """Load what is compiled, so that loading does not count as solving."""
    tables, stand = Tables(problem), np.ones((cell_count(problem), 4), dtype=np.bool_)
    standing = Trial(stand, (), 0.0, np.zeros((problem.samples, 4, 3)), _NOTHING)
    tables.tried(stand, polygons_after(problem, standing, stand), 0.0, standing)


def contacts_of(cells: Cells, per: int) -> Flags:
    """Return which feet are in contact at which sample."""
    return np.repeat(cells, per, axis=0)


def _polygons(choice: Choice) -> Index:
    return np.array([left[0] for left in choice], dtype=np.int64)


def polygons_after(problem: Problem, before: Trial, cells: Cells) -> Choice:
    """Return polygons for the footsteps of a contact table: those on which each foot stood about then."""
    per = cell_samples(problem)
    chosen = followed(
        contacts_of(before.cells, per), _polygons(before.choice), np.array(problem.start_polygons, dtype=np.int64),
        contacts_of(cells, per),
    )  # fmt: skip
    return tuple((int(one),) for one in chosen)


@numba.njit(cache=True, error_model="numpy")
def followed(before: Flags, polygons: Index, grounds: Index, contacts: Flags) -> Index:
    """Return polygons for the footsteps of a contact table, given those of another and of the start."""
    supports = points_of(before)[2]
    steps = points_of(contacts)[3]
    found = np.zeros(len(steps), dtype=np.int64)
    for number in range(len(steps)):
        foot, _, touch = steps[number]
        leave = len(contacts)
        if number + 1 < len(steps) and steps[number + 1, 0] == foot:
            leave = steps[number + 1, 1]
        middle, nearest = (touch + leave) // 2, 4 * len(contacts)
        for sample in range(len(before)):
            if supports[sample, foot] > -2 and abs(sample - middle) < nearest:
                nearest = abs(sample - middle)
                support = supports[sample, foot]
                found[number] = grounds[foot] if support < 0 else polygons[support]
    return found


@numba.njit(cache=True, error_model="numpy")
def renamed(names: Index, before: Flags, polygons_before: Index, contacts: Flags, polygons: Index) -> Index:
    """Return the names that rows of a program have in another one, as far as they are there (see ``table_rows``)."""
    old, new = points_of(before)[3], points_of(contacts)[3]
    match = np.full(len(old), -1, dtype=np.int64)
    for number in range(len(old)):
        nearest = len(contacts)
        for other in range(len(new)):
            off = abs(new[other, 2] - old[number, 2]) + abs(new[other, 1] - old[number, 1])
            if new[other, 0] == old[number, 0] and off < nearest:
                nearest, match[number] = off, other
    found, count = np.zeros_like(names), 0
    for row in range(len(names)):
        kind, one, two, three = names[row]
        found[count] = names[row]
        if kind == REACH or (kind == FORCE and contacts[one, two]):
            count += 1
        elif kind == CLEAR and match[one] >= 0:
            (_, lift, touch), (_, to_lift, to_touch) = old[one], new[match[one]]
            quarter = (to_touch - to_lift) // 4
            part = (two - lift) / (touch - lift)
            sample = to_lift + round(part * (to_touch - to_lift))
            sample = min(max(sample, to_lift + quarter), to_touch - quarter - 1)
            found[count] = (kind, match[one], sample, three)
            count += 1
        elif kind == SIDE and match[one] >= 0 and polygons[match[one]] == polygons_before[one]:
            found[count, 1] = match[one]
            count += 1
    return found[:count].copy()

"""Checks what only plans of a free gait claim: that the gait fits its cells, and that nothing at all is possible.

The refutation is of a relaxation, transcribed here from docs/footholds.md: multipliers of its rows whose sum is
positive for every base position, force and binary within their ranges, which no motion could make it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from surefoot.verify.footholds.file import Array, FootholdFile
from surefoot.verify.footholds.rows import jacobians, nominal, references, surfaces
from surefoot.verify.footholds.weighing import Tally, place_in, rounded

_WHOLE = 1e-3
_NEAR_M = 1e-6
_MOST_LEAVES = 2000


def cells_problem(plan: FootholdFile) -> str:
    """Return what is wrong with the gait of a plan as a contact table; empty when nothing is."""
    per = _per_cell(plan)
    if len(plan.contacts) % per:
        return "the horizon is no multiple of the cell"
    table = plan.contacts.reshape(-1, per, 4)
    if (table != table[:, :1]).any():
        return "a foot is lifted or set down within a cell"
    cells = table[:, 0]
    if not (cells[0].all() and cells[-1].all()):
        return "a foot is in the air at an end"
    dwell = int(plan.values["options"]["min_dwell_cells"])
    for foot in range(4):
        changes = np.flatnonzero(cells[1:, foot] != cells[:-1, foot])
        if (np.diff(changes) < dwell).any():
            return f"a stance or swing is shorter than {dwell} cells"
    return ""


def goal_without_ground(plan: FootholdFile) -> bool:
    """Return whether some foot has no ground within reach of the goal pose, in which all feet stand at the end."""
    robot, turn = plan.values["robot"], references(plan)[2][-1]
    goal = np.array(plan.values["goal"]["position_m"], dtype=float)
    span = np.array(robot["foot_reach_m"], dtype=float) + _NEAR_M
    start = np.array(plan.values["start"]["feet_m"], dtype=float)
    for foot, arm in enumerate(nominal(plan)):
        places = [*(one.corners for one in surfaces(plan)), start[foot, None]]
        seen = [(corners - goal) @ turn - arm for corners in places]
        if not any(((one.min(axis=0) <= span) & (one.max(axis=0) >= -span)).all() for one in seen):
            return True
    return False


def _per_cell(plan: FootholdFile) -> int:
    ratio = plan.number("options", "cell_s") / plan.number("step_s")
    if ratio < 0.5 or abs(ratio - round(ratio)) > _WHOLE:
        raise ValueError("cell_s")
    return round(ratio)


def refutation_problem(plan: FootholdFile, leaves: Any) -> str:
    """Return what is wrong with a refutation; empty when it proves that no gait has a plan."""
    if not isinstance(leaves, list) or not 0 < len(leaves) <= _MOST_LEAVES:
        return "there is no refutation"
    relaxed = Relaxation(plan)
    for number, leaf in enumerate(leaves):
        least = relaxed.least(leaf)
        if not least > 0:
            return f"leaf {number} proves nothing ({least:.3g})"
    count = relaxed.cells * (1 + len(relaxed.ground))
    return "" if _cover([_pins(leaf, count) for leaf in leaves]) else "the leaves leave something out"


def _cover(pins: list[dict[int, int]]) -> bool:
    """Return whether every assignment of the binaries agrees with one of the pins."""
    pending = [pins]
    while pending:
        here = pending.pop()
        if any(not one for one in here):
            continue
        if not here:
            return False
        place = min(here[0])
        for value in (0, 1):
            kept = [one for one in here if one.get(place, value) == value]
            pending.append([{k: v for k, v in one.items() if k != place} for one in kept])
    return True


class Relaxation:
    """The relaxation's ranges and rows; unknowns are base r, force F, and the binaries "carried" and "near".

    Args:
        plan: whose values are used.
    """

    def __init__(self, plan: FootholdFile) -> None:
        values, robot = plan.values, plan.values["robot"]
        self.size, self.per = len(plan.contacts), _per_cell(plan)
        self.cells = self.size // self.per
        self.ground = surfaces(plan)
        self.mass, self.step_s, self.pull = float(robot["mass_kg"]), plan.number("step_s"), plan.number("gravity_mps2")
        turns = references(plan)[2]
        arms = np.einsum("iab,jb->ija", turns, nominal(plan))
        half = (np.abs(turns) @ np.array(robot["foot_reach_m"], dtype=float))[:, None]
        self.away, self.close = (arms + half).max(axis=1), (arms - half).min(axis=1)
        corners = np.concatenate([one.corners for one in self.ground])
        self.start = np.array(values["start"]["position_m"], dtype=float)
        self.goal = np.array(values["goal"]["position_m"], dtype=float)
        ends = np.stack([self.start, self.goal])
        self.low = np.minimum(corners.min(axis=0) - self.away.max(axis=0), ends.min(axis=0))
        self.high = np.maximum(corners.max(axis=0) - self.close.min(axis=0), ends.max(axis=0))
        self.high[2] += self.pull * (self.size * self.step_s) ** 2 / 8
        torque = np.array(robot["torque_max_nm"], dtype=float)
        self.limit = np.repeat(sum(np.abs(np.linalg.inv(arm)).T @ torque for arm in jacobians(plan)), 2)

    def least(self, leaf: Any) -> float:
        """Return the least that the weighted rows add up to, over the ranges of all unknowns; positive: a proof."""
        base, force = Tally((self.size, 3)), Tally((self.size, 3))
        carried, near, shift = Tally(self.cells), Tally((self.cells, len(self.ground))), Tally(1)
        for *place, m in leaf["newton"]:
            i, a = place_in(place, self.size, 3)
            if i == 0:
                raise ValueError("newton")
            factor = m * self.mass / self.step_s**2
            base.add((i, a), factor)
            base.add((i - 1, a), -factor * (2 if i > 1 else 1))
            if i > 1:
                base.add((i - 2, a), factor)
            force.add((i, a), -m)
            shift.add(0, m * self.mass * self.pull * (a == 2))
        for *place, m in leaf["limit"]:
            i, way = place_in(place, self.size, 6)
            if m > 0:
                force.add((i, way // 2), m * (-1 if way % 2 else 1))
                carried.add(i // self.per, -m * self.limit[way])
        for *place, m in leaf["cover"]:
            (cell,) = place_in(place, self.cells)
            if m > 0:
                carried.add(cell, m)
                near.add(cell, -m)
        for *place, m in leaf["near"]:
            i, a, r, side = place_in(place, self.size, 3, len(self.ground), 2)
            if (m > 0) == (side == 0):
                slack, limit = self._near(i, a, r, side)
                base.add((i, a), m)
                near.add((i // self.per, r), m * slack)
                shift.add(0, -m * limit)
        for i, *vector in leaf["cone"]:
            force.add(place_in([i], self.size)[0], np.array(vector, dtype=float))
            shift.add(0, -self._beyond(np.array(vector, dtype=float)))
        least, size = self._ranges(leaf, base, force, carried, near)
        return float(shift.sum[0]) + least - rounded(float(shift.size[0]) + size)

    def _near(self, i: int, a: int, r: int, side: int) -> tuple[float, float]:
        """Return by how much a row of "near" gives with 0, and its limit then."""
        corners = self.ground[r].corners[:, a]
        if side == 0:
            bound = float(corners.max() - self.close[i, a])
            slack = max(self.high[a] - bound, 0.0)
            return slack, bound + slack
        bound = float(corners.min() - self.away[i, a])
        slack = max(bound - self.low[a], 0.0)
        return -slack, bound - slack

    def _beyond(self, vector: Array) -> float:
        """Return how much a vector that should be at most 0 on all pyramids may still add up to."""
        rays = np.concatenate([one.rays() for one in self.ground])
        return max(float((rays @ vector).max()), 0.0) * 4 * float(np.linalg.norm(self.limit))

    def _ranges(self, leaf: Any, base: Tally, force: Tally, carried: Tally, near: Tally) -> tuple[float, float]:
        """Return the least that sums add up to over the ranges of the unknowns, and how large their terms are."""
        low, high = np.tile(self.low, (self.size, 1)), np.tile(self.high, (self.size, 1))
        low[0] = high[0] = self.start
        low[-2:] = high[-2:] = self.goal
        factors = np.concatenate([carried.sum, near.sum.ravel()])
        floor, ceiling = np.zeros(len(factors)), np.ones(len(factors))
        floor[[0, self.cells - 1]] = 1.0
        for place, value in _pins(leaf, len(factors)).items():
            floor[place] = ceiling[place] = value
        least, size = 0.0, float(carried.size.sum() + near.size.sum())
        for tally, lower, upper in ((base, low, high), (force, -self.limit[1::2], self.limit[::2])):
            least += float(np.minimum(tally.sum * lower, tally.sum * upper).sum())
            size += float((tally.size * np.maximum(np.abs(lower), np.abs(upper))).sum())
        return least + float(np.minimum(factors * floor, factors * ceiling).sum()), size


def _pins(leaf: Any, count: int) -> dict[int, int]:
    """Return which binaries a leaf sets, and to what."""
    return dict(place_in(one, count, 2) for one in leaf["pinned"])  # type: ignore[misc]

"""Checks what only plans of a free gait claim: that the gait fits its cells, and that nothing at all is possible.

The refutation is of a relaxation, transcribed here from docs/footholds.md: multipliers of its rows whose sum is
positive for every base position, force and binary within their ranges, which no motion could make it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from surefoot.verify.footholds.file import Array, FootholdFile
from surefoot.verify.footholds.rows import jacobians, nominal, references, surfaces

_WHOLE = 1e-3
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
    pins = [{int(place): int(value) for place, value in leaf["pinned"]} for leaf in leaves]
    return "" if _cover(pins) else "the leaves leave something out"


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
        base, force = np.zeros((self.size, 3)), np.zeros((self.size, 3))
        carried, near = np.zeros(self.cells), np.zeros((self.cells, len(self.ground)))
        shift = 0.0
        for i, a, m in leaf["newton"]:
            if not 1 <= i < self.size:
                raise ValueError("newton")
            factor = m * self.mass / self.step_s**2
            base[i, a] += factor
            base[i - 1, a] -= factor * (2 if i > 1 else 1)
            if i > 1:
                base[i - 2, a] += factor
            force[i, a] -= m
            shift += m * self.mass * self.pull * (a == 2)
        for i, way, m in leaf["limit"]:
            if m > 0:
                force[i, way // 2] += m * (-1 if way % 2 else 1)
                carried[i // self.per] -= m * self.limit[way]
        for cell, m in leaf["cover"]:
            if m > 0:
                carried[cell] += m
                near[cell] -= m
        for i, a, r, side, m in leaf["near"]:
            shift += self._near(int(i), int(a), int(r), int(side), float(m), base, near)
        for i, *vector in leaf["cone"]:
            force[i] += vector
            shift -= self._beyond(np.array(vector, dtype=float))
        return float(shift + self._ranges(leaf, base, force, carried, near))

    def _near(self, i: int, a: int, r: int, side: int, m: float, base: Array, near: Array) -> float:
        corners = self.ground[r].corners[:, a]
        if (m > 0) == (side == 1):
            return 0.0
        if side == 0:
            bound = float(corners.max() - self.close[i, a])
            slack = max(self.high[a] - bound, 0.0)
            limit = bound + slack
        else:
            bound = float(corners.min() - self.away[i, a])
            slack = max(bound - self.low[a], 0.0)
            limit = bound - slack
        base[i, a] += m
        near[i // self.per, r] += m * slack * (1 if side == 0 else -1)
        return float(-m * limit)

    def _beyond(self, vector: Array) -> float:
        """Return how much a vector that should be at most 0 on all pyramids may still add up to."""
        rays = np.concatenate([one.rays() for one in self.ground])
        worst = max(float((rays @ vector / np.linalg.norm(rays, axis=1)).max()), 0.0)
        return worst * 4 * float(np.linalg.norm(self.limit))

    def _ranges(self, leaf: Any, base: Array, force: Array, carried: Array, near: Array) -> float:
        low, high = np.tile(self.low, (self.size, 1)), np.tile(self.high, (self.size, 1))
        low[0] = high[0] = self.start
        low[-2:] = high[-2:] = self.goal
        least = float(np.minimum(base * low, base * high).sum())
        least += float(np.minimum(force * self.limit[::2], -force * self.limit[1::2]).sum())
        factors = np.concatenate([carried, near.ravel()])
        floor, ceiling = np.zeros(len(factors)), np.ones(len(factors))
        floor[[0, self.cells - 1]] = 1.0
        for place, value in leaf["pinned"]:
            floor[int(place)] = ceiling[int(place)] = float(value)
        return least + float(np.minimum(factors * floor, factors * ceiling).sum())

"""Derives the bound over all gaits from the multipliers of a plan file (docs/formats.md 6).

Any multipliers are sound. With them the base is one linear system, and each foot by itself takes its cheapest pattern:
a shortest path over cells and nodes of grids on the polygons (``footholds_steps``).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from surefoot.verify.footholds_file import Array, FootholdFile
from surefoot.verify.footholds_grid import Grid, grid_of
from surefoot.verify.footholds_rows import nominal, references, surfaces
from surefoot.verify.footholds_steps import Steps, cheapest

_SPACINGS_M = (0.08, 0.055, 0.04)
_MOST_WORK = 6e8
_ENOUGH, _FAR = 1e-7, 0.01


def gait_bound(plan: FootholdFile, kept: Any, claimed: float) -> float:
    """Return what the multipliers prove, with grids as fine as the claim needs and time allows."""
    prices = _Prices(plan, kept)
    rest = prices.base() - prices.ties() + prices.turning(kept.get("turning", []))
    found = -np.inf
    for spacing_m in _SPACINGS_M:
        grids = [grid_of(prices.ground, prices.feet[:, j], prices.start[j], spacing_m) for j in range(4)]
        work = sum(len(grid.points) ** 2 for grid in grids) * prices.cells**2 / 2
        if work > _MOST_WORK and np.isfinite(found):
            break
        found = max(found, rest + sum(prices.foot(j, grid) for j, grid in enumerate(grids)))
        if claimed <= found + _ENOUGH * abs(found) or claimed > found + _FAR * abs(found):
            break
    return float(found)


class _Prices:
    """Multipliers on Eq. (16), shape (N, 4, 3) in the axes of the base, and y on the force, shape (N, 3)."""

    def __init__(self, plan: FootholdFile, kept: dict[str, Any]) -> None:
        values = plan.values
        self.plan, self.weights = plan, {name: float(w) for name, w in values["weights"].items()}
        self.size, self.step_s = len(plan.contacts), plan.number("step_s")
        self.per = round(plan.number("options", "cell_s") / self.step_s)
        self.cells = self.size // self.per
        self.reference, _, self.turns = references(plan)
        self.feet = self.reference[:, None] + np.einsum("iab,jb->ija", self.turns, nominal(plan))
        self.start = np.array(values["start"]["feet_m"], dtype=float)
        self.ground = surfaces(plan)
        self.reach = np.zeros((self.size, 4, 3))
        for i, j, a, _, m in kept["reach"]:
            self.reach[int(i), int(j), int(a)] += float(m)
        self.pull = np.array(kept["pull"], dtype=float)
        if self.pull.shape != (self.size, 3) or not (np.isfinite(self.pull).all() and np.isfinite(self.reach).all()):
            raise ValueError("pull")
        self.world = np.einsum("iab,ijb->ija", self.turns, self.reach)

    def ties(self) -> float:
        """Return what the bounds of Eq. (16) take away."""
        span = np.array(self.plan.values["robot"]["foot_reach_m"], dtype=float)
        return float((self.reach * nominal(self.plan)).sum() + (np.abs(self.reach) * span).sum())

    def base(self) -> float:
        """Return the least that the base can cost, its force being rewarded by 2 y."""
        w, mass = self.weights, float(self.plan.values["robot"]["mass_kg"])
        start, goal = (np.array(self.plan.values[end]["position_m"], dtype=float) for end in ("start", "goal"))
        up = np.array([0.0, 0.0, self.plan.number("gravity_mps2")])
        ends = np.zeros((self.size, 3))
        ends[0], ends[-2:] = start, goal
        second = _second(self.size, self.step_s)
        square = 2 * w["position"] * np.eye(self.size) + 2 * w["acceleration"] * second.T @ second
        linear = 2 * mass * second.T @ self.pull - 2 * w["position"] * self.reference - self.world.sum(axis=1)
        value = _least(square, linear, ends)
        value += w["position"] * float((self.reference**2).sum()) + 2 * mass * float((self.pull @ up).sum())
        return value - mass**2 * float((self.pull[0] ** 2).sum()) / w["acceleration"]

    def turning(self, multipliers: Any) -> float:
        """Return the least cost of the angles, where they are coupled to nothing else."""
        values, angles = self.plan.values, references(self.plan)[1]
        if values["options"]["moment_balance"]:
            return 0.0
        ends = np.zeros((self.size, 3))
        ends[0] = np.array(values["start"]["rpy_rad"], dtype=float)
        ends[-2:] = np.array(values["goal"]["rpy_rad"], dtype=float)
        second = _second(self.size, self.step_s)
        inertia, limit = np.array(values["robot"]["inertia_kgm2"]), float(values["robot"]["base_torque_max_nm"])
        pressed = np.zeros((self.size, 3))
        for i, a, m in multipliers:
            pressed[int(i), int(a)] += float(m)
        w, wa = self.weights["orientation"], self.weights["angular_acceleration"]
        linear = second.T @ (pressed * inertia) - 2 * w * angles
        value = _least(2 * w * np.eye(self.size) + 2 * wa * second.T @ second, linear, ends)
        return value + w * float((angles**2).sum()) - limit * float(np.abs(pressed).sum())

    def foot(self, foot: int, grid: Grid) -> float:
        """Return the least that a foot can cost by itself."""
        weights = self.weights
        reward = (self.pull**2).sum(axis=1) / weights["force"]
        steps = Steps(
            linear=self.world[:, foot] - 2 * weights["foot"] * self.feet[:, foot],
            constant=weights["foot"] * (self.feet[:, foot] ** 2).sum(axis=1),
            reward=reward,
            track=weights["foot"],
            accelerate=weights["foot_acceleration"],
            step_s=self.step_s,
            per=self.per,
            dwell=int(self.plan.values["options"]["min_dwell_cells"]),
            clearance_m=self.plan.number("options", "clearance_m"),
        )
        return cheapest(steps, grid)


def _second(size: int, step_s: float) -> Array:
    """Return second differences of what is at rest at sample 0; row 0 is empty."""
    matrix = np.eye(size) - 2 * np.eye(size, k=-1) + np.eye(size, k=-2)
    matrix[0] = 0.0
    matrix[1, 0] = -1.0
    return np.asarray(matrix / step_s**2, dtype=np.float64)


def _least(square: Array, linear: Array, ends: Array) -> float:
    """Return the least of x' square x / 2 + linear . x with samples 0, N-2 and N-1 as given."""
    found, inner = ends.copy(), slice(1, -2)
    rest = linear + square @ ends
    found[inner] = -np.linalg.solve(square[inner, inner], rest[inner])
    return float((found * (square @ found)).sum() / 2 + (linear * found).sum())

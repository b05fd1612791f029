"""Derives the bound over all gaits from the multipliers of a plan file (docs/formats.md 6).

Any multipliers are sound. With them the base is one linear system, and each foot by itself takes its cheapest pattern:
a shortest path over cells and nodes of grids on the polygons (``footholds_steps``). A file may hold a tree: what the
first multipliers prove keeps the base of all plans that cost less than some worth within a tube, cuts part the paths of
the base, and every part has multipliers that need to hold for a base in this part of the tube only.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from surefoot.verify.footholds.cone import leans, pressed_into
from surefoot.verify.footholds.file import Array, FootholdFile
from surefoot.verify.footholds.grid import Grid, grid_of
from surefoot.verify.footholds.rows import nominal, references, surfaces
from surefoot.verify.footholds.steps import Steps, cheapest
from surefoot.verify.footholds.tube import Span, ends_of, leaves_of, tube_of
from surefoot.verify.footholds.weighing import place_in, rounded

_SPACINGS_M = ((0.08, 0.08), (0.055, 0.055), (0.025, 0.055), (0.0125, 0.055), (0.0125, 0.04))
_MOST_WORK = 8e8
_ENOUGH, _FAR = 1e-7, 0.5
_FEET = np.arange(5)


def gait_bound(plan: FootholdFile, kept: Any, claimed: float) -> float:
    """Return what the multipliers prove, with grids as fine as the claim needs and time allows."""
    first = _Prices(plan, kept["first"])
    turned = first.turning(kept.get("turning", []))
    span = ends_of(first.known())
    if kept["tree"] is None:
        return turned + _proved(first, span, claimed - turned)
    worth, leaves = float(kept["worth"]), leaves_of(kept["tree"], first.size)
    slack = worth - _proved(first, span, np.inf, _SPACINGS_M[:2])
    found = worth
    for cuts, prices in leaves:
        part = tube_of(first.base()[1], first.base()[2], slack, cuts)
        if part is not None:
            found = min(found, _proved(_Prices(plan, prices, cuts), part, claimed - turned))
        if turned + found < claimed * (1 - _ENOUGH):
            break
    return turned + found


def _proved(
    prices: _Prices, span: Span, claimed: float, spacings_m: tuple[tuple[float, float], ...] = _SPACINGS_M
) -> float:
    """Return what multipliers prove while the base stays between two paths, on finer grids until that is enough."""
    found = -np.inf
    for spacing_m in spacings_m:
        grids = [grid_of(prices.ground, prices.feet[:, j], prices.start[j], spacing_m) for j in range(4)]
        work = sum(len(grid.points) ** 2 for grid in grids) * prices.cells**2 / 2
        if work > _MOST_WORK and np.isfinite(found):
            break
        found = max(found, prices.proved(grids, span))
        if claimed <= found or claimed > found + _FAR * abs(found):
            break
    return float(found)


class _Prices:
    """Multipliers.

    On Eq. (16), shape (N, 4, 3) in the axes of the base; y on the force, shape (N, 3); on contact by cell, shape (M,);
    the share of the base's acceleration that is paid with the force; and on the bounds that cuts set the base.
    """

    def __init__(self, plan: FootholdFile, kept: dict[str, Any], cuts: Span | None = None) -> None:
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
            self.reach[place_in((i, j, a), self.size, 4, 3)] += float(m)
        self.pull, self.contact = np.array(kept["pull"], dtype=float), np.array(kept["contact"], dtype=float)
        if self.pull.shape != (self.size, 3) or not (np.isfinite(self.pull).all() and np.isfinite(self.reach).all()):
            raise ValueError("pull")
        if self.contact.shape != (self.cells,) or not np.isfinite(self.contact).all():
            raise ValueError("contact")
        self.split = float(kept["split"])
        if not 0 <= self.split < 1:
            raise ValueError("split")
        self.world = np.einsum("iab,ijb->ija", self.turns, self.reach)
        self.leans = leans(self.ground)
        self.walls, self.beyond = np.zeros((self.size, 3)), 0.0
        for *place, m in kept.get("walls", []):
            at = place_in(place, self.size, 3)
            bound = np.nan if cuts is None else float(cuts[int(m > 0)][at])
            if not np.isfinite(bound * m):
                raise ValueError("walls")
            self.walls[at] += m
            self.beyond += m * bound

    def proved(self, grids: list[Grid], span: Span) -> float:
        """Return what the multipliers prove while the base stays between two paths."""
        rest = self.base()[0] + self.shared() - self.ties() - rounded(self.paid())
        return rest + sum(self.foot(j, grid, span) for j, grid in enumerate(grids))

    def ties(self) -> float:
        """Return what the bounds of Eq. (16) take away."""
        span = np.array(self.plan.values["robot"]["foot_reach_m"], dtype=float)
        return float((self.reach * nominal(self.plan)).sum() + (np.abs(self.reach) * span).sum())

    def paid(self) -> float:
        """Return how large all that is paid to the base and the feet is."""
        places = np.abs(self.feet) + max(float(np.abs(one.corners).max()) for one in self.ground)
        sizes = (np.abs(self.reach).sum(axis=2) * places.sum(axis=2)).sum() + np.abs(self.walls).sum() * places.max()
        return float(8 * np.abs(self.contact).sum() + 2 * sizes + (self.pull**2).sum())

    def base(self) -> tuple[float, Array, Array]:
        """Return the least that the base can cost, its force being rewarded by 2 y; its path; second derivatives."""
        w, mass = self.weights, float(self.plan.values["robot"]["mass_kg"])
        alone, up = w["acceleration"] * (1 - self.split), self._up()
        second = _second(self.size, self.step_s)
        square = 2 * w["position"] * np.eye(self.size) + 2 * alone * second.T @ second
        linear = 2 * mass * second.T @ self.pull - 2 * w["position"] * self.reference - self.world.sum(axis=1)
        value, path = _least(square, linear + self.walls, self.known())
        value += w["position"] * float((self.reference**2).sum()) + 2 * mass * float((self.pull @ up).sum())
        value += self.size * w["acceleration"] * self.split * float(up @ up)
        return value - self.beyond - mass**2 * float((self.pull[0] ** 2).sum()) / alone, path, square

    def shared(self) -> float:
        """Return the least of what feet in contact are paid less what they save, whatever their number."""
        w, mass = self.weights, float(self.plan.values["robot"]["mass_kg"])
        share = w["acceleration"] * self.split
        drawn = pressed_into(self.pull + share * self._up() / mass, self.leans)
        squares = drawn.reshape(self.cells, self.per).sum(axis=1)
        dear = w["force"] / _FEET[1:] + share / mass**2
        saved = np.concatenate([np.zeros((self.cells, 1)), squares[:, None] / dear], axis=1)
        return float((self.contact[:, None] * _FEET - saved).min(axis=1).sum())

    def _up(self) -> Array:
        return np.array([0.0, 0.0, self.plan.number("gravity_mps2")])

    def known(self) -> Array:
        """Return where the base is at its ends, and zeros elsewhere."""
        path = np.zeros((self.size, 3))
        path[0] = np.array(self.plan.values["start"]["position_m"], dtype=float)
        path[-2:] = np.array(self.plan.values["goal"]["position_m"], dtype=float)
        return path

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
        value = _least(2 * w * np.eye(self.size) + 2 * wa * second.T @ second, linear, ends)[0]
        return value + w * float((angles**2).sum()) - limit * float(np.abs(pressed).sum())

    def foot(self, foot: int, grid: Grid, span: Span) -> float:
        """Return the least that a foot can cost by itself, with stances within reach of a base between two paths."""
        weights = self.weights
        arm = self.turns @ nominal(self.plan)[foot]
        half = np.abs(self.turns) @ np.array(self.plan.values["robot"]["foot_reach_m"], dtype=float)
        steps = Steps(
            linear=self.world[:, foot] - 2 * weights["foot"] * self.feet[:, foot],
            constant=weights["foot"] * (self.feet[:, foot] ** 2).sum(axis=1),
            reward=np.repeat(self.contact / self.per, self.per),
            track=weights["foot"],
            accelerate=weights["foot_acceleration"],
            step_s=self.step_s,
            per=self.per,
            dwell=int(self.plan.values["options"]["min_dwell_cells"]),
            clearance_m=self.plan.number("options", "clearance_m"),
            near_m=span[0] + arm - half,
            far_m=span[1] + arm + half,
        )
        return cheapest(steps, grid)


def _second(size: int, step_s: float) -> Array:
    """Return second differences of what is at rest at sample 0; row 0 is empty."""
    matrix = np.eye(size) - 2 * np.eye(size, k=-1) + np.eye(size, k=-2)
    matrix[0] = 0.0
    matrix[1, 0] = -1.0
    return np.asarray(matrix / step_s**2, dtype=np.float64)


def _least(square: Array, linear: Array, ends: Array) -> tuple[float, Array]:
    """Return the least of x' square x / 2 + linear . x with samples 0, N-2 and N-1 as given, and where it is."""
    found, inner = ends.copy(), slice(1, -2)
    rest = linear + square @ ends
    found[inner] = -np.linalg.solve(square[inner, inner], rest[inner])
    return float((found * (square @ found)).sum() / 2 + (linear * found).sum()), found

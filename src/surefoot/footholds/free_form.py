"""The exact program of a free gait, Zhou et al. 2025, Eqs. (21)-(28), as a standard form with binaries H per cell.

Every constant of its big-M rows follows from where base and feet can be at all (``reach_boxes``) and from the torque
limits. With ``options.com_support_m`` it is a relaxation: those rows depend on which feet are in contact.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from surefoot.footholds.cells import Cells, cell_count, cell_samples
from surefoot.footholds.form import StandardForm, collision_implications, padded
from surefoot.footholds.model import (
    INF,
    base_torque_rows,
    boundary_rows,
    dynamics_rows,
    integration_rows,
    moment_rows,
    reach_rows,
    tilt_rows,
    whole_cost,
    whole_motion,
)
from surefoot.footholds.problem import Problem
from surefoot.footholds.rows import Array, Index, Quantity, RowBuilder


@dataclass(frozen=True, slots=True, eq=False)
class FreeForm:
    """The program of a free gait.

    Attributes:
        form: in standard form.
        chosen: the unknowns H, shape (R, M, 4).
    """

    form: StandardForm
    chosen: Index

    def cells(self, unknowns: Array) -> Cells:
        """Return the contact table of a solution."""
        cells: Cells = unknowns[self.chosen].sum(axis=0) > 0.5
        return cells


def reach_boxes(problem: Problem) -> tuple[Array, Array]:
    """Return boxes that hold the base, shape (2, 3), and the feet, shape (2, 3), in every motion of every gait.

    In contact the base is within reach of a polygon. In flight it moves evenly to the sides and, between two such
    places, rises over the line between them by at most g T^2 / 8, T being the horizon.
    """
    points = np.concatenate([one.vertices_m for one in problem.polygons])
    half = np.einsum("iab,b->ia", np.abs(problem.rotations), np.array(problem.robot.foot_reach_m))[:, None]
    away, near = (problem.levers_m + half).max(axis=(0, 1)), (problem.levers_m - half).min(axis=(0, 1))
    ends = np.stack([problem.start_m, problem.goal_m])
    low = np.minimum(points.min(axis=0) - away, ends.min(axis=0))
    high = np.maximum(points.max(axis=0) - near, ends.max(axis=0))
    high[2] += problem.gravity_mps2 * problem.gait.horizon_s**2 / 8
    return np.stack([low, high]), np.stack([low + near, high + away])


def free_form(problem: Problem, *, clearance: bool = True) -> FreeForm:
    """Return the program; without the rows of the swing's clearance it is a smaller relaxation."""
    motion, rates = whole_motion(problem.samples)
    count, polygons = cell_count(problem), len(problem.polygons)
    windows = problem.windows() if problem.options.collision else ()
    regions = len(problem.free_regions)
    binaries = polygons * count * 4 + 4 * len(windows) * regions
    size = motion.size + binaries
    chosen = np.arange(motion.size, motion.size + polygons * count * 4).reshape(polygons, count, 4)
    build = RowBuilder(size)
    boundary_rows(build, problem, motion, rates)
    integration_rows(build, problem, motion, rates)
    dynamics_rows(build, problem, motion)
    base_torque_rows(build, problem, motion)
    reach_rows(build, problem, motion)
    moment_rows(build, problem, motion)
    tilt_rows(build, problem, motion)
    free = _Contacts(build, problem, motion.feet, Quantity.unknown(chosen))
    assert motion.force is not None
    free.pattern_rows()
    free.region_rows()
    free.contact_rows(rates.feet_velocity, motion.force)
    free.friction_rows(motion.force)
    if clearance and problem.options.clearance_m > 0:
        free.clearance_rows()
    if windows:
        first = motion.size + polygons * count * 4
        inside = Quantity.unknown(np.arange(first, size).reshape(4, len(windows), regions))
        build.add("collision", 0.0, 1.0, [(1.0, inside)])
        build.add("collision", 1.0, 1.0, [(1.0, inside[:, :, s]) for s in range(regions)])
        collision_implications(build, problem, motion.feet, inside)
    form = StandardForm(padded(whole_cost(problem), binaries), build.rows(), np.arange(motion.size, size))
    return FreeForm(form, chosen)


class _Contacts:
    """The rows that depend on who is in contact; c(m, j) = sum over r of H(r, m, j)."""

    def __init__(self, build: RowBuilder, problem: Problem, feet: Quantity, chosen: Quantity) -> None:
        self.build, self.problem, self.feet, self.chosen = build, problem, feet, chosen
        self.count, self.per = cell_count(problem), cell_samples(problem)
        self.polygons = range(len(problem.polygons))
        self.low, self.high = reach_boxes(problem)[1]

    def pattern_rows(self) -> None:
        """Write (23)-(24), stance at both ends, one polygon per stance, and the dwell."""
        chosen, count = self.chosen, self.count
        self.build.add("region", 0.0, 1.0, [(1.0, chosen)])
        self.build.add("region", 0.0, 1.0, [(1.0, chosen[r]) for r in self.polygons])
        for cell in (0, count - 1):
            self.build.add("region", 1.0, 1.0, [(1.0, chosen[r, cell]) for r in self.polygons])
        for foot, start in enumerate(self.problem.start_polygons):
            others = [r for r in self.polygons if r != start]
            if others:
                self.build.add("region", 0.0, 0.0, [(1.0, chosen[others, 0, foot])])
        for r in self.polygons:
            after = [(1.0, chosen[s, 1:]) for s in self.polygons if s != r]
            if after:
                self.build.add("region", -INF, 1.0, [(1.0, chosen[r, :-1]), *after])
        for ahead in range(1, self.problem.options.min_dwell_cells):
            for cell in range(1, count - ahead):
                change = [(s, chosen[r, m]) for r in self.polygons for s, m in ((1.0, cell), (-1.0, cell - 1))]
                held = [(-1.0, chosen[r, cell + ahead]) for r in self.polygons]
                self.build.add("region", -1.0, 0.0, [*change, *held])

    def region_rows(self) -> None:
        """Write (21)-(22) at the first sample of every cell; the foot does not move in the rest of it."""
        first = np.arange(self.count) * self.per
        corners = np.stack([self.low, self.high])
        for foot, (r, one) in product(range(4), enumerate(self.problem.polygons)):
            planes = np.concatenate([one.sides, one.normal[None], -one.normal[None]])
            bounds = np.concatenate([one.bounds, [one.offset, -one.offset]])
            reach = np.maximum(planes * corners[0], planes * corners[1]).sum(axis=1)
            most = np.maximum(reach - bounds, 0.0)
            terms = [(planes[None, :, a], self.feet[first, foot, a][:, None]) for a in range(3)]
            self.build.add("region", -INF, bounds + most, [*terms, (most[None], self.chosen[r, :, foot][:, None])])

    def contact_rows(self, velocity: Quantity, force: Quantity) -> None:
        """Write (27), (28) and (14): still in contact, no force in swing, torques limited."""
        cell = np.arange(self.problem.samples) // self.per
        fastest = (self.high - self.low) / self.problem.step_s
        limit = np.array(self.problem.robot.torque_max_nm)
        for foot, jacobian in enumerate(np.array(self.problem.robot.jacobians)):
            held = [self.chosen[r, cell, foot][:, None] for r in self.polygons]
            for sign in (1.0, -1.0):
                moving = [(sign, velocity[:, foot]), *((fastest, one) for one in held)]
                self.build.add("contact", -INF, fastest, moving)
                torque = [(sign * jacobian[a][None], force[:, foot, a][:, None]) for a in range(3)]
                self.build.add("torque", -INF, 0.0, [*torque, *((-limit, one) for one in held)])

    def friction_rows(self, force: Quantity) -> None:
        """Write (25)-(26); M is what the joint torques let a force reach."""
        cell = np.arange(self.problem.samples) // self.per
        for foot, (r, one) in product(range(4), enumerate(self.problem.polygons)):
            inverse = np.abs(np.linalg.inv(np.array(self.problem.robot.jacobians[foot]).T))
            most = np.abs(one.pyramid) @ (inverse @ np.array(self.problem.robot.torque_max_nm))
            terms = [(one.pyramid[None, :, a], force[:, foot, a][:, None]) for a in range(3)]
            self.build.add("friction", -INF, most, [*terms, (most, self.chosen[r, cell, foot][:, None])])

    def clearance_rows(self) -> None:
        """Write VII-A2 for every swing of cells a .. b-1; it counts when a-1 and b are in contact and none between."""
        height = self.problem.options.clearance_m
        most = height + float(self.high[2] - self.low[2])
        for foot, a in product(range(4), range(1, self.count - 1)):
            for b in range(a + 1, self.count):
                size = (b - a) * self.per
                samples = np.arange(a * self.per + size // 4, b * self.per - size // 4)
                if not len(samples):
                    continue
                ends = [(-most, self.chosen[r, m, foot][None]) for r in self.polygons for m in (a - 1, b)]
                inner = [(most, self.chosen[r, m, foot][None]) for r in self.polygons for m in range(a, b)]
                for ground in (a * self.per - 1, b * self.per):
                    rise = [(1.0, self.feet[samples, foot, 2]), (-1.0, self.feet[[ground], foot, 2])]
                    self.build.add("clearance", height - 2 * most, INF, [*rise, *ends, *inner])

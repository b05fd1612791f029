"""One standard form of mixed-integer programs, and the solvers behind one protocol.

``standard_form`` writes a foothold problem with binaries and big-M rows over the whole model: a formulation that shares
no reduction and no tree with the fast path. Every M follows from polygons and torque limits, none is typed in.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy.sparse as sp

from surefoot.footholds.model import INF, fixed_rows, whole_cost, whole_motion
from surefoot.footholds.problem import Problem, reach_span
from surefoot.footholds.rows import Array, Cost, Index, Quantity, RowBuilder, Rows


@dataclass(frozen=True, slots=True, eq=False)
class StandardForm:
    """Minimise a convex quadratic cost below rows, some unknowns being 0 or 1.

    Attributes:
        cost: over all unknowns.
        rows: over all unknowns; those of the binaries' own range are among them.
        binaries: which unknowns are 0 or 1.
    """

    cost: Cost
    rows: Rows
    binaries: Index


@dataclass(frozen=True, slots=True, eq=False)
class FormAnswer:
    """What a solver says about a standard form.

    Attributes:
        feasible: True, False, or None when a limit stopped it.
        unknowns: of the best solution, or None.
        value: its cost; infinite without one.
        bound: lower bound of the cost; minus infinity when the solver gives none.
    """

    feasible: bool | None
    unknowns: Array | None
    value: float
    bound: float


class FormSolver(Protocol):
    """A solver of standard forms."""

    @property
    def name(self) -> str:
        """What people call it."""
        ...

    @property
    def optimises(self) -> bool:
        """Whether it finds the least cost; else it only decides feasibility."""
        ...

    def solve(self, form: StandardForm, time_limit_s: float) -> FormAnswer:
        """Solve a form."""
        ...


def standard_form(problem: Problem) -> StandardForm:
    """Return Eqs. (1)-(16) and (29)-(31) with their binaries H, one per footstep and polygon, and window and region."""
    motion, _ = whole_motion(problem.samples)
    steps, polygons = len(problem.footsteps), len(problem.polygons)
    windows = problem.windows() if problem.options.collision else ()
    regions = len(problem.free_regions)
    count = steps * polygons + 4 * len(windows) * regions
    size = motion.size + count
    chosen = Quantity.unknown(np.arange(motion.size, motion.size + steps * polygons).reshape(steps, polygons))
    free = Quantity.unknown(np.arange(motion.size + steps * polygons, size).reshape(4, len(windows), regions))
    build = RowBuilder(size)
    fixed_rows(build, problem)
    build.add("region", 0.0, 1.0, [(1.0, chosen)])
    for step in range(steps):
        build.add("region", 1.0, 1.0, [(1.0, chosen[step, r][None]) for r in range(polygons)])
    region_implications(build, problem, motion.feet, chosen)
    assert motion.force is not None
    _friction_implications(build, problem, motion.force, chosen)
    if windows:
        build.add("collision", 0.0, 1.0, [(1.0, free)])
        build.add("collision", 1.0, 1.0, [(1.0, free[:, :, s]) for s in range(regions)])
        collision_implications(build, problem, motion.feet, free)
    return StandardForm(padded(whole_cost(problem), count), build.rows(), np.arange(motion.size, size))


def padded(cost: Cost, count: int) -> Cost:
    """Return a cost over more unknowns, on which it does not depend."""
    hessian = sp.csc_matrix(sp.block_diag([cost.hessian, sp.csc_matrix((count, count))]))
    hessian.sort_indices()
    none = np.zeros(count)
    return Cost(hessian, np.append(cost.linear, none), cost.constant, np.append(cost.curvature, none))


def region_implications(build: RowBuilder, problem: Problem, feet: Quantity, chosen: Quantity) -> None:
    """Write (6)-(7): H implies that the foothold lies in the polygon; M spans all polygons, as it lies in one."""
    corners = np.concatenate([one.vertices_m for one in problem.polygons])
    for number, step in enumerate(problem.footsteps):
        foothold = feet[step.touch, step.foot]
        for r, one in enumerate(problem.polygons):
            planes = np.concatenate([one.sides, one.normal[None], -one.normal[None]])
            bounds = np.concatenate([one.bounds, [one.offset, -one.offset]])
            most = np.maximum((corners @ planes.T).max(axis=0) - bounds, 0.0)
            terms = [(planes[:, a], foothold[a][None]) for a in range(3)]
            build.add("region", -INF, bounds + most, [*terms, (most, chosen[number, r][None])])


def _friction_implications(build: RowBuilder, problem: Problem, force: Quantity, chosen: Quantity) -> None:
    """Write (10)-(11) with H; M is what the joint torques (14) let a force reach."""
    for foot in range(4):
        inverse = np.abs(np.linalg.inv(np.array(problem.robot.jacobians[foot]).T))
        most_n = inverse @ np.array(problem.robot.torque_max_nm)
        index = problem.support_index[:, foot]
        for support in np.unique(index[index > -2]):
            pushed = force[np.flatnonzero(index == support), foot]
            for r, one in enumerate(problem.polygons):
                cone = one.pyramid
                terms = [(cone[None, :, a], pushed[:, a][:, None]) for a in range(3)]
                if support < 0:
                    if r == problem.start_polygons[foot]:
                        build.add("friction", -INF, 0.0, terms)
                    continue
                most = np.abs(cone) @ most_n
                build.add("friction", -INF, most, [*terms, (most, chosen[support, r][None, None])])


def collision_implications(
    build: RowBuilder, problem: Problem, feet: Quantity, free: Quantity, slack: Quantity | None = None
) -> None:
    """Write (29) with H; M is what the feet can reach at all; a slack per foot and window may let them give."""
    centre, span = problem.start_m, reach_span(problem)
    for foot in range(4):
        for window, samples in enumerate(problem.windows()):
            points = feet[np.array(samples), foot]
            for s, (matrix, bound) in enumerate(problem.free_regions):
                most = np.maximum(matrix @ centre + np.linalg.norm(matrix, axis=1) * span - bound, 0.0)
                terms = [(matrix[None, :, a], points[:, a][:, None]) for a in range(3)]
                give = [] if slack is None else [(-1.0, slack[foot, window][None, None])]
                build.add("collision", -INF, bound + most, [*terms, (most, free[foot, window, s][None, None]), *give])

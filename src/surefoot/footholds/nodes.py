"""The convex programs that the search solves: the model with some choices still open."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from surefoot.footholds.model import (
    Choice,
    Motion,
    clearance_rows,
    collision_rows,
    cost_of,
    dynamics_rows,
    friction_rows,
    reach_rows,
    region_rows,
    support_rows,
    torque_rows,
    whole_cost,
    whole_motion,
    whole_rows,
)
from surefoot.footholds.problem import Problem, impossible_cost
from surefoot.footholds.qp import EquationBound, QpAnswer, broken_constant, solve_qp
from surefoot.footholds.reduction import reduced_motion
from surefoot.footholds.rows import FAMILIES, Array, Cost, RowBuilder, Rows, stacked

_CERTAIN = 100.0


@dataclass(frozen=True, slots=True, eq=False)
class Node:
    """One solved program.

    Attributes:
        rows: its rows.
        answer: what became of it.
        feet: positions of the feet, shape (N, 4, 3).
    """

    rows: Rows
    answer: QpAnswer
    feet: Array


class ReducedProgram:
    """The program over positions (and forces, if they are kept).

    Args:
        problem: what to solve.
        forces: whether forces are unknowns. Without them friction and torque are left out, which is a relaxation.
    """

    def __init__(self, problem: Problem, *, forces: bool) -> None:
        self.problem = problem
        self.forces = forces
        self.motion = reduced_motion(problem, forces=forces)
        self.cost: Cost = cost_of(problem, self.motion)
        build = RowBuilder(self.motion.size)
        dynamics_rows(build, problem, self.motion)
        reach_rows(build, problem, self.motion)
        clearance_rows(build, problem, self.motion)
        support_rows(build, problem, self.motion)
        if forces:
            torque_rows(build, problem, self.motion)
        self.fixed = build.rows()
        self.certain = _CERTAIN * impossible_cost(problem)

    def rows(self, choice: Choice) -> Rows:
        """Return the rows for what a choice leaves open."""
        build = RowBuilder(self.motion.size)
        region_rows(build, self.problem, self.motion, choice)
        if self.forces:
            friction_rows(build, self.problem, self.motion, choice)
        collision_rows(build, self.problem, self.motion, choice)
        return stacked([self.fixed, build.rows()])

    def solve(self, choice: Choice) -> Node:
        """Solve the program."""
        rows = self.rows(choice)
        broken = broken_constant(rows, self.certain)
        if broken is not None:
            return Node(rows, broken, self.motion.feet.at(broken.unknowns))
        rows = rows.pick(np.diff(rows.matrix.indptr) > 0)
        answer = solve_qp(self.cost, rows, certain=self.certain)
        return Node(rows, answer, self.motion.feet.at(answer.unknowns))


class WholeProgram:
    """The program over all 66 numbers of every sample: for moment balance, and as the reference.

    Args:
        problem: what to solve.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.forces = True
        self.certain = _CERTAIN * impossible_cost(problem)
        self.motion: Motion = whole_motion(problem.samples)[0]
        self.cost: Cost = whole_cost(problem)
        self.exact: EquationBound | None = None

    def solve(self, choice: Choice) -> Node:
        """Solve the program."""
        rows = whole_rows(self.problem, choice)
        answer = solve_qp(self.cost, rows, certain=self.certain)
        kept = rows.equal & (rows.family != FAMILIES.index("region"))
        if self.exact is None:
            self.exact = EquationBound(self.cost, rows.pick(kept))
        if np.isfinite(answer.value):
            bound = self.exact.bound(rows.pick(~kept), answer.multipliers[~kept])
            answer = replace(answer, bound=bound)
        return Node(rows, answer, self.motion.feet.at(answer.unknowns))


Program = ReducedProgram | WholeProgram

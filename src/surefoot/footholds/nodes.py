"""The convex programs that the search solves: the model with some choices still open."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from surefoot.footholds.assembly import Assembly, Part, Parts
from surefoot.footholds.model import Choice, Motion, support_rows, whole_cost, whole_motion, whole_rows, window_rows
from surefoot.footholds.problem import Problem, impossible_cost
from surefoot.footholds.qp import EquationBound, QpAnswer, broken_constant, solve_qp
from surefoot.footholds.rows import FAMILIES, Array, Cost, RowBuilder, Rows

_CERTAIN = 100.0


@dataclass(frozen=True, slots=True, eq=False)
class Node:
    """One solved program.

    Attributes:
        rows: its rows.
        answer: what became of it.
        feet: positions of the feet, shape (N, 4, 3).
        motion: which unknowns are which; None for a program that is no motion.
    """

    rows: Rows
    answer: QpAnswer
    feet: Array
    motion: Motion | None = None


class ReducedProgram:
    """The program over positions (and forces, if they are kept).

    Args:
        problem: what to solve.
        forces: whether forces are unknowns. Without them friction and torque are left out, which is a relaxation.
        parts: shared with the programs of other gaits of the same problem.
    """

    def __init__(self, problem: Problem, *, forces: bool, parts: Parts | None = None) -> None:
        self.problem = problem
        self.forces = forces
        self.assembly = Assembly(problem, parts or Parts(problem), forces=forces)
        self.motion = self.assembly.motion
        self.cost: Cost = self.assembly.cost()
        self.fixed = self.assembly.fixed()
        if problem.options.com_support_m is not None:
            build = RowBuilder(self.motion.size)
            support_rows(build, problem, self.motion)
            self.fixed.append(Part(build.rows()))
        if forces:
            self.fixed += [self.assembly.first_stance(foot) for foot in range(4)]
        self.certain = _CERTAIN * impossible_cost(problem)
        self.windows: dict[tuple[int, int], Part] = {}

    def rows(self, choice: Choice) -> Rows:
        """Return the rows for what a choice leaves open."""
        steps, parts = len(self.problem.footsteps), list(self.fixed)
        for number, left in enumerate(choice[:steps]):
            parts += self.assembly.step(number, left)
        if self.problem.options.collision:
            closed = [(number, left[0]) for number, left in enumerate(choice[steps:]) if len(left) == 1]
            parts += [self.window(number, region) for number, region in closed]
        return self.assembly.rows(parts)

    def window(self, number: int, region: int) -> Part:
        """Return the rows of a window that a foot spends in one region."""
        if (number, region) not in self.windows:
            build = RowBuilder(self.motion.size)
            window_rows(build, self.problem, self.motion, number, region)
            self.windows[number, region] = Part(build.rows())
        return self.windows[number, region]

    def solve(self, choice: Choice) -> Node:
        """Solve the program."""
        rows = self.rows(choice)
        broken = broken_constant(rows, self.certain)
        if broken is not None:
            return Node(rows, broken, self.motion.feet.at(broken.unknowns), self.motion)
        rows = rows.pick(np.diff(rows.matrix.indptr) > 0)
        answer = solve_qp(self.cost, rows, certain=self.certain)
        return Node(rows, answer, self.motion.feet.at(answer.unknowns), self.motion)


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
        return Node(rows, answer, self.motion.feet.at(answer.unknowns), self.motion)


Program = ReducedProgram | WholeProgram

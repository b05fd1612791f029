"""The convex programs that the search solves: the model with some choices still open."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from surefoot.footholds.model import (
    Choice,
    Motion,
    clearance_rows,
    cost_of,
    dynamics_rows,
    foothold_rows,
    reach_rows,
    stance_rows,
    support_rows,
    torque_rows,
    whole_cost,
    whole_motion,
    whole_rows,
    window_rows,
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
        self.blocks: dict[tuple[int, tuple[int, ...]], Rows] = {}

    def rows(self, choice: Choice) -> Rows:
        """Return the rows for what a choice leaves open; blocks are kept, as most nodes share most of them."""
        steps = self.problem.footsteps
        parts = [self.fixed, *(self.step(number, choice[number]) for number in range(len(steps)))]
        if self.forces:
            parts += [self.first_stance(foot) for foot in range(4)]
        if self.problem.options.collision:
            closed = [(number, left[0]) for number, left in enumerate(choice[len(steps) :]) if len(left) == 1]
            parts += [self.window(number, region) for number, region in closed]
        return stacked(parts)

    def step(self, number: int, left: tuple[int, ...]) -> Rows:
        """Return the rows of a footstep: its region, and its friction where forces are kept."""
        key = (number, left)
        if key not in self.blocks:
            build = RowBuilder(self.motion.size)
            foothold_rows(build, self.problem, self.motion, number, left)
            if self.forces:
                stance_rows(build, self.problem, self.motion, self.problem.footsteps[number].foot, number, left)
            self.blocks[key] = build.rows()
        return self.blocks[key]

    def window(self, number: int, region: int) -> Rows:
        """Return the rows of a window that a foot spends in one region."""
        key = (len(self.problem.footsteps) + number, (region,))
        if key not in self.blocks:
            build = RowBuilder(self.motion.size)
            window_rows(build, self.problem, self.motion, number, region)
            self.blocks[key] = build.rows()
        return self.blocks[key]

    def first_stance(self, foot: int) -> Rows:
        """Return the friction rows of a foot before its first swing."""
        key = (-1 - foot, ())
        if key not in self.blocks:
            build = RowBuilder(self.motion.size)
            stance_rows(build, self.problem, self.motion, foot, -1, (self.problem.start_polygons[foot],))
            self.blocks[key] = build.rows()
        return self.blocks[key]

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

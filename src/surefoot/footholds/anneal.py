"""Better plans from a plan: random changes of contacts and polygons, each tried by one or two convex programs.

With the polygons of all footsteps given a program has no choices left, so that it is solved once, and once more with
the forces as unknowns where friction or torque press. That is a fraction of what the search over all polygons takes;
the polygons themselves are changed at random instead. Simulated annealing in rounds that grow, from a fixed seed:
nothing depends on time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from surefoot.footholds.assembly import Parts
from surefoot.footholds.cells import Cells, fixed
from surefoot.footholds.model import Choice
from surefoot.footholds.moves import proposal
from surefoot.footholds.nodes import ReducedProgram, WholeProgram
from surefoot.footholds.problem import Problem
from surefoot.footholds.rows import Array
from surefoot.footholds.solve import slack

_HOT, _COLD = 0.02, 5e-4
_FIRST_ROUND, _GROWTH = 200, 1.5
_POLYGON_SHARE = 0.25
_NEAR_M = 0.4
_AGAIN = 0.25


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """A plan.

    Attributes:
        cells: its contact table.
        choice: its polygons.
        value: its cost, without that of the orientation.
        feet: positions, shape (N, 4, 3).
    """

    cells: Cells
    choice: Choice
    value: float
    feet: Array


def tried(problem: Problem, cells: Cells, choice: Choice, worth: float, parts: Parts) -> Trial | None:
    """Return the plan of a contact table with given polygons, or None when it costs as much as ``worth``."""
    at = fixed(problem, cells)
    program: ReducedProgram | WholeProgram
    if problem.options.moment_balance:
        program = WholeProgram(at)
        node = program.solve(choice)
    else:
        program = ReducedProgram(at, forces=False, parts=parts)
        node = program.solve(choice)
        if node.answer.feasible and node.answer.value < worth and not slack(at, program, choice, node):
            node = ReducedProgram(at, forces=True, parts=parts).solve(choice)
    if not node.answer.feasible or not node.answer.value < worth:
        return None
    return Trial(cells, choice, node.answer.value, node.feet)


def polygons_for(problem: Problem, before: Trial, cells: Cells) -> Choice:
    """Return polygons for the footsteps of a contact table: those on which each foot stood about then."""
    old, new = fixed(problem, before.cells), fixed(problem, cells)
    support = old.support_index
    found = []
    for step in new.footsteps:
        stood = support[:, step.foot]
        middle = (step.touch + step.leave) // 2
        held = np.flatnonzero(stood > -2)
        number = int(stood[held[np.abs(held - middle).argmin()]])
        found.append(before.choice[number] if number >= 0 else (problem.start_polygons[step.foot],))
    return tuple(found)


class Annealing:
    """A walk from plan to plan.

    Args:
        problem: its gait is free, and there are no windows of collision avoidance.
        start: the first plan.
        parts: of the programs.
    """

    def __init__(self, problem: Problem, start: Trial, parts: Parts) -> None:
        self.problem, self.parts = problem, parts
        self.here = self.best = start
        self.chance = np.random.default_rng(0)
        self.done, self.length = 0, _FIRST_ROUND
        self.failed: dict[tuple[bytes, Choice], float] = {}

    def offer(self, found: Trial) -> None:
        """Go on from a plan that was found elsewhere, when it is better than all so far."""
        if found.value < self.best.value:
            self.here = self.best = found

    def step(self) -> Trial | None:
        """Try one change; return the plan when it is the best so far."""
        heat = _HOT * (_COLD / _HOT) ** (self.done / self.length)
        worth = self.here.value - heat * self.best.value * float(np.log(max(self.chance.random(), 1e-12)))
        self._count()
        changed = self._changed()
        if changed is None:
            return None
        key = (changed[0].tobytes(), changed[1])
        if self.failed.get(key, -np.inf) >= worth:
            return None
        found = tried(self.problem, *changed, worth, self.parts)
        if found is None:
            self.failed[key] = worth
            return None
        self.here = found
        if found.value < self.best.value:
            self.best = found
            return found
        return None

    def _count(self) -> None:
        self.done += 1
        if self.done > self.length:
            self.done, self.length = 1, int(self.length * _GROWTH)
            self.here = self.best

    def _changed(self) -> tuple[Cells, Choice] | None:
        """Return another contact table, or another polygon for one footstep."""
        if self.chance.random() < _POLYGON_SHARE:
            moved = self._stepped_elsewhere()
            if moved is not None:
                return self.here.cells, moved
        cells = proposal(self.here.cells, self.problem.options.min_dwell_cells, self.chance)
        if cells is not None and self.chance.random() < _AGAIN:
            cells = proposal(cells, self.problem.options.min_dwell_cells, self.chance)
        return None if cells is None else (cells, polygons_for(self.problem, self.here, cells))

    def _stepped_elsewhere(self) -> Choice | None:
        """Return the choice with one footstep, and perhaps the one before or after, on a polygon nearby."""
        steps = fixed(self.problem, self.here.cells).footsteps
        if not steps:
            return None
        number = int(self.chance.integers(len(steps)))
        point = self.here.feet[steps[number].touch, steps[number].foot]
        near = [
            r
            for r, one in enumerate(self.problem.polygons)
            if (r,) != self.here.choice[number] and float(np.linalg.norm(one.nearest(point) - point)) < _NEAR_M
        ]
        if not near:
            return None
        chosen = (int(self.chance.choice(near)),)
        return (*self.here.choice[:number], chosen, *self.here.choice[number + 1 :])

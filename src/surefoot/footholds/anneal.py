"""Better plans from a plan: random changes of contacts and polygons, each tried by one small program.

With the polygons of all footsteps given a program has no choices left. It is solved from the rows that press in the
plan that was changed (``tables``), and given up as soon as its cost shows to be too high; with moment balance, support
or collision it is one of the convex programs of the search. The polygons are changed at random as well, and searched at
the end of a round. Simulated annealing from a fixed seed, in rounds: from the best plan, and by turns from other
families of gaits. Nothing depends on time.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from surefoot.footholds.assembly import Parts
from surefoot.footholds.cells import Cells, fixed
from surefoot.footholds.model import Choice
from surefoot.footholds.moves import proposal
from surefoot.footholds.nodes import ReducedProgram, WholeProgram
from surefoot.footholds.problem import Problem
from surefoot.footholds.solve import cheapest, slack
from surefoot.footholds.tables import Tables, Trial, polygons_after

_HOT, _WARM, _COOL, _COLD = 0.1, 0.03, 0.005, 2e-3
_FIRST_ROUND, _GROWTH = 200, 1.2
_POLYGON_SHARE = 0.25
_NEAR_M = 0.4
_AGAIN = 0.25
_POLISH_GAP = 2e-3
_ROUGH_GAP = 0.3
_HOPELESS = 4.0
_MOST_KEPT = 20_000


class Annealing:
    """A walk from plan to plan, begun by ``offer``.

    Args:
        problem: its gait is free.
        parts: of the programs.
        starts: named contact tables; some that have a plan are starts of rounds, one of every family.
        stop: asked in the middle of long searches.

    Attributes:
        idle: how many steps in a row came to what was known.
    """

    def __init__(
        self, problem: Problem, parts: Parts, starts: Iterator[tuple[str, Cells]], stop: Callable[[], bool]
    ) -> None:
        self.problem = replace(problem, options=replace(problem.options, gap=_POLISH_GAP, first_plan=False))
        self.parts, self.stop = parts, stop
        self.tables, options = Tables(problem), problem.options
        self.plain = not (options.collision or options.moment_balance or options.com_support_m is not None)
        self.here: Trial | None = None
        self.best: Trial | None = None
        self.polished: Trial | None = None
        self.starts = starts
        self.others = self._others()
        self.scale, self.heat = 0.0, _COOL
        self.chance = np.random.default_rng(0)
        self.done, self.rounds, self.length = 0, 0, _FIRST_ROUND
        self.idle, self.programs = 0, 0
        self.known: dict[tuple[bytes, Choice], Trial | float] = {}

    def offer(self, cells: Cells, choice: Choice, value: float) -> None:
        """Take a plan that was found elsewhere, when it is better than all so far."""
        if self.best is None or value < self.best.value:
            found = self._tried(cells, choice, np.inf)
            if found is not None:
                self.here = self.best = found
                self.scale = self.scale or found.value

    def take_count(self) -> int:
        """Return how many contact tables were tried since this was last asked."""
        count, self.programs = self.programs, 0
        return count

    def step(self) -> Trial | None:
        """Try one change; return the plan when it is the best so far."""
        if self.here is None or self.best is None:
            return None
        self.done += 1
        if self.done > self.length:
            return self._next_round()
        heat = self.heat * (_COLD / self.heat) ** (self.done / self.length)
        worth = self.here.value - heat * self.scale * float(np.log(max(self.chance.random(), 1e-12)))
        changed = self._changed(self.here)
        self.idle += 1
        found = None if changed is None else self._looked_up(*changed, worth)
        if found is None:
            return None
        self.here = found
        return self._better(found)

    def _better(self, found: Trial) -> Trial | None:
        if self.best is None or found.value < self.best.value:
            self.best = found
            return found
        return None

    def _next_round(self) -> Trial | None:
        """Begin a round: by turns from a plan of another family, and from the best plan, its polygons searched."""
        assert self.best is not None
        self.done, self.rounds, self.length = 0, self.rounds + 1, int(self.length * _GROWTH)
        other = next(self.others, None) if self.rounds % 2 else None
        better = None if other is not None else self._polished()
        self.here = other or self.best
        self.scale, self.heat = self.here.value, _WARM if other is None else _HOT
        return better

    def _others(self) -> Iterator[Trial]:
        """Yield plans to begin rounds with, of different families: the cheapest first where they are found quickly."""
        begun = ((name, self._begun(cells)) for name, cells in self.starts)
        found = ((name, one) for name, one in begun if one is not None)
        known: set[tuple[str, int]] = set()
        for name, one in sorted(found, key=lambda pair: pair[1].value) if self.plain else found:
            family = (name, len(one.choice) if self.plain else 0)
            if family not in known:
                known.add(family)
                yield one

    def _begun(self, cells: Cells) -> Trial | None:
        """Return a plan of a contact table: on the polygons nearest to where its feet are expected, or searched."""
        if self.best is None or self.stop():
            return None
        if self.plain:
            return self._tried(cells, self.tables.nearest(cells), _HOPELESS * self.best.value)
        at = fixed(self.problem, cells)
        rough = replace(at, options=replace(at.options, gap=_ROUGH_GAP))
        choice = cheapest(rough, cancelled=self.stop, worth=np.inf, parts=self.parts)[1]
        return None if choice is None else self._tried(cells, choice, np.inf)

    def _polished(self) -> Trial | None:
        """Search the polygons of the best plan; return what is better."""
        assert self.best is not None
        before = self.best
        if self.polished is before or self.stop():
            return None
        at, worth = fixed(self.problem, before.cells), before.value * (1 - _POLISH_GAP)
        _, choice, _ = cheapest(at, cancelled=self.stop, worth=worth, parts=self.parts)
        found = None if choice is None else self._tried(before.cells, choice, before.value)
        self.polished = found or before
        return None if found is None else self._better(found)

    def _looked_up(self, cells: Cells, choice: Choice, worth: float) -> Trial | None:
        key = (cells.tobytes(), choice)
        known = self.known.get(key, -np.inf)
        if isinstance(known, Trial):
            return known if known.value < worth else None
        if known >= worth:
            return None
        self.idle = 0
        found = self._tried(cells, choice, worth, self.here)
        if len(self.known) < _MOST_KEPT:
            self.known[key] = worth if found is None else found
        return found

    def _tried(self, cells: Cells, choice: Choice, worth: float, near: Trial | None = None) -> Trial | None:
        """Return the plan of a contact table with given polygons, or None when it costs as much as ``worth``."""
        self.programs += 1
        if self.plain:
            found = self.tables.tried(cells, choice, worth, near)
            if found is not None or np.isfinite(worth):
                return found
        at = fixed(self.problem, cells)
        if at.options.collision:
            return self._searched(at, cells, worth)
        program: ReducedProgram | WholeProgram
        if at.options.moment_balance:
            program = WholeProgram(at)
            node = program.solve(choice)
        else:
            program = ReducedProgram(at, forces=False, parts=self.parts)
            node = program.solve(choice)
            if node.answer.feasible and node.answer.value < worth and not slack(at, program, choice, node):
                node = ReducedProgram(at, forces=True, parts=self.parts).solve(choice)
        if not node.answer.feasible or not node.answer.value < worth:
            return None
        return Trial(cells, choice, node.answer.value, node.feet)

    def _searched(self, at: Problem, cells: Cells, worth: float) -> Trial | None:
        """Return the plan of a contact table whose polygons and free regions are searched: windows are too many."""
        value, choice, node = cheapest(at, cancelled=self.stop, worth=worth, parts=self.parts)
        return None if choice is None or node is None or value >= worth else Trial(cells, choice, value, node.feet)

    def _changed(self, here: Trial) -> tuple[Cells, Choice] | None:
        """Return another contact table, or another polygon for one footstep."""
        collision = self.problem.options.collision
        if self.chance.random() < _POLYGON_SHARE and not collision:
            moved = self._stepped_elsewhere(here)
            if moved is not None:
                return here.cells, moved
        cells = proposal(here.cells, self.problem.options.min_dwell_cells, self.chance)
        if cells is not None and self.chance.random() < _AGAIN:
            cells = proposal(cells, self.problem.options.min_dwell_cells, self.chance)
        if cells is None:
            return None
        return cells, () if collision else polygons_after(self.problem, here, cells)

    def _stepped_elsewhere(self, here: Trial) -> Choice | None:
        """Return the choice with one footstep on another polygon nearby."""
        if not here.choice:
            return None
        number = int(self.chance.integers(len(here.choice)))
        near = [r for r in self.tables.near(here, number, _NEAR_M) if (r,) != here.choice[number]]
        if not near:
            return None
        return (*here.choice[:number], (near[int(self.chance.integers(len(near)))],), *here.choice[number + 1 :])

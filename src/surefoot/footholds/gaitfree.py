"""Finds the gait: templates first, then annealing from the best plan, by turns with a bound over all gaits.

Zhou et al. 2025, VI-D, Eqs. (21)-(28), as the least over all contact tables of the gait-fixed program. Nothing depends
on time, except when to stop.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from surefoot.footholds.anneal import Annealing
from surefoot.footholds.assembly import Parts
from surefoot.footholds.bounding import MARGIN, Bounding
from surefoot.footholds.cells import Cells, cell_count, fixed, gait_of
from surefoot.footholds.decide import Decided, decided_exactly, decided_quickly
from surefoot.footholds.dual import Pricing
from surefoot.footholds.explain_free import explain_free
from surefoot.footholds.first_prices import even_prices, prices_of_node
from surefoot.footholds.model import Choice
from surefoot.footholds.orientation import turning
from surefoot.footholds.pool import FIRST, GUESSED, LAST, LATER, Pool
from surefoot.footholds.problem import Problem
from surefoot.footholds.proof import turning_multipliers
from surefoot.footholds.sharing import Prices
from surefoot.footholds.solve import FreeAnswer, Solution, cheapest, load_backends, no_plan, solve
from surefoot.footholds.tables import Trial, warm_up
from surefoot.footholds.templates import first_templates, templates

_COMPARE_GAP = 1e-3
_GUESSED = 12
_GUIDE_BOXES = 16
_TRIES_PER_ROUND = 2
_CHANGES_PER_ROUND = 3000
_TRIES_BEFORE_DOUBT = 13
_TRIES_BEFORE_EXACT = 160
_SURE = 1.02
_MOST_IDLE = 500
_MOST_QUIET = 2
_LEAST_GAP = 1.01 * MARGIN
_LAST_S, _EVER_S = 2.0, 1e4


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """A gait that works.

    Attributes:
        cells: its contact table.
        choice: its polygons.
        value: its cost, without that of the orientation.
        origin: what proposed it.
    """

    cells: Cells
    choice: Choice
    value: float
    origin: str


def solve_free(
    problem: Problem, *, cancelled: Callable[[], bool] = lambda: False, certify: bool = True, why: bool = True
) -> Solution:
    """Find a gait, footholds, forces and base motion, with a bound over all gaits, or prove that there are none."""
    load_backends()
    Pricing(problem, 1, points=True).at(even_prices(problem))
    warm_up(problem)
    solution = _Search(problem, cancelled).run(certify)
    if not why or solution.verdict != "infeasible":
        return solution
    begin = time.perf_counter()
    explanation = explain_free(problem)
    return replace(solution, explanation=explanation, explain_ms=(time.perf_counter() - begin) * 1e3)


class _Search:
    def __init__(self, problem: Problem, cancelled: Callable[[], bool]) -> None:
        self.problem, self.cancelled = problem, cancelled
        self.begin, self.begin_cpu = time.perf_counter(), time.process_time()
        self.limit: str | None = None
        self.tried = 0
        self.found: Found | None = None
        self.first_s: float | None = None
        self.first_objective: float | None = None
        self.bounding: Bounding | None = None
        self.parts = Parts(problem)

    def stop(self) -> bool:
        if self.cancelled():
            self.limit = "cancelled"
        elif self.elapsed_s() > self.problem.options.time_limit_s:
            self.limit = f"the time limit of {self.problem.options.time_limit_s:g} s was reached"
        return self.limit is not None

    def elapsed_s(self) -> float:
        return time.perf_counter() - self.begin

    @property
    def bound(self) -> float:
        """Lower bound of all gaits so far, without the orientation."""
        return -np.inf if self.bounding is None else self.bounding.proof.bound

    @property
    def close(self) -> bool:
        """Whether the gap is small enough, or nothing but what is left to checkers."""
        if self.found is None or self.problem.options.first_plan:
            return self.found is not None
        return self.found.value - self.bound <= max(self.problem.options.gap, _LEAST_GAP) * self.found.value

    def run(self, certify: bool) -> Solution:
        decided = decided_quickly(self.problem, self.stop)
        if decided is not None:
            return self.negative(decided)
        guide = Pricing(self.problem, _GUIDE_BOXES, points=True)
        self.pool = Pool(guide)
        dwell = self.problem.options.min_dwell_cells
        named = list(templates(cell_count(self.problem), dwell))
        guess = guide.guesses(even_prices(self.problem))
        named.sort(key=lambda one: (guess(one[1]), one[1].tobytes()))
        self.pool.add(named[:_GUESSED], GUESSED)
        self.pool.add(first_templates(cell_count(self.problem), dwell), FIRST)
        self.pool.price(even_prices(self.problem))
        while self.found is None and not self.stop() and self.tried < _TRIES_BEFORE_DOUBT and self.try_next():
            pass
        self.pool.add(named, LAST)
        if self.found is None and not self.stop():
            decided = decided_quickly(self.problem, self.stop, thorough=True)
            if decided is not None:
                return self.negative(decided)
        while self.found is None and not self.stop() and self.tried < _TRIES_BEFORE_EXACT and self.try_next():
            pass
        if self.found is None and not self.stop() and certify:
            decided = decided_exactly(self.problem, self.problem.options.time_limit_s - self.elapsed_s())
            if decided.cells is None:
                return self.negative(decided)
            self.offer(decided.cells, "exact program")
        if self.found is None:
            return self.negative(Decided((), None, "no gait that was tried is feasible"))
        self.improve()
        return self.positive()

    def try_next(self) -> bool:
        """Try the contact table that promises most; return whether there was one."""
        best = self.pool.pop(np.inf if self.found is None else self.found.value * _SURE)
        if best is None:
            return False
        before = self.found
        prices = self.offer(*best)
        if prices is not None and (self.found is None or self.found is not before):
            self.pool.price(prices)
        return True

    def fixed(self, cells: Cells) -> Problem:
        """Return the program of a contact table, to be solved well enough to compare tables."""
        options = replace(self.problem.options, gap=_COMPARE_GAP, first_plan=False)
        return replace(fixed(self.problem, cells), options=options)

    def offer(self, cells: Cells, origin: str) -> Prices | None:
        """Try a contact table, keep it when it is the best so far, and return its prices."""
        self.tried += 1
        at = self.fixed(cells)
        worth = np.inf if self.found is None else self.found.value
        value, choice, node = cheapest(at, cancelled=self.stop, worth=worth, parts=self.parts)
        prices = None if node is None or node.motion is None else prices_of_node(at, node)
        if choice is None or value >= worth:
            return prices
        if self.found is None:
            checked = solve(at, guesses=(choice,), certify=False, why=False)
            if checked.verdict != "feasible":
                return prices
            self.first_s, self.first_objective = self.elapsed_s(), checked.objective
        self.found = Found(cells, choice, value, origin)
        return prices

    def improve(self) -> None:
        """Lower the cost and raise the bound by turns."""
        assert self.found is not None
        self.bounding = Bounding(self.problem)
        starts = first_templates(cell_count(self.problem), self.problem.options.min_dwell_cells)
        annealing = Annealing(self.problem, self.parts, starts, self.stop)
        quiet = 0
        while not self.stop() and not self.close and not (annealing.idle >= _MOST_IDLE and self.bounding.stuck):
            before = self.found.value
            self.anneal(annealing)
            quiet = 0 if self.found.value < before else min(quiet + 1, _MOST_QUIET)
            for _ in range(1 + quiet):
                if not self.close and not self.bounding.stuck:
                    self.climb(self.bounding)
            for _ in range(_TRIES_PER_ROUND):
                if self.stop() or self.close or not self.try_next():
                    break

    def anneal(self, annealing: Annealing) -> None:
        """Change the best plan at random for a while, and keep the best of all changes when its rows hold."""
        assert self.found is not None
        annealing.offer(self.found.cells, self.found.choice, self.found.value)
        best: Trial | None = None
        for _ in range(_CHANGES_PER_ROUND):
            if self.stop() or annealing.idle >= _MOST_IDLE:
                break
            best = annealing.step() or best
        self.tried += annealing.take_count()
        if best is not None and best.value < self.found.value and self.holds(best):
            self.found = Found(best.cells, best.choice, best.value, "annealing")

    def holds(self, plan: Trial) -> bool:
        """Return whether a plan keeps all rows of the whole model, as another solver finds it."""
        at = self.fixed(plan.cells)
        at = replace(at, options=replace(at.options, first_plan=True, time_limit_s=_LAST_S))
        return solve(at, guesses=(plan.choice,), certify=False, why=False).verdict == "feasible"

    def climb(self, bounding: Bounding) -> None:
        """Raise the bound for a while, and try what its prices suggest."""
        assert self.found is not None
        suggested = bounding.climb(self.found.value, self.stop)
        self.pool.add((("prices", cells) for cells in suggested), LATER)
        self.pool.price(bounding.prices)

    def positive(self) -> Solution:
        """Return the best plan, solved once more to the end with its gait."""
        assert self.found is not None
        at = self.fixed(self.found.cells)
        for limit_s in (_LAST_S, _EVER_S):
            limited = replace(at, options=replace(at.options, time_limit_s=limit_s))
            best = solve(limited, guesses=(self.found.choice,), certify=False, why=False)
            if best.objective is not None:
                break
        assert best.objective is not None
        turned = None if self.problem.options.moment_balance else turning(self.problem)
        bound = min(self.bound + (0.0 if turned is None else turned.bound), best.objective)
        net = best.objective - at.gravity_cost
        return replace(
            best,
            bound=bound if np.isfinite(bound) else None,
            gap=(best.objective - bound) / best.objective if np.isfinite(bound) else None,
            net_gap=(best.objective - bound) / net if net > 0 and np.isfinite(bound) else None,
            solve_ms=self.elapsed_s() * 1e3,
            solve_cpu_ms=(time.process_time() - self.begin_cpu) * 1e3,
            limit=self.limit,
            notes=(*best.notes, *self.doubts()),
            proof=None,
            free=replace(self.answer(), turning=() if turned is None else tuple(turning_multipliers(turned))),
        )

    def doubts(self) -> tuple[str, ...]:
        """Return why no bound is claimed, if none is."""
        if self.bounding is None or np.isfinite(self.bound):
            return ()
        if self.found is not None and self.bounding.checkable(self.found.value):
            return ("no bound over all gaits is claimed: the search ended before one was high enough to be checked",)
        shortest_s = self.problem.options.min_dwell_cells * self.problem.options.cell_s
        return (
            f"no bound over all gaits is claimed: with swings of {shortest_s:g} s it is too loose to be checked; "
            "options.cell_s or options.min_dwell_cells may be larger",
        )

    def negative(self, decided: Decided) -> Solution:
        proved = len(decided.methods) > 1
        limit = self.limit if proved else self.limit or decided.open
        solution = no_plan(
            "infeasible" if proved else "unknown", " and ".join(decided.methods) if proved else "none", limit
        )
        return replace(
            solution,
            solve_ms=self.elapsed_s() * 1e3,
            solve_cpu_ms=(time.process_time() - self.begin_cpu) * 1e3,
            certify_ms=decided.certify_ms,
            free=replace(self.answer(), refutation=decided.refutation),
        )

    def answer(self) -> FreeAnswer:
        best = self.found
        return FreeAnswer(
            gait=None if best is None else gait_of(best.cells, self.problem.options.cell_s),
            origin="" if best is None else best.origin,
            templates_tried=self.tried,
            first_feasible_s=self.first_s,
            first_objective=self.first_objective,
            proof=None if self.bounding is None else self.bounding.proof,
        )

"""Decides whether a free gait has any plan at all: relaxations first, then the exact program."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from surefoot.errors import BackendMissing
from surefoot.footholds.cells import Cells
from surefoot.footholds.explain_free import unreached_goal
from surefoot.footholds.free_form import free_form
from surefoot.footholds.orientation import turning
from surefoot.footholds.problem import Problem
from surefoot.footholds.refute import Refuted, confirmed, refuted
from surefoot.footholds.skeleton import skeleton
from surefoot.footholds.solvers import HighsSolver, run_highs, solver_of

_QUICK_NODES, _MOST_NODES = 21, 160
_SKELETON_S = 5.0


@dataclass(frozen=True, slots=True, eq=False)
class Decided:
    """What was found out.

    Attributes:
        methods: that prove that there is no plan, by names; two of them are needed.
        cells: a contact table that has a plan, or None.
        open: why the question stays open, when it does.
        refutation: checked multipliers, when there are.
        certify_ms: what the second method took.
    """

    methods: tuple[str, ...]
    cells: Cells | None
    open: str
    refutation: Refuted | None = None
    certify_ms: float = 0.0


def decided_quickly(problem: Problem, stop: Callable[[], bool], *, thorough: bool = False) -> Decided | None:
    """Return that there is no plan if the skeleton says so, twice; None when that stays open."""
    if not problem.options.moment_balance and turning(problem).feasible is False:
        return _confirmed_exactly(problem, "the base cannot be turned that fast")
    form = skeleton(problem)
    found = refuted(problem, form, stop, _MOST_NODES if thorough else _QUICK_NODES)
    if found is None:
        return _confirmed_exactly(problem, "a foot finds no ground at the goal") if unreached_goal(problem) else None
    begin = time.perf_counter()
    also = confirmed(found, _SKELETON_S)
    methods = ("checked rays of the skeleton", "HiGHS on the skeleton")[: 1 + also]
    return Decided(methods, None, "HiGHS does not confirm it", found, (time.perf_counter() - begin) * 1e3)


def _confirmed_exactly(problem: Problem, reason: str) -> Decided:
    """Ask HiGHS whether the exact program, without clearance, is infeasible as well."""
    begin = time.perf_counter()
    also = HighsSolver().solve(free_form(problem, clearance=False).form, _SKELETON_S).feasible is False
    methods = (reason, "HiGHS feasibility")[: 1 + also]
    return Decided(methods, None, "no second method confirms it", None, (time.perf_counter() - begin) * 1e3)


def decided_exactly(problem: Problem, time_limit_s: float) -> Decided:
    """Decide by the exact program: HiGHS, and for "infeasible" SCIP beside it where that is installed."""
    form = free_form(problem)
    size = len(form.form.cost.linear)
    status, unknowns = run_highs(form.form, np.zeros(size), max(time_limit_s, 0.1))
    if status is None:
        return Decided((), None, "HiGHS did not decide the exact program in time")
    if status and unknowns is not None:
        return Decided((), form.cells(unknowns), "")
    begin = time.perf_counter()
    try:
        also = solver_of("scip").solve(form.form, max(time_limit_s, 0.1)).feasible is False
    except BackendMissing as missing:
        return Decided(("HiGHS on the exact program",), None, f"infeasible by HiGHS alone; a second opinion: {missing}")
    methods = ("HiGHS on the exact program", "SCIP on the exact program")[: 1 + also]
    return Decided(methods, None, "SCIP does not confirm it", None, (time.perf_counter() - begin) * 1e3)

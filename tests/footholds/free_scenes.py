"""Small problems with a free gait, shared by tests."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np

from surefoot.footholds import FreeGait, Options, Problem
from surefoot.footholds.free_families import free_problem_of
from surefoot.verify.findings import Ledger
from surefoot.verify.footholds.check import check_footholds


def leap() -> Problem:
    """Return a gap leap of a second, for which any plan will do."""
    problem = free_problem_of("gap-leap", 3)
    options = replace(problem.options, first_plan=True, time_limit_s=60.0)
    return replace(problem, gait=FreeGait(1.0), options=options)


def tiny(goal_x_m: float, cells: int = 5) -> Problem:
    """Return a problem of few cells whose gaits can be enumerated: 0.1 s per sample, 0.2 s per cell."""
    problem = free_problem_of("gap-leap", 0)
    options = Options(cell_s=0.2, gap=1e-4, time_limit_s=60.0, clearance_m=0.02)
    goal = np.array([goal_x_m, 0.0, 0.29])
    return replace(problem, gait=FreeGait(0.2 * cells), step_s=0.1, goal_m=goal, options=options)


def checked(path: Path) -> Ledger:
    """Return what the checker says to a plan file."""
    ledger = Ledger()
    check_footholds(path, ledger)
    return ledger


def every_table(cells: int) -> list[np.ndarray]:
    """Return all contact tables in which the two front and the two hind feet move together."""
    inner = cells - 2
    found = []
    for front, hind in product(product((True, False), repeat=inner), repeat=2):
        table = np.ones((cells, 4), dtype=bool)
        table[1:-1, :2] = np.array(front)[:, None]
        table[1:-1, 2:] = np.array(hind)[:, None]
        found.append(table)
    return found

"""The slow and simple way: every choice on the whole model, one after the other. The fast path is tested against it."""

from __future__ import annotations

import itertools
import math

from surefoot.errors import LimitExceeded
from surefoot.footholds.model import Choice, all_open, whole_cost, whole_rows
from surefoot.footholds.problem import Problem
from surefoot.footholds.qp import solve_qp

MOST_CHOICES = 100_000


def best_of_all(problem: Problem, root: Choice | None = None) -> tuple[Choice | None, float]:
    """Return the best choice and its cost on the whole model, or None and infinity when every choice is infeasible.

    Args:
        problem: what to solve.
        root: what is left to every footstep and window; everything by default.

    Raises:
        LimitExceeded: there are more choices than are reasonable.
    """
    root = all_open(problem) if root is None else root
    count = math.prod(len(left) for left in root)
    if count > MOST_CHOICES:
        raise LimitExceeded(f"{count} choices are more than the {MOST_CHOICES} that are tried")
    cost, best, value = whole_cost(problem), None, math.inf
    for picked in itertools.product(*root):
        choice = tuple((r,) for r in picked)
        answer = solve_qp(cost, whole_rows(problem, choice))
        if answer.feasible and answer.value < value:
            best, value = choice, answer.value
    return best, value

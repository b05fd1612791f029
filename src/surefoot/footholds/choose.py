"""Tries gaits that are known before it looks for one: for those who only need some gait that works."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from surefoot.footholds.gaits import NAMED, FreeGait, Gait
from surefoot.footholds.problem import Problem
from surefoot.footholds.solve import Solution, solve

_ANY = 0.99


def solve_with_gaits(
    problem: Problem,
    gaits: Sequence[str | Gait] = (),
    horizons_s: Sequence[float] = (),
    *,
    cancelled: Callable[[], bool] = lambda: False,
) -> tuple[Problem, Solution]:
    """Return the first gait that works, with its plan: known gaits in their order, then free ones in theirs.

    Args:
        problem: what to solve; its own gait does not matter.
        gaits: names such as ``trot-2s``, or gaits.
        horizons_s: of free gaits; the first plan of a free gait is taken, whatever it costs.
        cancelled: asked now and then; True ends the search with what there is.

    Returns:
        The problem with the gait in it, and the answer; those of the last attempt when none is feasible, and
        ``unknown`` when any attempt stayed unknown.
    """
    attempts: list[Gait | FreeGait] = [NAMED[one] if isinstance(one, str) else one for one in gaits]
    attempts += [FreeGait(one) for one in horizons_s]
    if not attempts:
        raise ValueError("needs at least one gait or one horizon to try")
    opened: tuple[Problem, Solution] | None = None
    for gait in attempts:
        at = replace(problem, gait=gait)
        if isinstance(gait, FreeGait):
            at = replace(at, options=replace(at.options, gap=_ANY))
        answer = (at, solve(at, cancelled=cancelled, why=False))
        if answer[1].verdict == "feasible":
            return answer
        if answer[1].verdict == "unknown":
            opened = answer
    return opened or answer

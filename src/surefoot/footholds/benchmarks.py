"""Measures the foothold programs over seeded families, in CPU time of the one thread they use.

``solve_ms`` of an answer is the clock's time; on a machine that does nothing else the two agree.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from surefoot.footholds.generators import FAMILIES, problem_of
from surefoot.footholds.solve import Solution, solve

INSTANCES = 100
DECIDED_MS, GAP_MS, COLLISION_MS = 30.0, 500.0, 200.0
PAPER = {"rebar": "1.1 s", "rebar-rotated": "3.6-9 s", "step-up": "2.65 s", "step-down": "2.65 s"}
_FIRST = 0.99


@dataclass(frozen=True, slots=True)
class FamilyFigures:
    """What one family took.

    Attributes:
        family: its name.
        instances: how many seeds.
        feasible, infeasible, unknown: verdicts at the gap of 1e-4.
        decided_ms: until feasible or refuted, median, 95 % below, worst.
        gap_ms: until the gap of 1e-4, likewise; instances that are infeasible included.
        certify_ms: what the second method took where it was needed, median; 0 without infeasible ones.
        net_gap: worst gap without the gravity cost.
        residual: worst residual of any plan.
        collision: whether collision avoidance is on.
    """

    family: str
    instances: int
    feasible: int
    infeasible: int
    unknown: int
    decided_ms: tuple[float, float, float]
    gap_ms: tuple[float, float, float]
    certify_ms: float
    net_gap: float
    residual: float
    collision: bool


def measure(instances: int = INSTANCES, say: Callable[[str], None] = lambda _: None) -> tuple[FamilyFigures, ...]:
    """Solve every family, each instance once to a first answer and once to a gap of 1e-4."""
    found = []
    solve(problem_of("stones-8", 0))
    for family in FAMILIES:
        say(f"footholds: {instances} x {family}")
        found.append(_family(family, instances))
    return tuple(found)


def _family(family: str, instances: int) -> FamilyFigures:
    first_ms: list[float] = []
    best_ms: list[float] = []
    best: list[Solution] = []
    for seed in range(instances):
        problem = problem_of(family, seed)
        quick = replace(problem, options=replace(problem.options, gap=_FIRST))
        first_ms.append(solve(quick, certify=False, why=False).solve_cpu_ms)
        solution = solve(problem_of(family, seed), certify=False, why=False)
        best_ms.append(solution.solve_cpu_ms)
        best.append(solution if solution.verdict == "feasible" else solve(problem, why=False))
    verdicts = [solution.verdict for solution in best]
    refuted = [solution.certify_ms for solution in best if solution.verdict == "infeasible"]
    return FamilyFigures(
        family=family,
        instances=instances,
        feasible=verdicts.count("feasible"),
        infeasible=verdicts.count("infeasible"),
        unknown=verdicts.count("unknown"),
        decided_ms=_spread(first_ms),
        gap_ms=_spread(best_ms),
        certify_ms=float(np.median(refuted)) if refuted else 0.0,
        net_gap=max((solution.net_gap or 0.0 for solution in best), default=0.0),
        residual=max((solution.max_residual or 0.0 for solution in best), default=0.0),
        collision=problem_of(family, 0).options.collision,
    )


def _spread(times: list[float]) -> tuple[float, float, float]:
    return float(np.median(times)), float(np.percentile(times, 95)), max(times)

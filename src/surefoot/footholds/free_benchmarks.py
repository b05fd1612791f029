"""Measures the search for gaits over seeded families, in CPU time of the one thread it uses."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from surefoot.footholds.free_families import FREE_FAMILIES, free_problem_of
from surefoot.footholds.problem import Problem
from surefoot.footholds.solve import Solution, solve

INSTANCES = 20
GOOD_INSTANCES = 4
FIRST_S, REFUTED_S, GAP = 1.0, 0.2, 0.2
GOOD_S = 15.0
_LONG_S = 120.0


@dataclass(frozen=True, slots=True)
class FreeFigures:
    """What one family took.

    Attributes:
        family: its name.
        instances: how many seeds.
        feasible, infeasible, unknown: verdicts.
        decided_s: CPU time to the first verified plan or to the refutation by two methods: median, 95 % below, worst.
        gaps: within the CPU time of a good plan: median and worst; empty where nothing is feasible.
    """

    family: str
    instances: int
    feasible: int
    infeasible: int
    unknown: int
    decided_s: tuple[float, float, float]
    gaps: tuple[float, ...]


def measure(instances: int = INSTANCES, say: Callable[[str], None] = lambda _: None) -> tuple[FreeFigures, ...]:
    """Solve every family to a first answer, and some instances of each for the time of a good plan."""
    solve(_first("gap-leap", 0))
    found = []
    for family in FREE_FAMILIES:
        say(f"gaits: {instances} x {family}")
        found.append(_family(family, instances))
    return tuple(found)


def _first(family: str, seed: int) -> Problem:
    problem = free_problem_of(family, seed)
    return replace(problem, options=replace(problem.options, first_plan=True, time_limit_s=_LONG_S))


def _good(family: str, seed: int) -> Problem:
    problem = free_problem_of(family, seed)
    return replace(problem, options=replace(problem.options, gap=1e-4, time_limit_s=_LONG_S))


def _solved_for(problem: Problem, cpu_s: float) -> Solution:
    """Solve until a CPU time is spent, which a busy machine does not stretch."""
    end = time.process_time() + cpu_s
    return solve(problem, cancelled=lambda: time.process_time() > end)


def _family(family: str, instances: int) -> FreeFigures:
    answers = [solve(_first(family, seed)) for seed in range(instances)]
    verdicts = [one.verdict for one in answers]
    seconds = [one.solve_cpu_ms / 1e3 for one in answers]
    good: list[Solution] = []
    if "feasible" in verdicts:
        good = [_solved_for(_good(family, seed), GOOD_S) for seed in range(min(GOOD_INSTANCES, instances))]
    gaps = [one.gap for one in good if one.gap is not None]
    return FreeFigures(
        family=family,
        instances=instances,
        feasible=verdicts.count("feasible"),
        infeasible=verdicts.count("infeasible"),
        unknown=verdicts.count("unknown"),
        decided_s=(float(np.median(seconds)), float(np.percentile(seconds, 95)), max(seconds)),
        gaps=(float(np.median(gaps)), max(gaps)) if gaps else (),
    )

"""Footholds for a given gait: the mixed-integer convex program of Zhou et al. 2025, fast and certified."""

from __future__ import annotations

from surefoot.footholds.plan_file import write_plan
from surefoot.footholds.problem import Options, Problem, Weights
from surefoot.footholds.problem_file import problem_schema, read_problem
from surefoot.footholds.retarget import Retargeted, retarget, retargeted
from surefoot.footholds.solve import Solution, solve

__all__ = [
    "Options",
    "Problem",
    "Retargeted",
    "Solution",
    "Weights",
    "problem_schema",
    "read_problem",
    "retarget",
    "retargeted",
    "solve",
    "write_plan",
]

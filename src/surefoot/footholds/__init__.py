"""Footholds for a gait that is given or to be found: the programs of Zhou et al. 2025, fast and certified."""

from __future__ import annotations

from surefoot.footholds.choose import solve_with_gaits
from surefoot.footholds.gaits import FreeGait, Gait
from surefoot.footholds.plan_file import write_plan
from surefoot.footholds.problem import Options, Problem, Weights
from surefoot.footholds.problem_file import problem_schema, read_problem
from surefoot.footholds.retarget import Retargeted, retarget, retargeted
from surefoot.footholds.solve import FreeAnswer, Solution, solve

__all__ = [
    "FreeAnswer",
    "FreeGait",
    "Gait",
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
    "solve_with_gaits",
    "write_plan",
]

"""Solving: fixpoints and executable strategies."""

from surefoot.games.arena import Arena, reachable, restrict, swap_players, with_goals
from surefoot.games.cores import Core, unrealizable_core
from surefoot.games.explicit import solve
from surefoot.games.partial import partial_evaluation
from surefoot.games.solution import Engine, EnvDeadEnd, Solution, follow, visit
from surefoot.games.synthesis import SynthesisAnswer, Vacuity, synthesize
from surefoot.games.warming import is_compiled, warm_up
from surefoot.games.witness import can_stay_safe, environment_cannot_keep_assumptions, failing_goals

__all__ = [
    "Arena",
    "Core",
    "Engine",
    "EnvDeadEnd",
    "Solution",
    "SynthesisAnswer",
    "Vacuity",
    "can_stay_safe",
    "environment_cannot_keep_assumptions",
    "failing_goals",
    "follow",
    "is_compiled",
    "partial_evaluation",
    "reachable",
    "restrict",
    "solve",
    "swap_players",
    "synthesize",
    "unrealizable_core",
    "visit",
    "warm_up",
    "with_goals",
]

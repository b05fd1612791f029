"""Solving: fixpoints and executable strategies.

Names are imported when they are first used, so that planning does not load what reads and solves specifications.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from surefoot.games.arena import Arena, reachable, restrict, swap_players, with_goals
    from surefoot.games.cores import Core, unrealizable_core
    from surefoot.games.explicit import solve
    from surefoot.games.partial import partial_evaluation
    from surefoot.games.solution import Engine, EnvDeadEnd, Solution, follow, visit
    from surefoot.games.synthesis import SynthesisAnswer, Vacuity, synthesize
    from surefoot.games.warming import is_compiled, is_kept, warm_up
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
    "is_kept",
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

_HOMES = {
    "Arena": "arena",
    "Core": "cores",
    "Engine": "solution",
    "EnvDeadEnd": "solution",
    "Solution": "solution",
    "SynthesisAnswer": "synthesis",
    "Vacuity": "synthesis",
    "can_stay_safe": "witness",
    "environment_cannot_keep_assumptions": "witness",
    "failing_goals": "witness",
    "follow": "solution",
    "is_compiled": "warming",
    "is_kept": "warming",
    "partial_evaluation": "partial",
    "reachable": "arena",
    "restrict": "arena",
    "solve": "explicit",
    "swap_players": "arena",
    "synthesize": "synthesis",
    "unrealizable_core": "cores",
    "visit": "solution",
    "warm_up": "warming",
    "with_goals": "arena",
}


def __getattr__(name: str) -> Any:
    """Import a public name from its module."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)

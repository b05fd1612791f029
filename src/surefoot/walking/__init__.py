"""The pendulum model, its safety theorems, the step library and the keyframe decision maker.

Names are imported when they are first used, so that reading a scenario does not load compiled code.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from surefoot.walking.library import StepLibrary, TurnTemplate, step_library
    from surefoot.walking.parameters import WalkingParameters, walking_parameters
    from surefoot.walking.planner import apex_risk, plan_step
    from surefoot.walking.state import StepCommand, StepKind, Unsafe, WalkingState, standing_state
    from surefoot.walking.step import WalkingStep
    from surefoot.walking.trajectory import Trajectory, sample_trajectory

__all__ = [
    "StepCommand",
    "StepKind",
    "StepLibrary",
    "Trajectory",
    "TurnTemplate",
    "Unsafe",
    "WalkingParameters",
    "WalkingState",
    "WalkingStep",
    "apex_risk",
    "plan_step",
    "sample_trajectory",
    "standing_state",
    "step_library",
    "walking_parameters",
]

_HOMES = {
    "StepCommand": "state",
    "StepKind": "state",
    "StepLibrary": "library",
    "Trajectory": "trajectory",
    "TurnTemplate": "library",
    "Unsafe": "state",
    "WalkingParameters": "parameters",
    "WalkingState": "state",
    "WalkingStep": "step",
    "apex_risk": "planner",
    "plan_step": "planner",
    "sample_trajectory": "trajectory",
    "standing_state": "state",
    "step_library": "library",
    "walking_parameters": "parameters",
}


def __getattr__(name: str) -> Any:
    """Import a public name from its module."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)

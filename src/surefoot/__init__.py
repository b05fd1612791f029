"""Plans for legged robots that provably neither fall nor collide, and get their task done.

The first hour needs these names; everything else is found by room (see docs):

    import surefoot as sf

    planned = sf.plan_mission("scenes/tutorial_mission.yaml", "plan")
    walked = sf.run_mission("scenes/tutorial_mission.yaml", "plan", steps=200, seed=1, obstacle="random", out="run")
    sf.verify_path("run").accepted

Names are imported when they are first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from surefoot.errors import InputError, SurefootError
    from surefoot.missions.biped.mission import RunAnswer, run_mission
    from surefoot.missions.biped.run_log import read_run
    from surefoot.missions.plans.planning import PlanAnswer, plan_mission
    from surefoot.missions.scenario.file import read_scenario
    from surefoot.missions.scenario_init import init_scenario
    from surefoot.verify import Report, verify_path
    from surefoot.viewer import view_run

__version__ = "0.1.0"

_HOMES = {
    "InputError": "errors",
    "PlanAnswer": "missions.plans.planning",
    "Report": "verify",
    "RunAnswer": "missions.biped.mission",
    "SurefootError": "errors",
    "init_scenario": "missions.scenario_init",
    "plan_mission": "missions.plans.planning",
    "read_run": "missions.biped.run_log",
    "read_scenario": "missions.scenario.file",
    "run_mission": "missions.biped.mission",
    "verify_path": "verify",
    "view_run": "viewer",
}

__all__ = [
    "InputError",
    "PlanAnswer",
    "Report",
    "RunAnswer",
    "SurefootError",
    "__version__",
    "init_scenario",
    "plan_mission",
    "read_run",
    "read_scenario",
    "run_mission",
    "verify_path",
    "view_run",
]


def __getattr__(name: str) -> Any:
    """Import a public name from its room."""
    if name not in _HOMES:
        raise AttributeError(f"module 'surefoot' has no attribute {name!r}; it has {', '.join(_HOMES)}")
    return getattr(import_module(f"surefoot.{_HOMES[name]}"), name)

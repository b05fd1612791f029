"""Robust controllable regions of a walking step, their controllers, and recovery from pushes.

Source: Shamsah et al., T-RO 2023, Sections IV-B and VII; Warnke et al., Section II and Appendix B. See docs/reach.md.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from surefoot.reach.artefact import load_region, masks_sha256, save_region
    from surefoot.reach.barriers import BarrierRegion, barrier_region, screen
    from surefoot.reach.capture import CaptureStep, capture_foot, capture_step
    from surefoot.reach.certified import Certified, certified_region
    from surefoot.reach.controller import Controller
    from surefoot.reach.ensembles import Law, table_1
    from surefoot.reach.library import RegionLibrary, composed_library, region_library
    from surefoot.reach.look_up import HalfStepController
    from surefoot.reach.parameters import (
        Disturbance,
        GridSpec,
        GuardTube,
        OmegaSet,
        Reading,
        Settings,
        Transition,
        first_foot_after_turn,
    )
    from surefoot.reach.policy import KeyframePolicy, robust_keyframe_policy
    from surefoot.reach.simulation import Push, Trace, simulate
    from surefoot.reach.synthesis import Region, synthesize

_HOMES = {
    "artefact": ("load_region", "masks_sha256", "save_region"),
    "barriers": ("BarrierRegion", "barrier_region", "screen"),
    "capture": ("CaptureStep", "capture_foot", "capture_step"),
    "certified": ("Certified", "certified_region"),
    "controller": ("Controller",),
    "look_up": ("HalfStepController",),
    "ensembles": ("Law", "table_1"),
    "library": ("RegionLibrary", "composed_library", "region_library"),
    "parameters": (
        "Disturbance",
        "GridSpec",
        "GuardTube",
        "OmegaSet",
        "Reading",
        "Settings",
        "Transition",
        "first_foot_after_turn",
    ),
    "policy": ("KeyframePolicy", "robust_keyframe_policy"),
    "simulation": ("Push", "Trace", "simulate"),
    "synthesis": ("Region", "synthesize"),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [
    "BarrierRegion",
    "CaptureStep",
    "Certified",
    "Controller",
    "Disturbance",
    "GridSpec",
    "GuardTube",
    "HalfStepController",
    "KeyframePolicy",
    "Law",
    "OmegaSet",
    "Push",
    "Reading",
    "Region",
    "RegionLibrary",
    "Settings",
    "Trace",
    "Transition",
    "barrier_region",
    "capture_foot",
    "capture_step",
    "certified_region",
    "composed_library",
    "first_foot_after_turn",
    "load_region",
    "masks_sha256",
    "region_library",
    "robust_keyframe_policy",
    "save_region",
    "screen",
    "simulate",
    "synthesize",
    "table_1",
]


def __getattr__(name: str) -> Any:
    """Import what is asked for only then: compiled code takes a moment to load."""
    home = _HOME_OF.get(name)
    if home is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"surefoot.reach.{home}"), name)

"""How a robot stands at the start, and where its swing foot is at every apex; transcribed from formats.md 3."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from surefoot.verify.findings import Ledger
from surefoot.verify.navigation.claims import Claims
from surefoot.verify.runs.file import Step
from surefoot.verify.runs.replay import Walked
from surefoot.verify.scene.derived import Scene, fine_center_m

TOLERANCE = 1e-6
SWING_BESIDE_M = 0.27
SWING_ABOVE_M = 0.35
SWING_SPEED_RATIO = 2.0
Vector = NDArray[np.float64]


def check_posture(scene: Scene, claims: Claims, walked: list[Walked], ledger: Ledger) -> None:
    """Check the posture at the start of a log, and the swing foot at every apex after it."""
    if not walked:
        return
    _check_start(scene, claims, walked[0].step, ledger)
    for before, item in pairwise(walked):
        _check_swing(before.step, item.step, ledger)


def _check_start(scene: Scene, claims: Claims, step: Step, ledger: Ledger) -> None:
    """Compare the first step with the standing posture at the start."""
    where, rule = f"run.jsonl line {step.line}", "formats.md 3, standing posture"
    waypoint = step.vectors["waypoint_m"]
    off = scene.frame.to_grid(waypoint[:2]) - np.array(fine_center_m(scene, claims.start, claims.fine))
    if float(np.abs(off).max()) > TOLERANCE:
        ledger.refuse(rule, "the first waypoint is not the centre of the fine cell of the start", where)
    if step.sign_alternates:
        ledger.refuse(rule, "sign_alternates: a foot on its waypoint has no side to change", where)
    yaw_rad = math.pi / 2 * (1 - claims.heading) + scene.frame.rotation_rad
    toward_other = -_side(step) * claims.walking["dy2_m"] * _left(yaw_rad)
    own = {
        "foot_m": (step.vectors["foot_m"], waypoint),
        "swing_from_m": (step.vectors["swing_from_m"], waypoint + 2 * toward_other),
        "swing_lift_m": (step.vectors["swing_lift_m"], waypoint + 2 * toward_other),
        "swing_velocity_mps": (step.vectors["swing_velocity_mps"], np.zeros(3)),
    }
    if step.rise is not None:
        height = np.array([0.0, 0.0, scene.robot.apex_height_m])
        own["rise_com_m"] = (step.rise.com_m, waypoint + toward_other + height)
    for name, (found, derived) in own.items():
        if not _same(found, derived):
            ledger.refuse(rule, f"{name} is not where the robot stands at the start", where)


def _check_swing(before: Step, step: Step, ledger: Ledger) -> None:
    """Compare the swing foot at the start apex of a step with what the step before it leaves."""
    where, rule = f"run.jsonl line {step.line}", "formats.md 3, swing foot"
    if before.closing_foot_m is not None:
        position, velocity = before.closing_foot_m, np.zeros(3)
        lift = before.closing_foot_m
    else:
        position, velocity = swing_at_next_apex(before)
        lift = before.vectors["foot_m"]
    own = {"swing_from_m": position, "swing_velocity_mps": velocity, "swing_lift_m": lift}
    for name, derived in own.items():
        if not _same(step.vectors[name], derived):
            ledger.refuse(rule, f"{name} is not what the step before it leaves", where)


def swing_at_next_apex(step: Step) -> tuple[Vector, Vector]:
    """Return position and velocity, at the next apex of a step, of the foot that stood before its switch."""
    yaw_rad, at = step.numbers["yaw_rad"], step.vectors
    ahead = np.array([math.cos(yaw_rad), math.sin(yaw_rad), 0.0])
    position = at["next_foot_m"] + _side(step) * SWING_BESIDE_M * _left(yaw_rad)
    position[2] = max(at["foot_m"][2], at["next_foot_m"][2]) + SWING_ABOVE_M
    return position, SWING_SPEED_RATIO * step.numbers["next_apex_speed_mps"] * ahead


def _side(step: Step) -> float:
    """Return +1 when the left foot carries the robot, -1 for the right."""
    return 1.0 if step.stance == 0 else -1.0


def _left(yaw_rad: float) -> Vector:
    return np.array([-math.sin(yaw_rad), math.cos(yaw_rad), 0.0])


def _same(one: Vector, other: Vector) -> bool:
    return float(np.abs(one - other).max()) <= TOLERANCE

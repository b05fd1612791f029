"""Pushed steps of a run log: the pendulum integrated arc by arc, and what the log claims about each push.

Transcribed from formats.md 3, pushes. "Sagittal" is along the heading of a step, "lateral" to its left.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from surefoot.verify.findings import Ledger
from surefoot.verify.navigation.claims import Claims
from surefoot.verify.runs.file import Step
from surefoot.verify.runs.pendulum import runge_kutta
from surefoot.verify.runs.push_file import Fall, Push, Pushing
from surefoot.verify.runs.replay import Walked
from surefoot.verify.scene.derived import Scene

TOLERANCE = 1e-6
WINDOW_TOLERANCE_MPS = 0.01
OMEGAS_RADPS = (2.8, 3.5)
SUBSTEP_S = 0.002
RULE = "formats.md 3, pushes"
Vector = NDArray[np.float64]


def check_pushes(
    scene: Scene, claims: Claims, walked: list[Walked], falls: list[Fall], pushing: Pushing, ledger: Ledger
) -> None:
    """Check every pushed step of a log, and that the pushes are those that the header announces."""
    steps = [item.step for item in walked]
    for step in steps:
        if step.push is not None:
            _check_step(scene, claims, step, step.push, ledger)
        elif step.side_speed_mps is not None:
            ledger.refuse(RULE, "a step that was not pushed leaves a lateral speed", _where(step))
        if step.transition is not None and step.transition != _flag(scene, step):
            ledger.refuse(RULE, "transition does not fit outcome and moved_cells", _where(step))
    _check_announced(steps, falls, pushing, ledger)
    for fall in falls:
        ledger.fail(RULE, "the robot fell after a push", f"run.jsonl line {fall.line}")
    pushed = [step.push for step in steps if step.push is not None]
    ledger.counts["pushes"] = len(pushed) + len(falls)
    ledger.counts["recovered_in_region"] = sum(push.region for push in pushed)
    ledger.counts["recovered_by_step"] = sum(not push.region for push in pushed)


def _where(step: Step) -> str:
    return f"run.jsonl line {step.line}"


def _check_announced(steps: list[Step], falls: list[Fall], pushing: Pushing, ledger: Ledger) -> None:
    """Compare the pushes of a log with its header, or with the script that the header names."""
    walked = {step.step: (step.push, step.line) for step in steps}
    for step in steps:
        push = step.push
        if push is None:
            continue
        if pushing.script is None:
            if not _small(push.jump_mps, pushing):
                ledger.refuse(RULE, "the jump is larger than the header allows", _where(step))
            continue
        listed = pushing.script.get(step.step)
        found = (push.time_s / math.fsum(push.planned_halves_s), *push.jump_mps)
        if listed is None or not np.allclose(listed, found, rtol=0, atol=TOLERANCE):
            ledger.refuse(RULE, "the push is not the script's", _where(step))
    for fall in falls:
        _check_fall(fall, len(steps), len(falls), pushing, ledger)
        listed = (pushing.script or {}).get(fall.step)
        if pushing.script is not None and (
            listed is None or not np.allclose(listed[1:], fall.jump_mps, atol=TOLERANCE)
        ):
            ledger.refuse(RULE, "the push is not the script's", f"run.jsonl line {fall.line}")
    for number in pushing.script or {}:
        if number in walked and walked[number][0] is None:
            ledger.refuse(RULE, "a push of the script is missing", f"run.jsonl line {walked[number][1]}")


def _small(jump_mps: tuple[float, float], pushing: Pushing) -> bool:
    return all(abs(a) <= b + TOLERANCE for a, b in zip(jump_mps, pushing.sizes_mps, strict=True))


def _check_fall(fall: Fall, steps: int, falls: int, pushing: Pushing, ledger: Ledger) -> None:
    """Check what a fall claims; whether the robot could have walked on is not checked."""
    where = f"run.jsonl line {fall.line}"
    if fall.step != steps or falls > 1:
        ledger.refuse(RULE, "a fall is not the last step of the walk", where)
    if -fall.margin_mps > math.hypot(*fall.jump_mps) + TOLERANCE:
        ledger.refuse(RULE, "a fall was lost by more than its jump", where)
    if pushing.script is None and not _small(fall.jump_mps, pushing):
        ledger.refuse(RULE, "the jump is larger than the header allows", where)


def _check_step(scene: Scene, claims: Claims, step: Step, push: Push, ledger: Ledger) -> None:
    """Check one pushed step."""
    ahead, left = _axes(step.numbers["yaw_rad"])
    problems = [
        *_timing(step, push),
        *_omegas(push, scene.robot.omega_radps),
        *_motion(step, push, scene.robot.omega_radps, ahead, left),
        *_plan(step, push, scene.robot.omega_radps, ahead, left),
        *_placement(scene, claims, step, push, ahead, left),
    ]
    for problem in problems:
        ledger.refuse(RULE, problem, _where(step))


def _axes(yaw_rad: float) -> tuple[Vector, Vector]:
    ahead = np.array([math.cos(yaw_rad), math.sin(yaw_rad)])
    return ahead, np.array([-ahead[1], ahead[0]])


def _lasting(arcs: Iterable[tuple[float, float]]) -> float:
    return math.fsum(duration for duration, _ in arcs)


def _timing(step: Step, push: Push) -> list[str]:
    """Return what is wrong with the times."""
    first, second = push.planned_halves_s
    if not 0 <= push.time_s < first + second or min(first, second) <= 0:
        return ["the push does not come between the apexes"]
    before, after = _lasting(push.before), _lasting(push.after)
    own = (push.time_s + before, after) if push.time_s < first else (first, push.time_s - first + after)
    problems = [] if push.time_s < first or not push.before else ["a switch is left after the planned one"]
    found = step.numbers["first_half_s"], step.numbers["second_half_s"]
    if not np.allclose(own, found, rtol=0, atol=TOLERANCE):
        problems.append("the halves do not last as long as their arcs")
    return problems


def _omegas(push: Push, robot_radps: float) -> list[str]:
    """Return what is wrong with the omegas."""
    for duration, omega in (*push.before, *push.after):
        inside = OMEGAS_RADPS[0] - TOLERANCE <= omega <= OMEGAS_RADPS[1] + TOLERANCE
        if duration < 0 or duration > 10:
            return ["an arc lasts less than no time, or too long"]
        if not inside and abs(omega - robot_radps) > TOLERANCE:
            return ["an omega is neither the robot's nor in the range of the law"]
    return []


def _motion(step: Step, push: Push, robot_radps: float, ahead: Vector, left: Vector) -> list[str]:
    """Integrate the arcs before the push, the jump, and the arcs after it."""
    at, first = step.vectors, push.planned_halves_s[0]
    jump = push.jump_mps[0] * ahead + push.jump_mps[1] * left
    state = _integrated(
        (at["com_m"][:2], at["velocity_mps"]), at["foot_m"][:2], [(min(push.time_s, first), robot_radps)]
    )
    problems = []
    if push.time_s < first:
        switch = _integrated((state[0], state[1] + jump), at["foot_m"][:2], push.before)
        rest: list[tuple[float, float]] = []
    else:
        switch, rest = state, [(push.time_s - first, robot_radps)]
    if not _same(switch, (at["switch_m"], at["switch_velocity_mps"])):
        problems.append("integrating the arcs does not lead to the switch")
    foot = at["next_foot_m"][:2]
    if push.time_s >= first:
        place, speed = _integrated(switch, foot, rest)
        switch = place, speed + jump
    if not _same(_integrated(switch, foot, push.after), (at["next_com_m"][:2], at["next_velocity_mps"])):
        problems.append("integrating the arcs does not lead to the next apex")
    return problems


def _plan(step: Step, push: Push, robot_radps: float, ahead: Vector, left: Vector) -> list[str]:
    """Check that the planned step leads to its apex when nobody pushes."""
    at, (first, second) = step.vectors, push.planned_halves_s
    state = _integrated((at["com_m"][:2], at["velocity_mps"]), at["foot_m"][:2], [(first, robot_radps)])
    place, speed = _integrated(state, push.planned_foot_m[:2], [(second, robot_radps)])
    over = float((place - push.planned_foot_m[:2]) @ ahead)
    if max(abs(over), abs(float(speed @ ahead) - push.planned_speed_mps), abs(float(speed @ left))) > TOLERANCE:
        return ["the plan does not lead over its own foot"]
    gap = (push.planned_foot_m - push.planned_waypoint_m)[:2]
    return [] if abs(float(gap @ ahead)) < TOLERANCE else ["the planned foot is not at the planned waypoint"]


def _placement(scene: Scene, claims: Claims, step: Step, push: Push, ahead: Vector, left: Vector) -> list[str]:
    """Check the foot against the waypoint, and what the log credits with the recovery."""
    problems, cell = [], claims.walking["fine_cell_m"]
    at = step.vectors
    gap = (at["next_foot_m"] - at["next_waypoint_m"])[:2]
    heading = step.numbers["yaw_rad"] - scene.frame.rotation_rad
    if abs(float(gap @ ahead)) > 0.5 * cell * (abs(math.cos(heading)) + abs(math.sin(heading))) + TOLERANCE:
        problems.append("the foot is too far ahead of its waypoint, or behind it")
    speed = step.numbers["next_apex_speed_mps"]
    shift = (at["next_foot_m"] - push.planned_foot_m)[:2]
    if push.time_s >= push.planned_halves_s[0] and float(np.abs(shift).max()) > TOLERANCE:
        problems.append("a foot that stood was moved")
    near = abs(float(shift @ ahead)) <= TOLERANCE
    kept = float(np.abs(at["next_waypoint_m"] - push.planned_waypoint_m).max()) <= TOLERANCE
    aside = abs(float(shift @ left)) - 0.5 * cell
    caught = push.jump_mps[1] != 0 and (push.time_s >= push.planned_halves_s[0] or aside > 0)
    law = push.window_mps is not None and all(
        OMEGAS_RADPS[0] - 1e-9 <= w <= OMEGAS_RADPS[1] + 1e-9 for _, w in (*push.before, *push.after)
    )
    met = push.window_mps is not None and (
        push.window_mps[0] - WINDOW_TOLERANCE_MPS <= speed <= push.window_mps[1] + WINDOW_TOLERANCE_MPS
    )
    unclear = abs(aside) < TOLERANCE and push.jump_mps[1] != 0
    if push.region != (law and met and near and kept and not caught) and not unclear:
        problems.append("the recovery is not what windows, foot and waypoint say")
    return problems


def _flag(scene: Scene, step: Step) -> str:
    """Return the transition flag of a step."""
    heading = step.numbers["yaw_rad"] - scene.frame.rotation_rad
    rows, columns = step.moved
    along = step.sagittal + math.cos(heading) * columns - math.sin(heading) * rows
    aside = step.lateral - math.cos(heading) * rows - math.sin(heading) * columns
    if abs(along) > 0.5:
        return "forward" if along > 0 else "backward"
    if abs(aside) > 0.5:
        return "left" if aside > 0 else "right"
    return "nominal"


def _integrated(
    state: tuple[Vector, Vector], foot: Vector, arcs: Iterable[tuple[float, float]]
) -> tuple[Vector, Vector]:
    """Integrate the pendulum over arcs of one omega each."""
    x, v = state
    for duration, omega in arcs:
        count = max(1, math.ceil(min(abs(duration), 10.0) / SUBSTEP_S))
        x, v = runge_kutta(x, v, foot, omega * omega, duration / count, count)
    return x, v


def _same(one: tuple[Vector, Vector], other: tuple[Vector, Vector]) -> bool:
    return all(float(np.abs(a - b).max()) <= TOLERANCE for a, b in zip(one, other, strict=True))

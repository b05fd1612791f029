"""Logged steps: one as curves in time, pushed ones included, and which of a run show its walking best."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace

import numpy as np
from numpy.typing import NDArray

from surefoot.frames import Foot
from surefoot.missions.biped.run_log import Run, Step, StepPush
from surefoot.viewer.sources.com_paths import orbit
from surefoot.walking import Trajectory, WalkingStep, sample_trajectory

Array = NDArray[np.float64]
_STRETCH_STEPS = 5
_NAMES = tuple(field.name for field in fields(WalkingStep))


def walking_step(step: Step) -> WalkingStep:
    """Return the planner's value of a logged step."""
    given = {name: getattr(step, name) for name in _NAMES if hasattr(step, name)}
    return WalkingStep(**{**given, "stance": Foot[step.stance.upper()]})


def step_curves(step: Step, rate_hz: float) -> Trajectory:
    """Return CoM and feet of a step, from the beginning of its double support; positions in map coordinates.

    The CoM of a pushed step follows the pendulum with the rates of the log; its feet go as in a step that nothing
    pushed, since the log leaves open how the foot in the air got where it landed.
    """
    curves = sample_trajectory(walking_step(step), rate_hz)
    if step.push is None:
        return curves
    rise_s = step.rise_s or 0.0
    walking = (curves.time_s >= rise_s) & (curves.time_s <= rise_s + step.first_half_s + step.second_half_s)
    com = curves.com_m.copy()
    com[walking, :2] = _pushed_com(step, step.push, curves.time_s[walking] - rise_s)
    return replace(curves, com_m=com)


def _pushed_com(step: Step, push: StepPush, time_s: Array) -> Array:
    """Return the CoM at moments since the start apex: arcs about the feet, with the push between two of them."""
    before = list(push.omegas_before_switch)
    arcs = [(push.time_s if before else step.first_half_s, step.omega_radps, step.foot_m[:2])]
    arcs += [(*arc, step.foot_m[:2]) for arc in before]
    if not before:
        arcs.append((push.time_s - step.first_half_s, step.omega_radps, step.next_foot_m[:2]))
    pushed_at = len(arcs) if not before else 1
    arcs += [(*arc, step.next_foot_m[:2]) for arc in push.omegas_after_switch]
    place, speed = np.array(step.com_m[:2]), np.array(step.velocity_mps)
    path, begin_s = np.tile(place, (len(time_s), 1)), 0.0
    for number, (duration_s, omega_radps, foot_m) in enumerate(arcs):
        if number == pushed_at:
            speed = speed + in_world(step.yaw_rad, push.jump_mps)
        for at in np.flatnonzero(time_s >= begin_s):
            path[at] = orbit(tuple(place), tuple(speed), foot_m, omega_radps, time_s[at] - begin_s, 2)[0][-1]
        ends, speeds = orbit(tuple(place), tuple(speed), foot_m, omega_radps, duration_s, 2)
        place, speed, begin_s = ends[-1], speeds[-1], begin_s + duration_s
    return path


def in_world(yaw_rad: float, ahead_left: tuple[float, float]) -> Array:
    """Return a vector ahead and to the left of a heading in map coordinates, shape (2,)."""
    c, s = np.cos(yaw_rad), np.sin(yaw_rad)
    ahead, left = ahead_left
    return np.array([c * ahead - s * left, s * ahead + c * left])


def straight_stretch(steps: Sequence[Step], count: int = _STRETCH_STEPS) -> tuple[Step, ...]:
    """Return the middle of the longest stretch without heading changes, starts and stops."""
    stretches: list[list[Step]] = [[]]
    for step in steps:
        if step.heading_change_rad or step.rise_s is not None or step.rest_s is not None:
            stretches.append([])
        else:
            stretches[-1].append(step)
    longest = max(stretches, key=len)
    begin = max(0, (len(longest) - count) // 2)
    return tuple(longest[begin : begin + count])


def turn_stretch(steps: Sequence[Step]) -> tuple[Step, ...]:
    """Return the first whole turn that is not the start of the run, with the step before it and the step after it."""
    for begin, step in enumerate(steps):
        if begin and step.heading_change_rad and not steps[begin - 1].heading_change_rad:
            end = begin
            while end < len(steps) and steps[end].heading_change_rad:
                end += 1
            if end < len(steps):
                return tuple(steps[begin - 1 : end + 1])
    return ()


def stretch_before_stop(run: Run, count: int = _STRETCH_STEPS) -> tuple[Step, ...]:
    """Return the last steps before the first moment without a safe step."""
    before = [step for step in run.steps if step.step < run.unsafe[0].step] if run.unsafe else []
    return tuple(before[-count:])

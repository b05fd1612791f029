"""A walking step as curves in time: the CoM and both feet."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.frames import Foot
from surefoot.walking.state import Point
from surefoot.walking.step import WalkingStep
from surefoot.walking.swing import SwingHalf, apex_swing, cubic

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Trajectory:
    """Samples of a step; arrays of points have the shape (n, 3), map coordinates.

    Attributes:
        time_s: from the beginning of the step, first and last moment included.
        com_m: CoM.
        com_velocity_mps: its velocity.
        left_foot_m: left foot.
        left_foot_velocity_mps: its velocity.
        right_foot_m: right foot.
        right_foot_velocity_mps: its velocity.
    """

    time_s: Array
    com_m: Array
    com_velocity_mps: Array
    left_foot_m: Array
    left_foot_velocity_mps: Array
    right_foot_m: Array
    right_foot_velocity_mps: Array


def sample_trajectory(step: WalkingStep, rate_hz: float) -> Trajectory:
    """Sample a step: rise (of a start), first half, second half, rest (of a stop).

    Args:
        step: what to sample.
        rate_hz: about how many samples a second; the moments are equidistant and include both ends.

    Source: Shamsah et al., T-RO 2023, Appendix A; docs/formats.md, section 3 for double support and heights.
    """
    count = max(2, math.ceil(step.duration_s * rate_hz) + 1)
    time = np.linspace(0.0, step.duration_s, count)
    com, com_velocity = _com(step, time)
    stance, swing = _feet(step, time)
    left, right = (stance, swing) if step.stance is Foot.LEFT else (swing, stance)
    arrays = (time, com, com_velocity, *left, *right)
    for array in arrays:
        array.flags.writeable = False
    return Trajectory(*arrays)


def _com(step: WalkingStep, time: Array) -> tuple[Array, Array]:
    """Return position and velocity of the CoM."""
    position, velocity = np.empty((time.size, 3)), np.zeros((time.size, 3))
    rise, walk = step.rise_s or 0.0, step.first_half_s + step.second_half_s
    before, after = time < rise, (time > rise + walk) & (step.rest_s is not None)
    during = ~(before | after)
    zero = (0.0, 0.0, 0.0)
    if step.rise_com_m is not None:
        u = time[before] / rise
        position[before], velocity[before] = _cubic_3d(
            u, rise, step.rise_com_m, zero, step.com_m, (*step.velocity_mps, 0.0)
        )
    if step.rest_com_m is not None and step.rest_s is not None:
        u = (time[after] - rise - walk) / step.rest_s
        position[after], velocity[after] = _cubic_3d(
            u, step.rest_s, step.next_com_m, (*step.next_velocity_mps, 0.0), step.rest_com_m, zero
        )
    position[during], velocity[during] = _single_support(step, np.clip(time[during] - rise, 0.0, walk))
    return position, velocity


def _cubic_3d(
    u: Array, duration_s: float, begin: Point, begin_rate: Point, end: Point, end_rate: Point
) -> tuple[Array, Array]:
    axes = [cubic(u, duration_s, begin[i], begin_rate[i], end[i], end_rate[i]) for i in range(3)]
    return np.stack([value for value, _ in axes], axis=1), np.stack([rate for _, rate in axes], axis=1)


def _single_support(step: WalkingStep, time: Array) -> tuple[Array, Array]:
    """Return the CoM between the apexes; each half is integrated from its apex, which keeps rounding small."""
    position, velocity = np.empty((time.size, 3)), np.empty((time.size, 3))
    omega, total = step.omega_radps, step.first_half_s + step.second_half_s
    first = (time <= step.first_half_s)[:, None]
    ahead, back = omega * time[:, None], omega * (time[:, None] - total)
    for begin, speed, foot, angle, part in (
        (step.com_m, step.velocity_mps, step.foot_m, ahead, first),
        (step.next_com_m, step.next_velocity_mps, step.next_foot_m, back, ~first),
    ):
        offset = np.array(begin[:2]) - np.array(foot[:2])
        rate = np.array(speed) / omega
        angle = np.where(part, angle, 0.0)
        value = np.array(foot[:2]) + offset * np.cosh(angle) + rate * np.sinh(angle)
        slope = omega * (offset * np.sinh(angle) + rate * np.cosh(angle))
        position[:, :2] = np.where(part, value, position[:, :2])
        velocity[:, :2] = np.where(part, slope, velocity[:, :2])
    phase = np.pi * time / total
    half = 0.5 * (step.next_com_m[2] - step.com_m[2])
    position[:, 2] = step.com_m[2] + half * (1 - np.cos(phase))
    velocity[:, 2] = half * np.pi / total * np.sin(phase)
    return position, velocity


def _feet(step: WalkingStep, time: Array) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Return position and velocity of the foot that stands first, and of the one that swings first."""
    rise = step.rise_s or 0.0
    landing, total = rise + step.first_half_s, rise + step.first_half_s + step.second_half_s
    zero = (0.0, 0.0, 0.0)
    first = SwingHalf(
        step.swing_from_m,
        step.swing_velocity_mps,
        step.next_foot_m,
        zero,
        step.first_half_s,
        lifted=step.rise_s is not None,
        landed=True,
    )
    middle, middle_velocity = apex_swing(
        step.foot_m, step.next_foot_m, step.yaw_rad, step.stance.side, step.next_apex_speed_mps
    )
    closing = step.closing_foot_m
    second = SwingHalf(
        step.foot_m,
        zero,
        middle if closing is None else closing,
        middle_velocity if closing is None else zero,
        step.second_half_s,
        lifted=True,
        landed=closing is not None,
    )
    stance, swing = second.at(time - landing), first.at(time - rise)
    _hold(stance, time <= landing, step.foot_m)
    _hold(stance, time >= total, closing)
    _hold(swing, time >= landing, step.next_foot_m)
    _hold(swing, time <= rise, step.swing_from_m if step.rise_s is not None else None)
    return stance, swing


def _hold(foot: tuple[Array, Array], when: NDArray[np.bool_], place_m: Point | None) -> None:
    """Let a foot stand still at a place."""
    if place_m is not None:
        foot[0][when], foot[1][when] = place_m, 0.0

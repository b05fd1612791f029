"""Timed double support: how the CoM comes to rest after a stop, and how it leaves rest before a start.

The CoM moves on a cubic per axis. Its centre of pressure p = x - x'' / omega^2 has to stay in the hull of both feet,
which stand side by side, so that the hull is a rectangle; the duration is the shortest of a row that does it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from surefoot.robots.biped import Biped

MARGIN_M = 0.005
DURATIONS_S = tuple(tenths / 10 for tenths in range(6, 41))


@dataclass(frozen=True, slots=True)
class Rest:
    """How a robot comes to rest after a stop, in the frame of the step.

    Attributes:
        duration_s: of the double support.
        com_left_m: lateral place of the CoM at rest, between the feet.
        closing_left_m: lateral place where the other foot was set down.
    """

    duration_s: float
    com_left_m: float
    closing_left_m: float


def rest_after(foot_left_m: float, com_left_m: float, dy2_m: float, speed_mps: float, robot: Biped) -> Rest | None:
    """Return how the robot comes to rest from its final apex; None if nothing is safe.

    The closing foot stands beside the other one, at a distance of two ``dy2_m`` unless the CoM is far from its foot.
    """
    dy2 = foot_left_m - com_left_m
    apart = math.copysign(max(2 * dy2_m, abs(dy2) + dy2_m), dy2)
    closing, rest = foot_left_m - apart, foot_left_m - 0.5 * apart
    duration = shift_duration_s(foot_left_m, closing, speed_mps, com_left_m, rest, robot)
    return None if duration is None else Rest(duration, rest, closing)


def shift_duration_s(
    foot_left_m: float,
    other_left_m: float,
    speed_mps: float,
    apex_left_m: float,
    rest_left_m: float,
    robot: Biped,
) -> float | None:
    """Return how long the CoM takes between an apex and rest, both above the feet sagittally; None if nothing is safe.

    A stop and a start with the same numbers are each other's mirror image in time, with the same accelerations.

    Args:
        foot_left_m: lateral place of one foot; both have the same sagittal place.
        other_left_m: of the other one.
        speed_mps: sagittal speed at the apex.
        apex_left_m: lateral place of the CoM at the apex.
        rest_left_m: lateral place at rest.
        robot: its feet and its pendulum.
    """
    omega = robot.omega_radps
    reach = robot.foot_half_length_m - MARGIN_M
    right = min(foot_left_m, other_left_m) - robot.foot_half_width_m + MARGIN_M
    left = max(foot_left_m, other_left_m) + robot.foot_half_width_m - MARGIN_M
    for duration in DURATIONS_S:
        ahead = pressure_range(0.0, speed_mps, 0.0, 0.0, duration, omega)
        aside = pressure_range(apex_left_m, 0.0, rest_left_m, 0.0, duration, omega)
        if -reach <= ahead[0] and ahead[1] <= reach and right <= aside[0] and aside[1] <= left:
            return duration
    return None


def pressure_range(
    begin_m: float, begin_mps: float, end_m: float, end_mps: float, time_s: float, omega_radps: float
) -> tuple[float, float]:
    """Return the least and the largest centre of pressure on the cubic between two states.

    With u from 0 to 1, x = x0 + f u + b u^2 + a u^3 and p = x - (2 b + 6 a u) / (omega T)^2.
    """
    rise, first, last = end_m - begin_m, begin_mps * time_s, end_mps * time_s
    a, b = first + last - 2 * rise, 3 * rise - 2 * first - last
    scale = 1 / (omega_radps * time_s) ** 2

    def pressure(u: float) -> float:
        return begin_m + u * (first + u * (b + u * a)) - scale * (2 * b + 6 * a * u)

    values = [pressure(0.0), pressure(1.0)]
    values += [pressure(u) for u in _roots(3 * a, 2 * b, first - 6 * a * scale) if 0 < u < 1]
    return min(values), max(values)


def _roots(a: float, b: float, c: float) -> tuple[float, ...]:
    """Return the real roots of a u^2 + b u + c."""
    if abs(a) < 1e-15:
        return () if abs(b) < 1e-15 else (-c / b,)
    square = b * b - 4 * a * c
    if square < 0:
        return ()
    root = math.sqrt(square)
    return (-b - root) / (2 * a), (-b + root) / (2 * a)

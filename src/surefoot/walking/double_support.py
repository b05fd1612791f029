"""Timed double support: how the CoM comes to rest after a stop, and how it leaves rest before a start.

The CoM moves on a cubic per axis. Its centre of pressure p = x - x'' / omega^2 has to stay in the hull of both feet, which stand
side by side, so that the hull is a rectangle; the duration is the shortest of a row that does it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

MARGIN_M = 0.005
_SHORTEST_S = 0.6
_LONGEST_S = 4.0
_STEP_S = 0.1


@dataclass(frozen=True, slots=True)
class Support:
    """The hull of two feet side by side, in the frame of the heading with the origin between their sagittal centres.

    Attributes:
        half_length_m: of a foot.
        right_m: lateral coordinate of the hull's right border.
        left_m: of its left border.
    """

    half_length_m: float
    right_m: float
    left_m: float


def support_of(foot_left_m: float, other_left_m: float, half_length_m: float, half_width_m: float) -> Support:
    """Return the hull of two feet with the same sagittal coordinate."""
    right, left = sorted((foot_left_m, other_left_m))
    return Support(half_length_m, right - half_width_m, left + half_width_m)


def duration_s(
    support: Support, speed_mps: float, apex_left_m: float, rest_left_m: float, omega_radps: float
) -> float | None:
    """Return how long the CoM takes between an apex and rest, both above the feet sagittally; None if nothing is safe.

    A stop and a start with the same numbers are each other's mirror image in time, with the same accelerations.

    Args:
        support: the hull of the feet.
        speed_mps: sagittal speed at the apex.
        apex_left_m: lateral place of the CoM at the apex.
        rest_left_m: lateral place at rest.
        omega_radps: rate of the pendulum.
    """
    duration = _SHORTEST_S
    while duration <= _LONGEST_S + 1e-9:
        ahead = pressure_range(0.0, speed_mps, 0.0, 0.0, duration, omega_radps)
        aside = pressure_range(apex_left_m, 0.0, rest_left_m, 0.0, duration, omega_radps)
        if (
            max(-ahead[0], ahead[1]) <= support.half_length_m - MARGIN_M
            and aside[0] >= support.right_m + MARGIN_M
            and aside[1] <= support.left_m - MARGIN_M
        ):
            return round(duration, 9)
        duration += _STEP_S
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

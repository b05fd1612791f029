"""Curves of the foot in the air, continuous in position and velocity from step to step.

A foot is lifted at a switch, passes beside the stance foot at the next apex, high enough for any step that may come,
and is set down at the next switch. Horizontally each half is a cubic; its height rises by half a cosine in the first
part of the half in which it is lifted, and falls by half a cosine in the last part of the half in which it is set
down, so that it has height where it crosses a riser.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.walking.state import Point

CLEARANCE_M = 0.15
HIGHEST_STEP_M = 0.2
"""No step climbs more; at the apex the foot in the air is so much, and the clearance, above the higher of both feet."""
_BESIDE_M = 0.27
_RISING_PART = 0.6
_SPEED_RATIO = 2.0

Array = NDArray[np.float64]


def apex_swing(lift_m: Point, stance_m: Point, yaw_rad: float, side: int, apex_speed_mps: float) -> tuple[Point, Point]:
    """Return where a swing foot is at an apex, and how fast it moves there.

    Args:
        lift_m: where it stood before.
        stance_m: the foot that carries the robot.
        yaw_rad: heading.
        side: of the swing foot, left +1.
        apex_speed_mps: of the CoM; the foot is twice as fast.
    """
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    height = max(lift_m[2], stance_m[2]) + CLEARANCE_M + HIGHEST_STEP_M
    position = (stance_m[0] - sin * side * _BESIDE_M, stance_m[1] + cos * side * _BESIDE_M, height)
    speed = _SPEED_RATIO * apex_speed_mps
    return position, (speed * cos, speed * sin, 0.0)


@dataclass(frozen=True, slots=True)
class SwingHalf:
    """The curve of a foot in the air over half a step.

    Attributes:
        begin_m: where it starts.
        begin_velocity_mps: its velocity there.
        end_m: where it ends.
        end_velocity_mps: its velocity there.
        duration_s: how long it takes.
        lifted: it stands on the ground at the beginning.
        landed: it stands on the ground at the end.
    """

    begin_m: Point
    begin_velocity_mps: Point
    end_m: Point
    end_velocity_mps: Point
    duration_s: float
    lifted: bool
    landed: bool

    def at(self, time_s: Array) -> tuple[Array, Array]:
        """Return positions and velocities, shape (n, 3), at times counted from the beginning of the half."""
        u = np.clip(time_s / self.duration_s, 0.0, 1.0)
        position, velocity = np.empty((u.size, 3)), np.empty((u.size, 3))
        for axis in range(2):
            position[:, axis], velocity[:, axis] = cubic(
                u,
                self.duration_s,
                self.begin_m[axis],
                self.begin_velocity_mps[axis],
                self.end_m[axis],
                self.end_velocity_mps[axis],
            )
        position[:, 2], velocity[:, 2] = self._height(u)
        return position, velocity

    def _height(self, u: Array) -> tuple[Array, Array]:
        begin, end = self.begin_m[2], self.end_m[2]
        if self.lifted and self.landed:
            top = max(begin, end) + CLEARANCE_M
            up, up_rate = _half_cosine(np.clip(u / 0.5, 0.0, 1.0), 0.5 * self.duration_s)
            down, down_rate = _half_cosine(np.clip(u / 0.5 - 1.0, 0.0, 1.0), 0.5 * self.duration_s)
            return begin + (top - begin) * up + (end - top) * down, (top - begin) * up_rate + (end - top) * down_rate
        start = 0.0 if self.lifted else 1.0 - _RISING_PART
        part, rate = _half_cosine(np.clip((u - start) / _RISING_PART, 0.0, 1.0), _RISING_PART * self.duration_s)
        return begin + (end - begin) * part, (end - begin) * rate


def cubic(
    u: Array, duration_s: float, begin: float, begin_rate: float, end: float, end_rate: float
) -> tuple[Array, Array]:
    """Return values and rates of the cubic that matches value and rate at both ends; u runs from 0 to 1."""
    rise, first, last = end - begin, begin_rate * duration_s, end_rate * duration_s
    a, b = first + last - 2 * rise, 3 * rise - 2 * first - last
    value = begin + u * (first + u * (b + u * a))
    return value, (first + u * (2 * b + 3 * u * a)) / duration_s


def _half_cosine(u: Array, duration_s: float) -> tuple[Array, Array]:
    """Return the rise from 0 to 1 of half a cosine, and its rate."""
    return 0.5 * (1 - np.cos(np.pi * u)), 0.5 * np.pi / duration_s * np.sin(np.pi * u)

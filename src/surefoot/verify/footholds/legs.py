"""Where the legs of a quadruped reach: its joints, and the half-spaces of ``joint_reach``; from docs/footholds.md."""

from __future__ import annotations

from typing import Any

import numpy as np

from surefoot.robots.legs import Legs, legs_of
from surefoot.verify.footholds.file import Array, FootholdFile


def legs_in(plan: FootholdFile) -> Legs:
    """Return the legs of a plan's robot."""
    robot: dict[str, Any] = plan.values["robot"]
    x, y, z = (float(value) for value in robot["foot_reference_m"])
    return legs_of(str(robot["name"]), (x, y, z), float(robot["hip_offset_m"]), float(robot["link_m"]))


def half_space(plan: FootholdFile, nominal_m: Array, foot: int, number: int) -> tuple[Array, float]:
    """Return a normal and a bound in the base frame: inside of all four of a foot no leg is stretched too far.

    A ball about the hip, over four quarters of the reach box: its tangent below the middle of a quarter, raised by the
    largest error of the four tangents in the corners of their quarters.
    """
    own = legs_in(plan)
    hip, limit = own.hips_m[foot], float(own.limits_rad[foot, 2, 1])
    square = (2 * own.link_m * np.cos(limit / 2)) ** 2 + own.hip_offset_m**2
    x, y, _ = nominal_m[foot] - hip
    a, b, _ = (float(value) / 2 for value in plan.values["robot"]["foot_reach_m"])
    places = [(x + sx * a, y + sy * b) for sx in (-1, 1) for sy in (-1, 1)]
    worst = 0.0
    for u, v in places:
        depth = np.sqrt(square - u * u - v * v)
        for p, q in ((u + sx * a, v + sy * b) for sx in (-1, 1) for sy in (-1, 1)):
            worst = max(worst, float((square - u * p - v * q) / depth - np.sqrt(square - p * p - q * q)))
    u, v = places[number]
    depth = float(np.sqrt(square - u * u - v * v))
    normal = np.array([u / depth, v / depth, -1.0])
    return normal, float(square / depth - worst + normal @ hip)

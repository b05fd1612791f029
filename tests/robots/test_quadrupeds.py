from __future__ import annotations

import math

import numpy as np
import pytest

from surefoot.errors import InputError
from surefoot.robots.quadruped import FOOT_SIGNS, Quadruped, quadruped


@pytest.mark.parametrize("name", ["go2", "chotu"])
def test_feet_are_mirrored(name: str) -> None:
    robot = quadruped(name)
    x, y, z = robot.foot_reference_m
    assert robot.feet_m == ((x, y, z), (x, -y, z), (-x, y, z), (-x, -y, z))


@pytest.mark.parametrize("name", ["go2", "chotu"])
def test_jacobians_are_the_derivatives_of_the_leg(name: str) -> None:
    robot = quadruped(name)
    step = 1e-6
    for (_, side), jacobian in zip(FOOT_SIGNS, robot.jacobians, strict=True):
        for joint in range(3):
            shift = step * np.eye(3)[joint]
            joints = np.array(robot.joint_reference_rad)
            slope = (foot(robot, side, joints + shift) - foot(robot, side, joints - shift)) / (2 * step)
            assert np.array(jacobian)[:, joint] == pytest.approx(slope, abs=1e-8)


def foot(robot: Quadruped, side: int, joints: np.ndarray) -> np.ndarray:
    """Return where the foot is below the hip, by angles of thigh and shank in the leg's plane."""
    q0, q1, q2 = joints
    x = -robot.link_m * (math.sin(q1) + math.sin(q1 + q2))
    y, z = side * robot.hip_offset_m, -robot.link_m * (math.cos(q1) + math.cos(q1 + q2))
    return np.array([x, math.cos(q0) * y - math.sin(q0) * z, math.sin(q0) * y + math.cos(q0) * z])


def test_unknown_robots_are_refused_with_those_that_exist() -> None:
    with pytest.raises(InputError, match="go2, chotu"):
        quadruped("spot")

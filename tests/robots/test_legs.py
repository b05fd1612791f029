"""Legs of quadrupeds: angles and feet belong together, limits hold, and what is out of reach is said."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from surefoot.robots import quadruped
from surefoot.robots.legs import JOINTS, legs, legs_of

GO2 = legs(quadruped("go2"))
ABDUCTION, LEANING, KNEE = st.floats(-0.9, 0.9), st.floats(-0.8, 0.8), st.floats(-2.6, -0.9)


@given(st.lists(st.tuples(ABDUCTION, LEANING, KNEE), min_size=4, max_size=4))
def test_the_angles_of_feet_below_the_hips_put_them_where_they_are(angles: list[tuple[float, float, float]]) -> None:
    """A leg that leans by less than a right angle has one set of angles for its foot."""
    given_rad = np.array([(abduction, leaning - knee / 2, knee) for abduction, leaning, knee in angles])[None]
    found_rad, away_m = GO2.joints_rad(GO2.feet_m(given_rad))
    assert away_m.max() < 1e-9
    assert np.abs(found_rad - given_rad).max() < 1e-6


@given(st.lists(st.tuples(*[st.floats(-1.0, 1.0)] * 3), min_size=4, max_size=4))
def test_limits_hold_and_the_distance_is_what_is_missing(feet: list[tuple[float, float, float]]) -> None:
    feet_m = np.array(feet)[None]
    angles, away_m = GO2.joints_rad(feet_m)
    assert (angles >= GO2.limits_rad[..., 0] - 1e-12).all()
    assert (angles <= GO2.limits_rad[..., 1] + 1e-12).all()
    assert away_m == pytest.approx(np.linalg.norm(GO2.feet_m(angles) - feet_m, axis=2), abs=1e-12)


def test_a_stretched_leg_points_to_a_foot_that_is_too_low() -> None:
    feet_m = GO2.hips_m + np.array([(0.0, side * GO2.hip_offset_m, -0.6) for side in (1, -1, 1, -1)])
    angles, away_m = GO2.joints_rad(feet_m[None])
    longest_m = 2 * GO2.link_m * np.cos(0.83776 / 2)
    assert away_m[0] == pytest.approx(np.full(4, 0.6 - longest_m))
    assert GO2.feet_m(angles)[0, :, :2] == pytest.approx(feet_m[:, :2], abs=1e-9)


@pytest.mark.parametrize("name", ["go2", "chotu"])
def test_the_jacobians_of_the_programs_are_those_of_these_legs(name: str) -> None:
    robot = quadruped(name)
    leg, at, step = legs(robot), np.tile(robot.joint_reference_rad, (1, 4, 1)), 1e-6
    for joint in range(3):
        ahead = np.zeros((1, 4, 3))
        ahead[..., joint] = step
        slope = (leg.feet_m(at + ahead) - leg.feet_m(at - ahead))[0] / (2 * step)
        assert slope == pytest.approx(np.array(robot.jacobians)[:, :, joint], abs=1e-8)


def test_legs_of_another_robot_hang_straight_down() -> None:
    other = legs_of("mule", (0.3, 0.2, -0.5), 0.1, 0.3)
    feet_m = other.feet_m(np.zeros((1, 4, 3)))[0]
    assert feet_m.tolist() == [
        pytest.approx([x, y, -0.6]) for x, y in ((0.3, 0.2), (0.3, -0.2), (-0.3, 0.2), (-0.3, -0.2))
    ]
    assert "straight down" in other.source


def test_joints_are_named_leg_by_leg() -> None:
    assert len(set(JOINTS)) == 12
    assert JOINTS[:3] == ("FL_hip_joint", "FL_thigh_joint", "FL_calf_joint")

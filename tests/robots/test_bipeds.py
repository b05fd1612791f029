"""The numbers of the bipeds."""

from __future__ import annotations

import math

import pytest

from surefoot.errors import InputError
from surefoot.robots import biped


@pytest.mark.parametrize("name", ["digit", "cassie"])
def test_a_biped_has_sensible_numbers_with_a_source(name: str) -> None:
    robot = biped(name)
    assert robot.name == name
    assert robot.omega_radps == pytest.approx(3.15585, abs=1e-5)  # 9.81 over 0.985 m
    half_diagonal_m = math.hypot(robot.foot_half_length_m, robot.foot_half_width_m)
    assert robot.foot_half_width_m < robot.foot_half_length_m <= robot.foot_radius_m <= half_diagonal_m
    assert "Foot" in robot.source


def test_an_unknown_name_lists_those_that_exist() -> None:
    with pytest.raises(InputError, match="no robot 'atlas'; there are: digit, cassie") as caught:
        biped("atlas")
    assert caught.value.key == "robot"

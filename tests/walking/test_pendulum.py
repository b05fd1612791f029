from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from surefoot.walking.pendulum import (
    growth_to,
    growth_to_apex,
    next_lateral_foot,
    propagate,
    switch_position,
    switch_speed,
)

OMEGA = math.sqrt(9.81 / 0.985)
offsets = st.floats(-0.3, 0.3)
speeds = st.floats(0.2, 0.7)


def integrated(position: float, speed: float, foot: float, time_s: float, steps: int = 400) -> tuple[float, float]:
    """Integrate x'' = omega^2 (x - foot) by the classical method of Runge and Kutta."""
    state, h = np.array([position, speed]), time_s / steps

    def rate(s: np.ndarray) -> np.ndarray:
        return np.array([s[1], OMEGA**2 * (s[0] - foot)])

    for _ in range(steps):
        a = rate(state)
        b = rate(state + h / 2 * a)
        c = rate(state + h / 2 * b)
        state = state + h / 6 * (a + 2 * b + 2 * c + rate(state + h * c))
    return float(state[0]), float(state[1])


@settings(deadline=None)
@given(offsets, st.floats(-0.7, 0.7), offsets, st.floats(0.01, 1.0))
def test_propagation_solves_the_equation_of_motion(x: float, v: float, foot: float, time_s: float) -> None:
    assert propagate(x, v, foot, OMEGA, math.exp(OMEGA * time_s)) == pytest.approx(
        integrated(x, v, foot, time_s), abs=1e-8
    )


@settings(deadline=None)
@given(st.floats(-0.05, 0.05), speeds, st.floats(-0.06, 0.06), st.floats(0.25, 0.55), speeds)
def test_both_orbits_meet_at_the_switch(x: float, v: float, foot: float, length: float, v_next: float) -> None:
    at = switch_position(x, v, foot, length, v_next, length, OMEGA)
    assume(x - foot + v / OMEGA > 0.01)
    assume(max(x, foot) + 0.01 < at < length - 0.01)
    fast = switch_speed(x, v, foot, at, OMEGA)
    first = math.log(growth_to(x, v, foot, at, fast, OMEGA)) / OMEGA
    second = math.log(growth_to_apex(at, length, v_next, OMEGA)) / OMEGA
    assert integrated(x, v, foot, first) == pytest.approx((at, fast), abs=1e-7)
    assert integrated(at, fast, length, second) == pytest.approx((length, v_next), abs=1e-6)


@settings(deadline=None)
@given(offsets, st.floats(-0.8, 0.8), st.floats(0.1, 0.7))
def test_lateral_speed_vanishes_at_the_next_apex(y: float, v: float, time_s: float) -> None:
    foot, apex = next_lateral_foot(y, v, math.exp(OMEGA * time_s), OMEGA)
    end, speed = integrated(y, v, foot, time_s)
    assert speed == pytest.approx(0, abs=1e-6)
    assert end == pytest.approx(apex, abs=1e-7)


@settings(deadline=None)
@given(st.floats(0.02, 0.2), speeds, st.floats(0.2, 0.55))
def test_symmetric_gait_repeats_itself(dy2: float, speed: float, length: float) -> None:
    half = math.asinh(OMEGA * length / 2 / speed) / OMEGA
    foot = dy2 * math.sqrt(1 + (0.5 * OMEGA * length / speed) ** 2)
    y, v = propagate(foot - dy2, 0.0, foot, OMEGA, math.exp(OMEGA * half))
    next_foot, next_apex = next_lateral_foot(y, v, math.exp(OMEGA * half), OMEGA)
    assert next_foot == pytest.approx(-foot, abs=1e-9)
    assert next_apex == pytest.approx(dy2 - foot, abs=1e-9)


def test_falling_back_before_the_foot_is_not_a_number() -> None:
    assert math.isnan(growth_to(-0.2, 0.3, 0.0, 0.1, 0.3, OMEGA))
    assert math.isnan(switch_speed(-0.2, 0.3, 0.0, 0.05, OMEGA))

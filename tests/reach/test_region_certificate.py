"""The certified closed form under zero-order hold: an adversary with its own integration never wins."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surefoot.reach import (
    Certified,
    Disturbance,
    Reading,
    Settings,
    Transition,
    barrier_region,
    certified_region,
)

RATE = Settings(Disturbance(Reading.RATE))
GOLDEN = Transition(0.416, (0.4, 0.6))


def advance(x: float, v: float, foot: float, w: float, d: tuple[float, float], t: float) -> tuple[float, float]:
    """Integrate with constant rates, by growing and falling modes."""
    z, u = x - foot + d[1] / w**2, v + d[0]
    up, down = 0.5 * (z + u / w) * np.exp(w * t), 0.5 * (z - u / w) * np.exp(-w * t)
    return float(foot - d[1] / w**2 + up + down), float(w * (up - down) - d[0])


def walk_ends_well(c: Certified, transition: Transition, x: float, v: float, rng: np.random.Generator) -> bool:
    """Walk against a disturbance at vertices of its bound that changes four times a sample."""
    half, fixed = "first", rng.random() < 0.5
    d = (0.01 * rng.choice([-1, 1]), 0.02 * rng.choice([-1, 1]))
    for _ in range(400):
        if half == "first" and c.switches(x, v):
            half = "second"
        low, high = c.first_half(x) if half == "first" else c.second_half(x)
        if not low - 1e-9 <= v <= high + 1e-9:
            return False
        w, foot = c.omega(x, v, half), transition.first_foot_m if half == "first" else transition.step_length_m
        for _ in range(4):
            if not fixed:
                d = (0.01 * rng.choice([-1, 1]), 0.02 * rng.choice([-1, 1]))
            y, u = advance(x, v, foot, w, d, 0.005)
            if half == "second" and y >= transition.step_length_m:
                a, b = 0.0, 0.005
                for _ in range(60):
                    m = 0.5 * (a + b)
                    a, b = (m, b) if advance(x, v, foot, w, d, m)[0] < transition.step_length_m else (a, m)
                apex = advance(x, v, foot, w, d, a)[1]
                return transition.apex_velocity_mps[0] - 1e-9 <= apex <= transition.apex_velocity_mps[1] + 1e-9
            x, v = y, u
    return False


@pytest.mark.parametrize(
    "transition",
    [GOLDEN, Transition(0.52, (0.45, 0.7)), Transition(0.28, (0.2, 0.4), 0.05), Transition(0.312, (0.2, 0.45), -0.04)],
)
def test_every_edge_and_every_inner_state_meets_the_window(transition: Transition) -> None:
    c = certified_region(transition, RATE)
    assert c.valid, c.reason
    rng = np.random.default_rng(1)
    tried = 0
    while tried < 250:
        x = float(rng.uniform(-0.05, 0.3))
        low, high = c.first_half(x)
        if low > high:
            continue
        share = rng.choice([0.0, 1.0, rng.random()])
        tried += 1
        assert walk_ends_well(c, transition, x, min(low + share * (high - low), high), rng), (x, low, high, share)


def test_it_reaches_95_percent_of_the_exact_areas() -> None:
    area = certified_region(GOLDEN, RATE).area(-0.05)
    assert area["shws"] >= 0.95 * 0.0667
    assert area["fhws"] >= 0.95 * 0.1464


@settings(max_examples=15, deadline=None)
@given(length=st.floats(0.2, 0.6), low=st.floats(0.2, 0.5), width=st.floats(0.02, 0.3), foot=st.floats(-0.05, 0.05))
def test_it_never_goes_beyond_the_outer_bound(length: float, low: float, width: float, foot: float) -> None:
    transition = Transition(length, (low, low + width), foot)
    c = certified_region(transition, RATE)
    if not c.valid:
        assert c.reason
        assert not c.contains(0.0, 0.5)
        assert c.area(-0.05, 11) == {"shws": 0.0, "fhws": 0.0}
        return
    x = np.linspace(-0.05, length, 80)
    least, most = barrier_region(transition, RATE).first_half(x, asymptote_rule=False)
    for at, a, b in zip(x, least, most, strict=True):
        inner, outer = c.first_half(float(at))
        assert inner > outer or (a - 1e-6 <= inner and outer <= b + 1e-6)


@pytest.mark.parametrize(
    ("transition", "asked", "reason"),
    [
        (GOLDEN, Settings(Disturbance(Reading.JUMP)), "jumps"),
        (Transition(1.5, (0.4, 0.6)), RATE, "guard"),
        (GOLDEN, Settings(Disturbance(Reading.RATE), tau_s=0.3), ""),
        (GOLDEN, Settings(Disturbance(Reading.RATE, 0.06, 0.02)), "disturbance"),
        (Transition(0.416, (0.4, 0.6), height_change_m=0.1, level_com=True), RATE, "omegas"),
    ],
)
def test_where_the_proof_does_not_apply_it_says_so(transition: Transition, asked: Settings, reason: str) -> None:
    c = certified_region(transition, asked)
    assert not c.valid
    assert c.reason
    assert reason in c.reason

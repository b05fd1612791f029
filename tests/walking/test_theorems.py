"""Each theorem against what the pendulum does, over more than twenty thousand random cases each."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from surefoot.walking.theorems import (
    apex_margin,
    away_margin,
    heading_margin,
    straight_margin,
    toward_margin,
    turn_away_margin,
    turn_toward_margin,
)

OMEGA = math.sqrt(9.81 / 0.985)
CASES = 30_000
UNDECIDED = 1e-9


def switch(foot: float, speed: float, length: float, next_speed: float) -> float:
    """Return where two orbits meet, from their energies: apex at 0, next apex above its foot at ``length``."""
    first = speed**2 / OMEGA**2 - foot**2
    second = next_speed**2 / OMEGA**2
    # (x - foot)^2 + first = (x - length)^2 + second
    return (length**2 - foot**2 + second - first) / (2 * (length - foot))


def cases(seed: int) -> NDArray[np.float64]:
    """Return rows of speed, next speed, distance, dy2 and turn."""
    low, high = np.array([0.05, 0.05, 0.1, 0.01, 0.05]), np.array([1.2, 1.2, 0.6, 0.3, 1.0])
    return np.asarray(low + (high - low) * np.random.default_rng(seed).random((CASES, 5)))


def test_theorem_iv_1_is_the_switch_between_the_apexes() -> None:
    holds = 0
    for v, w, d, _, _ in cases(1):
        margin = straight_margin(v, w, d, OMEGA)
        if abs(margin) > UNDECIDED:
            assert (margin > 0) == (0 <= switch(0.0, v, d, w) <= d)
            holds += margin > 0
    assert 0.1 * CASES < holds < 0.95 * CASES


@pytest.mark.parametrize("away", [True, False])
def test_corollaries_are_the_switch_between_the_apexes_of_the_new_frame(away: bool) -> None:
    holds = 0
    for v, w, d, dy2, turn in cases(2):
        foot = -dy2 * math.sin(turn) if away else dy2 * math.sin(turn)
        if foot >= d:
            continue
        margin = (turn_away_margin if away else turn_toward_margin)(v, w, d, dy2, turn, OMEGA)
        at = switch(foot, v * math.cos(turn), d, w)
        if abs(margin) > UNDECIDED:
            assert (margin > 0) == (0 <= at <= d)
            holds += margin > 0
    assert 0.1 * CASES < holds < 0.95 * CASES


def test_turn_toward_the_stance_foot_gets_over_it() -> None:
    for v, _, _, dy2, turn in cases(3):
        margin = toward_margin(v, dy2, turn, OMEGA)
        x, speed, foot = 0.0, v * math.cos(turn), dy2 * math.sin(turn)
        later = np.linspace(0.05, 3.0, 60)
        reached = foot + (x - foot) * np.cosh(OMEGA * later) + speed / OMEGA * np.sinh(OMEGA * later)
        if abs(margin) > 1e-4:
            assert (margin > 0) == bool((reached > foot).any())


def test_turn_away_does_not_cross_over_the_stance_foot() -> None:
    for v, _, _, dy2, turn in cases(4):
        margin = away_margin(v, dy2, turn, OMEGA)
        gap, speed = dy2 * math.cos(turn), -v * math.sin(turn)
        later = np.linspace(0.05, 3.0, 60)
        beside = gap * np.cosh(OMEGA * later) + speed / OMEGA * np.sinh(OMEGA * later)
        if abs(margin) > 1e-4:
            assert (margin > 0) == bool((beside > 0).all())


def test_applicable_case_depends_on_the_stance_side() -> None:
    v, w, d, dy2, turn = 0.4, 0.35, 0.4, 0.13, 0.39
    for side in (1.0, -1.0):
        assert heading_margin(v, dy2, side, side * turn, OMEGA) == toward_margin(v, dy2, turn, OMEGA)
        assert heading_margin(v, dy2, side, -side * turn, OMEGA) == away_margin(v, dy2, turn, OMEGA)
        assert heading_margin(v, dy2, side, 0.0, OMEGA) == math.inf
        assert apex_margin(v, w, d, dy2, side, side * turn, OMEGA) == turn_toward_margin(v, w, d, dy2, turn, OMEGA)
        assert apex_margin(v, w, d, dy2, side, -side * turn, OMEGA) == turn_away_margin(v, w, d, dy2, turn, OMEGA)
        assert apex_margin(v, w, d, dy2, side, 0.0, OMEGA) == straight_margin(v, w, d, OMEGA)


def test_worked_example_of_the_paper() -> None:
    """At 0.2 m/s and dy2 = 0.14 m a turn toward the stance foot may be up to 24.36 degrees."""
    for omega, most in ((math.sqrt(9.81 / 0.985), 24.36), (3.15, 24.395)):
        assert toward_margin(0.2, 0.14, math.radians(most - 0.02), omega) > 0
        assert toward_margin(0.2, 0.14, math.radians(most + 0.02), omega) < 0

"""The closed form: an outer bound of the grid's regions, the known formula without disturbance, and screening."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surefoot.errors import InputError
from surefoot.reach import Disturbance, GridSpec, Reading, Settings, Transition, barrier_region, screen, synthesize
from surefoot.reach.barriers import LABEL, screen_arrays

RATE = Settings(Disturbance(Reading.RATE))
GOLDEN = Transition(0.416, (0.4, 0.6))


@settings(max_examples=25, deadline=None)
@given(
    length=st.floats(0.15, 0.6),
    low=st.floats(0.15, 0.5),
    width=st.floats(0.1, 0.4),
    foot=st.floats(-0.05, 0.05),
    reading=st.sampled_from([Reading.RATE, Reading.INSIDE_PHI]),
    size=st.floats(0, 1),
)
def test_no_winning_cell_lies_beyond_the_barriers(
    length: float, low: float, width: float, foot: float, reading: Reading, size: float
) -> None:
    asked = Settings(Disturbance(reading, 0.01 * size, 0.02 * size), grid=GridSpec(0.004, 0.008))
    transition = Transition(length, (low, low + width), foot)
    region, curves = synthesize(transition, asked), barrier_region(transition, asked)
    x = np.array([region.cells.x0_m + i * region.cells.x_step_m for i in range(region.cells.columns)])
    v = region.cells.v0_mps + region.cells.v_step_mps * np.arange(region.cells.rows)
    for (least, most), half in (
        (curves.second_half(x), region.second),
        (curves.first_half(x, asymptote_rule=False), region.first),
    ):
        won = half.won & (x < length - 0.0071)[:, None]
        outside = won & ((v[None, :] < least[:, None] - 1e-9) | (v[None, :] > most[:, None] + 1e-9))
        assert not outside.any()


def test_the_exact_areas_of_the_golden_transition() -> None:
    area = barrier_region(GOLDEN, RATE, at_apex=True).area(-0.05)
    assert area["shws"] == pytest.approx(0.0667, abs=1e-4)
    assert area["fhws"] == pytest.approx(0.1464, rel=0.01)
    grid = synthesize(GOLDEN, Settings(Disturbance(Reading.RATE), grid=GridSpec(0.0005, 0.001))).area
    assert grid["shws"] < area["shws"]
    assert grid["fhws"] < area["fhws"]


def test_without_disturbance_the_second_half_has_the_known_formula() -> None:
    calm = Settings(Disturbance(Reading.RATE, 0.0, 0.0))
    x = np.linspace(0.1, 0.416, 50)
    low, high = barrier_region(GOLDEN, calm, at_apex=True).second_half(x)
    assert low == pytest.approx(np.sqrt(0.4**2 + (2.8 * (x - 0.416)) ** 2))
    assert high == pytest.approx(np.minimum(np.sqrt(0.6**2 + (3.5 * (x - 0.416)) ** 2), 1.1))


@settings(max_examples=100, deadline=None)
@given(length=st.floats(0.1, 0.8), low=st.floats(0.12, 0.6), width=st.floats(0.05, 0.4), foot=st.floats(-0.05, 0.05))
def test_screening_agrees_with_the_region(length: float, low: float, width: float, foot: float) -> None:
    transition = Transition(length, (low, low + width), foot)
    least, most = screen([transition], RATE)[0]
    curves = barrier_region(transition, RATE)
    if least > most:
        assert synthesize(transition, RATE, all_masks=False).first.won[25].sum() == 0
    else:
        low_here, high_here = curves.first_half(np.array([0.0]))
        assert least == pytest.approx(low_here[0])
        assert most == pytest.approx(high_here[0])


def test_steps_that_are_too_fast_are_screened_out() -> None:
    found = screen_arrays(np.array([0.2, 2.5]), np.array([[0.2, 0.4], [0.2, 0.4]]), np.zeros(2), RATE)
    assert found[0, 0] < found[0, 1]
    assert found[1, 0] > found[1, 1]


def test_the_closed_form_is_labelled_as_no_certificate() -> None:
    assert barrier_region(GOLDEN, RATE).label == LABEL
    assert "not a certificate" in LABEL


def test_jumps_have_no_closed_form() -> None:
    with pytest.raises(InputError, match="no closed form"):
        barrier_region(GOLDEN, Settings(Disturbance(Reading.JUMP)))

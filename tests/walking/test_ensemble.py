"""Random command sequences: no step may be unsafe."""

from __future__ import annotations

from collections import Counter

import pytest
from walks import CELL_M, DEFAULTS, DIGIT, Place, command_of, first_place, walk

from surefoot.walking import StepCommand, StepKind, Unsafe, WalkingStep, plan_step, walking_parameters


def unsafe_steps(seeds: int, steps: int, deviations: float, straight: tuple[int, ...] = ()) -> Counter[str]:
    reasons: Counter[str] = Counter()
    for seed in range(seeds):
        for label, step in walk(seed, steps, DEFAULTS, deviations, straight):
            if isinstance(step, Unsafe):
                reasons[f"{label}: {step.reason}"] += 1
    return reasons


@pytest.mark.parametrize("deviations", [0.0, 0.5])
def test_walks_of_equal_straight_steps_with_any_turns_and_stops(deviations: float) -> None:
    assert not unsafe_steps(20, 300, deviations, straight=(4,))


def test_walks_that_mix_straight_lengths_and_may_deviate() -> None:
    assert not unsafe_steps(20, 300, 1.0)


@pytest.mark.campaign
def test_many_walks() -> None:
    assert not unsafe_steps(200, 300, 0.0, straight=(4,))
    assert not unsafe_steps(200, 300, 1.0)


@pytest.mark.parametrize("angle", [15.0, 11.25])
def test_other_turn_angles(angle: float) -> None:
    parameters = walking_parameters(CELL_M, turn_angle_deg=angle)
    for seed in range(4):
        for label, step in walk(seed, 200, parameters, 0.5):
            assert isinstance(step, WalkingStep), (label, step)


def test_lengths_that_alternate_with_the_feet_drift_until_no_step_is_safe() -> None:
    """Left steps longer than right ones move the feet aside, whatever the apex speeds."""
    parameters = walking_parameters(CELL_M, straight_cells=[3, 5])
    place = first_place(parameters)
    command, _ = command_of(place, "start", parameters)
    step = plan_step(place.state, command, parameters, DIGIT)
    for i in range(40):
        if isinstance(step, Unsafe):
            break
        place = Place("walk", step.next_state())
        step = plan_step(
            place.state, StepCommand(StepKind.WALK, (5 if i % 2 else 3) * parameters.fine_cell_m), parameters, DIGIT
        )
    assert isinstance(step, Unsafe)
    assert "safety distance" in step.reason

"""Pushes and many steps: Table I, push maps, capture steps, the library and the robust keyframe policy."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from surefoot.compute import Deadline
from surefoot.errors import InputError, LimitExceeded, UnsafeStepError
from surefoot.reach import (
    Controller,
    Disturbance,
    GridSpec,
    Law,
    Reading,
    Settings,
    Transition,
    capture_foot,
    capture_step,
    composed_library,
    first_foot_after_turn,
    region_library,
    robust_keyframe_policy,
    synthesize,
    table_1,
)
from surefoot.reach.capture import FootMove
from surefoot.reach.ensembles import push_map
from surefoot.reach.library import LibraryStep, action_follows, action_steps
from surefoot.reach.policy import SlopedPendulum
from surefoot.reach.simulation import Ending
from surefoot.reach.winning_sets import KeyframeStep, initial_winning_set
from surefoot.robots import biped
from surefoot.walking import step_library, walking_parameters

RATE = Settings(Disturbance(Reading.RATE))


def test_table_1_is_near_the_paper_and_the_barrier_law_beats_it() -> None:
    table, barrier = table_1(400, seed=3), table_1(400, seed=3, law=Law.BARRIER)
    mean = np.mean([cell.percent for cell in table])
    assert abs(mean - np.mean([cell.paper_percent for cell in table])) < 3
    assert np.mean([cell.percent for cell in barrier]) > 97
    assert table == table_1(400, seed=3)


def test_larger_pushes_succeed_less_often() -> None:
    region = synthesize(Transition(0.416, (0.4, 0.6)), RATE)
    found = push_map(region, (0.0, 0.15, 0.6), samples=5, runs=40)
    assert (found.percent[0] == 100).all()
    assert found.percent[0].mean() > found.percent[1].mean() > found.percent[2].mean()


@given(switch=st.floats(0.1, 0.4), speed=st.floats(0.1, 1.5), apex=st.floats(0.05, 1.5))
def test_the_capture_foot_meets_its_apex_velocity(switch: float, speed: float, apex: float) -> None:
    if speed < apex:
        with pytest.raises(UnsafeStepError, match="at most"):
            capture_foot(switch, speed, apex, 3.15)
        return
    foot = capture_foot(switch, speed, apex, 3.15)
    assert foot >= switch
    assert speed**2 - 3.15**2 * (foot - switch) ** 2 == pytest.approx(apex**2, abs=1e-9)


@given(x=st.floats(-0.05, 0.3), v=st.floats(-0.2, 1.5), apex=st.floats(0.2, 0.7))
def test_capture_steps_say_fall_or_meet_an_apex(x: float, v: float, apex: float) -> None:
    found = capture_step(
        x,
        v,
        stance_foot_m=0.0,
        switch_m=0.2,
        apex_velocity_mps=apex,
        omega_radps=3.15,
        nominal_foot_m=0.416,
        fine_cell_m=0.104,
    )
    assert found.recovered == (found.margin_mps > 0)
    if not found.recovered:
        return
    assert found.apex_velocity_mps <= apex
    energy = found.switch_velocity_mps**2 - (3.15 * (found.foot_m - found.switch_m)) ** 2
    assert energy == pytest.approx(found.apex_velocity_mps**2, abs=1e-9)
    sign = {FootMove.FORWARD: 1, FootMove.NOMINAL: 0, FootMove.BACKWARD: -1}[found.move]
    assert np.sign(found.cells) == sign
    assert found.cells == round(found.shift_m / 0.104)


def test_a_push_forward_moves_the_foot_forward_and_a_slow_state_lowers_the_apex() -> None:
    def capture(v: float) -> tuple[FootMove, float]:
        found = capture_step(
            0.1,
            v,
            stance_foot_m=0.0,
            switch_m=0.208,
            apex_velocity_mps=0.5,
            omega_radps=3.15,
            nominal_foot_m=0.416,
            fine_cell_m=0.104,
        )
        return found.move, found.apex_velocity_mps

    assert capture(1.0) == (FootMove.FORWARD, 0.5)
    assert capture(0.59)[0] is FootMove.NOMINAL
    assert capture(0.32)[0] is FootMove.BACKWARD
    assert capture(-0.5 + 0.0)[1] == 0.0


@pytest.fixture(scope="module")
def steps() -> tuple[LibraryStep, ...]:
    return action_steps(step_library(walking_parameters(2.70351), biped("digit")))


def test_the_library_holds_every_transition_and_comes_from_the_cache(
    steps: tuple[LibraryStep, ...], tmp_path: Path
) -> None:
    library = region_library(steps, RATE, cache=tmp_path)
    assert library.empty == {}
    assert len(list(tmp_path.glob("*.npz"))) == len({step.transition for step in steps})
    stamps = {path: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    again = region_library(steps, RATE, cache=tmp_path)
    assert {path: path.stat().st_mtime_ns for path in tmp_path.iterdir()} == stamps
    name = steps[0].name
    assert np.array_equal(again.regions[name].first.masks, library.regions[name].first.masks)
    assert again.controller(name).omega(0.0, 0.4) == library.controller(name).omega(0.0, 0.4)
    with pytest.raises(InputError, match="there is no step"):
        library.controller("moonwalk")


def test_gaps_are_true(steps: tuple[LibraryStep, ...]) -> None:
    library = region_library(steps, RATE)
    gaps = library.gaps(action_follows)
    assert len(gaps) < len(library.gaps())
    by_name = {step.name: step for step in steps}
    for gap in gaps[:10]:
        before, after = library.regions[gap.before], Controller(library.regions[gap.after])
        turn = math.cos(by_name[gap.after].heading_change_rad)
        i, j = np.nonzero(before.second.target)
        x = before.cells.x0_m + i * before.cells.x_step_m - before.transition.step_length_m
        v = before.cells.v0_mps + j * before.cells.v_step_mps
        held = [after.contains(float(a * turn), float(b * turn)) for a, b in zip(x, v, strict=True)]
        # A cell whose centre is lost is lost; one at the edge of the region may be lost with its centre inside.
        assert 1 - np.mean(held) <= gap.missing + 1e-9 <= 1 - np.mean(held) + 0.15


def test_equal_steps_with_a_wide_region_compose() -> None:
    step = LibraryStep("long", Transition(0.52, (0.45, 0.6)))
    assert region_library([step], RATE).gaps() == ()


def test_composed_regions_carry_any_sequence_of_steps(steps: tuple[LibraryStep, ...]) -> None:
    fine = Settings(Disturbance(Reading.RATE), grid=GridSpec(0.001, 0.002))
    library = composed_library(steps, fine, follows=action_follows)
    assert library.empty == {}
    controllers = {step.name: library.controller(step.name) for step in steps}
    rng = np.random.default_rng(5)
    x, v, before = 0.0, 0.45, steps[0]
    turned = 0
    for number in range(60):
        actions: dict[tuple[str, int, float], list[LibraryStep]] = {}
        for step in steps:
            if action_follows(before, step):
                actions.setdefault((step.turn, step.number, step.transition.step_length_m), []).append(step)
        options = list(actions.values())[rng.integers(len(actions))]
        turn = math.cos(options[0].heading_change_rad)
        fitting = [step for step in options if controllers[step.name].contains(x * turn, v * turn)]
        assert fitting, (number, x, v, options[0].name)
        before = fitting[-1]
        trace = controllers[before.name].simulate(x * turn, v * turn, seed=number)
        assert trace.ending is Ending.REACHED
        turned += before.last
        x, v = trace.positions_m[-1] - before.transition.step_length_m, trace.velocities_mps[-1]
    assert turned > 3


def test_library_misuse() -> None:
    step = LibraryStep("a", Transition(0.416, (0.4, 0.6)))
    with pytest.raises(InputError, match="same name"):
        region_library([step, step], RATE)
    with pytest.raises(LimitExceeded):
        region_library([step], RATE, deadline=Deadline(0.0))


def test_a_turn_toward_the_stance_foot_has_it_ahead() -> None:
    assert first_foot_after_turn(0.4, 1.0, 0.135) == pytest.approx(0.135 * math.sin(0.4))
    assert first_foot_after_turn(-0.4, 1.0, 0.135) < 0 < first_foot_after_turn(-0.4, -1.0, 0.135)


def test_initial_winning_sets_shrink_with_the_apex_velocity() -> None:
    found = [initial_winning_set(KeyframeStep(v, height_change_m=-0.2)) for v in (0.5, 0.6, 0.7)]
    assert found[0].size > found[1].size > found[2].size > 0
    for one in found:
        assert not (one.shared & ~one.initial).any()
        assert not (one.shared & ~one.winning).any()
        assert one.area == pytest.approx(one.size * 16e-6)


def test_the_policy_lowers_the_apex_velocity_with_height_and_heading() -> None:
    policy = robust_keyframe_policy(0.6, 0.3)
    assert policy.apex_velocity() == pytest.approx(0.6)
    heights = [policy.apex_velocity(dz) for dz in (0.0, 0.1, 0.2)]
    assert heights == sorted(heights, reverse=True)
    assert heights[-1] < heights[0]
    assert policy.apex_velocity(-0.1) == policy.apex_velocity(0.1)
    turns = [policy.apex_velocity(0.0, turn) for turn in (0.0, 0.2, math.pi / 8)]
    assert turns == sorted(turns, reverse=True)
    assert turns[-1] < turns[0]
    with pytest.raises(InputError, match="slowest < cruise"):
        robust_keyframe_policy(0.3, 0.6)


@given(a=st.floats(-0.3, 0.3), b=st.floats(-0.3, 0.3), x=st.floats(-1, 1), y=st.floats(-1, 1))
def test_the_sloped_pendulum_stays_in_its_plane(a: float, b: float, x: float, y: float) -> None:
    pendulum = SlopedPendulum(a, b, 0.8, (0.2, -0.1))
    assume(pendulum.apex_height_m > 0.1)
    ax, ay, az = pendulum.acceleration(x, y)
    assert az == pytest.approx(a * ax + b * ay)
    assert ax == pytest.approx(9.81 / pendulum.apex_height_m * (x - 0.2))


def test_a_plane_below_the_foot_is_refused() -> None:
    with pytest.raises(InputError, match="above the foot"):
        _ = SlopedPendulum(1.0, 0.0, 0.8, (-1.0, 0.0)).omega_radps

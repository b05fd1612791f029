from __future__ import annotations

import random

import numpy as np
import pytest
from walks import DEFAULTS, DIGIT, Place, command_of, first_place, walk

from surefoot.frames import Foot
from surefoot.walking import WalkingStep, plan_step, sample_trajectory

FIELDS = ("com", "left_foot", "right_foot")
TREAD_M, RISER_M = 4 * DEFAULTS.fine_cell_m, 0.1


def stairs(seed: int, climbs: int) -> list[WalkingStep]:
    """Walk on stairs up and down at random, with stops and turns on the flat."""
    chance = random.Random(seed)
    place, steps = first_place(DEFAULTS, floor_m=1.0), []
    plan = ["start"]
    for _ in range(climbs):
        rise = chance.choice([RISER_M, -RISER_M])
        plan += ["4", *[f"4{rise:+}"] * chance.randrange(1, 6), "4", "A", "turn", "turn", "turn", "4", "stop", "start"]
    for name in plan:
        action, height = (name[0], float(name[1:])) if name[1:2] in ("+", "-") else (name, 0.0)
        command, node = command_of(place, action, DEFAULTS, height_m=height)
        step = plan_step(place.state, command, DEFAULTS, DIGIT)
        assert isinstance(step, WalkingStep), (name, step)
        steps.append(step)
        place = Place(node, step.next_state())
    return steps


def sequences() -> list[list[WalkingStep]]:
    walks = [[step for _, step in walk(seed, 150, DEFAULTS, deviations=0.5)] for seed in range(4)]
    return [[s for s in steps if isinstance(s, WalkingStep)] for steps in walks] + [stairs(seed, 8) for seed in (0, 1)]


@pytest.mark.parametrize("rate_hz", [1000.0, 4000.0])
def test_curves_are_continuous_with_their_velocity_within_and_across_steps(rate_hz: float) -> None:
    for steps in sequences():
        last: dict[str, np.ndarray] = {}
        for step in steps:
            curve = sample_trajectory(step, rate_hz)
            dt = curve.time_s[1] - curve.time_s[0]
            assert curve.time_s[0] == 0
            assert curve.time_s[-1] == pytest.approx(step.duration_s)
            for name in FIELDS:
                place = getattr(curve, f"{name}_m")
                speed = getattr(curve, f"{name}_velocity_mps")
                assert np.isfinite(place).all()
                change = np.diff(place, axis=0) - 0.5 * dt * (speed[1:] + speed[:-1])
                # what jumps does not shrink with the interval; the foot is lifted by 0.35 m in 0.6 of a half
                fastest = 8 / min(step.first_half_s, step.second_half_s) ** 2
                assert np.abs(change).max() < fastest * dt**2, (name, "place")
                assert np.abs(np.diff(speed, axis=0)).max() < fastest * dt, (name, "velocity")
                if name in last:
                    assert (*place[0], *speed[0]) == pytest.approx(tuple(last[name]), abs=1e-9), name
                last[name] = np.concatenate([place[-1], speed[-1]])


def test_planted_feet_do_not_move() -> None:
    for steps in sequences():
        for step in steps:
            curve = sample_trajectory(step, 200.0)
            rise = step.rise_s or 0.0
            landing, apex = rise + step.first_half_s, rise + step.first_half_s + step.second_half_s
            stance, swing = (
                (curve.left_foot_m, curve.right_foot_m)
                if step.stance is Foot.LEFT
                else (curve.right_foot_m, curve.left_foot_m)
            )
            assert (stance[curve.time_s <= landing] == step.foot_m).all()
            assert (swing[curve.time_s >= landing] == step.next_foot_m).all()
            if step.closing_foot_m is not None:
                assert (stance[curve.time_s >= apex] == step.closing_foot_m).all()
            if step.rise_s is not None:
                assert (swing[curve.time_s <= rise] == step.swing_from_m).all()


@pytest.mark.parametrize("up", [True, False])
@pytest.mark.parametrize("riser_m", [0.1, 0.2])
def test_feet_clear_the_stairs(up: bool, riser_m: float) -> None:
    """Six steps on treads of four fine cells, each riser half a tread before a foot and at least 0.1 m from it."""
    for phase in (0.25, 0.5, 0.75):
        place, steps = first_place(DEFAULTS, floor_m=2.0), []
        for i in range(11):
            climb = (riser_m if up else -riser_m) if 2 <= i < 8 else 0.0
            action = "start" if i == 0 else "4"
            command, node = command_of(place, action, DEFAULTS, height_m=climb)
            step = plan_step(place.state, command, DEFAULTS, DIGIT)
            assert isinstance(step, WalkingStep)
            steps.append(step)
            place = Place(node, step.next_state())
        edges = [step.waypoint_m[0] + phase * TREAD_M for step in steps[2:8]]
        floor = steps[0].waypoint_m[2]
        for step in steps:
            curve = sample_trajectory(step, 500.0)
            for feet in (curve.left_foot_m, curve.right_foot_m):
                risers = (feet[:, :1] > np.array(edges)).sum(axis=1)
                terrain = floor + (riser_m if up else -riser_m) * risers
                assert (feet[:, 2] >= terrain - 1e-9).all()


def test_height_of_the_com_follows_half_a_cosine() -> None:
    steps = stairs(2, 2)
    step = next(s for s in steps if s.height_change_m)
    curve = sample_trajectory(step, 500.0)
    phase = np.pi * curve.time_s / (step.first_half_s + step.second_half_s)
    expected = step.com_m[2] + step.height_change_m * 0.5 * (1 - np.cos(phase))
    assert curve.com_m[:, 2] == pytest.approx(expected, abs=1e-9)
    assert step.com_m[2] == pytest.approx(step.waypoint_m[2] + DIGIT.apex_height_m)


def test_samples_are_read_only() -> None:
    step = stairs(0, 1)[0]
    with pytest.raises(ValueError, match="read-only"):
        sample_trajectory(step, 100.0).com_m[0, 0] = 0.0


def test_short_step_still_has_both_ends() -> None:
    step = stairs(0, 1)[1]
    assert sample_trajectory(step, 0.1).time_s.tolist() == pytest.approx([0.0, step.duration_s])

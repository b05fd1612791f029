from __future__ import annotations

import dataclasses
import json
import math

import pytest
from walks import CELL_M, DEFAULTS, DIGIT, Place, command_of, first_place, walk

from surefoot.frames import Foot
from surefoot.walking import StepCommand, StepKind, Unsafe, WalkingStep, plan_step, standing_state, walking_parameters
from surefoot.walking.double_support import MARGIN_M, pressure_range
from surefoot.walking.theorems import apex_margin, heading_margin

OMEGA = DIGIT.omega_radps
CELL = DEFAULTS.fine_cell_m


def planned(place: Place, *names: str) -> tuple[Place, list[WalkingStep]]:
    """Carry out actions."""
    steps = []
    for name in names:
        command, node = command_of(place, name, DEFAULTS)
        step = plan_step(place.state, command, DEFAULTS, DIGIT)
        assert isinstance(step, WalkingStep), step
        steps.append(step)
        place = Place(node, step.next_state())
    return place, steps


def local(step: WalkingStep, point: tuple[float, ...]) -> tuple[float, float]:
    dx, dy = point[0] - step.waypoint_m[0], point[1] - step.waypoint_m[1]
    cos, sin = math.cos(step.yaw_rad), math.sin(step.yaw_rad)
    return cos * dx + sin * dy, cos * dy - sin * dx


@pytest.mark.parametrize("seed", range(6))
def test_every_step_obeys_the_hard_rules(seed: int) -> None:
    """The rules of rules.md 6, computed again from the fields of the record."""
    for label, step in walk(seed, 120, DEFAULTS, deviations=0.5):
        assert isinstance(step, WalkingStep), step
        (x, y), (foot_x, foot_y) = local(step, step.com_m), local(step, step.foot_m)
        turn, v, w = step.heading_change_rad, step.apex_speed_mps, step.next_apex_speed_mps
        dy2, side = math.hypot(foot_x - x, foot_y - y), step.stance.side
        assert heading_margin(v, dy2, side, turn, OMEGA) >= 0
        assert apex_margin(v, w, step.length_m - x, dy2, side, turn, OMEGA) >= 0
        for change in step.next_heading_changes_rad:
            assert heading_margin(w, abs(step.dy2_m), -side, change, OMEGA) >= 0
        assert math.cos(step.yaw_rad) * step.switch_velocity_mps[0] + math.sin(step.yaw_rad) * step.switch_velocity_mps[
            1
        ] <= (DEFAULTS.switch_speed_max_mps)
        assert abs(step.dy1_m + step.dy2_m) <= DEFAULTS.safety_distance_m
        assert -side * step.dy2_m > 0
        assert step.first_half_s > 0
        assert step.second_half_s > 0
        if label == "stop":
            assert w == 0.1
        else:
            assert 0.2 <= w <= (0.4 if turn else 0.7)
        assert abs(step.lateral_cells) <= (2 if label in ("A4", "B4") else 0)
        assert abs(step.sagittal_cells) <= (1 if not turn else 0)


@pytest.mark.parametrize("seed", range(3))
def test_pendulum_carries_every_step_from_apex_to_apex(seed: int) -> None:
    for _, step in walk(seed, 60, DEFAULTS):
        assert isinstance(step, WalkingStep)
        state = [*step.com_m[:2], *step.velocity_mps]
        for foot, time_s, end in (
            (step.foot_m, step.first_half_s, (*step.switch_m, *step.switch_velocity_mps)),
            (step.next_foot_m, step.second_half_s, (*step.next_com_m[:2], *step.next_velocity_mps)),
        ):
            c, s = math.cosh(OMEGA * time_s), math.sinh(OMEGA * time_s)
            p = [foot[i] + (state[i] - foot[i]) * c + state[2 + i] / OMEGA * s for i in range(2)]
            v = [(state[i] - foot[i]) * OMEGA * s + state[2 + i] * c for i in range(2)]
            assert (*p, *v) == pytest.approx(end, abs=1e-9)
            state = [*end]
        assert local(step, step.next_foot_m)[0] == pytest.approx(step.length_m, abs=1e-9)
        assert local(step, step.next_com_m)[0] == pytest.approx(step.length_m, abs=1e-9)
        left = local(step, step.next_waypoint_m)
        assert left == pytest.approx((step.length_m, step.lateral_cells * CELL), abs=1e-9)
        assert step.dy1_m == pytest.approx(local(step, step.next_com_m)[1] - left[1], abs=1e-9)
        assert step.dy2_m == pytest.approx(local(step, step.next_foot_m)[1] - local(step, step.next_com_m)[1], abs=1e-9)
        before, after = step.next_state(), step
        assert before.stance is after.stance.other
        assert before.stance_foot_m == after.next_foot_m


@pytest.mark.parametrize("side", ["A", "B"])
def test_whole_turn_ends_on_a_fine_cell_centre(side: str) -> None:
    start = first_place(DEFAULTS, yaw_rad=0.7)
    lead = ["start", "4"] if side == "A" else ["start", "4", "pre"]
    place, _ = planned(start, *lead)
    origin, yaw = place.state.waypoint_m, place.state.yaw_rad
    place, steps = planned(place, *(["A"] if side == "A" else []), *["turn"] * (3 if side == "A" else 4))
    turned = math.remainder(place.state.yaw_rad - yaw, math.tau)
    assert abs(turned) == pytest.approx(math.pi / 2)
    dx, dy = place.state.waypoint_m[0] - origin[0], place.state.waypoint_m[1] - origin[1]
    ahead = (math.cos(yaw) * dx + math.sin(yaw) * dy) / CELL
    aside = (math.cos(yaw) * dy - math.sin(yaw) * dx) / CELL * math.copysign(1, turned)
    shift = -steps[-1].lateral_cells * math.copysign(1, turned)
    assert ahead - shift == pytest.approx(7 if side == "A" else 6, abs=1e-9)
    assert aside == pytest.approx(10, abs=1e-9)
    assert [step.turn_step for step in steps] == [1, 2, 3, 0]


def test_left_and_right_are_mirror_images() -> None:
    for foot in Foot:
        state = standing_state((0.0, 0.0, 0.0), 0.0, foot, DEFAULTS, DIGIT)
        _, steps = planned(Place("stand", state), "start", "4", "A", "turn", "turn", "turn", "3", "stop")
        mirrored = [(s.dy1_m * foot.side, s.next_apex_speed_mps, s.lateral_cells * foot.side) for s in steps]
        if foot is Foot.LEFT:
            expected = mirrored
        assert [value for step in mirrored for value in step] == pytest.approx(
            [value for step in expected for value in step], abs=1e-9
        )


def test_robot_stands_and_starts_again() -> None:
    place, (start, stop) = planned(first_place(DEFAULTS), "start", "stop")
    assert start.rise_s is not None
    assert start.rise_com_m == first_place(DEFAULTS).state.com_m
    assert start.apex_speed_mps == 0.1
    assert local(start, start.com_m)[0] == pytest.approx(0, abs=1e-12)
    assert place.state.standing
    assert place.state.apex_speed_mps == 0
    assert place.state.com_m == stop.rest_com_m
    assert stop.closing_foot_m is not None
    apart = math.dist(stop.closing_foot_m, stop.next_foot_m)
    assert apart == pytest.approx(0.27)
    assert local(stop, stop.closing_foot_m)[0] == pytest.approx(stop.length_m)
    _, (again,) = planned(place, "start")
    assert again.swing_from_m == stop.closing_foot_m
    assert again.swing_lift_m == stop.closing_foot_m


@pytest.mark.parametrize("seed", range(8))
def test_centre_of_pressure_stays_between_the_feet(seed: int) -> None:
    for _, step in walk(seed, 60, DEFAULTS):
        assert isinstance(step, WalkingStep)
        if step.rest_s is not None and step.rest_com_m is not None and step.closing_foot_m is not None:
            begin, end, time_s = step.next_com_m, step.rest_com_m, step.rest_s
            speeds, feet = (step.next_apex_speed_mps, 0.0), (step.next_foot_m, step.closing_foot_m)
        elif step.rise_s is not None and step.rise_com_m is not None:
            begin, end, time_s = step.rise_com_m, step.com_m, step.rise_s
            speeds, feet = (0.0, step.apex_speed_mps), (step.foot_m, step.swing_from_m)
        else:
            continue
        (x0, y0), (x1, y1) = local(step, begin), local(step, end)
        (foot_x, foot_y), (_, other_y) = local(step, feet[0]), local(step, feet[1])
        for tenth in range(101):
            u = tenth / 100
            pressure = []
            for a, b, va, vb in ((x0, x1, *speeds), (y0, y1, 0.0, 0.0)):
                h = (2 * u**3 - 3 * u**2 + 1, u**3 - 2 * u**2 + u, -2 * u**3 + 3 * u**2, u**3 - u**2)
                g = (12 * u - 6, 6 * u - 4, 6 - 12 * u, 6 * u - 2)
                k = (a, va * time_s, b, vb * time_s)
                value = sum(p * q for p, q in zip(h, k, strict=True))
                pressure.append(value - sum(p * q for p, q in zip(g, k, strict=True)) / (OMEGA * time_s) ** 2)
            assert abs(pressure[0] - foot_x) <= DIGIT.foot_half_length_m
            assert min(foot_y, other_y) - DIGIT.foot_half_width_m <= pressure[1]
            assert pressure[1] <= max(foot_y, other_y) + DIGIT.foot_half_width_m


def test_pressure_range_holds_the_extremes_of_a_cubic() -> None:
    low, high = pressure_range(0.0, 0.1, 0.2, 0.0, 0.8, OMEGA)
    assert low < 0 < high
    assert MARGIN_M > 0
    still = pressure_range(0.3, 0.0, 0.3, 0.0, 1.0, OMEGA)
    assert still == (0.3, 0.3)


def test_record_holds_the_fields_of_the_format_and_nothing_else() -> None:
    _, (start, walk_step, stop) = planned(first_place(DEFAULTS), "start", "4", "stop")
    assert "rise_s" in start.record()
    assert "rest_s" not in start.record()
    assert "closing_foot_m" in stop.record()
    record = walk_step.record()
    assert record["stance"] == "right"
    assert not {"rise_s", "rest_s", "lateral_cells", "sagittal_cells", "turn_step"} & set(record)
    assert len(record) == 28
    json.dumps(record, allow_nan=False)


def test_turning_costs_nothing_when_unsafe_is_the_answer() -> None:
    place, _ = planned(first_place(DEFAULTS), "start", "4")
    state = dataclasses.replace(place.state, apex_speed_mps=0.69)
    side = state.stance.side
    sharp = StepCommand(StepKind.WALK, 0.4, heading_change_rad=-side * 1.2)
    answer = plan_step(state, sharp, DEFAULTS, DIGIT)
    assert isinstance(answer, Unsafe)
    assert "Theorem IV.2" in answer.reason


@pytest.mark.parametrize(
    ("length_m", "speed", "words"),
    [(0.05, 0.7, "Theorem IV.1"), (1.0, 0.4, "switch speed"), (0.52, 0.2, "safety distance")],
)
def test_unsafe_says_which_rule(length_m: float, speed: float, words: str) -> None:
    place, _ = planned(first_place(DEFAULTS), "start", "4")
    state = dataclasses.replace(place.state, apex_speed_mps=speed)
    if words == "safety distance":
        foot = (*state.stance_foot_m[:1], state.stance_foot_m[1] - 0.2 * state.stance.side, 0.0)
        state = dataclasses.replace(state, stance_foot_m=(foot[0], foot[1] + 0.5 * state.stance.side, 0.0))
    kind = StepKind.STOP if words == "Theorem IV.1" else StepKind.WALK
    answer = plan_step(state, StepCommand(kind, length_m), DEFAULTS, DIGIT)
    assert isinstance(answer, Unsafe)
    assert words in answer.reason


def test_commands_out_of_place_are_refused() -> None:
    place = first_place(DEFAULTS)
    assert isinstance(plan_step(place.state, StepCommand(StepKind.WALK, 0.4), DEFAULTS, DIGIT), Unsafe)
    turned = StepCommand(StepKind.START, 0.2, heading_change_rad=0.39)
    assert isinstance(plan_step(place.state, turned, DEFAULTS, DIGIT), Unsafe)
    place, _ = planned(place, "start")
    assert isinstance(plan_step(place.state, StepCommand(StepKind.START, 0.2), DEFAULTS, DIGIT), Unsafe)


def test_rounded_parameters_walk_too() -> None:
    other = walking_parameters(CELL_M, turn_angle_deg=15, dy2_m=0.12, cost_straight=[1, 1, 1, 1])
    steps = list(walk(3, 60, other, deviations=0.5))
    assert len(steps) == 60
    assert all(isinstance(step, WalkingStep) for _, step in steps)

"""From a state and a command to a walking step: frames, Algorithm 1, double support."""

from __future__ import annotations

import math

import numpy as np

from surefoot.robots.biped import Biped
from surefoot.walking.decision import Choice, Freedom, choose
from surefoot.walking.double_support import rest_after, shift_duration_s
from surefoot.walking.library import STOP_SPEED_MPS
from surefoot.walking.parameters import WalkingParameters
from surefoot.walking.risk import READY, STANDING, START_OFFSETS_M, WALKING, risk_at, turn_node
from surefoot.walking.rulebook import Rulebook, rulebook
from surefoot.walking.rules import REASONS, Apex, Rule, turned_speeds
from surefoot.walking.state import StepCommand, StepKind, Unsafe, WalkingState
from surefoot.walking.step import WalkingStep
from surefoot.walking.step_frame import StepFrame


def plan_step(
    state: WalkingState, command: StepCommand, parameters: WalkingParameters, robot: Biped
) -> WalkingStep | Unsafe:
    """Plan one walking step.

    Args:
        state: where the robot is.
        command: what the action game wants.
        parameters: of the walk.
        robot: its pendulum and feet.

    Returns:
        The step, or why there is none.

    Source: Shamsah et al., T-RO 2023, Sections III-V; docs/rules.md, section 6.
    """
    starting = command.kind is StepKind.START
    if starting != state.standing:
        return Unsafe("a robot that stands has to start" if state.standing else "a robot that walks cannot start")
    if command.heading_change_rad and command.kind is not StepKind.WALK:
        return Unsafe("the heading cannot change in a start or a stop")
    book = rulebook(parameters, robot)
    frame = StepFrame.of(state, command)
    apex = Apex(
        *frame.into(state.com_m),
        *frame.into(state.stance_foot_m),
        STOP_SPEED_MPS if starting else state.apex_speed_mps,
        float(state.stance.side),
        command.heading_change_rad,
        state.side_speed_mps,
    )
    if starting:
        apex = apex._replace(com_m=0.0)
    freedom = _freedom(command, apex, parameters, book)
    steering = command.heading_change_rad != 0 and not command.last_turn_step
    turn_step = min(state.turn_step + 1, parameters.turn_steps - 1) if steering else 0
    choice = choose(
        apex,
        freedom,
        np.array(command.next_heading_changes_rad, np.float64),
        book.limits,
        book.steering if steering else book.straight,
        book.risks,
        _next_node(command, state, turn_step, parameters),
    )
    if not choice.found:
        return Unsafe(REASONS[Rule(choice.furthest)])
    return _finished(state, command, parameters, robot, frame, apex, choice, freedom, book, turn_step)


def apex_risk(state: WalkingState, node: int, parameters: WalkingParameters, robot: Biped) -> float:
    """Return how likely a state leads to a command that no step can follow safely (``risk``), from 0 to 1.

    Args:
        state: at an apex without lateral speed.
        node: of the commands that may follow (``surefoot.walking.risk``).
        parameters: of the walk.
        robot: its pendulum.
    """
    cos, sin = math.cos(state.yaw_rad), math.sin(state.yaw_rad)
    com, foot = (
        state.stance.side * (cos * (place[1] - state.waypoint_m[1]) - sin * (place[0] - state.waypoint_m[0]))
        for place in (state.com_m, state.stance_foot_m)
    )
    return float(risk_at(rulebook(parameters, robot).risks, node, com, foot - com, state.apex_speed_mps))


def _next_node(command: StepCommand, state: WalkingState, turn_step: int, parameters: WalkingParameters) -> int:
    """Return the node of the commands that may follow a step."""
    if command.kind is StepKind.STOP:
        return STANDING
    if not turn_step:
        return WALKING if 0.0 in command.next_heading_changes_rad else READY
    away = command.heading_change_rad * state.stance.side < 0
    return turn_node("A" if away == (turn_step % 2 == 1) else "B", turn_step, parameters.turn_steps)


_NO_CORRECTION = np.zeros(1, np.int64)
_STOP_SPEED = np.array([STOP_SPEED_MPS])


def _freedom(command: StepCommand, apex: Apex, parameters: WalkingParameters, book: Rulebook) -> Freedom:
    turning = command.heading_change_rad != 0
    cell = parameters.fine_cell_m
    most = 0 if turning else command.sagittal_outcomes_cells
    deviating = [command.length_m + e * cell for e in range(-most, most + 1) if e]
    lengths = [command.length_m, *(length for length in deviating if length > 0.5 * cell)]
    speeds = book.steering_speeds_mps if turning else book.speeds_mps
    shifts = book.corrections_cells if command.last_turn_step else _NO_CORRECTION
    return Freedom(
        np.array(lengths),
        _STOP_SPEED if command.kind is StepKind.STOP else speeds,
        apex.foot_left_m - apex.side * START_OFFSETS_M
        if command.kind is StepKind.START
        else np.array([apex.com_left_m]),
        shifts if command.shift_cells is None else np.array([command.shift_cells], np.int64),
    )


def _finished(
    state: WalkingState,
    command: StepCommand,
    parameters: WalkingParameters,
    robot: Biped,
    frame: StepFrame,
    apex: Apex,
    choice: Choice,
    freedom: Freedom,
    book: Rulebook,
    turn_step: int,
) -> WalkingStep | Unsafe:
    """Return the chosen step in map coordinates."""
    chosen = choice.candidate
    omega, apex_height = robot.omega_radps, robot.apex_height_m
    length = float(freedom.lengths_m[choice.length])
    shift = choice.shift_cells * parameters.fine_cell_m
    dy1, dy2 = chosen.next_com_left_m - shift, chosen.next_foot_left_m - chosen.next_com_left_m
    floor = state.waypoint_m[2] + command.height_change_m
    next_waypoint = (*frame.out(length, shift), floor)
    next_foot = (*frame.out(length, chosen.next_foot_left_m), floor)
    next_com = (*frame.out(length, chosen.next_com_left_m), floor + apex_height)
    starting, stopping = command.kind is StepKind.START, command.kind is StepKind.STOP
    com, rise_s, rest = state.com_m, None, None
    if starting:
        com = (*frame.out(0.0, choice.com_left_m), state.com_m[2])
        feet = frame.into(state.stance_foot_m)[1], frame.into(state.other_foot_m)[1]
        rise_s = shift_duration_s(*feet, STOP_SPEED_MPS, choice.com_left_m, frame.into(state.com_m)[1], robot)
        if rise_s is None:
            return Unsafe("no double support before the start keeps the centre of pressure between the feet")
    if stopping:
        rest = rest_after(chosen.next_foot_left_m, chosen.next_com_left_m, parameters.dy2_m, STOP_SPEED_MPS, robot)
        if rest is None:
            return Unsafe("no double support after the stop keeps the centre of pressure between the feet")
    before = _offset(state)
    sagittal = round((length - command.length_m) / parameters.fine_cell_m)
    speed, side_speed = turned_speeds(apex)
    low, high = book.dy2_range_m
    return WalkingStep(
        yaw_rad=frame.yaw_rad,
        heading_change_rad=command.heading_change_rad,
        length_m=length,
        height_change_m=command.height_change_m,
        stance=state.stance,
        waypoint_m=state.waypoint_m,
        next_waypoint_m=next_waypoint,
        com_m=com,
        velocity_mps=frame.turned(speed, side_speed),
        foot_m=state.stance_foot_m,
        next_foot_m=next_foot,
        swing_from_m=state.other_foot_m,
        swing_velocity_mps=state.other_foot_velocity_mps,
        swing_lift_m=state.other_foot_lift_m,
        omega_radps=omega,
        first_half_s=math.log(chosen.growth) / omega,
        second_half_s=math.log(chosen.next_growth) / omega,
        switch_m=frame.out(chosen.switch_m, chosen.switch_left_m),
        switch_velocity_mps=frame.turned(chosen.switch_speed_mps, chosen.switch_left_speed_mps),
        next_com_m=next_com,
        next_velocity_mps=frame.turned(choice.speed_mps, 0.0),
        dy1_m=dy1,
        dy2_m=dy2,
        apex_speed_mps=apex.speed_mps,
        next_apex_speed_mps=choice.speed_mps,
        next_heading_changes_rad=command.next_heading_changes_rad,
        sign_alternates=(dy1 + dy2) * before < 0,
        dy2_in_range=low <= abs(dy2) <= high,
        rise_s=rise_s,
        rise_com_m=state.com_m if starting else None,
        rest_s=None if rest is None else rest.duration_s,
        rest_com_m=None if rest is None else (*frame.out(length, rest.com_left_m), next_com[2]),
        closing_foot_m=None if rest is None else (*frame.out(length, rest.closing_left_m), floor),
        lateral_cells=int(choice.shift_cells),
        sagittal_cells=sagittal,
        turn_step=turn_step,
    )


def _offset(state: WalkingState) -> float:
    """Return dy1 + dy2 of a state: lateral foot minus waypoint in its own heading."""
    dx, dy = state.stance_foot_m[0] - state.waypoint_m[0], state.stance_foot_m[1] - state.waypoint_m[1]
    return math.cos(state.yaw_rad) * dy - math.sin(state.yaw_rad) * dx

"""How the CoM moves in a pushed step: arcs of the pendulum with one omega each, before and after the switch.

Everything is in the frame of the step (origin at its waypoint, ahead along its heading). Sagittally the law of a
controllable region, the capture rule, or a held omega bring the CoM over the next foot; where that foot is still in
the air it is set down sideways so that no lateral speed is left at the next apex.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

from surefoot.reach import Controller, Disturbance, Reading, Settings, Transition, capture_step, synthesize
from surefoot.reach.controller import Half
from surefoot.walking import WalkingStep
from surefoot.walking.step_frame import StepFrame

TAU_S = 0.02
MOST_SAMPLES = 300
OMEGAS_RADPS = (2.8, 3.5)
"""The least and the greatest omega of the law."""
SHORTEST_HALF_S = 0.05
"""A second half that is shorter leaves no time to steer sideways."""
Arcs = tuple[tuple[float, float], ...]
"""Pairs (duration [s], omega [rad/s])."""


class Body(NamedTuple):
    """The CoM in the frame of a step: place and speed ahead, place and speed to the left."""

    ahead_m: float
    ahead_mps: float
    left_m: float
    left_mps: float


class Foot(NamedTuple):
    """A foot in the frame of a step."""

    ahead_m: float
    left_m: float


def flow(body: Body, foot: Foot, arcs: Iterable[tuple[float, float]]) -> Body:
    """Return where the CoM is after some arcs about a foot."""
    for duration, omega in arcs:
        cosh, sinh = math.cosh(omega * duration), math.sinh(omega * duration)
        x, y = body.ahead_m - foot.ahead_m, body.left_m - foot.left_m
        body = Body(
            foot.ahead_m + cosh * x + sinh / omega * body.ahead_mps,
            omega * sinh * x + cosh * body.ahead_mps,
            foot.left_m + cosh * y + sinh / omega * body.left_mps,
            omega * sinh * y + cosh * body.left_mps,
        )
    return body


def lasting(arcs: Arcs) -> float:
    """Return how long some arcs last."""
    return math.fsum(duration for duration, _ in arcs)


@dataclass(frozen=True, slots=True)
class Planned:
    """A planned step in its own frame, with the push that hits it.

    Attributes:
        step: the plan.
        frame: of the step.
        foot: that carries the robot until the switch.
        next_foot: where the other one was to be set down.
        time_s: of the push, since the start apex.
        jump_mps: of the push, ahead and to the left.
        pushed: the CoM right after the push.
        switched: whether the push comes after the planned switch.
    """

    step: WalkingStep
    frame: StepFrame
    foot: Foot
    next_foot: Foot
    time_s: float
    jump_mps: tuple[float, float]
    pushed: Body
    switched: bool

    @classmethod
    def of(cls, step: WalkingStep, time_s: float, jump_mps: tuple[float, float]) -> Planned:
        """Return a planned step with a push: its time since the start apex, and the jump ahead and to the left."""
        cos, sin = math.cos(step.yaw_rad), math.sin(step.yaw_rad)
        frame = StepFrame(step.waypoint_m[0], step.waypoint_m[1], step.yaw_rad, cos, sin)
        foot, next_foot = Foot(*frame.into(step.foot_m)), Foot(*frame.into(step.next_foot_m))
        body, omega = _body(frame, step.com_m, step.velocity_mps), step.omega_radps
        body = flow(body, foot, [(min(time_s, step.first_half_s), omega)])
        switched = time_s >= step.first_half_s
        if switched:
            body = flow(body, next_foot, [(time_s - step.first_half_s, omega)])
        pushed = body._replace(ahead_mps=body.ahead_mps + jump_mps[0], left_mps=body.left_mps + jump_mps[1])
        return cls(step, frame, foot, next_foot, time_s, jump_mps, pushed, switched)

    @property
    def start_m(self) -> float:
        """Return where the CoM is at the start apex, along the heading."""
        return self.frame.into(self.step.com_m)[0]


def _body(
    frame: StepFrame, place_m: tuple[float, float, float] | tuple[float, float], velocity_mps: tuple[float, float]
) -> Body:
    """Return a CoM of the map in the frame of a step."""
    ahead, left = frame.into((place_m[0], place_m[1], 0.0))
    speed = frame.cos * velocity_mps[0] + frame.sin * velocity_mps[1]
    return Body(ahead, speed, left, frame.cos * velocity_mps[1] - frame.sin * velocity_mps[0])


@dataclass(frozen=True, slots=True)
class Motion:
    """The way from a push to the next apex.

    Attributes:
        before: arcs about the stance foot, from the push to the switch; empty when the foot had been switched.
        after: arcs about the next foot.
        switch: the CoM at the switch.
        foot: where the next foot stands.
        end: the CoM at the next apex.
    """

    before: Arcs
    after: Arcs
    switch: Body
    foot: Foot
    end: Body

    @property
    def duration_s(self) -> float:
        """Return how long it lasts."""
        return lasting(self.before) + lasting(self.after)


def landed(planned: Planned, before: Arcs, after: Arcs, foot_ahead_m: float) -> Motion | None:
    """Return the motion of arcs before and after a switch yet to come, its foot set down to end the lateral speed.

    The lateral speed at the end is linear in the place of the foot. None when there is no time to steer.
    """
    if lasting(after) < SHORTEST_HALF_S:
        return None
    switch = flow(planned.pushed, planned.foot, before)
    place, speed = (
        flow(Body(0.0, 0.0, one, other), Foot(0.0, 0.0), after).left_mps for one, other in ((1.0, 0.0), (0.0, 1.0))
    )
    foot = Foot(foot_ahead_m, switch.left_m + speed / place * switch.left_mps)
    return Motion(before, after, switch, foot, flow(switch, foot, after)._replace(left_mps=0.0))


def stood(planned: Planned, after: Arcs) -> Motion:
    """Return the motion of arcs about a next foot that stood before the push."""
    switch = _body(planned.frame, planned.step.switch_m, planned.step.switch_velocity_mps)
    return Motion((), after, switch, planned.next_foot, flow(planned.pushed, planned.next_foot, after))


@lru_cache(maxsize=64)
def step_controller(length_m: float, first_foot_m: float, window_mps: tuple[float, float]) -> Controller:
    """Return the controller of a step's robust controllable region."""
    return Controller(synthesize(Transition(length_m, window_mps, first_foot_m), Settings(Disturbance(Reading.RATE))))


def region_motion(planned: Planned, window_mps: tuple[float, float], aim_mps: float | None = None) -> Motion | None:
    """Return how the synthesised law recovers from a push; None when the state is outside the region.

    Args:
        planned: the step and its push.
        window_mps: apex speeds of the region's target.
        aim_mps: of the omegas that the region allows the one is held whose orbit comes nearest to this apex speed; None
            for the one that the paper's criterion takes.
    """
    start = planned.start_m
    length = planned.next_foot.ahead_m - start
    if length <= 0:
        return None
    controller = step_controller(length, planned.foot.ahead_m - start, window_mps)
    x, v = planned.pushed.ahead_m - start, planned.pushed.ahead_mps
    if not controller.contains(x, v, "second" if planned.switched else "first"):
        return None
    arcs: tuple[list[tuple[float, float]], list[tuple[float, float]]] = ([], [])
    half, omega = int(planned.switched), planned.step.omega_radps
    for _ in range(MOST_SAMPLES):
        if half == 0 and controller.switches(x, v):
            half = 1
        held = _held(controller, x, v, half, omega, aim_mps)
        if held is None and not (half and controller.second.in_target(x, v)):
            return None
        omega = omega if held is None else held
        foot = length if half else planned.foot.ahead_m - start
        crossing = _crossing_s(x - length, v, omega) if half else math.inf
        arcs[half].append((min(TAU_S, crossing), omega))
        if crossing <= TAU_S:
            before, after = _merged(arcs[0]), _merged(arcs[1])
            if planned.switched:
                return stood(planned, after)
            return landed(planned, before, after, planned.next_foot.ahead_m)
        moved = flow(Body(x, v, 0.0, 0.0), Foot(foot, 0.0), [(TAU_S, omega)])
        x, v = moved.ahead_m, moved.ahead_mps
    return None


def _held(
    controller: Controller, x_m: float, v_mps: float, half: int, omega_radps: float, aim_mps: float | None
) -> float | None:
    """Return the omega that the law holds for the next sample; None where the region has none."""
    name: Half = "second" if half else "first"
    if aim_mps is None or not half:
        return controller.omega(x_m, v_mps, name, omega_radps)
    allowed = controller.omegas(x_m, v_mps, name)
    behind = controller.region.transition.step_length_m - x_m
    wished = math.sqrt(max(v_mps**2 - aim_mps**2, 0.0)) / max(behind, 1e-6)
    return min(allowed, key=lambda omega: abs(omega - wished), default=None)


def capture_motion(planned: Planned, apex_speed_mps: float, fine_cell_m: float) -> Motion | float:
    """Return how the capture rule moves the foot for an apex speed; else the speed that is missing, negative [m/s]."""
    step, body, foot = planned.step, planned.pushed, planned.foot
    switch_m = _body(planned.frame, step.switch_m, step.switch_velocity_mps).ahead_m
    found = capture_step(
        body.ahead_m,
        body.ahead_mps,
        stance_foot_m=foot.ahead_m,
        switch_m=switch_m,
        apex_velocity_mps=apex_speed_mps,
        omega_radps=step.omega_radps,
        nominal_foot_m=planned.next_foot.ahead_m,
        fine_cell_m=fine_cell_m,
    )
    if not found.recovered:
        return found.margin_mps
    return _switched(planned, found.switch_m, found.switch_velocity_mps, found.foot_m, found.apex_velocity_mps)


def meeting_motion(planned: Planned, foot_ahead_m: float, apex_speed_mps: float) -> Motion | float:
    """Return how an earlier or later switch leads over a foot at a place with an apex speed; -infinity when none does.

    The switch is where the orbit of the pushed CoM meets that of the apex (Eqs. 17-18).
    """
    omega, body, foot = planned.step.omega_radps, planned.pushed, planned.foot.ahead_m
    gap, behind = foot_ahead_m - foot, body.ahead_m - foot
    energy = body.ahead_mps**2 - (omega * behind) ** 2
    if gap <= 0 or body.ahead_mps <= 0 or (behind < 0 and energy <= 0):
        return -math.inf
    at = 0.5 * (foot + foot_ahead_m + (apex_speed_mps**2 - energy) / (omega**2 * gap))
    if not body.ahead_m <= at < foot_ahead_m:
        return -math.inf
    return _switched(planned, at, math.sqrt(energy + (omega * (at - foot)) ** 2), foot_ahead_m, apex_speed_mps)


def _switched(planned: Planned, at_m: float, speed_mps: float, foot_m: float, apex_speed_mps: float) -> Motion | float:
    """Return the motion with the robot's omega and a known switch; -infinity when it leaves no time to steer."""
    omega, body, stance, before = planned.step.omega_radps, planned.pushed, planned.foot.ahead_m, 0.0
    if at_m > body.ahead_m:
        before = math.log((at_m - stance + speed_mps / omega) / (body.ahead_m - stance + body.ahead_mps / omega))
    after = math.asinh(omega * (foot_m - at_m) / apex_speed_mps) / omega
    return landed(planned, ((before / omega, omega),) if before else (), ((after, omega),), foot_m) or -math.inf


def held_motion(planned: Planned, first_radps: float, then_radps: float) -> Motion | float:
    """Return how the CoM gets over a foot that stands; else the speed that is missing, negative [m/s].

    One omega is held for half the time that it would take alone, and then the other one.
    """
    ahead, speed = planned.pushed.ahead_m - planned.next_foot.ahead_m, planned.pushed.ahead_mps
    arcs: list[tuple[float, float]] = []
    if first_radps != then_radps:
        crossing = _crossing_s(ahead, speed, first_radps)
        if math.isfinite(crossing):
            arcs = [(0.5 * crossing, first_radps)]
            body = flow(Body(ahead, speed, 0.0, 0.0), Foot(0.0, 0.0), arcs)
            ahead, speed = body.ahead_m, body.ahead_mps
    crossing = _crossing_s(ahead, speed, then_radps)
    if not math.isfinite(crossing):
        return speed - then_radps * abs(ahead)
    return stood(planned, (*arcs, (crossing, then_radps)))


def _crossing_s(behind_m: float, speed_mps: float, omega_radps: float) -> float:
    """Return when the CoM is above a foot that it is behind of (a negative place); infinite when never."""
    ratio = -omega_radps * behind_m / speed_mps if speed_mps > 0 else math.inf
    return math.atanh(ratio) / omega_radps if 0 <= ratio < 1 else math.inf


def _merged(arcs: list[tuple[float, float]]) -> Arcs:
    """Return arcs with equal neighbours joined."""
    merged: list[tuple[float, float]] = []
    for duration, omega in arcs:
        if merged and merged[-1][1] == omega:
            merged[-1] = (merged[-1][0] + duration, omega)
        else:
            merged.append((duration, omega))
    return tuple(merged)

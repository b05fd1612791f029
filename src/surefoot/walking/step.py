"""One planned walking step, from apex to apex."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

from surefoot.frames import Foot
from surefoot.walking.state import Point, WalkingState
from surefoot.walking.swing import apex_swing

Place = tuple[float, float]


@dataclass(frozen=True, slots=True)
class WalkingStep:
    """A walking step in map coordinates; those up to ``next_side_speed_mps`` as in docs/formats.md, section 3.

    Attributes:
        yaw_rad: heading of the step.
        heading_change_rad: how much the robot turned to get there, left positive.
        length_m: from waypoint to waypoint along the heading, deviation included.
        height_change_m: of the floor.
        stance: the foot that carries the robot until the switch.
        waypoint_m: before the step; z is the floor.
        next_waypoint_m: after it.
        com_m: CoM at the start apex.
        velocity_mps: its velocity there.
        foot_m: stance foot before the switch.
        next_foot_m: stance foot after the switch.
        swing_from_m: where the swing foot is at the start apex.
        swing_velocity_mps: its velocity there.
        swing_lift_m: where it stood before it was lifted.
        omega_radps: rate of the pendulum.
        first_half_s: from the start apex to the switch.
        second_half_s: from the switch to the next apex.
        switch_m: CoM at the switch.
        switch_velocity_mps: its velocity there.
        next_com_m: CoM at the next apex.
        next_velocity_mps: its velocity there.
        dy1_m: lateral apex CoM minus waypoint, at the next apex.
        dy2_m: lateral foot minus apex CoM, at the next apex.
        apex_speed_mps: at the start apex.
        next_apex_speed_mps: at the next apex.
        next_heading_changes_rad: heading changes that may be commanded next.
        sign_alternates: Prop. V.1: the stance foot changes its side of the waypoint.
        dy2_in_range: Def. V.2.
        rise_s: start only: how long the double support before the start apex lasts.
        rise_com_m: start only: where the CoM rested.
        rest_s: stop only: how long the double support after the final apex lasts.
        rest_com_m: stop only: where the CoM comes to rest.
        closing_foot_m: stop only: where the other foot was set down.
        next_side_speed_mps: after a push only: speed to the left of the heading that is left at the next apex.
        lateral_cells: correction of the next waypoint, left positive.
        sagittal_cells: deviation from the commanded length.
        turn_step: how many steps of a pending turn are done after the step; 0 when none is pending.
    """

    yaw_rad: float
    heading_change_rad: float
    length_m: float
    height_change_m: float
    stance: Foot
    waypoint_m: Point
    next_waypoint_m: Point
    com_m: Point
    velocity_mps: Place
    foot_m: Point
    next_foot_m: Point
    swing_from_m: Point
    swing_velocity_mps: Point
    swing_lift_m: Point
    omega_radps: float
    first_half_s: float
    second_half_s: float
    switch_m: Place
    switch_velocity_mps: Place
    next_com_m: Point
    next_velocity_mps: Place
    dy1_m: float
    dy2_m: float
    apex_speed_mps: float
    next_apex_speed_mps: float
    next_heading_changes_rad: tuple[float, ...]
    sign_alternates: bool
    dy2_in_range: bool
    rise_s: float | None = None
    rise_com_m: Point | None = None
    rest_s: float | None = None
    rest_com_m: Point | None = None
    closing_foot_m: Point | None = None
    next_side_speed_mps: float | None = None
    lateral_cells: int = 0
    sagittal_cells: int = 0
    turn_step: int = 0

    @property
    def duration_s(self) -> float:
        """Return how long the step lasts, double support included."""
        return (self.rise_s or 0.0) + self.first_half_s + self.second_half_s + (self.rest_s or 0.0)

    def next_state(self) -> WalkingState:
        """Return where the robot is after the step."""
        swing, swing_velocity = apex_swing(
            self.foot_m, self.next_foot_m, self.yaw_rad, self.stance.side, self.next_apex_speed_mps
        )
        stopped = self.closing_foot_m is not None and self.rest_com_m is not None
        if self.closing_foot_m is not None:
            swing, swing_velocity = self.closing_foot_m, (0.0, 0.0, 0.0)
        return WalkingState(
            waypoint_m=self.next_waypoint_m,
            yaw_rad=self.yaw_rad,
            com_m=self.rest_com_m if self.rest_com_m is not None else self.next_com_m,
            apex_speed_mps=0.0 if stopped else self.next_apex_speed_mps,
            stance=self.stance.other,
            stance_foot_m=self.next_foot_m,
            other_foot_m=swing,
            other_foot_velocity_mps=swing_velocity,
            other_foot_lift_m=self.closing_foot_m if self.closing_foot_m is not None else self.foot_m,
            standing=stopped,
            turn_step=self.turn_step,
            side_speed_mps=self.next_side_speed_mps or 0.0,
        )

    def record(self) -> dict[str, Any]:
        """Return the fields of docs/formats.md, section 3, that apply; the stance by its name."""
        content = {field.name: getattr(self, field.name) for field in fields(self)}
        for name in _OUTCOMES:
            del content[name]
        content["stance"] = self.stance.name.lower()
        return {name: value for name, value in content.items() if value is not None}


_OUTCOMES = ("lateral_cells", "sagittal_cells", "turn_step")

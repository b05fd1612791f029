"""Where a robot is between two walking steps, and what it is told to do next."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

from surefoot.frames import Foot
from surefoot.robots.biped import Biped
from surefoot.walking.parameters import WalkingParameters

Point = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class WalkingState:
    """A robot at an apex of its centre of mass (CoM), or standing on both feet; map coordinates.

    Attributes:
        waypoint_m: where the plan says the robot is; z is the floor.
        yaw_rad: heading.
        com_m: CoM.
        apex_speed_mps: along the heading; 0 when standing.
        stance: the foot that carries the robot (when standing: the one that will carry the next step).
        stance_foot_m: where it stands.
        other_foot_m: where the other foot is now: on the ground when standing, else in the air.
        other_foot_velocity_mps: its velocity.
        other_foot_lift_m: where it stood before it was lifted.
        standing: both feet carry the robot, which is at rest.
        turn_step: how many steps of a pending turn are done; 0 when no turn is pending.
        side_speed_mps: of the CoM to the left of the heading; only a push leaves one.
    """

    waypoint_m: Point
    yaw_rad: float
    com_m: Point
    apex_speed_mps: float
    stance: Foot
    stance_foot_m: Point
    other_foot_m: Point
    other_foot_velocity_mps: Point
    other_foot_lift_m: Point
    standing: bool
    turn_step: int = 0
    side_speed_mps: float = 0.0


class StepKind(Enum):
    """What kind of step is commanded."""

    WALK = "walk"
    START = "start"
    STOP = "stop"


@dataclass(frozen=True, slots=True)
class StepCommand:
    """One walking step as the action game commands it.

    Attributes:
        kind: walk, start from standing, or stop (which ends standing).
        length_m: from waypoint to waypoint along the new heading.
        heading_change_rad: left positive; happens before the step.
        height_change_m: of the floor, from the stance foot to the next foot.
        last_turn_step: lateral corrections are allowed only there.
        next_heading_changes_rad: heading changes that may be commanded at the next apex, where the other foot stands.
        sagittal_outcomes_cells: by how many fine cells the planner may lengthen or shorten the step.
        shift_cells: by how many fine cells the waypoint is moved to the left; None leaves it to the planner.
    """

    kind: StepKind
    length_m: float
    heading_change_rad: float = 0.0
    height_change_m: float = 0.0
    last_turn_step: bool = False
    next_heading_changes_rad: tuple[float, ...] = (0.0,)
    sagittal_outcomes_cells: int = 0
    shift_cells: int | None = None


@dataclass(frozen=True, slots=True)
class Unsafe:
    """No walking step satisfies the hard rules.

    Attributes:
        reason: the rule that the last candidates broke, in one sentence.
    """

    reason: str


def standing_state(
    position_m: Point, yaw_rad: float, stance: Foot, parameters: WalkingParameters, robot: Biped
) -> WalkingState:
    """Return a robot that stands still, its feet side by side and its CoM between them.

    The stance foot stands on the waypoint, as it nearly does after a stop: from there a start leads into a gait whose
    feet are symmetric about the waypoints, and from feet on both sides of the waypoint it does not.

    Args:
        position_m: the waypoint; z is the floor.
        yaw_rad: heading.
        stance: the foot that carries the first step.
        parameters: the feet are ``2 dy2_m`` apart.
        robot: its apex height is the height of the CoM.
    """
    x, y, z = position_m
    reach = -stance.side * parameters.dy2_m
    left = (-math.sin(yaw_rad) * reach, math.cos(yaw_rad) * reach)
    other = (x + 2 * left[0], y + 2 * left[1], z)
    return WalkingState(
        waypoint_m=(x, y, z),
        yaw_rad=math.remainder(yaw_rad, math.tau),
        com_m=(x + left[0], y + left[1], z + robot.apex_height_m),
        apex_speed_mps=0.0,
        stance=stance,
        stance_foot_m=(x, y, z),
        other_foot_m=other,
        other_foot_velocity_mps=(0.0, 0.0, 0.0),
        other_foot_lift_m=other,
        standing=True,
    )

"""The frame of a step: origin at the waypoint, x along the new heading, y to its left."""

from __future__ import annotations

import math
from dataclasses import dataclass

from surefoot.walking.state import Point, StepCommand, WalkingState


@dataclass(frozen=True, slots=True)
class StepFrame:
    """The frame of a step in map coordinates.

    Attributes:
        x_m: of the waypoint.
        y_m: of the waypoint.
        yaw_rad: heading after the turn, in -pi .. pi.
        cos: of the yaw.
        sin: of the yaw.
    """

    x_m: float
    y_m: float
    yaw_rad: float
    cos: float
    sin: float

    @classmethod
    def of(cls, state: WalkingState, command: StepCommand) -> StepFrame:
        """Return the frame of a step from a state."""
        yaw = math.remainder(state.yaw_rad + command.heading_change_rad, math.tau)
        return cls(state.waypoint_m[0], state.waypoint_m[1], yaw, math.cos(yaw), math.sin(yaw))

    def into(self, point_m: Point) -> tuple[float, float]:
        """Return how far a point of the map is ahead and to the left."""
        dx, dy = point_m[0] - self.x_m, point_m[1] - self.y_m
        return self.cos * dx + self.sin * dy, self.cos * dy - self.sin * dx

    def out(self, ahead_m: float, left_m: float) -> tuple[float, float]:
        """Return the map coordinates of a point of the frame."""
        return self.x_m + self.cos * ahead_m - self.sin * left_m, self.y_m + self.sin * ahead_m + self.cos * left_m

    def turned(self, ahead: float, left: float) -> tuple[float, float]:
        """Return the map components of a vector of the frame."""
        return self.cos * ahead - self.sin * left, self.sin * ahead + self.cos * left

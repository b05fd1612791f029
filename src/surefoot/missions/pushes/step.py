"""A pushed step in map coordinates, and its record (docs/formats.md, section 3)."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

from surefoot.missions.pushes.motion import Motion, Planned, lasting
from surefoot.missions.scenario.scene import BipedScene
from surefoot.navigation import Moved
from surefoot.walking import WalkingStep
from surefoot.walking.double_support import Rest, rest_after
from surefoot.walking.library import STOP_SPEED_MPS
from surefoot.walking.state import Point

Window = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Way:
    """A way out of a push.

    Attributes:
        planned: the step and its push.
        motion: of the CoM.
        window_mps: at which apex speeds the law aims; None for no law.
        shift: rows and columns by which the waypoint leaves the planned one.
        outcome: sagittal and lateral deviation as the action game labels it.
        displaced: rows and columns that the outcome leaves out.
        moved: what comes of it in the action game.
        put_off: whether a stop is not carried out.
    """

    planned: Planned
    motion: Motion
    window_mps: Window | None
    shift: tuple[int, int]
    outcome: tuple[int, int]
    displaced: tuple[int, int]
    moved: Moved
    put_off: bool

    def in_region(self, fine_cell_m: float) -> bool:
        """Return whether the region's law alone recovered the push: no foot has to catch a lateral jump."""
        caught = abs(self.motion.foot.left_m - self.planned.next_foot.left_m) > 0.5 * fine_cell_m
        aside = self.planned.jump_mps[1] != 0 and (self.planned.switched or caught)
        return self.window_mps is not None and self.shift == (0, 0) and not aside

    def record(self, fine_cell_m: float) -> dict[str, Any]:
        """Return what the log says about the push."""
        old = self.planned.step
        names = ("next_foot_m", "next_waypoint_m", "next_apex_speed_mps", "first_half_s", "second_half_s")
        return {
            "time_s": self.planned.time_s,
            "jump_mps": self.planned.jump_mps,
            "recovery": "region" if self.in_region(fine_cell_m) else "step",
            "window_mps": self.window_mps,
            "omegas_before_switch": self.motion.before,
            "omegas_after_switch": self.motion.after,
            "put_off": self.put_off,
            "planned": {name: getattr(old, name) for name in names},
        }


def walked(way: Way, next_changes_rad: tuple[float, ...], scene: BipedScene) -> WalkingStep | str:
    """Return the step as a way out leads it, or why it cannot be walked."""
    old, frame, end, foot = way.planned.step, way.planned.frame, way.motion.end, way.motion.foot
    floor = old.waypoint_m[2] + way.moved.height_change_m
    waypoint = _waypoint(way, scene, floor)
    rest = None
    if old.rest_s is not None and not way.put_off:
        found = _rest(way, scene)
        if isinstance(found, str):
            return found
        rest = found
    dy1, dy2 = end.left_m - frame.into(waypoint)[1], foot.left_m - end.left_m
    apex_m = floor + scene.robot.apex_height_m
    first_s, second_s = _halves(way)
    return replace(
        old,
        length_m=old.length_m + (way.outcome[0] - old.sagittal_cells) * scene.walking.fine_cell_m,
        height_change_m=way.moved.height_change_m,
        next_waypoint_m=waypoint,
        next_foot_m=(*frame.out(*foot), floor),
        first_half_s=first_s,
        second_half_s=second_s,
        switch_m=frame.out(way.motion.switch.ahead_m, way.motion.switch.left_m),
        switch_velocity_mps=frame.turned(way.motion.switch.ahead_mps, way.motion.switch.left_mps),
        next_com_m=(*frame.out(end.ahead_m, end.left_m), apex_m),
        next_velocity_mps=frame.turned(end.ahead_mps, end.left_mps),
        next_side_speed_mps=end.left_mps,
        dy1_m=dy1,
        dy2_m=dy2,
        next_apex_speed_mps=end.ahead_mps,
        next_heading_changes_rad=next_changes_rad,
        sign_alternates=(dy1 + dy2) * _offset_before(old) < 0,
        dy2_in_range=_in_range(abs(dy2), old.omega_radps, scene),
        rest_s=None if rest is None else rest.duration_s,
        rest_com_m=None if rest is None else (*frame.out(end.ahead_m, rest.com_left_m), apex_m),
        closing_foot_m=None if rest is None else (*frame.out(foot.ahead_m, rest.closing_left_m), floor),
        lateral_cells=way.outcome[1],
        sagittal_cells=way.outcome[0],
    )


def _waypoint(way: Way, scene: BipedScene, floor_m: float) -> Point:
    """Return the waypoint that a way out leads to."""
    cell, old = scene.walking.fine_cell_m, way.planned.step.next_waypoint_m
    east, north = way.shift[1] * cell, -way.shift[0] * cell
    cos, sin = math.cos(scene.grid.rotation_rad), math.sin(scene.grid.rotation_rad)
    return old[0] + cos * east - sin * north, old[1] + sin * east + cos * north, floor_m


def _halves(way: Way) -> tuple[float, float]:
    """Return how long both halves really last."""
    planned, first_s = way.planned, way.planned.step.first_half_s
    after = lasting(way.motion.after)
    if planned.switched:
        return first_s, planned.time_s - first_s + after
    return planned.time_s + lasting(way.motion.before), after


def _rest(way: Way, scene: BipedScene) -> Rest | str:
    """Return how the robot comes to rest after a stop, or why it does not."""
    end, foot = way.motion.end, way.motion.foot
    if abs(end.left_mps) > 1e-9 or abs(end.ahead_mps - STOP_SPEED_MPS) > 1e-9:
        return "the robot is too fast to stop"
    rest = rest_after(foot.left_m, end.left_m, scene.walking.dy2_m, STOP_SPEED_MPS, scene.robot)
    return rest or "no double support after the stop keeps the centre of pressure between the feet"


def _offset_before(step: WalkingStep) -> float:
    """Return how far the stance foot stands left of the waypoint in the heading before the step."""
    yaw = step.yaw_rad - step.heading_change_rad
    dx, dy = step.foot_m[0] - step.waypoint_m[0], step.foot_m[1] - step.waypoint_m[1]
    return math.cos(yaw) * dy - math.sin(yaw) * dx


def _in_range(dy2_m: float, omega_radps: float, scene: BipedScene) -> bool:
    """Return whether Def. V.2 holds."""
    tan, (low, high) = math.tan(scene.walking.turn_rad), scene.walking.apex_speed_mps
    return high * tan / omega_radps <= dy2_m <= low / (omega_radps * tan)


def transition(outcome: tuple[int, int], displaced: tuple[int, int], yaw_grid_rad: float) -> str:
    """Return the flag t_nd of a step: nominal, forward, backward, left or right.

    Args:
        outcome: sagittal and lateral, in fine cells.
        displaced: rows and columns beyond it.
        yaw_grid_rad: heading of the step in the grid frame.
    """
    cos, sin = math.cos(yaw_grid_rad), math.sin(yaw_grid_rad)
    ahead = outcome[0] + cos * displaced[1] - sin * displaced[0]
    left = outcome[1] - cos * displaced[0] - sin * displaced[1]
    if abs(ahead) > 0.5:
        return "forward" if ahead > 0 else "backward"
    if abs(left) > 0.5:
        return "left" if left > 0 else "right"
    return "nominal"

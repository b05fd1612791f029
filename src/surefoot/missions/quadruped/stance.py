"""How a quadruped stands between two motions, and the motion that is sent to whoever tracks it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from surefoot.footholds import Options, Problem, retarget
from surefoot.footholds.gaits import NAMED
from surefoot.footholds.plan import Plan
from surefoot.footholds.problem import Array, nominal_feet
from surefoot.missions.quadruped.world import World, on_plane
from surefoot.robots.quadruped import Quadruped
from surefoot.skills.patches import Rectangle
from surefoot.skills.quadruped_terrain import Point
from surefoot.skills.values import Cell

STEP_S = 0.025


@dataclass(frozen=True, slots=True, eq=False)
class Stance:
    """A robot that stands on four feet; world frame.

    Attributes:
        cell: of the map.
        quarter_turns: its heading, in units of 90 degrees from +x, counter-clockwise.
        base_m: of the base, shape (3,).
        feet_m: shape (4, 3).
    """

    cell: Cell
    quarter_turns: int
    base_m: Array
    feet_m: Array

    @property
    def rpy_rad(self) -> Array:
        """Roll, pitch and yaw of the base."""
        return heading_rpy_rad(self.quarter_turns)


@dataclass(frozen=True, slots=True, eq=False)
class Segment:
    """One motion of the mission: what is sent to the controller that tracks it.

    It begins and ends at rest on four feet. Sample i of the plan stands for the time ``start_s + i * step_s``, and the
    pose at ``end_s`` is that of the last sample.

    Attributes:
        number: from 0.
        problem: robot, gait, ground, poses, options: all that the plan was made for.
        plan: base, orientation, feet and forces at every sample.
        start_s: when it begins [s of the mission].
    """

    number: int
    problem: Problem
    plan: Plan
    start_s: float

    @property
    def end_s(self) -> float:
        """When the robot stands again [s of the mission]."""
        return self.start_s + self.problem.gait.horizon_s

    def at(self, time_s: float) -> int:
        """Return the sample of a time of the mission; the first and the last one are held before and after."""
        sample = math.floor((time_s - self.start_s) / self.problem.step_s + 1e-9)
        return int(np.clip(sample, 0, self.problem.samples - 1))


def heading_rpy_rad(quarter_turns: int) -> Array:
    """Return roll, pitch and yaw of a level robot."""
    return np.array([0.0, 0.0, quarter_turns * math.pi / 2])


def standing_problem(
    robot: Quadruped, world: World, place_m: Point, quarter_turns: int, *, joint_reach: bool = False
) -> Problem:
    """Return the program of standing about a place, on the ground of its cell; for re-targeting."""
    cell = world.terrain.cell_at(place_m)
    height_m = world.height_m(cell)
    wished = np.array([*place_m, height_m - robot.foot_reference_m[2]])
    rpy = heading_rpy_rad(quarter_turns)
    half = world.terrain.cell_m / 2
    box = Rectangle(-half, -half, half, half).moved(*place_m)
    polygons = tuple(
        one
        for one, part in world.ground_in(box)
        if abs(float(on_plane(one, np.array([[part.centroid.x, part.centroid.y]]))[0, 2]) - height_m) < _LEVEL_M
    )
    return Problem(
        robot=robot,
        gait=NAMED["trot-2s"],
        step_s=STEP_S,
        start_m=wished,
        start_rpy_rad=rpy,
        feet_m=nominal_feet(robot, wished, rpy),
        goal_m=wished,
        goal_rpy_rad=rpy,
        polygons=polygons,
        options=Options(joint_reach=joint_reach),
    )


_LEVEL_M = 0.08
"""Ground that differs by more from the mean of a cell is no part of it: other measures call it another level."""


def stance_about(
    robot: Quadruped, world: World, place_m: Point, quarter_turns: int, *, joint_reach: bool = False
) -> Stance | None:
    """Return how the robot can stand nearest to a place; None where it cannot, or outside of the map."""
    if not _on_map(world, place_m):
        return None
    problem = standing_problem(robot, world, place_m, quarter_turns, joint_reach=joint_reach)
    if not problem.polygons:
        return None
    found = retarget(problem)
    if found.position_m is None or found.feet_m is None:
        return None
    place_m = float(found.position_m[0]), float(found.position_m[1])
    if not _on_map(world, place_m):
        return None
    cell = world.terrain.cell_at(place_m)
    return Stance(cell, quarter_turns % 4, found.position_m, found.feet_m)


def _on_map(world: World, place_m: Point) -> bool:
    terrain = world.terrain
    (x, y), (rows, columns) = terrain.origin_m, terrain.cells
    return 0 <= (place_m[0] - x) // terrain.cell_m < rows and 0 <= (place_m[1] - y) // terrain.cell_m < columns

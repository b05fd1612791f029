"""A foothold problem: robot, gait, terrain, two poses, options; and what follows from it without solving anything."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import SurefootError
from surefoot.footholds.gaits import Footstep, FreeGait, Gait, contact_table, footsteps
from surefoot.footholds.terrain import Polygon
from surefoot.robots.quadruped import Quadruped

Array = NDArray[np.float64]
GRAVITY_MPS2 = 9.81


@dataclass(frozen=True, slots=True)
class Weights:
    """Weights of the squared deviations, the same on all axes (Zhou et al. 2025, Table I)."""

    position: float = 1000.0
    orientation: float = 1000.0
    foot: float = 1000.0
    acceleration: float = 10.0
    angular_acceleration: float = 10.0
    foot_acceleration: float = 0.5
    force: float = 0.1


_ANY_GAP = 0.999


@dataclass(frozen=True, slots=True)
class Options:
    """What can be switched.

    Attributes:
        clearance_m: height of the swing foot above lift-off and touch-down; 0 for no such rows.
        collision: whether the feet keep to the free regions.
        collision_windows: how many windows the horizon is cut into for that.
        moment_balance: whether forces exert moments, about levers of the reference motion.
        tilt_max_rad: with moment balance, largest deviation of each angle from its reference.
        com_support_m: largest distance of the base from the mean of the feet in contact, per horizontal axis, whenever
            three or more are; None for no such rows.
        joint_reach: whether feet keep to where the legs reach with their joints' limits, inside the reach box; not with
            a free gait.
        pitch_keyframe: whether the reference pitch passes the slope of the motion half way.
        cell_s: with a free gait, how long the cells are in which a foot is in contact or not.
        min_dwell_cells: with a free gait, how many cells a stance or a swing lasts at least; what the ends cut off may
            be shorter, as the robot stands before and after.
        gap: relative gap at which the search stops.
        first_plan: whether any plan will do, so that the search stops at the first one.
        time_limit_s: of the search.
    """

    clearance_m: float = 0.05
    collision: bool = False
    collision_windows: int = 30
    moment_balance: bool = False
    tilt_max_rad: float = 0.35
    com_support_m: float | None = None
    joint_reach: bool = False
    pitch_keyframe: bool = False
    cell_s: float = 0.1
    min_dwell_cells: int = 1
    gap: float = 1e-4
    first_plan: bool = False
    time_limit_s: float = 10.0

    @property
    def stop_gap(self) -> float:
        """Return the relative gap at which the search stops, whatever was asked for."""
        return _ANY_GAP if self.first_plan else self.gap


@dataclass(frozen=True, eq=False)
class Problem:
    """A foothold problem with everything filled in; SI units, world frame, feet in the order FL, FR, RL, RR.

    Attributes:
        robot: its numbers.
        gait: its contact modes, or how long the gait lasts that is to be found.
        step_s: time between samples.
        start_m: base position at sample 0.
        start_rpy_rad: roll, pitch, yaw there.
        feet_m: where the feet stand, shape (4, 3).
        goal_m: base position at the last sample.
        goal_rpy_rad: roll, pitch, yaw there.
        polygons: where feet may stand.
        free_regions: pairs (A, b); a point is free when ``A @ p <= b`` in one of them.
        options: switches.
        weights: of the cost.
        gravity_mps2: downwards.
    """

    robot: Quadruped
    gait: Gait | FreeGait
    step_s: float
    start_m: Array
    start_rpy_rad: Array
    feet_m: Array
    goal_m: Array
    goal_rpy_rad: Array
    polygons: tuple[Polygon, ...]
    free_regions: tuple[tuple[Array, Array], ...] = ()
    options: Options = field(default_factory=Options)
    weights: Weights = field(default_factory=Weights)
    gravity_mps2: float = GRAVITY_MPS2
    source: Any = None

    @cached_property
    def contacts(self) -> NDArray[np.bool_]:
        """Which feet are in contact at which sample, shape (N, 4)."""
        if isinstance(self.gait, FreeGait):
            raise SurefootError("a problem whose gait is free has no contacts; give it the gait that was found")
        return contact_table(self.gait, self.step_s)

    @cached_property
    def samples(self) -> int:
        """How many samples there are."""
        return round(self.gait.horizon_s / self.step_s)

    @cached_property
    def footsteps(self) -> tuple[Footstep, ...]:
        """All footsteps, by foot and then by time."""
        return footsteps(self.contacts)

    @cached_property
    def base_reference_m(self) -> Array:
        """Reference of the base, linear from start to goal, shape (N, 3)."""
        part = np.arange(self.samples)[:, None] / (self.samples - 1)
        reference: Array = self.start_m + part * (self.goal_m - self.start_m)
        return reference

    @cached_property
    def rpy_reference_rad(self) -> Array:
        """Reference of the orientation, linear (by way of the slope half way if asked for), shape (N, 3)."""
        part = np.arange(self.samples)[:, None] / (self.samples - 1)
        reference: Array = self.start_rpy_rad + part * (self.goal_rpy_rad - self.start_rpy_rad)
        if self.options.pitch_keyframe:
            ahead = self.goal_m - self.start_m
            slope = -math.atan2(ahead[2], math.hypot(ahead[0], ahead[1]))
            knots = [self.start_rpy_rad[1], slope, self.goal_rpy_rad[1]]
            reference[:, 1] = np.interp(part[:, 0], [0.0, 0.5, 1.0], knots)
        return reference

    @cached_property
    def rotations(self) -> Array:
        """Rotation matrices base to world of the reference orientation, shape (N, 3, 3)."""
        return rotations_of(self.rpy_reference_rad)

    @cached_property
    def levers_m(self) -> Array:
        """Nominal feet relative to the base, in world axes, shape (N, 4, 3)."""
        levers: Array = np.einsum("iab,jb->ija", self.rotations, np.array(self.robot.feet_m))
        return levers

    @cached_property
    def foot_reference_m(self) -> Array:
        """Reference of the feet, shape (N, 4, 3)."""
        return self.base_reference_m[:, None, :] + self.levers_m

    @cached_property
    def start_polygons(self) -> tuple[int, ...]:
        """The first polygon that holds each start foot; -1 where there is none."""
        return tuple(
            next((r for r, one in enumerate(self.polygons) if one.excess(foot) <= 1e-6), -1) for foot in self.feet_m
        )

    @cached_property
    def support_index(self) -> NDArray[np.int64]:
        """The footstep that a foot stands on at a sample, -1 for the start foothold, -2 in swing; shape (N, 4)."""
        index = np.where(self.contacts, -1, -2)
        for number, footstep in enumerate(self.footsteps):
            index[footstep.touch : footstep.leave, footstep.foot] = number
        return index

    @property
    def gravity_cost(self) -> float:
        """The part of the objective that only holds the robot's weight up: its force cost with all feet sharing it."""
        counts = self.contacts.sum(axis=1)
        weight_n = self.robot.mass_kg * self.gravity_mps2
        return float(self.weights.force * weight_n**2 * (1.0 / counts[counts > 0]).sum())

    def windows(self) -> tuple[range, ...]:
        """Return the samples of every collision window; neighbours share one."""
        count, last = self.options.collision_windows, self.samples - 1
        return tuple(range(w * last // count, (w + 1) * last // count + 1) for w in range(count))


def rotations_of(rpy_rad: Array) -> Array:
    """Return Rz(yaw) Ry(pitch) Rx(roll) for angles of shape (n, 3)."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy_rad).T, np.sin(rpy_rad).T
    rows = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def nominal_feet(robot: Quadruped, position_m: Array, rpy_rad: Array) -> Array:
    """Return where the feet stand nominally below a pose, shape (4, 3)."""
    rotation = rotations_of(np.asarray(rpy_rad, dtype=float)[None, :])[0]
    feet: Array = np.asarray(position_m, dtype=float) + np.array(robot.feet_m) @ rotation.T
    return feet


def reach_span(problem: Problem) -> float:
    """Return a distance that no two places of base and feet exceed, in any motion [m].

    Whatever is in contact stands on a polygon, and base and feet are within reach of each other; in flight the base
    falls for as long as the longest flight lasts.
    """
    points = np.concatenate(
        [*(one.vertices_m for one in problem.polygons), problem.feet_m, problem.start_m[None], problem.goal_m[None]]
    )
    robot = problem.robot
    span = float(np.linalg.norm(points.max(axis=0) - points.min(axis=0)))
    arm = math.dist((0, 0, 0), robot.foot_reference_m) + math.dist((0, 0, 0), robot.foot_reach_m)
    longest = problem.samples if isinstance(problem.gait, FreeGait) else _longest_flight(problem)
    return span + 4 * arm + problem.gravity_mps2 * (longest * problem.step_s) ** 2


def _longest_flight(problem: Problem) -> int:
    longest, current = 0, 0
    for held in (bool(row.any()) for row in problem.contacts):
        current = 0 if held else current + 1
        longest = max(longest, current)
    return longest


def impossible_cost(problem: Problem) -> float:
    """Return a cost that no motion reaches: whatever costs more is infeasible.

    With D the largest distance between any two places that base or feet can take, accelerations are at most 2 D / dt^2,
    forces are bounded by the joint torques, angular accelerations by the base torque; the weighted squares of all that
    are added up, twice for good measure.
    """
    robot, weights, reach = problem.robot, problem.weights, reach_span(problem)
    horizon = problem.samples * problem.step_s
    rate = 2 * reach / problem.step_s**2
    pull = robot.mass_kg * (rate + problem.gravity_mps2)
    push = max(float(np.linalg.norm(np.linalg.inv(np.array(j)), 2)) for j in robot.jacobians) * math.dist(
        (0, 0, 0), robot.torque_max_nm
    )
    spin = 2 * robot.base_torque_max_nm / min(robot.inertia_kgm2)
    angle = float(np.abs(problem.rpy_reference_rad).max()) + spin * horizon**2
    squares = (weights.position + 4 * weights.foot) * reach**2
    squares += (weights.acceleration + 4 * weights.foot_acceleration) * rate**2
    squares += weights.force * (pull**2 + 4 * push**2)
    squares += 3 * weights.orientation * angle**2 + 3 * weights.angular_acceleration * spin**2
    return 2 * problem.samples * squares

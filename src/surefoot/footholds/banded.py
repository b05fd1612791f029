"""The cost of a contact table as one pentadiagonal system, the same on all three axes, compiled.

Second differences reach back two samples, and a foot that stands keeps the point at which its last swing ended. So the
unknown points of the base (all samples between the ends), then of every foot (one per swing sample, the last of a swing
is the foothold) make a matrix with two diagonals below the main one, without any coupling between base and feet. It is
the program of ``reduction`` with forces shared equally; rows are kept elsewhere (``active``).
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from surefoot.footholds.problem import Problem
from surefoot.footholds.rows import Array, Index
from surefoot.footholds.terrain import hull_of

Flags = NDArray[np.bool_]

KNOWN = -1


class Givens(NamedTuple):
    """What the programs of all contact tables share.

    Attributes:
        step_s: between samples.
        weights: of the base, its acceleration, the feet, their acceleration; of the force, times the mass squared.
        up_mps2: gravity.
        clearance_m: of swings.
        ends_m: the base where it is known, shape (N, 3).
        base_m: reference of the base, shape (N, 3).
        start_m: of the feet, shape (4, 3).
        feet_m: reference of the feet, shape (N, 4, 3).
        turns: reference orientation, shape (N, 3, 3).
        nominal_m: middles of the reach boxes, shape (4, 3).
        reach_m: half their sides.
        planes: sides of the polygons, the last ones repeated, shape (P, K, 3).
        bounds: shape (P, K).
        normals: shape (P, 3).
        offsets: shape (P,).
        pyramids: rows of the friction pyramids, shape (P, 5, 3).
        grounds: polygons of the first stances, shape (4,).
        levers: how a force per foot acts on its joints, shape (4, 3, 3).
        torques_nm: limits, shape (3,).
        mass_kg: of the robot.
    """

    step_s: float
    weights: Array
    up_mps2: float
    clearance_m: float
    ends_m: Array
    base_m: Array
    start_m: Array
    feet_m: Array
    turns: Array
    nominal_m: Array
    reach_m: Array
    planes: Array
    bounds: Array
    normals: Array
    offsets: Array
    pyramids: Array
    grounds: Index
    levers: Array
    torques_nm: Array
    mass_kg: float


class System(NamedTuple):
    """The cost of one contact table: factors of its matrix, and what is least without any rows.

    Attributes:
        points: which unknown point a foot is at, or ``KNOWN`` at the start, shape (N, 4).
        begins: first point of base and feet, and of nothing, shape (6,).
        supports: the footstep on which a foot stands, -1 for its first stance, -2 in swing, shape (N, 4).
        carried: how many feet are in contact, shape (N,).
        steps: foot, first swing sample and first stance sample of every footstep, shape (S, 3).
        pivots: inverse of D in L D L'.
        near: first diagonal of L below the main one.
        far: second one.
        free_m: the points of least cost, shape (points, 3).
        linear: of the cost, shape (points, 3).
        constant: of the cost.
    """

    points: Index
    begins: Index
    supports: Index
    carried: Index
    steps: Index
    pivots: Array
    near: Array
    far: Array
    free_m: Array
    linear: Array
    constant: float


def givens_of(problem: Problem) -> Givens:
    """Return what the programs of a problem share, whatever the gait."""
    weights, robot = problem.weights, problem.robot
    ends = np.zeros((problem.samples, 3))
    ends[0], ends[-2:] = problem.start_m, problem.goal_m
    hulls = [hull_of([one]) for one in problem.polygons]
    most = max(len(one.bounds) for one in hulls)
    places = [np.minimum(np.arange(most), len(one.bounds) - 1) for one in hulls]
    return Givens(
        step_s=float(problem.step_s),
        weights=np.array([
            weights.position, weights.acceleration, weights.foot, weights.foot_acceleration,
            weights.force * robot.mass_kg**2,
        ]),
        up_mps2=float(problem.gravity_mps2),
        clearance_m=float(problem.options.clearance_m),
        ends_m=ends,
        base_m=np.ascontiguousarray(problem.base_reference_m),
        start_m=np.ascontiguousarray(problem.feet_m, dtype=np.float64),
        feet_m=np.ascontiguousarray(problem.foot_reference_m),
        turns=np.ascontiguousarray(problem.rotations),
        nominal_m=np.array(robot.feet_m, dtype=np.float64),
        reach_m=np.array(robot.foot_reach_m, dtype=np.float64),
        planes=np.array([one.planes[at] for one, at in zip(hulls, places, strict=True)]),
        bounds=np.array([one.bounds[at] for one, at in zip(hulls, places, strict=True)]),
        normals=np.array([one.normal for one in problem.polygons]),
        offsets=np.array([one.offset for one in hulls], dtype=np.float64),
        pyramids=np.array([one.pyramid for one in problem.polygons]),
        grounds=np.array(problem.start_polygons, dtype=np.int64),
        levers=np.array(robot.jacobians, dtype=np.float64),
        torques_nm=np.array(robot.torque_max_nm, dtype=np.float64),
        mass_kg=float(robot.mass_kg),
    )  # fmt: skip


@numba.njit(cache=True, error_model="numpy")
def base_point(sample: int, samples: int) -> int:
    """Return which unknown point the base is at, or ``KNOWN`` at its ends."""
    return sample - 1 if 0 < sample < samples - 2 else KNOWN


@numba.njit(cache=True, error_model="numpy")
def points_of(contacts: Flags) -> tuple[Index, Index, Index, Index]:
    """Return where points of base and feet begin, at which points the feet are, on which footsteps, and these."""
    samples = len(contacts)
    points, supports = np.full((samples, 4), KNOWN, dtype=np.int64), np.full((samples, 4), -1, dtype=np.int64)
    steps, begins = np.zeros((2 * samples, 3), dtype=np.int64), np.zeros(6, dtype=np.int64)
    count, size = 0, samples - 3
    for foot in range(4):
        begins[foot + 1] = size
        for sample in range(1, samples):
            if not contacts[sample, foot]:
                points[sample, foot], supports[sample, foot] = size, -2
                size += 1
                if contacts[sample - 1, foot]:
                    steps[count, 0], steps[count, 1] = foot, sample
                continue
            points[sample, foot], supports[sample, foot] = points[sample - 1, foot], supports[sample - 1, foot]
            if not contacts[sample - 1, foot]:
                supports[sample, foot], steps[count, 2] = count, sample
                count += 1
    begins[5] = size
    return begins, points, supports, steps[:count].copy()


@numba.njit(cache=True, error_model="numpy")
def system_of(given: Givens, contacts: Flags) -> System:
    """Return the cost of a contact table."""
    samples = len(contacts)
    begins, points, supports, steps = points_of(contacts)
    carried, size = contacts.sum(axis=1), begins[5]
    bands, linear = np.zeros((size, 3)), np.zeros((size, 3))
    constant = 0.0
    place, factor, known = np.zeros(3, dtype=np.int64), np.zeros(3), np.zeros(3)
    position, moved, track, swung, shared = given.weights
    rate = given.step_s**-2
    for block in range(5):
        weight = position if block == 4 else track
        for sample in range(samples):
            at = base_point(sample, samples) if block == 4 else points[sample, block]
            wanted = given.base_m[sample] if block == 4 else given.feet_m[sample, block]
            here = given.ends_m[sample] if block == 4 else given.start_m[block]
            for axis in range(3):
                if at >= 0:
                    linear[at, axis] -= 2 * weight * wanted[axis]
                    constant += weight * wanted[axis] ** 2
                else:
                    constant += weight * (here[axis] - wanted[axis]) ** 2
            if at >= 0:
                bands[at, 0] += 2 * weight
            if sample == 0:
                continue
            push = 0.0
            if block == 4:
                push = shared / carried[sample] if carried[sample] else 0.0
            bend = moved + push if block == 4 else swung
            known[:] = 0.0
            for back in range(3):
                earlier = max(sample - back, 0)
                place[back] = base_point(earlier, samples) if block == 4 else points[earlier, block]
                factor[back] = rate * ((1.0, -2.0, 1.0)[back] if sample > 1 else (1.0, -1.0, 0.0)[back])
                if place[back] < 0:
                    known += factor[back] * (given.ends_m[earlier] if block == 4 else given.start_m[block])
                    factor[back] = 0.0
                for before in range(back):
                    if place[before] == place[back]:
                        factor[before] += factor[back]
                        factor[back] = 0.0
            constant += bend * (known**2).sum()
            constant += push * (2 * known[2] * given.up_mps2 + given.up_mps2**2)
            for one in range(3):
                if factor[one] == 0.0:
                    continue
                for axis in range(3):
                    linear[place[one], axis] += 2 * bend * factor[one] * known[axis]
                linear[place[one], 2] += 2 * push * factor[one] * given.up_mps2
                for other in range(3):
                    if factor[other] != 0.0 and place[other] <= place[one]:
                        bands[place[one], place[one] - place[other]] += 2 * bend * factor[one] * factor[other]
    four = shared / 4
    constant += moved * four / (moved + four) * given.up_mps2**2
    near, far = factored(bands)
    pivots = 1.0 / bands[:, 0]
    free = linear.copy()
    free *= -1.0
    for axis in range(3):
        solved(pivots, near, far, free, axis, 0, size)
    return System(points, begins, supports, carried, steps, pivots, near, far, free, linear, constant)


@numba.njit(cache=True, error_model="numpy")
def factored(bands: Array) -> tuple[Array, Array]:
    """Factor a pentadiagonal matrix as L D L'; D replaces the main diagonal, and L's others are returned."""
    size = len(bands)
    near, far = np.zeros(size), np.zeros(size)
    for row in range(size):
        if row > 1:
            far[row] = bands[row, 2] / bands[row - 2, 0]
            bands[row, 0] -= far[row] ** 2 * bands[row - 2, 0]
        if row > 0:
            rest = bands[row, 1] - (far[row] * bands[row - 2, 0] * near[row - 1] if row > 1 else 0.0)
            near[row] = rest / bands[row - 1, 0]
            bands[row, 0] -= near[row] ** 2 * bands[row - 1, 0]
    return near, far


@numba.njit(cache=True, error_model="numpy")
def solved(pivots: Array, near: Array, far: Array, right: Array, axis: int, begin: int, end: int) -> None:
    """Solve with the factors, in place, along one axis, for some points that are not coupled to others."""
    last, before = 0.0, 0.0
    for row in range(begin, end):
        value = (right[row, axis] - far[row] * before) - near[row] * last
        right[row, axis] = value * pivots[row]
        last, before = value, last
    near_next, far_next, last, before = 0.0, 0.0, 0.0, 0.0
    for row in range(end - 1, begin - 1, -1):
        value = (right[row, axis] - far_next * before) - near_next * last
        right[row, axis] = value
        far_next = far[row + 1] if row + 1 < end else 0.0
        near_next, last, before = near[row], value, last

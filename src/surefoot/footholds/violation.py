"""Which row of a contact table's program its points violate most, compiled (rows and their names: ``table_rows``)."""

from __future__ import annotations

import numba
import numpy as np

from surefoot.footholds.banded import Givens, System, base_point
from surefoot.footholds.rows import Array, Index
from surefoot.footholds.table_rows import CLEAR, FORCE, FORCE_SCALE, REACH, SIDE, TORQUES, force_limit


@numba.njit(cache=True, error_model="numpy")
def worst_row(given: Givens, system: System, polygons: Index, points: Array) -> tuple[float, Index]:
    """Return by how much the inequality that is violated most is [m], and its name; 0 where all hold."""
    name = np.zeros(4, dtype=np.int64)
    base = base_path(given, points)
    worst = _reach(given, system, points, base, 0.0, name)
    worst = _steps(given, system, polygons, points, worst, name)
    return _forces(given, system, polygons, base, worst, name), name


@numba.njit(cache=True, error_model="numpy")
def base_path(given: Givens, points: Array) -> Array:
    """Return the base's path, shape (N, 3)."""
    path = given.ends_m.copy()
    path[1:-2] = points[: len(path) - 3]
    return path


@numba.njit(cache=True, error_model="numpy")
def _reach(given: Givens, system: System, points: Array, base: Array, worst: float, name: Index) -> float:
    samples = len(base)
    for sample in range(samples):
        middle, known = base[sample], base_point(sample, samples) < 0
        for foot in range(4):
            at = system.points[sample, foot]
            if at < 0 and known:
                continue
            here = given.start_m[foot] if at < 0 else points[at]
            for axis in range(3):
                off = -given.nominal_m[foot, axis]
                for along in range(3):
                    off += given.turns[sample, along, axis] * (here[along] - middle[along])
                if abs(off) - given.reach_m[axis] > worst:
                    worst = abs(off) - given.reach_m[axis]
                    name[:] = (REACH, sample, foot, 2 * axis + int(off > 0))
    return worst


@numba.njit(cache=True, error_model="numpy")
def _steps(given: Givens, system: System, polygons: Index, points: Array, worst: float, name: Index) -> float:
    for number in range(len(system.steps)):
        foot, lift, touch = system.steps[number]
        quarter, polygon = (touch - lift) // 4, polygons[number]
        before, landing = system.points[lift - 1, foot], points[system.points[touch, foot]]
        ground = given.start_m[foot, 2] if before < 0 else points[before, 2]
        if given.clearance_m > 0:
            for sample in range(lift + quarter, touch - quarter):
                lack = max(ground, landing[2]) + given.clearance_m - points[system.points[sample, foot], 2]
                if lack > worst:
                    worst = lack
                    name[:] = (CLEAR, number, sample, int(ground <= landing[2]))
        for side in range(given.bounds.shape[1]):
            lack = (given.planes[polygon, side] * landing).sum() - given.bounds[polygon, side]
            if lack > worst:
                worst = lack
                name[:] = (SIDE, number, side, 0)
    return worst


@numba.njit(cache=True, error_model="numpy")
def _forces(given: Givens, system: System, polygons: Index, base: Array, worst: float, name: Index) -> float:
    push = np.zeros(3)
    for sample in range(1, len(base)):
        if system.carried[sample] == 0:
            continue
        share = FORCE_SCALE * given.mass_kg / system.carried[sample]
        for axis in range(3):
            push[axis] = base[sample, axis] - base[sample - 1, axis]
            if sample > 1:
                push[axis] -= base[sample - 1, axis] - base[sample - 2, axis]
            push[axis] *= share / given.step_s**2
        push[2] += share * given.up_mps2
        for foot in range(4):
            support = system.supports[sample, foot]
            if support < -1:
                continue
            polygon = given.grounds[foot] if support < 0 else polygons[support]
            for number in range(TORQUES + given.pyramids.shape[1]):
                lack = -FORCE_SCALE * given.torques_nm[number % 3] if number < TORQUES else 0.0
                for axis in range(3):
                    lack += force_limit(given, polygon, foot, number, axis) * push[axis]
                if lack > worst:
                    worst = lack
                    name[:] = (FORCE, sample, foot, number)
    return worst

"""The rows of a contact table's program over its unknown points, one at a time, compiled.

A row is named by four numbers. FLIGHT: sample, axis. PLANE: footstep. REACH: sample, foot, twice the axis, plus 1 for
the upper bound. CLEAR: footstep, sample, 0 for the ground at lift-off and 1 at touch-down. SIDE: footstep, side of its
polygon. FORCE: sample, foot, limit: three torques, their negatives, and the friction pyramid. The first two are
equations. All others are ``entries >= limit``.
"""

from __future__ import annotations

import numba

from surefoot.footholds.banded import Givens, System, base_point
from surefoot.footholds.rows import Array, Index

FLIGHT, PLANE, REACH, CLEAR, SIDE, FORCE = 0, 1, 2, 3, 4, 5
EQUATIONS = 2
WIDEST = 9
TORQUES = 6
FORCE_SCALE = 1e-3
"""Metres to the newton or newton metre, where violations are compared."""


@numba.njit(cache=True, error_model="numpy")
def write_row(
    given: Givens, system: System, polygons: Index, name: Index, at: Index, factor: Array
) -> tuple[int, float]:
    """Write where a row has entries (three times the point, plus the axis) and which; return their number and limit."""
    if name[0] == FLIGHT:
        limit = -given.up_mps2 if name[2] == 2 else 0.0
        return _bend(given, name[1], name[2], 1.0, 0, limit, at, factor)
    if name[0] == FORCE:
        return _force(given, system, polygons, name, at, factor)
    if name[0] == REACH:
        return _reach(given, system, name, at, factor)
    if name[0] == CLEAR:
        return _clearance(given, system, name, at, factor)
    return _place(given, system, polygons, name, at, factor)


@numba.njit(cache=True, error_model="numpy")
def _bend(
    given: Givens, sample: int, axis: int, size: float, count: int, limit: float, at: Index, factor: Array
) -> tuple[int, float]:
    """Add the base's acceleration along an axis to a row."""
    samples, rate = len(given.turns), given.step_s**-2
    for back in range(3):
        part = size * rate * ((1.0, -2.0, 1.0)[back] if sample > 1 else (1.0, -1.0, 0.0)[back])
        earlier = max(sample - back, 0)
        point = base_point(earlier, samples)
        if point < 0:
            limit -= part * given.ends_m[earlier, axis]
        elif part != 0.0:
            at[count], factor[count] = 3 * point + axis, part
            count += 1
    return count, limit


@numba.njit(cache=True, error_model="numpy")
def force_limit(given: Givens, polygon: int, foot: int, number: int, axis: int) -> float:
    """Return an entry of a limit on the force of a foot: a torque, its negative, or a row of the friction pyramid."""
    if number < TORQUES:
        return float(given.levers[foot, axis, number % 3] * (1.0 if number < 3 else -1.0))
    return float(given.pyramids[polygon, number - TORQUES, axis])


@numba.njit(cache=True, error_model="numpy")
def _force(given: Givens, system: System, polygons: Index, name: Index, at: Index, factor: Array) -> tuple[int, float]:
    _, sample, foot, number = name
    support = system.supports[sample, foot]
    if support < -1:
        return 0, 0.0
    polygon = given.grounds[foot] if support < 0 else polygons[support]
    share = -FORCE_SCALE * given.mass_kg / system.carried[sample]
    count, limit = 0, -FORCE_SCALE * given.torques_nm[number % 3] if number < TORQUES else 0.0
    for axis in range(3):
        size = share * force_limit(given, polygon, foot, number, axis)
        if axis == 2:
            limit -= size * given.up_mps2
        if size != 0.0:
            count, limit = _bend(given, sample, axis, size, count, limit, at, factor)
    return count, limit


@numba.njit(cache=True, error_model="numpy")
def _reach(given: Givens, system: System, name: Index, at: Index, factor: Array) -> tuple[int, float]:
    _, sample, number, bound = name
    axis, sign, count = bound // 2, 1.0 - 2.0 * (bound % 2), 0
    limit = sign * given.nominal_m[number, axis] - given.reach_m[axis]
    foot, base = system.points[sample, number], base_point(sample, len(given.turns))
    for along in range(3):
        size = sign * given.turns[sample, along, axis]
        if size == 0.0:
            continue
        if foot < 0:
            limit -= size * given.start_m[number, along]
        else:
            at[count], factor[count] = 3 * foot + along, size
            count += 1
        if base < 0:
            limit += size * given.ends_m[sample, along]
        else:
            at[count], factor[count] = 3 * base + along, -size
            count += 1
    return count, limit


@numba.njit(cache=True, error_model="numpy")
def _clearance(given: Givens, system: System, name: Index, at: Index, factor: Array) -> tuple[int, float]:
    _, number, sample, side = name
    foot, lift, touch = system.steps[number]
    ground, point = system.points[lift - 1 if side == 0 else touch, foot], system.points[sample, foot]
    if ground == point:
        return 0, given.clearance_m
    at[0], factor[0] = 3 * point + 2, 1.0
    if ground < 0:
        return 1, given.clearance_m + given.start_m[foot, 2]
    at[1], factor[1] = 3 * ground + 2, -1.0
    return 2, given.clearance_m


@numba.njit(cache=True, error_model="numpy")
def _place(given: Givens, system: System, polygons: Index, name: Index, at: Index, factor: Array) -> tuple[int, float]:
    kind, number, side, _ = name
    polygon, count = polygons[number], 0
    point = system.points[system.steps[number, 2], system.steps[number, 0]]
    for along in range(3):
        size = -given.planes[polygon, side, along] if kind == SIDE else given.normals[polygon, along]
        if size != 0.0:
            at[count], factor[count] = 3 * point + along, size
            count += 1
    return count, -given.bounds[polygon, side] if kind == SIDE else given.offsets[polygon]

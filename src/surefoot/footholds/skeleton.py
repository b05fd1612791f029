"""A small relaxation of the program of a free gait, to refute it fast: the base, the total force, and what carries it.

In every cell the robot is carried by nothing, or the base is within reach of at least one polygon during the whole
cell; the total force is 0 in the first case and in the hull of the friction cones and torque limits of four feet in the
other.
All else (which foot, standing still, swings) is left out, so that "infeasible" here is infeasible.
"""

from __future__ import annotations

import numpy as np

from surefoot.footholds.cells import cell_count, cell_samples
from surefoot.footholds.form import StandardForm
from surefoot.footholds.free_form import reach_boxes
from surefoot.footholds.model import INF, gravity
from surefoot.footholds.problem import Problem
from surefoot.footholds.reduction import at_rest, differences
from surefoot.footholds.rows import Array, CostBuilder, Index, Quantity, RowBuilder, Term
from surefoot.footholds.terrain import cone_hull


def skeleton(problem: Problem) -> StandardForm:
    """Return the relaxation; its cost only makes it strictly convex."""
    count, per, size = cell_count(problem), cell_samples(problem), problem.samples
    base, free = at_rest(size, problem.start_m, problem.goal_m)
    force = Quantity.unknown(np.arange(free, free + 3 * size).reshape(size, 3))
    polygons = len(problem.polygons)
    carried = Quantity.unknown(np.arange(free + 3 * size, free + 3 * size + count))
    first = free + 3 * size + count
    near = Quantity.unknown(np.arange(first, first + count * polygons).reshape(count, polygons))
    total = first + count * polygons
    build, costs = RowBuilder(total), CostBuilder(total)
    mass, cell = problem.robot.mass_kg, np.arange(size) // per
    motion = [(mass * np.asarray(f), q) for f, q in differences(base, problem.step_s)]
    pull = mass * gravity(problem)
    law: list[Term] = [(f[1:] if np.ndim(f) else f, q[1:]) for f, q in motion]
    where = (np.arange(1, size)[:, None], np.arange(3))
    build.add("dynamics", pull, pull, [*law, (-1.0, force[1:])], where=where)
    _force_rows(build, problem, force, carried[cell])
    build.add("region", 0.0, 1.0, [(1.0, carried)])
    build.add("region", 0.0, 1.0, [(1.0, near)])
    build.add("region", 1.0, 1.0, [(1.0, carried[[0, count - 1]])])
    cover = [(1.0, carried), *((-1.0, near[:, r]) for r in range(polygons))]
    build.add("contact", -INF, 0.0, cover, where=(np.arange(count),))
    _reach_rows(build, problem, base, near, cell)
    costs.add(1.0, [(1.0, base)], problem.base_reference_m)
    costs.add(1e-4, [(1.0, force)], 0.0)
    costs.add(1.0, [(1.0, carried)], 0.0)
    costs.add(1.0, [(1.0, near)], 0.0)
    return StandardForm(costs.cost(), build.rows(), np.arange(free + 3 * size, total))


def force_limits(problem: Problem) -> Array:
    """Return the largest force of four feet along x, -x, y, -y, z and -z by the torque limits, shape (6,)."""
    limit = np.array(problem.robot.torque_max_nm)
    ways = np.kron(np.eye(3), [[1.0], [-1.0]])
    inverses = [np.abs(ways @ np.linalg.inv(np.array(j)).T) for j in problem.robot.jacobians]
    found: Array = sum((inverse @ limit for inverse in inverses), np.zeros(6))
    return found


def _force_rows(build: RowBuilder, problem: Problem, force: Quantity, carried: Quantity) -> None:
    cone = cone_hull(problem.polygons)
    samples = np.arange(problem.samples)
    if len(cone):
        terms = [(cone[None, :, a], force[:, a][:, None]) for a in range(3)]
        build.add("friction", -INF, 0.0, terms, where=(samples[:, None], np.arange(len(cone))))
    for way, limit in enumerate(force_limits(problem)):
        one = [(1.0 - 2.0 * (way % 2), force[:, way // 2]), (-limit, carried)]
        build.add("torque", -INF, 0.0, one, where=(samples, way))


def _reach_rows(build: RowBuilder, problem: Problem, base: Quantity, near: Quantity, cell: Index) -> None:
    """Keep the base within reach of the polygons that are near in a cell, by some foot."""
    low, high = reach_boxes(problem)[0]
    build.add("boundary", low, high, [(1.0, base)])
    where = (np.arange(problem.samples)[:, None], np.arange(3))
    for r, (least, most) in enumerate(zip(*near_ranges(problem), strict=True)):
        here = near[cell, r][:, None]
        slack = np.maximum(high - most, 0.0)
        build.add("reach", -INF, most + slack, [(1.0, base), (slack, here)], where=(*where, r, 0))
        slack = np.maximum(least - low, 0.0)
        build.add("reach", least - slack, INF, [(1.0, base), (-slack, here)], where=(*where, r, 1))


def near_ranges(problem: Problem) -> tuple[Array, Array]:
    """Return where the base is when some foot reaches a polygon: least and most, shape (R, N, 3) each."""
    half = np.einsum("iab,b->ia", np.abs(problem.rotations), np.array(problem.robot.foot_reach_m))[:, None]
    away, close = (problem.levers_m + half).max(axis=1), (problem.levers_m - half).min(axis=1)
    corners = [one.vertices_m for one in problem.polygons]
    return (
        np.array([points.min(axis=0) - away for points in corners]),
        np.array([points.max(axis=0) - close for points in corners]),
    )


def outside_m(problem: Problem, unknowns: Array) -> Array:
    """Return by how much the base leaves the range of every polygon in every cell, shape (M, R)."""
    base = at_rest(problem.samples, problem.start_m, problem.goal_m)[0].at(unknowns)
    least, most = near_ranges(problem)
    off = np.maximum(np.maximum(least - base, base - most), 0.0).max(axis=2)
    found: Array = off.reshape(len(off), cell_count(problem), -1).max(axis=2).T
    return found


def cost_limit(problem: Problem, form: StandardForm) -> float:
    """Return what no point of the skeleton costs: unknowns are within their boxes, forces within their limits."""
    low, high = reach_boxes(problem)[0]
    size = problem.samples
    far = np.maximum(high - low, np.abs(problem.base_reference_m - low).max(axis=0))
    first = problem.robot.mass_kg * problem.gravity_mps2
    squares = size * (2 * float((far**2).sum()) + 1e-4 * (3 * float(force_limits(problem).max()) ** 2 + first**2))
    return 2 * squares + 2 * len(form.binaries)

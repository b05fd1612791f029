"""The orientation, solved apart: in the paper's model it is coupled to nothing (see docs/footholds.md)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.footholds.problem import Problem
from surefoot.footholds.qp import solve_qp
from surefoot.footholds.reduction import at_rest, differences
from surefoot.footholds.rows import Array, CostBuilder, Index, RowBuilder


@dataclass(frozen=True, slots=True, eq=False)
class Turning:
    """The best orientation over time.

    Attributes:
        feasible: False when the base cannot be turned that fast; None when that stayed open.
        angles_rad: shape (N, 3).
        value: its cost.
        bound: certified lower bound of that cost.
        where: sample and axis of every multiplier, shape (k, 2).
        multipliers: of the base torque rows, shape (k,).
    """

    feasible: bool | None
    angles_rad: Array
    value: float
    bound: float
    where: Index
    multipliers: Array


def turning(problem: Problem) -> Turning:
    """Minimise the orientation's part of Eqs. (3)-(5) and (15)."""
    reference = problem.rpy_reference_rad
    if float(np.abs(np.diff(reference, axis=0)).max()) == 0.0:
        return Turning(True, reference.copy(), 0.0, 0.0, np.zeros((0, 2), dtype=np.int64), np.zeros(0))
    angle, count = at_rest(problem.samples, problem.start_rpy_rad, problem.goal_rpy_rad)
    rate = differences(angle, problem.step_s)
    costs, build = CostBuilder(count), RowBuilder(count)
    costs.add(problem.weights.orientation, [(1.0, angle)], reference)
    costs.add(problem.weights.angular_acceleration, rate, 0.0)
    limit = problem.robot.base_torque_max_nm
    inertia = np.array(problem.robot.inertia_kgm2)
    terms = [(factor * inertia, quantity) for factor, quantity in rate]
    build.add("base torque", -limit, limit, terms, where=(np.arange(problem.samples)[:, None], np.arange(3)))
    rows = build.rows()
    empty = np.diff(rows.matrix.indptr) == 0
    cost = costs.cost()
    constant = rows.pick(empty)
    possible = bool((constant.lower <= 0).all() and (constant.upper >= 0).all())
    rows = rows.pick(~empty)
    answer = solve_qp(cost, rows)
    return Turning(
        feasible=answer.feasible if possible else False,
        angles_rad=angle.at(answer.unknowns),
        value=answer.value,
        bound=answer.bound,
        where=rows.where[:, :2],
        multipliers=answer.multipliers,
    )

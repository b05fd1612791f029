"""One convex quadratic program: PIQP solves it; what PIQP says is turned into bounds that hold whatever it said."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from surefoot.footholds.rows import Array, Cost, Rows

_LIMIT = 1e-30
_LEAST_GAIN = 1e-9
_BROKEN = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class QpAnswer:
    """What became of a program.

    Attributes:
        feasible: True when it was solved, False when the solver found it infeasible, None when it broke down.
        unknowns: the last iterate.
        value: its objective.
        multipliers: one per row, positive where the upper bound presses.
        bound: a lower bound of the objective that ``multipliers`` prove; above ``problem.impossible_cost`` they prove
            infeasibility.
        iterations: of the solver.
    """

    feasible: bool | None
    unknowns: Array
    value: float
    multipliers: Array
    bound: float
    iterations: int


def solve_qp(cost: Cost, rows: Rows, tolerance: float = 1e-9, certain: float = 1e16) -> QpAnswer:
    """Minimise a cost below rows with PIQP.

    Args:
        cost: convex.
        rows: equations are recognised by equal bounds; one-sided rows have infinite bounds.
        tolerance: absolute and relative, on residuals and duality gap.
        certain: a bound beyond which rays of infeasible programs are not stretched any further.
    """
    import piqp  # type: ignore[import-untyped]

    equal = rows.equal
    solver: Any = piqp.SparseSolver()
    settings = solver.settings
    settings.eps_abs = tolerance
    settings.eps_rel = tolerance
    settings.check_duality_gap = True
    settings.eps_duality_gap_abs = 1e-3
    settings.eps_duality_gap_rel = 1e-9
    settings.max_iter = 120
    settings.eps_primal_inf = 1e-12
    solver.setup(
        cost.hessian, cost.linear,
        _columns(rows.matrix[equal]), rows.lower[equal],
        _columns(rows.matrix[~equal]), rows.lower[~equal], rows.upper[~equal],
    )  # fmt: skip
    status = solver.solve()
    result = solver.result
    multipliers = np.zeros(len(rows.lower))
    multipliers[equal] = result.y
    multipliers[~equal] = result.z_u - result.z_l
    unknowns = np.array(result.x)
    feasible = {piqp.PIQP_SOLVED: True, piqp.PIQP_PRIMAL_INFEASIBLE: False}.get(status)
    return _answer(cost, rows, unknowns, multipliers, feasible, int(result.info.iter), certain)


def broken_constant(rows: Rows, certain: float) -> QpAnswer | None:
    """Return the answer where a row without unknowns does not hold, which is proof enough; None where all do."""
    lone = np.diff(rows.matrix.indptr) == 0
    excess = np.where(lone, np.maximum(rows.lower, -rows.upper), -np.inf)
    worst = int(excess.argmax()) if len(excess) else 0
    if not len(excess) or excess[worst] <= _BROKEN:
        return None
    multipliers = np.zeros(len(rows.lower))
    multipliers[worst] = certain / excess[worst] * (1.0 if -rows.upper[worst] > rows.lower[worst] else -1.0)
    return QpAnswer(False, np.zeros(rows.matrix.shape[1]), np.inf, multipliers, certain, 0)


def _columns(matrix: sp.csr_matrix) -> sp.csc_matrix:
    columns = sp.csc_matrix(matrix)
    columns.sort_indices()
    return columns


def _answer(
    cost: Cost, rows: Rows, unknowns: Array, multipliers: Array, feasible: bool | None, iterations: int, certain: float
) -> QpAnswer:
    if not (np.isfinite(unknowns).all() and np.isfinite(multipliers).all()):
        nothing = np.zeros(len(rows.lower))
        return QpAnswer(None, np.zeros(len(cost.linear)), np.inf, nothing, -np.inf, iterations)
    multipliers = clipped(rows, multipliers)
    value = cost.at(unknowns)
    if feasible is False:
        multipliers, bound = scaled_ray(cost, rows, unknowns, multipliers, certain)
    else:
        bound = lower_bound(cost, rows, unknowns, multipliers)
    return QpAnswer(feasible, unknowns, value, multipliers, bound, iterations)


def clipped(rows: Rows, multipliers: Array) -> Array:
    """Return multipliers without those that press on a bound that is not there."""
    kept = multipliers.copy()
    kept[(multipliers > 0) & np.isinf(rows.upper)] = 0.0
    kept[(multipliers < 0) & np.isinf(rows.lower)] = 0.0
    return kept


def lower_bound(cost: Cost, rows: Rows, unknowns: Array, multipliers: Array) -> float:
    """Return what any multipliers prove about the least cost, by weak duality.

    The Lagrangian is at least its value at ``unknowns`` minus what its slope there can still gain against the curvature
    of the cost. Without positive curvature everywhere nothing is proved this way.
    """
    if not (cost.curvature > 0).all():
        return -np.inf
    slope = cost.hessian @ unknowns + cost.linear + rows.matrix.T @ multipliers
    return cost.at(unknowns) + _press(rows, unknowns, multipliers) - float(slope @ (slope / cost.curvature)) / 2


def _press(rows: Rows, unknowns: Array, multipliers: Array) -> float:
    """Return the multipliers' part of the Lagrangian: positive when the rows cannot hold."""
    with np.errstate(invalid="ignore"):
        limits = np.where(multipliers > 0, rows.upper, rows.lower)
    limits = np.where(multipliers == 0, 0.0, limits)
    return float(multipliers @ (rows.matrix @ unknowns) - multipliers @ limits)


def scaled_ray(cost: Cost, rows: Rows, unknowns: Array, multipliers: Array, certain: float) -> tuple[Array, float]:
    """Return multipliers along a direction that prove most, and what they prove (a Farkas ray grows without limit)."""
    multipliers = multipliers / max(float(np.abs(multipliers).max(initial=0.0)), _LIMIT)
    if not (cost.curvature > 0).all():
        return certain / max(_press(rows, unknowns, multipliers), _LEAST_GAIN) * multipliers, -np.inf
    slope = cost.hessian @ unknowns + cost.linear
    tilt = rows.matrix.T @ multipliers
    gain = _press(rows, unknowns, multipliers)
    square = float(tilt @ (tilt / cost.curvature))
    cross = gain - float(slope @ (tilt / cost.curvature))
    length = min(max(cross / max(square, _LIMIT), 0.0), certain / max(abs(gain), _LIMIT))
    stretched = length * multipliers
    return stretched, lower_bound(cost, rows, unknowns, stretched)


class EquationBound:
    """Bounds for costs without positive curvature everywhere: the Lagrangian is minimised below the equations exactly.

    Args:
        cost: positive along every direction that the equations leave free.
        equations: of the program.
    """

    def __init__(self, cost: Cost, equations: Rows) -> None:
        from scipy.sparse.linalg import splu

        self.cost, self.right = cost, equations.lower
        matrix = equations.matrix
        self.factors: Any = splu(sp.bmat([[cost.hessian, matrix.T], [matrix, None]], format="csc"))

    def bound(self, rows: Rows, multipliers: Array) -> float:
        """Return what the multipliers of rows, which need not hold the equations, prove."""
        size = len(self.cost.linear)
        tilt = rows.matrix.T @ multipliers
        solved = self.factors.solve(np.concatenate([-(self.cost.linear + tilt), self.right]))
        unknowns = solved[:size]
        return self.cost.at(unknowns) + _press(rows, unknowns, multipliers)

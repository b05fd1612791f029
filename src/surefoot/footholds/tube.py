"""Where the base stays: at its ends it is known, and a plan that costs less than the best one keeps it near a path.

The base's part of what prices prove is a quadratic in its path with Hessian H (in every axis), least at a path r*. With
the base at r instead, every plan costs at least ``bound + (r - r*)' H (r - r*) / 2``. So a plan that costs less than
``worth`` keeps each coordinate of each sample within ``sqrt(2 (worth - bound) (H^-1)_ii)`` of r*.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.footholds.cells import cell_count, cell_samples
from surefoot.footholds.problem import Problem
from surefoot.footholds.rows import Array

_EPS_M = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Tube:
    """Bounds of the base's path.

    Attributes:
        low_m: shape (N, 3).
        high_m: shape (N, 3).
    """

    low_m: Array
    high_m: Array


def tube_of_ends(problem: Problem) -> Tube:
    """Return what the ends alone tell: the base is known at sample 0 and at the last two."""
    low = np.full((problem.samples, 3), -np.inf)
    low[0], low[-2:] = problem.start_m, problem.goal_m
    return Tube(low, np.where(np.isfinite(low), low, np.inf))


def tube_below(problem: Problem, inverse: Array, base_m: Array, slack: float) -> Tube:
    """Return where the base stays in plans that cost at most so much more than the prices prove.

    Args:
        problem: whose ends count.
        inverse: of H between the ends, shape (N - 3, N - 3).
        base_m: r*, shape (N, 3).
        slack: worth less bound.
    """
    away = np.zeros((problem.samples, 1))
    away[1:-2, 0] = np.sqrt(2 * max(slack, 0.0) * np.diag(inverse))
    return Tube(base_m - away, base_m + away)


def reachable(problem: Problem, tube: Tube, foot: int, low: Array, high: Array) -> NDArray[np.bool_]:
    """Return in which cells a foot may stand in which boxes, shape (M, B): Eq. (16) at all samples of the cell.

    Args:
        problem: whose cells and reference orientation count.
        tube: of the base.
        foot: which one.
        low: corners of the boxes, shape (B, 3).
        high: shape (B, 3).
    """
    robot, turns = problem.robot, problem.rotations
    arm = turns @ np.array(robot.feet_m[foot])
    half = np.abs(turns) @ np.array(robot.foot_reach_m)
    near, far = (tube.low_m + arm - half)[:, None], (tube.high_m + arm + half)[:, None]
    kept = ((high >= near - _EPS_M) & (low <= far + _EPS_M)).all(axis=2)
    return np.asarray(kept.reshape(cell_count(problem), cell_samples(problem), -1).all(axis=1))

"""Where the base stays: at its ends it is known, a region may be given, and cheap plans keep it near a path.

The base's part of what prices prove is a quadratic in its path with Hessian H (in every axis), least at a path r*. With
the base at r instead, every plan costs at least ``bound + (r - r*)' H (r - r*) / 2``. So a plan that costs less than
``worth`` keeps d = r - r* in an ellipsoid: with C = H^-1 and S = 2 (worth - bound), |d_i| <= sqrt(S C_ii); and where
the deviations d_k of some samples are known to lie in intervals, those of the others lie within sqrt(S) times their
conditional deviation of C_ik C_kk^-1 d_k.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.footholds.cells import cell_count, cell_samples
from surefoot.footholds.problem import Problem
from surefoot.footholds.rows import Array

_EPS_M = 1e-9
CLEAR_M = 0.015
"""What is added to the reach of feet where it decides what they may do, for checkers who cut the ground otherwise."""


@dataclass(frozen=True, slots=True, eq=False)
class Tube:
    """Bounds of the base's path.

    Attributes:
        low_m: shape (N, 3).
        high_m: shape (N, 3).
    """

    low_m: Array
    high_m: Array

    @property
    def empty(self) -> bool:
        """Whether no path is within."""
        return bool((self.low_m > self.high_m + _EPS_M).any())

    def halves(self, sample: int, axis: int, at_m: float) -> tuple[Tube, Tube]:
        """Return the parts below and above a place at a sample."""
        low, high = self.low_m.copy(), self.high_m.copy()
        low[sample, axis], high[sample, axis] = max(at_m, low[sample, axis]), min(at_m, high[sample, axis])
        return Tube(self.low_m, high), Tube(low, self.high_m)


def everywhere(problem: Problem) -> Tube:
    """Return no bounds at all."""
    return Tube(np.full((problem.samples, 3), -np.inf), np.full((problem.samples, 3), np.inf))


def tube_of_ends(problem: Problem) -> Tube:
    """Return what the ends alone tell: the base is known at sample 0 and at the last two."""
    low = np.full((problem.samples, 3), -np.inf)
    low[0], low[-2:] = problem.start_m, problem.goal_m
    return Tube(low, np.where(np.isfinite(low), low, np.inf))


def tube_below(inverse: Array, base_m: Array, slack: float, region: Tube) -> Tube:
    """Return where the base stays in plans that cost at most so much more than the prices prove.

    Args:
        inverse: of H between the ends, shape (N - 3, N - 3).
        base_m: r*, shape (N, 3), which has the ends of all paths.
        slack: worth less bound.
        region: in which the base is.
    """
    low, high = base_m.copy(), base_m.copy()
    span = np.sqrt(2 * max(slack, 0.0))
    for axis in range(3):
        inner = slice(1, -2)
        walls = region.low_m[inner, axis] - base_m[inner, axis], region.high_m[inner, axis] - base_m[inner, axis]
        below, above = _deviations(inverse, span, *walls)
        low[inner, axis] += below
        high[inner, axis] += above
    return Tube(low, high)


def _deviations(inverse: Array, span: float, low: Array, high: Array) -> tuple[Array, Array]:
    """Return how far one coordinate may deviate at every sample, given bounds of some of its deviations."""
    away = span * np.sqrt(np.diag(inverse))
    least, most = np.maximum(-away, low), np.minimum(away, high)
    cut = np.flatnonzero(np.isfinite(low) | np.isfinite(high))
    given = [(cut[k : k + 1], slice(None)) for k in range(len(cut))]
    given += [(cut[k : k + 2], slice(cut[k], cut[k + 1])) for k in range(len(cut) - 1)]
    below, above = least.copy(), most.copy()
    for known, where in given:
        gain = np.linalg.solve(inverse[np.ix_(known, known)], inverse[known, where]).T
        rest = np.diag(inverse)[where] - (gain * inverse[known, where].T).sum(axis=1)
        beside = span * np.sqrt(np.maximum(rest, 0.0))
        one, other = gain * least[known], gain * most[known]
        below[where] = np.maximum(below[where], np.minimum(one, other).sum(axis=1) - beside)
        above[where] = np.minimum(above[where], np.maximum(one, other).sum(axis=1) + beside)
    return below, above


def within_reach(problem: Problem, foot: int, points_m: Array) -> tuple[Array, Array]:
    """Return between which places the base has a point within reach of a foot, Eq. (16), shape (N, B, 3) each."""
    turns = problem.rotations
    arm = (turns @ np.array(problem.robot.feet_m[foot]))[:, None]
    half = (np.abs(turns) @ np.array(problem.robot.foot_reach_m))[:, None]
    return points_m - arm - half, points_m - arm + half


def reachable(problem: Problem, tube: Tube, foot: int, low: Array, high: Array) -> NDArray[np.bool_]:
    """Return in which cells a foot may stand in which boxes, shape (M, B): Eq. (16) at all samples of the cell.

    Args:
        problem: whose cells and reference orientation count.
        tube: of the base.
        foot: which one.
        low: corners of the boxes, shape (B, 3).
        high: shape (B, 3).
    """
    near, far = within_reach(problem, foot, low)[0], within_reach(problem, foot, high)[1]
    kept = ((tube.high_m[:, None] >= near - CLEAR_M) & (tube.low_m[:, None] <= far + CLEAR_M)).all(axis=2)
    return np.asarray(kept.reshape(cell_count(problem), cell_samples(problem), -1).all(axis=1))

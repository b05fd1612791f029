"""The cheapest way of one foot through cells and nodes: stances and swings by turns, a shortest path."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from surefoot.verify.footholds_file import Array
from surefoot.verify.footholds_grid import Grid

_MOST_LEVELS = 5
_LEVEL_M = 0.005
_EPS_M = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Steps:
    """What a foot is charged.

    Attributes:
        linear: on its position at every sample, shape (N, 3).
        constant: at every sample, shape (N,).
        reward: for contact at every sample, shape (N,).
        track: weight of the squared position.
        accelerate: weight of the squared acceleration.
        step_s: between samples.
        per: samples of a cell.
        dwell: cells that a stance between swings, or a swing, lasts at least.
        clearance_m: of the middle of a swing above both its ends.
        near_m: least coordinates within reach at every sample, shape (N, 3).
        far_m: largest ones, shape (N, 3).
    """

    linear: Array
    constant: Array
    reward: Array
    track: float
    accelerate: float
    step_s: float
    per: int
    dwell: int
    clearance_m: float
    near_m: Array
    far_m: Array


def cheapest(steps: Steps, grid: Grid) -> float:
    """Return a lower bound of what any way of the foot costs that stands in the first and the last cell."""
    cells, nodes = len(steps.constant) // steps.per, len(grid.points)
    level, levels_m = _levels(grid.points[:, 2])
    landed = np.full((cells, nodes), np.inf)
    landed[0, -1] = 0.0
    standing, within = _standing(steps, grid), _within(steps, grid, cells)
    lifted = np.full((cells + 1, nodes), np.inf)
    for to in range(1, cells + 1):
        for since in range(to):
            if since == 0 or to == cells or to - since >= steps.dwell:
                cost = np.where(within[since:to].all(axis=0), landed[since] + standing(since, to), np.inf)
                np.minimum(lifted[to], cost, out=lifted[to])
        if to < cells:
            for lift in range(1, to - steps.dwell + 1):
                cost = _swing(steps, grid, lift, to, level, levels_m)
                landed[to, :-1] = np.minimum(landed[to, :-1], (lifted[lift][:, None] + cost).min(axis=0)[:-1])
    return float(lifted[cells].min())


def _within(steps: Steps, grid: Grid, cells: int) -> np.ndarray:
    """Return in which cells footholds that may be drawn to a node are within reach at all samples, shape (M, B)."""
    near, far = steps.near_m[:, None] - _EPS_M, steps.far_m[:, None] + _EPS_M
    kept = ((grid.high >= near) & (grid.low <= far)).all(axis=2)
    return np.asarray(kept.reshape(cells, steps.per, -1).all(axis=1))


def _standing(steps: Steps, grid: Grid) -> Callable[[int, int], Array]:
    """Return a function of two cells: what standing from the one to before the other costs at every node."""
    tilt, fixed = _sums(steps.linear), _sums((steps.constant - steps.reward)[:, None])[:, 0]
    squares = (grid.points**2).sum(axis=1) - grid.spread

    def cost(since: int, to: int) -> Array:
        a, b = since * steps.per, to * steps.per
        found = steps.track * (b - a) * squares + grid.points @ (tilt[b] - tilt[a]) + fixed[b] - fixed[a]
        return np.asarray(found)

    return cost


def _sums(values: Array) -> Array:
    return np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(values, axis=0)])


def _levels(heights_m: Array) -> tuple[Array, Array]:
    """Return the number of the level of every node, and the heights of a few levels."""
    levels = np.unique(np.round(heights_m / _LEVEL_M) * _LEVEL_M)
    while len(levels) > _MOST_LEVELS:
        near = int(np.argmin(np.diff(levels)))
        levels = np.concatenate([levels[:near], [levels[near : near + 2].mean()], levels[near + 2 :]])
    return np.abs(heights_m[:, None] - levels).argmin(axis=1), levels


def _swing(steps: Steps, grid: Grid, lift: int, to: int, level: Array, levels_m: Array) -> Array:
    """Return what swings between two cells cost, from every node to every node."""
    count = (to - lift) * steps.per
    samples = np.arange(lift * steps.per, to * steps.per)
    square = _quadratic(count, steps)
    inverse = np.asarray(np.linalg.inv(square[2:, 2:]), dtype=np.float64)
    gain = square[:2, 2:] @ inverse
    ends = square[:2, :2] - gain @ square[2:, :2]
    linear = steps.linear[samples]
    slope = -gain @ linear[:-1]
    slope[1] += linear[-1]
    fixed = float(steps.constant[samples].sum()) - 0.5 * float((linear[:-1, :2] * (inverse @ linear[:-1, :2])).sum())
    points, spread = grid.points, grid.spread
    before = 0.5 * ends[0, 0] * ((points**2).sum(axis=1) - spread) + points[:, :2] @ slope[0, :2]
    after = 0.5 * ends[1, 1] * ((points**2).sum(axis=1) - spread) + points[:, :2] @ slope[1, :2]
    cost = ends[0, 1] * points @ points.T + before[:, None] + after + fixed
    high = np.array([[_high(steps, inverse, gain, linear[:, 2], p, q) for q in levels_m] for p in levels_m])
    first, last, rest = np.moveaxis(high, 2, 0)
    z, pair = points[:, 2], np.ix_(level, level)
    return np.asarray(cost + first[pair] * z[:, None] + last[pair] * z + rest[pair])


def _quadratic(count: int, steps: Steps) -> Array:
    """Return the second derivatives of a swing's cost: by foothold before, foothold after, and samples between."""
    places = [0, 0, *range(2, count + 1), 1, 1]
    second = np.zeros((count + 1, count + 1))
    for row in range(count + 1):
        for factor, place in zip((1.0, -2.0, 1.0), places[row : row + 3], strict=True):
            second[row, place] += factor
    square = 2 * steps.accelerate / steps.step_s**4 * second.T @ second
    tracked = np.diag([0.0] + [2 * steps.track] * count)
    return np.asarray(square + tracked)


def _high(steps: Steps, inverse: Array, gain: Array, linear: Array, p: float, q: float) -> tuple[float, float, float]:
    """Return slopes at both ends and the constant for the height, with clearance multipliers best between p and q."""
    count = len(linear)
    middle = np.arange(count // 4, min(count - count // 4, count - 1))
    nu = np.zeros(count - 1)
    if steps.clearance_m > 0 and len(middle):
        path = -(gain.T @ np.array([p, q])) - inverse @ linear[:-1]
        lacks = max(p, q) + steps.clearance_m - path[middle]
        if (lacks > 0).any():
            root = np.linalg.cholesky(inverse[np.ix_(middle, middle)])
            nu[middle] = nnls(root.T, np.linalg.solve(root, lacks))[0]
    inner, total = linear[:-1] - nu, float(nu.sum())
    share = (np.sign(p - q) + 1) / 2
    slope = -gain @ inner
    rest = steps.clearance_m * total - 0.5 * float(inner @ inverse @ inner)
    return float(slope[0] + share * total), float(slope[1] + linear[-1] + (1 - share) * total), rest

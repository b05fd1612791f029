"""The cheapest way of one foot through cells and nodes: stances and swings by turns, a shortest path."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from surefoot.verify.footholds.file import Array
from surefoot.verify.footholds.grid import Grid

Index = NDArray[np.int64]

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
        there = np.flatnonzero(within[to, :-1]) if to < cells else np.zeros(0, dtype=np.int64)
        for lift in range(1, to - steps.dwell + 1) if len(there) else ():
            here = np.flatnonzero(np.isfinite(lifted[lift]))
            if len(here):
                cost = _landed(steps, grid, (lift, to), (here, there), lifted[lift, here], level, levels_m)
                landed[to, there] = np.minimum(landed[to, there], cost)
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


def _levels(heights_m: Array) -> tuple[Index, Array]:
    """Return the number of the level of every node, and the heights of a few levels."""
    levels = np.unique(np.round(heights_m / _LEVEL_M) * _LEVEL_M)
    while len(levels) > _MOST_LEVELS:
        near = int(np.argmin(np.diff(levels)))
        levels = np.concatenate([levels[:near], [levels[near : near + 2].mean()], levels[near + 2 :]])
    return np.abs(heights_m[:, None] - levels).argmin(axis=1), levels


def _landed(
    steps: Steps,
    grid: Grid,
    cells: tuple[int, int],
    nodes: tuple[Index, Index],
    lifted: Array,
    level: Index,
    levels_m: Array,
) -> Array:
    """Return the least that it costs to land on some nodes after a swing between two cells from some nodes."""
    (lift, to), (here, there) = cells, nodes
    samples = np.arange(lift * steps.per, to * steps.per)
    inverse, gain, ends = _eliminated(len(samples), steps.track, steps.accelerate, steps.step_s)
    linear = steps.linear[samples]
    slope = -gain @ linear[:-1]
    slope[1] += linear[-1]
    fixed = float(steps.constant[samples].sum()) - 0.5 * float((linear[:-1, :2] * (inverse @ linear[:-1, :2])).sum())
    p, q = grid.points[here], grid.points[there]
    before = lifted + 0.5 * ends[0, 0] * ((p**2).sum(axis=1) - grid.spread[here]) + p[:, :2] @ slope[0, :2] + fixed
    after = 0.5 * ends[1, 1] * ((q**2).sum(axis=1) - grid.spread[there]) + q[:, :2] @ slope[1, :2]
    found = np.full(len(there), np.inf)
    for a in np.unique(level[here]):
        left = level[here] == a
        for b in np.unique(level[there]):
            right = level[there] == b
            first, last, rest = _high(steps, inverse, gain, linear[:, 2], levels_m[a], levels_m[b])
            costs = ends[0, 1] * p[left] @ q[right].T + (before[left] + first * p[left, 2] + rest)[:, None]
            found[right] = np.minimum(found[right], costs.min(axis=0) + after[right] + last * q[right, 2])
    return found


@lru_cache(maxsize=256)
def _eliminated(count: int, track: float, accelerate: float, step_s: float) -> tuple[Array, Array, Array]:
    """Return a swing's inverse between its ends, how the ends pull there, and the second derivatives at the ends."""
    square = _quadratic(count, track, accelerate, step_s)
    inverse = np.asarray(np.linalg.inv(square[2:, 2:]), dtype=np.float64)
    gain = square[:2, 2:] @ inverse
    return inverse, gain, square[:2, :2] - gain @ square[2:, :2]


def _quadratic(count: int, track: float, accelerate: float, step_s: float) -> Array:
    """Return the second derivatives of a swing's cost: by foothold before, foothold after, and samples between."""
    places = [0, 0, *range(2, count + 1), 1, 1]
    second = np.zeros((count + 1, count + 1))
    for row in range(count + 1):
        for factor, place in zip((1.0, -2.0, 1.0), places[row : row + 3], strict=True):
            second[row, place] += factor
    square = 2 * accelerate / step_s**4 * second.T @ second
    tracked = np.diag([0.0] + [2 * track] * count)
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

"""All patterns of one foot at once, the cheap ones most: the smooth counterpart of the cheapest path, compiled.

Every pattern of stances and swings (see ``paths``, with footholds at points) is weighed by exp(-cost / heat). The
value is -heat log of the sum of the weights: never above the cost of the cheapest pattern, smooth in the prices, and
its slope is the mean of all patterns: how much stands where in every cell, and how much swings from where to where.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from surefoot.footholds.paths import Flags
from surefoot.footholds.rows import Array, Index

_FARTHEST = 30.0
_LEAST_PART = 1e-9


class Charges(NamedTuple):
    """What a foot is charged.

    Attributes:
        middle: points that may be stood on, shape (B, 3); the last one is the start foothold.
        half: half their squared lengths, shape (B,).
        level: of every point, shape (B,).
        stood: what standing costs, summed over all cells before, shape (M + 1, B).
        ends: see ``SwingCosts``, shape (M, 3).
        slopes: shape (M, M, 2, 2).
        constants: shape (M, M).
        high_slopes: shape (K, K, M, M, 2).
        high_constants: shape (K, K, M, M).
        within: in which cells which points may be stood on, shape (M, B).
        dwell: least length of a stance between swings, and of a swing.
    """

    middle: Array
    half: Array
    level: Index
    stood: Array
    ends: Array
    slopes: Array
    constants: Array
    high_slopes: Array
    high_constants: Array
    within: Flags
    dwell: int


class Ways(NamedTuple):
    """The mean of all patterns.

    Attributes:
        value: -heat log of the sum of their weights; infinite where there is none.
        standing: how much stands where, shape (M, B).
        swung: how much swings, by levels, first cell in swing and first in stance, shape (K, K, M, M).
        left: the sum of the points that are left, shape (K, K, M, M, 3).
        reached: the sum of the points that are reached, shape (K, K, M, M, 3).
    """

    value: float
    standing: Array
    swung: Array
    left: Array
    reached: Array


@numba.njit(cache=True)
def ways_of(foot: Charges, heat: float) -> Ways:
    """Return the mean of all patterns of a foot.

    Args:
        foot: what it is charged.
        heat: how much dearer a pattern may be that weighs 1/e as much.
    """
    count, points, kinds = foot.within.shape[0], len(foot.middle), foot.high_slopes.shape[0]
    landed, lifted = np.full((count, points), np.inf), np.full((count + 1, points), np.inf)
    landed[0, points - 1] = 0.0
    costs = np.empty((count + 1) * points)
    for to in range(1, count + 1):
        _stand(foot, heat, to, landed, lifted, costs)
        if to < count:
            _land(foot, heat, to, landed, lifted, costs)
    value = _soft_least(lifted[count], points, heat)
    standing, swung = np.zeros((count + 1, points)), np.zeros((kinds, kinds, count, count))
    left, reached = np.zeros((kinds, kinds, count, count, 3)), np.zeros((kinds, kinds, count, count, 3))
    if value < np.inf:
        parts_landed, parts_lifted = np.zeros((count, points)), np.zeros((count + 1, points))
        for point in range(points):
            parts_lifted[count, point] = np.exp(min((value - lifted[count, point]) / heat, 0.0))
        for to in range(count, 0, -1):
            if to < count:
                _landed_from(foot, heat, to, landed, lifted, parts_landed, parts_lifted, swung, left, reached)
            _stood_since(foot, heat, to, landed, lifted, parts_landed, parts_lifted, standing)
    for cell in range(1, count):
        standing[cell] += standing[cell - 1]
    return Ways(value, standing[:count], swung, left, reached)


@numba.njit(cache=True)
def _soft_least(costs: Array, size: int, heat: float) -> float:
    """Return -heat log of the sum of exp(-cost / heat)."""
    best = np.inf
    for k in range(size):
        best = min(best, costs[k])
    if best == np.inf:
        return best
    total = 0.0
    for k in range(size):
        if costs[k] < best + _FARTHEST * heat:
            total += np.exp((best - costs[k]) / heat)
    return float(best - heat * np.log(total))


@numba.njit(cache=True)
def _swing(foot: Charges, lift: int, to: int, p: int, q: int) -> float:
    """Return what a swing between two points costs."""
    s, g, a, b = foot.ends[to - lift], foot.slopes[lift, to], foot.middle[p], foot.middle[q]
    h = foot.high_slopes[foot.level[p], foot.level[q], lift, to]
    cost = foot.constants[lift, to] + foot.high_constants[foot.level[p], foot.level[q], lift, to]
    cost += s[0] * foot.half[p] + s[2] * foot.half[q] + s[1] * (a[0] * b[0] + a[1] * b[1] + a[2] * b[2])
    cost += g[0, 0] * a[0] + g[1, 0] * a[1] + h[0] * a[2] + g[0, 1] * b[0] + g[1, 1] * b[1] + h[1] * b[2]
    return float(cost)


@numba.njit(cache=True)
def _may_stand(foot: Charges, since: int, to: int) -> bool:
    """Return whether a stance between two cells is long enough."""
    return bool(to - since >= foot.dwell or to == foot.within.shape[0] or since == 0)


@numba.njit(cache=True)
def _stand(foot: Charges, heat: float, to: int, landed: Array, lifted: Array, costs: Array) -> None:
    """Fill in what it costs to have stood on every point until a cell."""
    for point in range(len(foot.middle)):
        size = 0
        for since in range(to - 1, -1, -1):
            if not foot.within[since, point]:
                break
            if landed[since, point] < np.inf and _may_stand(foot, since, to):
                costs[size] = landed[since, point] + foot.stood[to, point] - foot.stood[since, point]
                size += 1
        lifted[to, point] = _soft_least(costs, size, heat)


@numba.njit(cache=True)
def _land(foot: Charges, heat: float, to: int, landed: Array, lifted: Array, costs: Array) -> None:
    """Fill in what it costs to land on every point with a cell."""
    points = len(foot.middle)
    for q in range(points - 1):
        if not foot.within[to, q]:
            continue
        size = 0
        for lift in range(1, to - foot.dwell + 1):
            for p in range(points):
                if lifted[lift, p] < np.inf:
                    costs[size] = lifted[lift, p] + _swing(foot, lift, to, p, q)
                    size += 1
        landed[to, q] = _soft_least(costs, size, heat)


@numba.njit(cache=True)
def _landed_from(
    foot: Charges, heat: float, to: int, landed: Array, lifted: Array, parts_landed: Array, parts_lifted: Array,
    swung: Array, left: Array, reached: Array,
) -> None:  # fmt: skip
    """Share out what lands with a cell to the swings that it comes from."""
    points = len(foot.middle)
    for q in range(points - 1):
        part = parts_landed[to, q]
        if part < _LEAST_PART:
            continue
        farthest = landed[to, q] + _FARTHEST * heat
        for lift in range(1, to - foot.dwell + 1):
            for p in range(points):
                if lifted[lift, p] == np.inf:
                    continue
                cost = lifted[lift, p] + _swing(foot, lift, to, p, q)
                if cost < farthest:
                    share = part * np.exp((landed[to, q] - cost) / heat)
                    parts_lifted[lift, p] += share
                    here, there = foot.level[p], foot.level[q]
                    swung[here, there, lift, to] += share
                    for axis in range(3):
                        left[here, there, lift, to, axis] += share * foot.middle[p, axis]
                        reached[here, there, lift, to, axis] += share * foot.middle[q, axis]


@numba.njit(cache=True)
def _stood_since(
    foot: Charges, heat: float, to: int, landed: Array, lifted: Array, parts_landed: Array, parts_lifted: Array,
    standing: Array,
) -> None:  # fmt: skip
    """Share out what lifts off with a cell to the stances that it ends; ``standing`` takes what changes by cell."""
    for point in range(len(foot.middle)):
        part = parts_lifted[to, point]
        if part < _LEAST_PART:
            continue
        for since in range(to - 1, -1, -1):
            if not foot.within[since, point]:
                break
            if landed[since, point] == np.inf or not _may_stand(foot, since, to):
                continue
            cost = landed[since, point] + foot.stood[to, point] - foot.stood[since, point]
            share = part * np.exp(min((lifted[to, point] - cost) / heat, 0.0))
            parts_landed[since, point] += share
            standing[since, point] += share
            standing[to, point] -= share

"""The cheapest contact pattern of one foot by itself, over cells and boxes of footholds: a shortest path, compiled.

The foot stands in a box during some cells and swings during others. Stances and swings are charged the least that they
can cost with each of their ends anywhere in its box, so that the path's cost is a lower bound. The ends of neighbours
on the path are the same point, though; that they pull it to different sides of its box would cost a lot. So every box
hands on, with its value, the slope of the best way so far at its middle: charging ``slope . (p - middle)`` to what
comes before and crediting it to what comes after is sound for any slope, and leaves only differences of second order.
Axes along which a box is wide are left alone: there every part finds its own best place within it.
"""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

from surefoot.footholds.rows import Array, Index

Flags = NDArray[np.bool_]

ANY, STANCE, SWING = 0, 1, 2
WIDE_M = 0.08


@numba.njit(cache=True)
def least_1d(square: float, slope: float, low: float, high: float) -> float:
    """Return the least of square x^2 / 2 + slope x over an interval; square is positive or zero."""
    x = low if slope > 0 else high
    if square > 0:
        x = min(max(-slope / square, low), high)
    return square * x * x / 2 + slope * x


@numba.njit(cache=True)
def least_2d(
    s11: float, s12: float, s22: float, g1: float, g2: float, p0: float, p1: float, q0: float, q1: float
) -> float:
    """Return the least of a convex quadratic of two numbers over a rectangle."""
    if p0 == p1:
        return s11 * p0 * p0 / 2 + g1 * p0 + least_1d(s22, g2 + s12 * p0, q0, q1)
    if q0 == q1:
        return s22 * q0 * q0 / 2 + g2 * q0 + least_1d(s11, g1 + s12 * q0, p0, p1)
    det = s11 * s22 - s12 * s12
    p = (-g1 * s22 + g2 * s12) / det
    q = (-g2 * s11 + g1 * s12) / det
    if p0 <= p <= p1 and q0 <= q <= q1:
        return (g1 * p + g2 * q) / 2
    best = np.inf
    for x in (p0, p1):
        best = min(best, s11 * x * x / 2 + g1 * x + least_1d(s22, g2 + s12 * x, q0, q1))
    for x in (q0, q1):
        best = min(best, s22 * x * x / 2 + g2 * x + least_1d(s11, g1 + s12 * x, p0, p1))
    return best


@numba.njit(cache=True)
def cheapest_path(
    low: Array,
    high: Array,
    middle: Array,
    level: Index,
    square: Array,
    slope: Array,
    constant: Array,
    ends: Array,
    slopes: Array,
    constants: Array,
    high_slopes: Array,
    high_constants: Array,
    allowed: Index,
    within: Flags,
    dwell: int,
) -> tuple[float, Index]:
    """Return the cost of the cheapest path, and its stances, last first: first cell, end cell, box; -1 after the last.

    Args:
        low: corners of the boxes, shape (B, 3); the last box is the start foothold, which is only stood on at first.
        high: shape (B, 3).
        middle: a likely point of every box, shape (B, 3).
        level: of every box, shape (B,).
        square: what standing costs, summed over all cells before: square x^2 / 2 + slope x + constant, shape (M + 1,).
        slope: shape (M + 1, 3).
        constant: shape (M + 1,).
        ends: see ``SwingCosts``, shape (M, 3).
        slopes: shape (M, M, 2, 2).
        constants: shape (M, M).
        high_slopes: shape (K, K, M, M, 2).
        high_constants: shape (K, K, M, M).
        allowed: ``ANY``, ``STANCE`` or ``SWING`` for every cell, shape (M,).
        within: in which cells which boxes may be stood in, shape (M, B).
        dwell: least length of a stance between swings, and of a swing.
    """
    count, boxes = len(allowed), len(low) - 1
    # by first cell of a stance and box: the bound, its slope, the cost by way of middles, and where it comes from
    value = np.full((count, boxes + 1), np.inf)
    tilt = np.zeros((count, boxes + 1, 3))
    rough = np.full((count, boxes + 1), np.inf)
    source = np.full((count, boxes + 1, 2), -1, dtype=np.int64)
    value[0, boxes] = rough[0, boxes] = 0.0
    # by first cell of a swing and box: the same at the end of the stance
    lifted = np.full((count + 1, boxes + 1), np.inf)
    lifted_tilt = np.zeros((count + 1, boxes + 1, 3))
    lifted_rough = np.full((count + 1, boxes + 1), np.inf)
    since_of = np.full((count + 1, boxes + 1), -1, dtype=np.int64)
    for to in range(1, count + 1):
        for box in range(boxes + 1):
            _stand(
                to, box, count, low, high, middle, square, slope, constant, allowed, within, dwell, value, tilt, rough,
                lifted, lifted_tilt, lifted_rough, since_of,
            )  # fmt: skip
        if to < count and allowed[to] != SWING:
            for box in range(boxes):
                if not within[to, box]:
                    continue
                _land(
                    to, box, low, high, middle, level, ends, slopes, constants, high_slopes, high_constants, allowed,
                    dwell, value, tilt, rough, source, lifted, lifted_tilt, lifted_rough,
                )  # fmt: skip
    return _traced(count, lifted, since_of, source)


@numba.njit(cache=True)
def _stand(
    to: int, box: int, count: int, low: Array, high: Array, middle: Array, square: Array, slope: Array, constant: Array,
    allowed: Index, within: Flags, dwell: int, value: Array, tilt: Array, rough: Array,
    lifted: Array, lifted_tilt: Array, lifted_rough: Array, since_of: Index,
) -> None:  # fmt: skip
    """Fill in what it costs to have stood in a box until a cell."""
    best, at = np.inf, -1
    for since in range(to - 1, -1, -1):
        if allowed[since] == SWING or not within[since, box]:
            break
        if rough[since, box] == np.inf or (to - since < dwell and to < count and since > 0):
            continue
        cost = rough[since, box] + constant[to] - constant[since]
        for axis in range(3):
            x = middle[box, axis]
            cost += (square[to] - square[since]) * x * x / 2 + (slope[to, axis] - slope[since, axis]) * x
        if cost < best:
            best, at = cost, since
    if at < 0:
        return
    lifted_rough[to, box] = best
    if to < count:
        for axis in range(3):
            x = middle[box, axis]
            steep = (square[to] - square[at]) * x + slope[to, axis] - slope[at, axis]
            if high[box, axis] - low[box, axis] < WIDE_M:
                lifted_tilt[to, box, axis] = tilt[at, box, axis] + steep
    for since in range(to - 1, -1, -1):
        if allowed[since] == SWING or not within[since, box]:
            break
        if value[since, box] == np.inf or (to - since < dwell and to < count and since > 0):
            continue
        cost = value[since, box] + constant[to] - constant[since]
        for axis in range(3):
            turn = tilt[since, box, axis] - lifted_tilt[to, box, axis]
            g = slope[to, axis] - slope[since, axis] + turn
            cost += least_1d(square[to] - square[since], g, low[box, axis], high[box, axis])
            cost -= turn * middle[box, axis]
        if cost < lifted[to, box]:
            lifted[to, box], since_of[to, box] = cost, since


@numba.njit(cache=True)
def _land(
    to: int, goal: int, low: Array, high: Array, middle: Array, level: Index, ends: Array, slopes: Array,
    constants: Array, high_slopes: Array, high_constants: Array, allowed: Index, dwell: int,
    value: Array, tilt: Array, rough: Array, source: Index, lifted: Array, lifted_tilt: Array, lifted_rough: Array,
) -> None:  # fmt: skip
    """Fill in what it costs to land in a box with a cell."""
    boxes = len(low) - 1
    best, from_lift, from_box = np.inf, -1, -1
    for lift in range(to - 1, 0, -1):
        if allowed[lift] == STANCE:
            break
        if to - lift < dwell:
            continue
        s11, s12, s22 = ends[to - lift]
        for box in range(boxes + 1):
            if lifted_rough[lift, box] == np.inf:
                continue
            here, there = level[box], level[goal]
            cost = lifted_rough[lift, box] + constants[lift, to] + high_constants[here, there, lift, to]
            for axis in range(3):
                p, q = middle[box, axis], middle[goal, axis]
                if axis < 2:
                    g1, g2 = slopes[lift, to, axis, 0], slopes[lift, to, axis, 1]
                else:
                    g1, g2 = high_slopes[here, there, lift, to, 0], high_slopes[here, there, lift, to, 1]
                cost += s11 * p * p / 2 + s12 * p * q + s22 * q * q / 2 + g1 * p + g2 * q
            if cost < best:
                best, from_lift, from_box = cost, lift, box
    if from_lift < 0:
        return
    rough[to, goal] = best
    for axis in range(3):
        g2 = slopes[from_lift, to, axis, 1] if axis < 2 else high_slopes[level[from_box], level[goal], from_lift, to, 1]
        steep = ends[to - from_lift, 1] * middle[from_box, axis] + ends[to - from_lift, 2] * middle[goal, axis]
        if high[goal, axis] - low[goal, axis] < WIDE_M:
            tilt[to, goal, axis] = steep + g2
    for lift in range(to - 1, 0, -1):
        if allowed[lift] == STANCE:
            break
        if to - lift < dwell:
            continue
        s11, s12, s22 = ends[to - lift]
        for box in range(boxes + 1):
            if lifted[lift, box] == np.inf:
                continue
            here, there = level[box], level[goal]
            cost = lifted[lift, box] + constants[lift, to] + high_constants[here, there, lift, to]
            for axis in range(3):
                if axis < 2:
                    g1, g2 = slopes[lift, to, axis, 0], slopes[lift, to, axis, 1]
                else:
                    g1, g2 = high_slopes[here, there, lift, to, 0], high_slopes[here, there, lift, to, 1]
                g1 += lifted_tilt[lift, box, axis]
                g2 -= tilt[to, goal, axis]
                cost += least_2d(
                    s11, s12, s22, g1, g2, low[box, axis], high[box, axis], low[goal, axis], high[goal, axis]
                )
                cost += tilt[to, goal, axis] * middle[goal, axis] - lifted_tilt[lift, box, axis] * middle[box, axis]
            if cost < value[to, goal]:
                value[to, goal] = cost
                source[to, goal, 0], source[to, goal, 1] = lift, box


@numba.njit(cache=True)
def _traced(count: int, lifted: Array, since_of: Index, source: Index) -> tuple[float, Index]:
    """Follow the cheapest path back."""
    path = np.full((count + 1, 3), -1, dtype=np.int64)
    box = int(np.argmin(lifted[count]))
    best, end = lifted[count, box], count
    if best == np.inf:
        return best, path
    for number in range(count):
        since = since_of[end, box]
        path[number, 0], path[number, 1], path[number, 2] = since, end, box
        if since == 0:
            break
        end, box = source[since, box, 0], source[since, box, 1]
    return best, path

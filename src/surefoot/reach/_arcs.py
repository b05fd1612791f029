"""Barrier curves in closed form: chains of hyperbola arcs in the phase plane.

With position as time, the slowest state that can still be saved obeys dv/dx = (w^2 (x - x_foot) + d2) / (v + d1) for
the omega that lifts it most and the disturbance that lowers it most; each arc keeps
(v + d1)^2 - w^2 (x - x_foot + d2 / w^2)^2 constant, and w, d1, d2 change only at the foot and D2 / w^2 beside it. The
fastest state that can still be saved is its mirror image.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Chain(NamedTuple):
    """Three arcs from left to right: up to ``first``, up to ``second``, and beyond; offsets are from the foot."""

    first: float
    second: float
    w: tuple[float, float, float]
    d1: tuple[float, float, float]
    d2: tuple[float, float, float]


class Funnel(NamedTuple):
    """What bounds one half step: chains, foot, and the band of velocities that is considered."""

    lower: Chain
    upper: Chain
    foot: float
    slowest: float
    fastest: float


class Corners(NamedTuple):
    """Where the guard's edges meet: positions and velocities; ``empty`` when there is no guard."""

    empty: bool
    left_x: float
    left_v: float
    bottom_x: float
    bottom_v: float
    top_x: float
    top_v: float
    right_x: float
    right_v: float


@njit(cache=True)
def _arc(x: float, v: float, to: float, foot: float, w: float, d1: float, d2: float) -> float:
    """Return the velocity of an arc at another position; 0 where it has come to rest."""
    shift = d2 / (w * w) - foot
    square = (v + d1) ** 2 + w * w * ((to + shift) ** 2 - (x + shift) ** 2)
    return max(math.sqrt(square) - d1, 0.0) if square > 0 else 0.0


@njit(cache=True)
def back(chain: Chain, x: float, v: float, to: float, foot: float, slowest: float) -> float:
    """Follow a chain backwards to a position on the left; never slower than ``slowest`` on the way."""
    for k in (2, 1, 0):
        edge = -math.inf if k == 0 else foot + (chain.second if k == 2 else chain.first)
        if x <= edge:
            continue
        until = max(edge, to)
        v = max(_arc(x, v, until, foot, chain.w[k], chain.d1[k], chain.d2[k]), slowest)
        x = until
        if x <= to:
            break
    return v


@njit(cache=True)
def second_low(funnel: Funnel, x: float, end: float, window_low: float) -> float:
    """Return the least velocity from which the second half step can arrive at ``end`` at ``window_low`` or more."""
    return back(funnel.lower, end, window_low, x, funnel.foot, funnel.slowest)


@njit(cache=True)
def second_high(funnel: Funnel, x: float, end: float, window_high: float) -> float:
    """Return the greatest velocity from which the second half step can arrive at ``window_high`` or less."""
    return min(back(funnel.upper, end, window_high, x, funnel.foot, funnel.slowest), funnel.fastest)


@njit(cache=True)
def _manifold(z: float, w: float, apex_velocity: float) -> float:
    """Return the velocity of a tangent manifold at an offset from the foot."""
    return math.sqrt(apex_velocity * apex_velocity + (w * z) ** 2)


@njit(cache=True)
def _gap(
    funnel: Funnel, x: float, end: float, window: float, top: bool, foot: float, tube_w: float, tube_v: float
) -> float:
    """Return tube minus barrier of the second half at a position: it grows from left to right."""
    barrier = second_high(funnel, x, end, window) if top else second_low(funnel, x, end, window)
    return _manifold(x - foot, tube_w, tube_v) - barrier


@njit(cache=True)
def _meet(funnel: Funnel, end: float, window: float, top: bool, foot: float, tube_w: float, tube_v: float) -> float:
    """Return where a tangent manifold meets a barrier (regula falsi with the Illinois rule), or an end of the step."""
    a, b = foot, end
    fa = _gap(funnel, a, end, window, top, foot, tube_w, tube_v)
    fb = _gap(funnel, b, end, window, top, foot, tube_w, tube_v)
    if fa >= 0:
        return a
    if fb <= 0:
        return b
    side = 0
    for _ in range(60):
        x = b - fb * (b - a) / (fb - fa)
        f = _gap(funnel, x, end, window, top, foot, tube_w, tube_v)
        if abs(f) < 1e-12 or b - a < 1e-13:
            return x
        if f > 0:
            b, fb = x, f
            if side == 1:
                fa *= 0.5
            side = 1
        else:
            a, fa = x, f
            if side == -1:
                fb *= 0.5
            side = -1
    return 0.5 * (a + b)


@njit(cache=True)
def corners(
    funnel: Funnel,
    end_low: float,
    end_high: float,
    window_low: float,
    window_high: float,
    foot: float,
    tube_w: float,
    tube_low: float,
    tube_high: float,
) -> Corners:
    """Return the corners of the guard, between the second half's barriers and the first half's manifolds."""
    left = _meet(funnel, end_low, window_low, False, foot, tube_w, tube_high)
    bottom = _meet(funnel, end_low, window_low, False, foot, tube_w, tube_low)
    top = _meet(funnel, end_high, window_high, True, foot, tube_w, tube_high)
    right = _meet(funnel, end_high, window_high, True, foot, tube_w, tube_low)
    bottom, top = max(bottom, left), max(top, left)
    empty = right <= left
    return Corners(
        empty,
        left,
        second_low(funnel, left, end_low, window_low),
        bottom,
        max(second_low(funnel, bottom, end_low, window_low), _manifold(bottom - foot, tube_w, tube_low)),
        top,
        min(second_high(funnel, top, end_high, window_high), _manifold(top - foot, tube_w, tube_high)),
        right,
        _manifold(right - foot, tube_w, tube_low),
    )


@njit(cache=True)
def first_low(funnel: Funnel, c: Corners, x: float) -> float:
    """Return the least velocity from which the first half step can reach the guard, at a position left of it."""
    low = math.inf
    if x <= c.right_x:
        low = back(funnel.lower, c.right_x, c.right_v, x, funnel.foot, funnel.slowest)
    if x <= c.bottom_x:
        low = min(low, back(funnel.lower, c.bottom_x, c.bottom_v, x, funnel.foot, funnel.slowest))
    return low


@njit(cache=True)
def first_high(funnel: Funnel, c: Corners, x: float) -> float:
    """Return the greatest velocity from which the first half step can reach the guard, at a position left of it."""
    high = -math.inf
    if x <= c.top_x:
        high = back(funnel.upper, c.top_x, c.top_v, x, funnel.foot, funnel.slowest)
    if x <= c.left_x:
        high = max(high, back(funnel.upper, c.left_x, c.left_v, x, funnel.foot, funnel.slowest))
    return min(high, funnel.fastest)


@njit(cache=True)
def screen_many(
    second: Funnel,
    first: Funnel,
    lengths: Floats,
    windows: Floats,
    feet: Floats,
    half_width: float,
    tube: tuple[float, float, float],
) -> Floats:
    """Return per transition between which velocities at the current apex it may succeed; low > high where none."""
    found = np.empty((lengths.size, 2))
    for n in range(lengths.size):
        s = Funnel(second.lower, second.upper, lengths[n], second.slowest, second.fastest)
        f = Funnel(first.lower, first.upper, feet[n], first.slowest, first.fastest)
        end_low, end_high = target_ends(s, half_width, windows[n, 0])
        c = corners(s, end_low, end_high, windows[n, 0], windows[n, 1], feet[n], tube[0], tube[1], tube[2])
        if c.empty or c.right_x <= 0:
            found[n, 0], found[n, 1] = math.inf, -math.inf
        else:
            low, high = max(first_low(f, c, 0.0), f.lower.w[0] * abs(feet[n])), first_high(f, c, 0.0)
            if feet[n] < 0.0:
                guard_low = max(second_low(s, 0.0, end_low, windows[n, 0]), _manifold(feet[n], tube[0], tube[1]))
                guard_high = min(second_high(s, 0.0, end_high, windows[n, 1]), _manifold(feet[n], tube[0], tube[2]))
                if guard_low <= guard_high:
                    low, high = min(low, guard_low), max(high, guard_high)
            found[n, 0], found[n, 1] = low, high
    return found


@njit(cache=True)
def target_ends(funnel: Funnel, half_width: float, window_low: float) -> tuple[float, float]:
    """Return where on the target the outermost barriers start.

    Both barriers dip beside the foot. So the lowest one passes the window's lower bound at an edge of the target, and
    the highest one passes the upper bound at its dip.
    """
    left, right = funnel.foot - half_width, funnel.foot + half_width
    low = right if back(funnel.lower, right, window_low, left, funnel.foot, 0.0) < window_low else left
    return low, funnel.foot + max(-half_width, min(funnel.upper.first, half_width))

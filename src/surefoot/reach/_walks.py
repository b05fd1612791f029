"""Compiled simulation of many walking steps about the two feet, sampled, with a held omega."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]

REACHED, LEFT_REGION, PASSED, STALLED, TOO_LONG = 0, 1, 2, 3, 4
TABLE, BARRIER = 0, 1
MOST_SAMPLES = 400


class Tables(NamedTuple):
    """What the laws look up; ``low``/``high`` hold the barriers of each half on positions ``x0 + k dx``."""

    masks: NDArray[np.uint64]
    guard: NDArray[np.bool_]
    omegas: Floats
    x_low: float
    v_low: float
    x_step: float
    v_step: float
    feet: tuple[float, float]
    low: Floats
    high: Floats
    switch_low: Floats
    switch_high: Floats
    x0: float
    dx: float


class Goal(NamedTuple):
    """The target at the next apex, and the sampling time."""

    x_low: float
    x_high: float
    v_low: float
    v_high: float
    tau: float


@njit(cache=True)
def advance(x: float, v: float, foot: float, w: float, d1: float, d2: float, t: float) -> tuple[float, float]:
    """Return the state after a time with constant omega and constant disturbance rates."""
    c, s = math.cosh(w * t), math.sinh(w * t)
    lever = (c - 1) / (w * w)
    return (
        foot + c * (x - foot) + s / w * (v + d1) + lever * d2,
        w * s * (x - foot) + c * v + (c - 1) * d1 + s / w * d2,
    )


@njit(cache=True)
def cell_of(tables: Tables, x: float, v: float) -> tuple[int, int]:
    """Return the cell of a state, or (-1, -1) off the grid."""
    i, j = (x - tables.x_low) / tables.x_step, (v - tables.v_low) / tables.v_step
    _, columns, rows, _ = tables.masks.shape
    if 0.0 <= i < columns and 0.0 <= j < rows:
        return int(i), int(j)
    return -1, -1


@njit(cache=True)
def table_omega(tables: Tables, half: int, x: float, v: float, wish: float) -> float:
    """Return the allowed omega nearest to a wish, or NaN."""
    i, j = cell_of(tables, x, v)
    if i < 0:
        return math.nan
    best = math.nan
    for k in range(tables.omegas.shape[1]):
        if (tables.masks[half, i, j, k >> 6] >> np.uint64(k & 63)) & np.uint64(1):
            w = tables.omegas[half, k]
            if math.isnan(best) or abs(w - wish) < abs(best - wish):
                best = w
    return best


@njit(cache=True)
def _interpolated(values: Floats, tables: Tables, x: float) -> float:
    at = min(max((x - tables.x0) / tables.dx, 0.0), values.size - 1.000001)
    k = int(at)
    return float(values[k] + (at - k) * (values[k + 1] - values[k]))


@njit(cache=True)
def depth(tables: Tables, half: int, x: float, v: float) -> float:
    """Return where a state is between its barriers, in squares of velocity: 0 on the lower, 1 on the upper one."""
    low, high = _interpolated(tables.low[half], tables, x), _interpolated(tables.high[half], tables, x)
    return (v * v - low * low) / max(high * high - low * low, 1e-9)


@njit(cache=True)
def barrier_omega(tables: Tables, half: int, x: float, v: float, tau: float, wish: float) -> float:
    """Return the omega after which the state is halfway between its barriers, or as near to that as can be."""
    foot, least, most = tables.feet[half], tables.omegas[half, 0], tables.omegas[half, -1]
    xa, va = advance(x, v, foot, least, 0.0, 0.0, tau)
    xb, vb = advance(x, v, foot, most, 0.0, 0.0, tau)
    a, b = depth(tables, half, xa, va), depth(tables, half, xb, vb)
    middle = wish if abs(b - a) < 1e-9 else least + (0.5 - a) / (b - a) * (most - least)
    return float(min(max(middle, least), most))


@njit(cache=True)
def may_switch(tables: Tables, law: int, x: float, v: float) -> bool:
    """Tell whether the foot may be switched: a guard cell, or for the barrier law the guard between its curves."""
    if law == TABLE:
        i, j = cell_of(tables, x, v)
        return i >= 0 and tables.guard[i, j]
    low, high = _interpolated(tables.switch_low, tables, x), _interpolated(tables.switch_high, tables, x)
    return low <= v <= high


@njit(cache=True)
def walk(
    x: float, v: float, rates: Floats, jumps: Floats, law: int, nominal: float, tables: Tables, goal: Goal
) -> tuple[int, int, float, float]:
    """Walk one step.

    Args:
        x: position at the start.
        v: velocity at the start.
        rates: disturbance rates of every sample, (samples, 2).
        jumps: jumps of the state at the begin of every sample, (samples, 2).
        law: TABLE or BARRIER.
        nominal: omega that the law likes.
        tables: what the law looks up.
        goal: target and sampling time.

    Returns:
        How it ended, after how many samples, and the last state.
    """
    half, previous = 0, nominal
    for k in range(min(MOST_SAMPLES, rates.shape[0])):
        x, v = x + jumps[k, 0], v + jumps[k, 1]
        if half == 0 and may_switch(tables, law, x, v):
            half = 1
        if half == 1 and goal.x_low <= x <= goal.x_high and goal.v_low <= v <= goal.v_high:
            return REACHED, k, x, v
        if x > goal.x_high:
            return PASSED, k, x, v
        if v <= 0.0:
            return STALLED, k, x, v
        wish = 0.5 * (nominal + previous)
        if law == TABLE:
            w = table_omega(tables, half, x, v, wish)
            if math.isnan(w):
                return LEFT_REGION, k, x, v
        else:
            w = barrier_omega(tables, half, x, v, goal.tau, wish)
        previous = w
        x, v = advance(x, v, tables.feet[half], w, rates[k, 0], rates[k, 1], goal.tau)
    return TOO_LONG, rates.shape[0], x, v


@njit(cache=True)
def walk_many(
    starts: Floats, rates: Floats, jumps: Floats, law: int, nominal: float, tables: Tables, goal: Goal
) -> tuple[NDArray[np.int64], Floats]:
    """Walk from many states; ``rates`` and ``jumps`` are (runs, samples, 2)."""
    ends = np.empty(starts.shape[0], np.int64)
    states = np.empty((starts.shape[0], 2))
    for n in range(starts.shape[0]):
        ends[n], _, states[n, 0], states[n, 1] = walk(
            starts[n, 0], starts[n, 1], rates[n], jumps[n], law, nominal, tables, goal
        )
    return ends, states

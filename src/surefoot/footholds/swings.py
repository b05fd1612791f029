"""What one swing costs a foot, as a function of where it leaves and where it lands: the exact quadratic of every swing.

For given prices on the foot's positions (multipliers of the rows that couple it to the base), tracking and acceleration
of a swing from p to q cost, on each axis, ``S11 p^2 / 2 + S12 p q + S22 q^2 / 2 + g1 p + g2 q + c``: the points
in between are eliminated. S depends on the length only; g and c also on the reference and the prices.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numba
import numpy as np

from surefoot.footholds.cells import cell_count, cell_samples
from surefoot.footholds.problem import Problem
from surefoot.footholds.rows import Array

_SWEEPS = 40
_LONG = 32
_SWEPT_M = 1e-5


@dataclass(frozen=True, slots=True, eq=False)
class Swing:
    """The quadratic of swings of one length.

    Attributes:
        ends: S, shape (2, 2).
        gain: how linear terms between the ends act on them, shape (2, n - 1).
        inverse: of the Hessian between the ends, shape (n - 1, n - 1).
    """

    ends: Array
    gain: Array
    inverse: Array


@lru_cache(maxsize=512)
def swing_of(samples: int, step_s: float, track: float, accelerate: float) -> Swing:
    """Return the quadratic of swings of so many samples.

    Args:
        samples: n, of the swing; the last of them is at the new foothold.
        step_s: between samples.
        track: weight of the squared deviation from the reference.
        accelerate: weight of the squared acceleration.
    """
    places = [0, 0, *range(2, samples + 1), 1, 1]
    second = np.zeros((samples + 1, samples + 1))
    for row in range(samples + 1):
        for factor, place in zip((1.0, -2.0, 1.0), places[row : row + 3], strict=True):
            second[row, place] += factor
    hessian = 2 * accelerate / step_s**4 * second.T @ second
    tracked = np.arange(1, samples + 1)
    hessian[tracked, tracked] += 2 * track
    inner = hessian[2:, 2:]
    inverse = np.linalg.inv(inner) if samples > 1 else np.zeros((0, 0))
    gain = -hessian[:2, 2:] @ inverse
    ends = hessian[:2, :2] + gain @ hessian[2:, :2]
    return Swing(np.asarray(ends, dtype=np.float64), gain, np.asarray(inverse, dtype=np.float64))


@numba.njit(cache=True)
def held_up(gram: Array, lacks: Array, near: Array) -> Array:
    """Return multipliers nu >= 0 that nearly maximise lacks . nu - nu' gram nu / 2 for every row of lacks.

    Any multipliers are sound; these come from sweeps over the coordinates, from both ends in, where they press most,
    and begin at those of before.
    """
    count, size = lacks.shape
    found = np.zeros((count, size))
    for row in range(count):
        if lacks[row].max() <= 0:
            continue
        rest = lacks[row].copy()
        for k in range(size):
            if near[row, k] > 0:
                found[row, k] = near[row, k]
                rest -= near[row, k] * gram[k]
        for _ in range(_SWEEPS):
            most = 0.0
            for half in range(size):
                k = half // 2 if half % 2 == 0 else size - 1 - half // 2
                change = max(found[row, k] + rest[k] / gram[k, k], 0.0) - found[row, k]
                if change != 0.0:
                    found[row, k] += change
                    rest -= change * gram[k]
                    most = max(most, abs(change) * gram[k, k])
            if most < _SWEPT_M:
                break
    return found


@dataclass(frozen=True, slots=True, eq=False)
class SwingCosts:
    """The quadratics of every swing of every foot, for given prices; cells a (first in swing) and b (first in stance).

    The height has one for every pair of levels, as the clearance multipliers that are best depend on them.

    Attributes:
        ends: S by number of cells, shape (M, 3): S11, S12, S22.
        slopes: g of both horizontal axes, shape (4, M, M, 2, 2).
        constants: c of both together, shape (4, M, M).
        high_slopes: g of the height, by level of p and of q, shape (4, K, K, M, M, 2).
        high_constants: c of the height, shape (4, K, K, M, M).
        pressed: the clearance multipliers by number of cells, each of shape (4, K, K, swings of that length, n).
    """

    ends: Array
    slopes: Array
    constants: Array
    high_slopes: Array
    high_constants: Array
    pressed: dict[int, Array]


def swing_costs(problem: Problem, prices: Array, levels_m: Array, near: SwingCosts | None = None) -> SwingCosts:
    """Return what swings cost.

    Args:
        problem: whose weights, cells and reference count.
        prices: on the positions of the feet, shape (N, 4, 3).
        levels_m: heights at which clearance multipliers are chosen, shape (K,); any are sound.
        near: at prices that are nearly the same: its clearance multipliers are where the search for new ones begins.
    """
    weights, per, count, kinds = problem.weights, cell_samples(problem), cell_count(problem), len(levels_m)
    reference = problem.foot_reference_m
    linear = np.moveaxis(prices - 2 * weights.foot * reference, 0, -1)
    squares = np.concatenate(
        [np.zeros((4, 3, 1)), np.cumsum(weights.foot * np.moveaxis(reference**2, 0, -1), axis=-1)], axis=-1
    )
    ends = np.zeros((count, 3))
    slopes, constants = np.zeros((4, count, count, 2, 2)), np.zeros((4, count, count))
    high_slopes = np.zeros((4, kinds, kinds, count, count, 2))
    high_constants = np.zeros((4, kinds, kinds, count, count))
    pressed: dict[int, Array] = {}
    share = (np.sign(levels_m[:, None] - levels_m) + 1)[:, :, None] / 2
    for cells in range(1, count - 1):
        size = cells * per
        one = swing_of(size, problem.step_s, weights.foot, weights.foot_acceleration)
        ends[cells] = one.ends[0, 0], one.ends[0, 1], one.ends[1, 1]
        first = np.arange(1, count - cells)
        along = linear[:, :, first[:, None] * per + np.arange(size)]
        tracked = squares[:, :, first * per + size] - squares[:, :, first * per]
        slope, constant = _eliminated(one, along[:, :2])
        slopes[:, first, first + cells] = np.moveaxis(slope, 1, 2)
        constants[:, first, first + cells] = (constant + tracked[:, :2]).sum(axis=1)
        before = None if near is None else near.pressed[cells]
        nu = _clearance(one, along[:, 2], levels_m, problem.options.clearance_m, before)
        slope, constant = _eliminated(one, along[:, None, None, 2] - nu)
        total = nu.sum(axis=-1)
        slope += np.stack([share * total, (1 - share) * total], axis=-1)
        high_slopes[:, :, :, first, first + cells] = slope
        constant += tracked[:, None, None, 2] + problem.options.clearance_m * total
        high_constants[:, :, :, first, first + cells] = constant
        pressed[cells] = nu
    return SwingCosts(ends, slopes, constants, high_slopes, high_constants, pressed)


def _eliminated(one: Swing, linear: Array) -> tuple[Array, Array]:
    """Return what linear terms along the swing leave at its ends, and the constant."""
    inner = linear[..., :-1]
    slope = inner @ one.gain.T
    slope[..., 1] += linear[..., -1]
    return slope, -0.5 * np.einsum("...k,...k->...", inner @ one.inverse, inner)


def _clearance(one: Swing, linear: Array, levels_m: Array, clearance_m: float, before: Array | None) -> Array:
    """Return clearance multipliers of swings between all pairs of levels, shape (4, K, K, swings, n).

    Swings that last long do without: to lift a foot slowly costs next to nothing, but many sweeps.
    """
    size, kinds = linear.shape[-1], len(levels_m)
    found = np.zeros((4, kinds, kinds, *linear.shape[1:]))
    middle = np.arange(size // 4, min(size - size // 4, size - 1))
    if clearance_m > 0 and len(middle) and size <= _LONG:
        pairs = np.stack(np.meshgrid(levels_m, levels_m, indexing="ij"), axis=-1)
        rest = -(linear[..., :-1] @ one.inverse)[..., middle]
        free = (pairs @ one.gain[:, middle])[None, :, :, None] + rest[:, None, None]
        lacks = pairs.max(axis=-1)[None, :, :, None, None] + clearance_m - free
        gram = np.ascontiguousarray(one.inverse[np.ix_(middle, middle)])
        near = found[..., middle] if before is None else before[..., middle]
        found[..., middle] = held_up(gram, lacks.reshape(-1, len(middle)), near.reshape(-1, len(middle))).reshape(
            lacks.shape
        )
    return found

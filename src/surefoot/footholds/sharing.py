"""What feet in contact are worth together, by their number: the price of force and of a share of base acceleration.

With n feet in contact that share a force F equally, force and a part s of the weight a of the base's acceleration cost

    w |F|^2 / n + s a |F / m - g|^2  =  h |F|^2 - 2 s a g.F / m + s a |g|^2,      h = w / n + s a / m^2,

and for every y that is at least  2 y.F + s a |g|^2 - |z|^2 / h  with  z = y + s a g / m  (g points upwards here). What
n feet save, the sum of |z|^2 / h over the samples of a cell, is concave in n: feet that are in contact one half of the
time save less than half as much, as the base pays for not being carried. A price per foot in contact and cell takes the
feet apart; the best number of feet at this price is what is left. As all friction pyramids lie within one upright
pyramid, F is in it too, and z may be replaced by the nearest point of that pyramid.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.footholds.cells import cell_count, cell_samples
from surefoot.footholds.problem import Problem
from surefoot.footholds.rows import Array

_FEET = np.arange(5)
_STEEPEST, _LEAST_SLOPE = 0.05, 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class Prices:
    """Multipliers.

    Attributes:
        reach: of Eq. (16), positive where the upper bound presses, in the axes of the base, shape (N, 4, 3).
        pull: y of every sample, shape (N, 3).
        contact: what a foot is paid for being in contact in a cell, shape (M,).
        split: s, which share of the base's acceleration is paid with the force, 0 to less than 1.
        walls: of the bounds of the base's region, positive where the upper bound presses, shape (N, 3), as found last
            (``Pricing`` finds the best ones itself); None: none.
    """

    reach: Array
    pull: Array
    contact: Array
    split: float = 0.0
    walls: Array | None = None


def upwards(problem: Problem) -> Array:
    """Return gravity, upwards."""
    return np.array([0.0, 0.0, problem.gravity_mps2])


def shifted(problem: Problem, prices: Prices) -> Array:
    """Return z of every sample, pressed into the pyramid that every force is in, shape (N, 3)."""
    share = prices.split * problem.weights.acceleration / problem.robot.mass_kg
    return nearest_in_cone(prices.pull + share * upwards(problem), cone_slopes(problem))


def cone_slopes(problem: Problem) -> Array:
    """Return how much of its height a force may lean in -x, x, -y, y on any polygon; infinite on near-walls."""
    edges = np.concatenate([one.rays for one in problem.polygons])
    if (edges[:, 2] < _STEEPEST).any():
        return np.full(4, np.inf)
    lean = edges[:, :2] / edges[:, 2:]
    slopes = np.array([-lean[:, 0].min(), lean[:, 0].max(), -lean[:, 1].min(), lean[:, 1].max()])
    return np.asarray(np.maximum(slopes, _LEAST_SLOPE))


def nearest_in_cone(forces: Array, slopes: Array) -> Array:
    """Return the nearest points of a pyramid with sides ``cone_slopes`` about the vertical, shape (N, 3)."""
    if not np.isfinite(slopes).all():
        return forces
    steep = np.where(forces[:, :2] < 0, slopes[[0, 2]], slopes[[1, 3]])
    lean, high = np.abs(forces[:, :2]), forces[:, 2]
    until = lean / steep
    late = until.argmax(axis=1)
    rows = np.arange(len(forces))
    k, a = steep[rows, late], lean[rows, late]
    one = (high + k * a) / (1 + k**2)
    both = (high + (steep * lean).sum(axis=1)) / (1 + (steep**2).sum(axis=1))
    height = np.where(high >= until.max(axis=1), high, np.where(one >= until.min(axis=1), one, np.maximum(both, 0.0)))
    sideways = np.sign(forces[:, :2]) * np.minimum(lean, steep * height[:, None])
    return np.column_stack([sideways, height])


def dearness(problem: Problem, split: float) -> Array:
    """Return h for 0 to 4 feet, shape (5,); infinite for none."""
    with np.errstate(divide="ignore"):
        alone = problem.weights.force / _FEET
    return np.asarray(alone + split * problem.weights.acceleration / problem.robot.mass_kg**2, dtype=np.float64)


def savings(problem: Problem, prices: Prices) -> Array:
    """Return what 0 to 4 feet in contact save in every cell, shape (M, 5)."""
    squares = (shifted(problem, prices) ** 2).sum(axis=1).reshape(cell_count(problem), cell_samples(problem))
    return np.asarray(squares.sum(axis=1)[:, None] / dearness(problem, prices.split))


def left_over(saved: Array, contact: Array) -> float:
    """Return the least of what feet are paid less what they save, over all cells."""
    return float((contact[:, None] * _FEET - saved).min(axis=1).sum())


def contact_prices(saved: Array, held: Array) -> Array:
    """Return prices at which so many feet in contact, shape (M,), are best: what one foot more or less changes."""
    slopes = np.diff(saved, axis=1)
    below = np.clip(np.ceil(held).astype(np.int64) - 1, 0, 3)
    above = np.clip(np.floor(held).astype(np.int64), 0, 3)
    cells = np.arange(len(saved))
    mean: Array = (slopes[cells, below] + slopes[cells, above]) / 2
    return mean

"""What feet in contact are worth together, by their number: the price of force and of a share of base acceleration.

With n feet in contact that share a force F equally, force and a part s of the weight a of the base's acceleration cost

    w |F|^2 / n + s a |F / m - g|^2  =  h |F|^2 - 2 s a g.F / m + s a |g|^2,      h = w / n + s a / m^2,

and for every y that is at least  2 y.F + s a |g|^2 - |z|^2 / h  with  z = y + s a g / m  (g points upwards here). What
n feet save, the sum of |z|^2 / h over the samples of a cell, is concave in n: feet that are in contact one half of the
time save less than half as much, as the base pays for not being carried. A price per foot in contact and cell takes the
feet apart; the best number of feet at this price is what is left.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.footholds.cells import cell_count, cell_samples
from surefoot.footholds.problem import Problem
from surefoot.footholds.rows import Array, Index

_FEET = np.arange(5)


@dataclass(frozen=True, slots=True, eq=False)
class Prices:
    """Multipliers.

    Attributes:
        reach: of Eq. (16), positive where the upper bound presses, in the axes of the base, shape (N, 4, 3).
        pull: y of every sample, shape (N, 3).
        contact: what a foot is paid for being in contact in a cell, shape (M,).
        split: s, which share of the base's acceleration is paid with the force, 0 to less than 1.
    """

    reach: Array
    pull: Array
    contact: Array
    split: float = 0.0


def upwards(problem: Problem) -> Array:
    """Return gravity, upwards."""
    return np.array([0.0, 0.0, problem.gravity_mps2])


def shifted(problem: Problem, prices: Prices) -> Array:
    """Return z of every sample, shape (N, 3)."""
    share = prices.split * problem.weights.acceleration / problem.robot.mass_kg
    shifted: Array = prices.pull + share * upwards(problem)
    return shifted


def dearness(problem: Problem, split: float) -> Array:
    """Return h for 0 to 4 feet, shape (5,); infinite for none."""
    with np.errstate(divide="ignore"):
        alone = problem.weights.force / _FEET
    return np.asarray(alone + split * problem.weights.acceleration / problem.robot.mass_kg**2, dtype=np.float64)


def savings(problem: Problem, prices: Prices) -> Array:
    """Return what 0 to 4 feet in contact save in every cell, shape (M, 5)."""
    squares = (shifted(problem, prices) ** 2).sum(axis=1).reshape(cell_count(problem), cell_samples(problem))
    return np.asarray(squares.sum(axis=1)[:, None] / dearness(problem, prices.split))


def left_over(saved: Array, contact: Array) -> tuple[float, Index]:
    """Return the least of what feet are paid less what they save, over all cells, and the numbers of feet for it."""
    paid = contact[:, None] * _FEET - saved
    return float(paid.min(axis=1).sum()), paid.argmin(axis=1)


def contact_prices(saved: Array, held: Array) -> Array:
    """Return prices at which so many feet in contact, shape (M,), are best: what one foot more or less changes."""
    slopes = np.diff(saved, axis=1)
    below = np.clip(np.ceil(held).astype(np.int64) - 1, 0, 3)
    above = np.clip(np.floor(held).astype(np.int64), 0, 3)
    cells = np.arange(len(saved))
    mean: Array = (slopes[cells, below] + slopes[cells, above]) / 2
    return mean

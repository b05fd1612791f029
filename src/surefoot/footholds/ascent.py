"""Better and better prices for the bound over all gaits: deflected subgradient steps of Polyak's length."""

from __future__ import annotations

import numpy as np

from surefoot.footholds.dual import Priced, Prices, Pricing
from surefoot.footholds.model import gravity
from surefoot.footholds.nodes import Node
from surefoot.footholds.problem import Problem
from surefoot.footholds.rows import FAMILIES, Array

_FEET_EXPECTED = 2.7
_REACH_SCALE = 1000.0
_DEFLECTION = 0.7
_LENGTH = 0.3
_PATIENCE = 12
_SHRINK = 0.6
_HOPE = 0.97
_LEAST_LENGTH = 1e-3


def prices_of_node(problem: Problem, node: Node) -> Prices:
    """Return the prices at which the solution of a program is the best one of its gait: its multipliers.

    Where forces are shared equally, the pull is w F / n; in flight, and where forces are unknowns, it is half the
    multiplier of Newton's law.
    """
    multipliers, where = node.answer.multipliers, node.rows.where
    reach = np.zeros((problem.samples, 4, 3))
    chosen = node.rows.family == FAMILIES.index("reach")
    reach[where[chosen, 0], where[chosen, 1], where[chosen, 2]] = multipliers[chosen]
    assert node.motion is not None
    terms = node.motion.base_acceleration
    acceleration = sum(np.asarray(factor) * quantity.at(node.answer.unknowns) for factor, quantity in terms)
    counts = np.maximum(problem.contacts.sum(axis=1), 1)[:, None]
    pull = problem.weights.force * problem.robot.mass_kg * (np.asarray(acceleration) - gravity(problem)) / counts
    law = (node.rows.family == FAMILIES.index("flight")) | (node.rows.family == FAMILIES.index("dynamics"))
    pull[where[law, 0], where[law, 1]] = multipliers[law] / 2
    return Prices(reach, pull)


def even_prices(problem: Problem) -> Prices:
    """Return prices for a base that moves evenly on some three feet: reach is free, force costs what weight does."""
    pull = np.zeros((problem.samples, 3))
    pull[:, 2] = problem.weights.force * problem.robot.mass_kg * problem.gravity_mps2 / _FEET_EXPECTED
    return Prices(np.zeros((problem.samples, 4, 3)), pull)


class Ascent:
    """A walk up the bound.

    Args:
        pricing: evaluates prices.
        start: first prices.
    """

    def __init__(self, pricing: Pricing, start: Prices) -> None:
        self.pricing = pricing
        self.size = start.reach.size
        self.here = self.best_at = self._flat(start)
        self.best = -np.inf
        self.direction: Array = np.zeros_like(self.here)
        self.length, self.failures = 1.0, 0

    @property
    def prices(self) -> Prices:
        """The best prices so far."""
        return self._prices(self.best_at)

    @property
    def stuck(self) -> bool:
        """Whether steps have become too short to matter."""
        return self.length < _LEAST_LENGTH

    def try_from(self, prices: Prices) -> None:
        """Go on from other prices, if they are better."""
        bound = self.pricing.at(prices).bound
        if bound > self.best:
            self.here = self.best_at = self._flat(prices)
            self.best, self.direction, self.failures = bound, np.zeros_like(self.here), 0
        self.length = 1.0

    def step(self, hope: float) -> Priced:
        """Evaluate the prices here and go on.

        Args:
            hope: cost of the best plan, which the bound cannot exceed.
        """
        priced = self.pricing.at(self._prices(self.here))
        slope = np.concatenate([priced.slope.reach.ravel() * _REACH_SCALE, priced.slope.pull.ravel()])
        if priced.bound > self.best:
            self.best, self.best_at, self.failures = priced.bound, self.here, 0
        else:
            self.failures += 1
        if self.failures > _PATIENCE:
            self.length, self.failures = self.length * _SHRINK, 0
            self.here, self.direction = self.best_at, np.zeros_like(self.here)
        self.direction = slope + _DEFLECTION * self.direction
        rise = max(_HOPE * hope - priced.bound, 1e-3 * hope)
        step = self.length * _LENGTH * rise / max(float(slope @ slope), 1e-12)
        self.here = self.here + step * self.direction
        return priced

    def _flat(self, prices: Prices) -> Array:
        return np.concatenate([prices.reach.ravel() / _REACH_SCALE, prices.pull.ravel()])

    def _prices(self, flat: Array) -> Prices:
        return Prices(flat[: self.size].reshape(-1, 4, 3) * _REACH_SCALE, flat[self.size :].reshape(-1, 3))

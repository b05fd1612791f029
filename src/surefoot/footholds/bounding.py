"""Raises the bound over all gaits: prices first, then prices within the tube that these and the best plan leave."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from surefoot.footholds.ascent import Ascent, even_prices, repriced
from surefoot.footholds.cells import Cells, cell_samples
from surefoot.footholds.dual import Priced, Pricing
from surefoot.footholds.problem import Problem
from surefoot.footholds.sharing import Prices
from surefoot.footholds.swings import swing_of
from surefoot.footholds.tube import tube_below

_GUIDE_BOXES, _BOXES = 32, 48
_ROUND, _SHORTEST, _LONGEST = 45_000, 60, 300
_FIRST_STEPS = 150
_SPLIT = 0.7
_MARGIN = 4e-3
_CHEAPER = 0.995
_FINEST_M, _PART = 0.04, 0.015


@dataclass(frozen=True, slots=True, eq=False)
class GaitProof:
    """What proves a bound over all gaits: no plan costs less than ``bound``.

    Attributes:
        bound: without the cost of the orientation; minus infinity where a checker could not derive it.
        prices: multipliers; within the tube, if there is one.
        first: multipliers that prove the tube, for plans that cost less than ``worth``; None: there is no tube.
        worth: infinite without a tube.
    """

    bound: float
    prices: Prices
    first: Prices | None = None
    worth: float = np.inf


class Bounding:
    """The bound so far, and the walk that raises it.

    Args:
        problem: its gait is free.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem, self.guide = problem, Pricing(problem, _GUIDE_BOXES, points=True)
        self.free, self.confined = Pricing(problem, _BOXES), Pricing(problem, _BOXES)
        self.ascent = Ascent(self.guide, even_prices(problem))
        self.round, self.begun = min(max(_ROUND // self.guide.count**2, _SHORTEST), _LONGEST), False
        self.first: tuple[Prices, Priced] | None = None
        self.landing = _landing(problem)
        self.worth = np.inf
        self.proof = self._proved(even_prices(problem))

    @property
    def stuck(self) -> bool:
        """Whether more rounds would not help."""
        return self.first is not None and self.ascent.stuck

    def climb(self, worth: float, stop: Callable[[], bool]) -> list[Cells]:
        """Go on for a round; return the contact tables that its prices suggest.

        Args:
            worth: cost of the best plan.
            stop: asked now and then.
        """
        suggested: list[Cells] = []
        if self.begun and worth < _CHEAPER * self.worth:
            self._confine(worth)
        steps, self.begun = self.round if self.begun else max(self.round, _FIRST_STEPS), True
        for _ in range(steps):
            if stop():
                return suggested
            suggested.append(self.ascent.step(worth).cells)
        found = self._proved(self.ascent.prices)
        if found.bound > self.proof.bound:
            self.proof = found
        return suggested

    def _confine(self, worth: float) -> None:
        """Keep the base in the tube of all plans that cost less."""
        if self.first is None:
            prices = self.ascent.prices
            self.first = prices, self.free.at(prices)
            split = repriced(self.guide, prices, _SPLIT)
        else:
            split = self.ascent.prices
        prices, priced = self.first
        slack = worth - (1 - _MARGIN) * priced.bound
        tube = tube_below(self.problem, self.free.base_hessian(prices.split)[1], priced.base_m, slack)
        self.guide.confine(tube)
        self.confined.confine(tube)
        self.worth, self.ascent = worth, Ascent(self.guide, split)

    def _proved(self, prices: Prices) -> GaitProof:
        """Return what prices prove; a little is left to checkers who cut the ground otherwise."""
        if self.first is None:
            bound = self.free.at(prices).bound
            return GaitProof(self._checkable(bound - _MARGIN * abs(bound)), prices)
        bound = self.confined.at(prices).bound
        bound = min(bound - _MARGIN * abs(bound), self.worth)
        return GaitProof(self._checkable(bound), prices, self.first[0], self.worth)

    def _checkable(self, bound: float) -> float:
        """Return a bound that nodes of a grid can derive as well, else minus infinity."""
        return bound if self.landing <= _PART * bound else -np.inf


def _landing(problem: Problem) -> float:
    """Return what a grid of 4 cm takes off for one landing of the shortest swing, whose curvature is the largest."""
    shortest = problem.options.min_dwell_cells * cell_samples(problem)
    swing = swing_of(shortest, problem.step_s, problem.weights.foot, problem.weights.foot_acceleration)
    return float(np.trace(swing.ends)) * _FINEST_M**2 / 4

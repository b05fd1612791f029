"""Raises the bound over all gaits: prices for all paths of the base, then a tree of parts with prices of their own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from surefoot.footholds.ascent import Stage, ascended
from surefoot.footholds.branching import Branch, Branching
from surefoot.footholds.cells import Cells, cell_samples
from surefoot.footholds.dual import Priced, Pricing
from surefoot.footholds.first_prices import even_prices, repriced
from surefoot.footholds.problem import Problem
from surefoot.footholds.sharing import Prices
from surefoot.footholds.swings import swing_of
from surefoot.footholds.tube import Tube, everywhere, tube_below

_GUIDE_BOXES, _BOXES = 32, 48
_FIRST_STAGES = (Stage(6e-3, 50), Stage(1e-3, 40))
_SECOND_STAGES = (Stage(6e-4, 60),)
_ROUND = 600
_SPLIT = 0.7
MARGIN = 4e-3
"""What a claimed bound is below the proved one, as a part of it."""
_FINEST_M, _PART = 0.04, 0.015


@dataclass(frozen=True, slots=True, eq=False)
class GaitProof:
    """What proves a bound over all gaits: no plan costs less than ``bound``.

    Attributes:
        bound: without the cost of the orientation; minus infinity where a checker could not derive it.
        first: multipliers; they prove the bound, if there is no tree.
        tree: parts of the paths of the base with multipliers of their own, for plans that cost less than ``worth``.
        worth: infinite without a tree.
    """

    bound: float
    first: Prices
    tree: Branch | None = None
    worth: float = np.inf


class Bounding:
    """The bound so far, and the work that raises it.

    Args:
        problem: its gait is free.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem, self.prices = problem, even_prices(problem)
        self.guide, self.judge = Pricing(problem, _GUIDE_BOXES, points=True), Pricing(problem, _BOXES)
        self.first: Priced | None = None
        self.tree: Branching | None = None
        self.landing = _landing(problem)
        self.proof = GaitProof(self._claimed(self.judge.at(self.prices).bound), self.prices)

    @property
    def stuck(self) -> bool:
        """Whether more rounds would not help."""
        return self.tree is not None and self.tree.stuck

    def climb(self, worth: float, stop: Callable[[], bool]) -> list[Cells]:
        """Go on for a round; return the contact tables that its prices suggest.

        Args:
            worth: cost of the best plan.
            stop: asked now and then.
        """
        if self.first is None:
            return self._begin(worth, stop)
        if self.tree is None:
            return self._plant(worth, stop)
        suggested: list[Cells] = []
        for _ in range(max(_ROUND // self.guide.count**2, 2)):
            if stop() or self.tree.stuck:
                break
            suggested += self.tree.grow(worth, stop)
        found = self._claimed(min(self.tree.bound, worth))
        if found > self.proof.bound or self.proof.tree is not None:
            # once the tree is the proof, its worth has to be that of its leaves, which follow the best plan
            self.proof = GaitProof(found, self.prices, self.tree.root, worth)
        return suggested

    def _begin(self, worth: float, stop: Callable[[], bool]) -> list[Cells]:
        """Look for prices that hold for all paths, without a share of acceleration: they prove the tubes."""
        found = ascended(self.guide, self.prices, _FIRST_STAGES, worth, stop=stop)
        self.prices, self.first = found.prices, self.judge.at(found.prices)
        claimed = self._claimed(self.first.bound)
        if claimed > self.proof.bound:
            self.proof = GaitProof(claimed, found.prices)
        return [self.first.cells]

    def _plant(self, worth: float, stop: Callable[[], bool]) -> list[Cells]:
        """Look for prices that hold for all paths in the tube of plans that cost less than the best one."""
        assert self.first is not None
        region = everywhere(self.problem)
        tube = self._tube(region, worth)
        self.guide.confine(tube, region)
        start = repriced(self.guide, self.prices, _SPLIT)
        found = ascended(self.guide, start, _SECOND_STAGES, worth, stop=stop)
        self.judge.confine(tube, region)
        priced = self.judge.at(found.prices)
        root = Branch(region, tube, 0, found.prices, priced.bound, worth, found.mixture, cells=priced.cells)
        self.tree = Branching(self.guide, self.judge, root, self._tube)
        return [priced.cells]

    def _tube(self, region: Tube, worth: float) -> Tube:
        """Return where the base stays in a region, in plans that cost less than some worth."""
        assert self.first is not None
        slack = worth - (1 - MARGIN) * self.first.bound
        return tube_below(self.judge.base_hessian(0.0)[1], self.first.base_m, slack, region)

    def _claimed(self, bound: float) -> float:
        """Return a little less, for checkers who cut the ground otherwise; minus infinity if they could not follow."""
        claimed = bound - MARGIN * abs(bound)
        return claimed if self.checkable(claimed) else -np.inf

    def checkable(self, bound: float) -> bool:
        """Return whether such a bound exceeds by far what landings take off that a checker derives."""
        return self.landing <= _PART * bound


def _landing(problem: Problem) -> float:
    """Return what a grid of 4 cm takes off for one landing of the shortest swing, whose curvature is the largest."""
    shortest = problem.options.min_dwell_cells * cell_samples(problem)
    swing = swing_of(shortest, problem.step_s, problem.weights.foot, problem.weights.foot_acceleration)
    return float(np.trace(swing.ends)) * _FINEST_M**2 / 4

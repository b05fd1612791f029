"""Cuts the paths of the base in two, again and again, where the mixture that the bound is made of wants both halves.

With one set of prices for all paths of the base, a foot may stand early half of the time and late half of the time; the
base is then within reach on average only. Between two halves (below and above a place of the base at some sample) the
footholds that the mixture stands on are out of reach in one or the other. Each half gets prices of its own; the bound
over all is the least of those of the leaves, and the leaf with the least bound is cut next.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from surefoot.footholds.ascent import Stage, ascended
from surefoot.footholds.cells import Cells
from surefoot.footholds.dual import Pricing
from surefoot.footholds.mixture import Mixture
from surefoot.footholds.rows import Array
from surefoot.footholds.sharing import Prices
from surefoot.footholds.tube import CLEAR_M, Tube, within_reach

_STAGES = (Stage(1.5e-3, 40),)
_LEAST_VIOLATION_M, _LEAST_SHARE = 0.003, 1e-6
_NARROWEST_M, _WORTH_CUTTING_M = 0.005, 0.1
_CANDIDATES = 20
_ALONG = 0.5
_NEAREST_M = CLEAR_M + 2e-3
_DEEPEST = 60
_STALE = 0.998
_AHEAD = 1.05


@dataclass(frozen=True, slots=True)
class Cut:
    """Where the paths of the base are cut: at a sample, along an axis."""

    sample: int
    axis: int
    at_m: float


@dataclass(slots=True, eq=False)
class Branch:
    """A part of the paths of the base.

    Attributes:
        region: which part.
        tube: where the base stays in plans of this part that cost less than the worth.
        depth: number of cuts.
        prices: what proves its bound.
        bound: of all plans whose base stays in the region and that cost less than the worth.
        worth: which it was found for.
        mixture: at its prices; None where there is nothing left to cut.
        early: whether better prices were not looked for, as the bound was high enough for the time being.
        cells: the cheapest pattern of every foot at its prices.
        cut: how it was cut in two, if it was.
        parts: below and above the cut.
    """

    region: Tube
    tube: Tube
    depth: int
    prices: Prices
    bound: float
    worth: float
    mixture: Mixture | None = None
    early: bool = False
    cells: Cells | None = None
    cut: Cut | None = None
    parts: tuple[Branch, Branch] | None = None


class Branching:
    """The tree of parts, which grows.

    Args:
        guide: footholds at points, for the ascents.
        judge: footholds in boxes, for the bounds.
        root: all paths.
        tube_of: where the base stays in a region, in plans that cost less than some worth.
    """

    def __init__(self, guide: Pricing, judge: Pricing, root: Branch, tube_of: Callable[[Tube, float], Tube]) -> None:
        self.guide, self.judge, self.tube_of = guide, judge, tube_of
        self.root, self.count = root, 1
        self.open: list[tuple[float, int, Branch]] = [(root.bound, 0, root)]

    @property
    def bound(self) -> float:
        """The least of the leaves' bounds."""
        return self.open[0][0]

    @property
    def stuck(self) -> bool:
        """Whether the leaf with the least bound cannot be cut."""
        leaf = self.open[0][2]
        return not leaf.early and self._cut(leaf) is None

    def grow(self, worth: float, stop: Callable[[], bool]) -> list[Cells]:
        """Cut the leaf with the least bound in two; return the contact tables that the prices of the halves suggest."""
        _, _, leaf = heapq.heappop(self.open)
        cut = None if leaf.early or worth < _STALE * leaf.worth else self._cut(leaf)
        if cut is None:
            self._raise(leaf, worth, worth, stop)
            self._push(leaf)
            return [] if leaf.cells is None else [leaf.cells]
        regions = leaf.region.halves(cut.sample, cut.axis, cut.at_m)
        below, above = (Branch(one, one, leaf.depth + 1, leaf.prices, leaf.bound, worth) for one in regions)
        enough = min(worth, _AHEAD * self.open[0][0]) if self.open else worth
        for part in (below, above):
            self._raise(part, worth, enough, stop)
        leaf.cut, leaf.parts, leaf.mixture = cut, (below, above), None
        self._push(below)
        self._push(above)
        return [part.cells for part in (below, above) if part.cells is not None]

    def _push(self, leaf: Branch) -> None:
        self.count += 1
        heapq.heappush(self.open, (leaf.bound, self.count, leaf))

    def _raise(self, branch: Branch, worth: float, enough: float, stop: Callable[[], bool]) -> None:
        """Look for prices of a part that prove enough; keep them if they prove more than the whole did."""
        tube = self.tube_of(branch.region, worth)
        branch.worth, branch.tube = worth, tube
        if tube.empty:
            branch.bound = np.inf
            return
        self.guide.confine(tube, branch.region)
        found = ascended(self.guide, branch.prices, _STAGES, worth, enough=enough, stop=stop)
        branch.mixture, branch.early = found.mixture, found.early and enough < worth
        self.judge.confine(tube, branch.region)
        priced = self.judge.at(found.prices)
        if priced.bound >= branch.bound:
            branch.prices, branch.bound = replace(found.prices, walls=priced.walls), priced.bound
        branch.cells = priced.cells if np.isfinite(priced.bound) else None

    def _cut(self, leaf: Branch) -> Cut | None:
        """Return where the mixture of a leaf is farthest out of reach, half way to where it would be within."""
        mixture = leaf.mixture
        if mixture is None or leaf.depth >= _DEEPEST:
            return None
        off, share = self._violations(mixture, leaf.tube)
        for number in np.argsort(-(off * share), axis=None)[:_CANDIDATES]:
            side, sample, axis = (int(one) for one in np.unravel_index(number, off.shape))
            if off[side, sample, axis] * share[side, sample, axis] < _LEAST_VIOLATION_M:
                break
            away = off[side, sample, axis]
            way = min(away / 2, away - _NEAREST_M) * (1 if side else -1)
            low, high = leaf.tube.low_m[sample, axis], leaf.tube.high_m[sample, axis]
            at = float(np.clip(mixture.base_m[sample, axis], low, high) + way)
            if low + _NARROWEST_M < at < high - _NARROWEST_M:
                return Cut(sample, axis, at)
        return self._widest(leaf)

    def _widest(self, leaf: Branch) -> Cut | None:
        """Return a cut through the middle of the widest place of a leaf's tube, along the way or in height."""
        ahead = np.abs(self.guide.problem.goal_m - self.guide.problem.start_m)[:2]
        kept = np.append(ahead >= _ALONG * ahead.max(), True)
        wide = (leaf.tube.high_m - leaf.tube.low_m)[:: self.guide.per] * kept
        cell, axis = (int(one) for one in np.unravel_index(int(wide.argmax()), wide.shape))
        if wide[cell, axis] < _WORTH_CUTTING_M:
            return None
        sample = cell * self.guide.per
        return Cut(sample, axis, float((leaf.tube.low_m + leaf.tube.high_m)[sample, axis] / 2))

    def _violations(self, mixture: Mixture, tube: Tube) -> tuple[Array, Array]:
        """Return how far the base is too high, and too low, for what stands, and how much stands so.

        Means over what stands on all feet, shape (2, N, 3); zero inside the cells.
        """
        problem, per = self.guide.problem, self.guide.per
        far, share = np.zeros((2, problem.samples, 3)), np.zeros((2, problem.samples, 3))
        ends = np.unique(np.concatenate([np.arange(0, problem.samples, per), np.arange(per - 1, problem.samples, per)]))
        ends = ends[(ends > 0) & (ends < problem.samples - 2)]
        base = np.clip(mixture.base_m, tube.low_m, tube.high_m)[ends][:, None]
        for foot, standing in enumerate(mixture.standing):
            least, most = (one[ends] for one in within_reach(problem, foot, self.guide.boxes[foot][2]))
            parts = standing[ends // per][:, :, None]
            for side, off in enumerate((_counted(base - most), _counted(least - base))):
                far[side, ends] += (parts * off).sum(axis=1)
                share[side, ends] += (parts * (off > 0)).sum(axis=1)
        return far / np.maximum(share, _LEAST_SHARE), share


def _counted(off_m: Array) -> Array:
    """Return what is too far out of reach to be let pass once the base is cut."""
    return np.where(off_m > 1.5 * _NEAREST_M, off_m, 0.0)

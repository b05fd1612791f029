"""Better and better prices for the bound over all gaits: the smooth bound at falling heats, by quasi-Newton steps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from surefoot.footholds.dual import Pricing
from surefoot.footholds.mixture import Mixture, mixture_at
from surefoot.footholds.rows import Array
from surefoot.footholds.sharing import Prices

_REACH_SCALE, _PULL_SCALE, _CONTACT_SCALE, _WALL_SCALE = 1000.0, 3.0, 300.0, 1000.0
_WORTH_SCALE = 0.01
_MEMORY = 20
_EASE = 1e-6
_IMPOSSIBLE = 1e6


@dataclass(frozen=True, slots=True)
class Stage:
    """One part of an ascent.

    Attributes:
        heat: of the mixture, as a part of the worth.
        steps: how many at most.
    """

    heat: float
    steps: int


@dataclass(frozen=True, slots=True, eq=False)
class Ascended:
    """Where an ascent ended.

    Attributes:
        prices: the last ones.
        mixture: what they prove at the last heat; None where no pattern is allowed.
        early: whether it ended because enough was proved.
    """

    prices: Prices
    mixture: Mixture | None
    early: bool


def ascended(
    pricing: Pricing,
    start: Prices,
    stages: Sequence[Stage],
    worth: float,
    *,
    enough: float = np.inf,
    stop: Callable[[], bool] = lambda: False,
) -> Ascended:
    """Raise the smooth bound.

    Args:
        pricing: its footholds are points; its region's bounds get multipliers.
        start: prices to start from.
        stages: one after the other.
        worth: cost of the best plan.
        enough: a bound at which to stop.
        stop: asked now and then.
    """
    layout = _Layout(pricing, start)
    at = layout.packed(start)
    scale, last, early = _WORTH_SCALE * worth, None, False
    for stage in stages:
        walk = _Walk(layout, stage.heat * worth, scale, enough, stop)
        answer = minimize(
            walk.value, at, jac=True, method="L-BFGS-B", bounds=layout.bounds, callback=walk.checked,
            options={"maxiter": stage.steps, "maxfun": 2 * stage.steps, "maxcor": _MEMORY, "ftol": _EASE, "gtol": 1e-9},
        )  # fmt: skip
        at, last, early = answer.x, walk.last, walk.early
        if last is None or early or stop():
            break
    return Ascended(layout.prices(at), last, early)


class _Walk:
    """One stage: what is minimised, and when to end."""

    def __init__(self, layout: _Layout, heat: float, scale: float, enough: float, stop: Callable[[], bool]) -> None:
        self.layout, self.heat, self.scale, self.enough, self.stop = layout, heat, scale, enough, stop
        self.last: Mixture | None = None
        self.early = False

    def value(self, at: Array) -> tuple[float, Array]:
        mixture = mixture_at(self.layout.pricing, self.layout.prices(at), self.heat)
        if not np.isfinite(mixture.value):
            self.last = None
            return -_IMPOSSIBLE, np.zeros_like(at)
        self.last = mixture
        value, slope = self.layout.slope(at, mixture)
        return -value / self.scale, -slope / self.scale

    def checked(self, intermediate_result: object) -> None:
        fun = float(intermediate_result.fun)  # type: ignore[attr-defined]
        self.early = -fun * self.scale > self.enough
        if self.early or self.stop():
            raise StopIteration


class _Layout:
    """Prices as one vector: multipliers of upper and lower bounds apart, all of them positive.

    Args:
        pricing: whose region counts.
        start: whose split is kept.
    """

    def __init__(self, pricing: Pricing, start: Prices) -> None:
        self.pricing, self.split = pricing, start.split
        region = pricing.region
        self.shapes = start.reach.shape, start.pull.shape, start.contact.shape
        self.below, self.above = np.isfinite(region.low_m), np.isfinite(region.high_m)
        sizes = [start.reach.size, start.reach.size, start.pull.size, start.contact.size]
        sizes += [int(self.below.sum()), int(self.above.sum())]
        self.cuts = np.cumsum(sizes)[:-1]
        scales = [_REACH_SCALE, _REACH_SCALE, _PULL_SCALE, _CONTACT_SCALE, _WALL_SCALE, _WALL_SCALE]
        self.scales = np.repeat(scales, sizes)
        signs = np.repeat([True, True, False, False, True, True], sizes)
        self.bounds = [(0.0, None) if one else (None, None) for one in signs]

    def packed(self, prices: Prices) -> Array:
        """Return prices as a vector."""
        walls = np.zeros(self.shapes[1]) if prices.walls is None else prices.walls
        parts = [np.maximum(prices.reach, 0), np.maximum(-prices.reach, 0), prices.pull, prices.contact]
        parts += [np.maximum(-walls[self.below], 0), np.maximum(walls[self.above], 0)]
        packed: Array = np.concatenate([part.ravel() for part in parts]) / self.scales
        return packed

    def prices(self, at: Array) -> Prices:
        """Return the prices of a vector."""
        up, down, pull, contact, below, above = np.split(at * self.scales, self.cuts)
        walls = None
        if self.cuts[-1] > self.cuts[-2] or len(above):
            walls = np.zeros(self.shapes[1])
            walls[self.above] += above
            walls[self.below] -= below
        reach = (up - down).reshape(self.shapes[0])
        return Prices(reach, pull.reshape(self.shapes[1]), contact, self.split, walls)

    def slope(self, at: Array, mixture: Mixture) -> tuple[float, Array]:
        """Return the value with what the bounds of Eq. (16) take away, and its slope."""
        up, down = np.split(at * self.scales, self.cuts)[:2]
        reach, region = np.array(self.pricing.problem.robot.foot_reach_m), self.pricing.region
        taken = float(((up + down).reshape(self.shapes[0]) * reach).sum())
        slopes = [mixture.off_m - reach, -mixture.off_m - reach, mixture.draw, mixture.missing]
        slopes += [(region.low_m - mixture.base_m)[self.below], (mixture.base_m - region.high_m)[self.above]]
        return mixture.value - taken, np.concatenate([one.ravel() for one in slopes]) * self.scales

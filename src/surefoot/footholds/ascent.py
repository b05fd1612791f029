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

_REACH_SCALE, _PULL_SCALE, _CONTACT_SCALE = 1000.0, 3.0, 300.0
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
        pricing: its footholds are points.
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
    """Prices as one vector: multipliers of upper and lower bounds of reach apart, both positive.

    Args:
        pricing: whose reach counts.
        start: whose split is kept.
    """

    def __init__(self, pricing: Pricing, start: Prices) -> None:
        self.pricing, self.split = pricing, start.split
        self.shapes = start.reach.shape, start.pull.shape
        sizes = [start.reach.size, start.reach.size, start.pull.size, start.contact.size]
        self.cuts = np.cumsum(sizes)[:-1]
        self.scales = np.repeat([_REACH_SCALE, _REACH_SCALE, _PULL_SCALE, _CONTACT_SCALE], sizes)
        self.bounds = [(0.0, None)] * (2 * start.reach.size) + [(None, None)] * (sizes[2] + sizes[3])

    def packed(self, prices: Prices) -> Array:
        """Return prices as a vector."""
        parts = [np.maximum(prices.reach, 0), np.maximum(-prices.reach, 0), prices.pull, prices.contact]
        packed: Array = np.concatenate([part.ravel() for part in parts]) / self.scales
        return packed

    def prices(self, at: Array) -> Prices:
        """Return the prices of a vector."""
        up, down, pull, contact = np.split(at * self.scales, self.cuts)
        return Prices((up - down).reshape(self.shapes[0]), pull.reshape(self.shapes[1]), contact, self.split)

    def slope(self, at: Array, mixture: Mixture) -> tuple[float, Array]:
        """Return the value with what the bounds of Eq. (16) take away, and its slope."""
        up, down = np.split(at * self.scales, self.cuts)[:2]
        reach = np.array(self.pricing.problem.robot.foot_reach_m)
        taken = float(((up + down).reshape(self.shapes[0]) * reach).sum())
        slopes = [mixture.off_m - reach, -mixture.off_m - reach, mixture.draw, mixture.missing]
        return mixture.value - taken, np.concatenate([one.ravel() for one in slopes]) * self.scales

"""Regions in closed form: what is left of the grid's answer when sample and cell shrink to nothing.

Under zero-order hold these curves are an OUTER bound of the controllable region: no controller, however fast, saves a
state beyond them. They screen transitions, draw regions and measure margins; they certify nothing. What is certified
is in ``certified``. The reading ``jump`` has no such limit, as its disturbance grows without bound.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.reach import _arcs
from surefoot.reach.parameters import Disturbance, Reading, Settings, Transition

LABEL = "outer bound (continuous time); not a certificate under zero-order hold"

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class BarrierRegion:
    """The region of one walking step between barrier curves.

    Attributes:
        first: funnel of the first half step.
        second: funnel of the second half step.
        guard: corners of the guard.
        window_mps: at the next apex.
        ends_m: where the lower and the upper barrier pass the window's bounds.
        tube: omega, slowest and fastest apex velocity of the tangent manifolds.
        label: what the region is good for.
    """

    first: _arcs.Funnel
    second: _arcs.Funnel
    guard: _arcs.Corners
    window_mps: tuple[float, float]
    ends_m: tuple[float, float]
    tube: tuple[float, float, float]
    label: str = LABEL

    @property
    def is_empty(self) -> bool:
        """Whether no state can be switched, so that the step is impossible."""
        return bool(self.guard.empty)

    def second_half(self, x_m: Floats) -> tuple[Floats, Floats]:
        """Return least and greatest winning velocity of the second half step at positions [m/s]."""
        x = np.asarray(x_m, np.float64)
        low = [_arcs.second_low(self.second, min(p, self.ends_m[0]), self.ends_m[0], self.window_mps[0]) for p in x]
        high = [_arcs.second_high(self.second, min(p, self.ends_m[1]), self.ends_m[1], self.window_mps[1]) for p in x]
        return np.array(low), np.array(high)

    def guard_span(self, x_m: Floats) -> tuple[Floats, Floats]:
        """Return least and greatest velocity of the guard at positions; low > high where there is none."""
        x = np.asarray(x_m, np.float64)
        low, high = self.second_half(x)
        omega, slowest, fastest = self.tube
        rise = (omega * (x - self.first.foot)) ** 2
        low, high = np.maximum(low, np.sqrt(slowest**2 + rise)), np.minimum(high, np.sqrt(fastest**2 + rise))
        return np.where(x > self.first.foot, low, np.inf), np.where(x > self.first.foot, high, -np.inf)

    def first_half(self, x_m: Floats, *, asymptote_rule: bool = True) -> tuple[Floats, Floats]:
        """Return least and greatest winning velocity of the first half step, its guard included.

        Args:
            x_m: positions.
            asymptote_rule: leave out states below v = omega_min |x - x_foot|, as the grid does.
        """
        x = np.asarray(x_m, np.float64)
        low = np.array([_arcs.first_low(self.first, self.guard, p) for p in x])
        high = np.array([_arcs.first_high(self.first, self.guard, p) for p in x])
        if asymptote_rule:
            low = np.maximum(low, self.first.lower.w[0] * np.abs(x - self.first.foot))
        guard_low, guard_high = self.guard_span(x)
        there = guard_low <= guard_high
        low, high = (
            np.where(there, np.minimum(low, guard_low), low),
            np.where(there, np.maximum(high, guard_high), high),
        )
        empty = np.full_like(x, self.guard.empty, dtype=np.bool_)
        return np.where(empty, np.inf, low), np.where(empty, -np.inf, high)

    def area(self, begin_m: float, *, asymptote_rule: bool = True, points: int = 4001) -> dict[str, float]:
        """Return the areas of both regions from a position on, up to where the barriers end [m m/s]."""
        x = np.linspace(begin_m, max(self.ends_m), points)
        spans = {"shws": self.second_half(x), "fhws": self.first_half(x, asymptote_rule=asymptote_rule)}
        return {
            name: float(np.trapezoid(np.where(high > low, high - low, 0.0), x)) for name, (low, high) in spans.items()
        }


def barrier_region(transition: Transition, settings: Settings, *, at_apex: bool = False) -> BarrierRegion:
    """Return the closed form of a transition's regions.

    Args:
        transition: of the step.
        settings: the grid gives the band of velocities, the rest as for ``synthesize``; tau plays no part.
        at_apex: the target counts as met when the orbit crosses the next apex position inside the window, instead of
            anywhere in the target; this is the exact region in continuous time.

    Raises:
        InputError: the disturbance is read as jumps.
    """
    first, second = funnels(transition, settings)
    half_width = 0.0 if at_apex else settings.target_half_width_m
    window = (float(transition.apex_velocity_mps[0]), float(transition.apex_velocity_mps[1]))
    ends = _arcs.target_ends(second, half_width, window[0])
    tube = _tube(settings)
    guard = _arcs.corners(second, *ends, *window, first.foot, *tube)
    return BarrierRegion(first, second, guard, window, ends, tube)


def screen(transitions: Sequence[Transition], settings: Settings) -> Floats:
    """Return the velocities at the current apex between which each step may succeed, low > high where none does.

    An empty interval is final: no controller makes that step surely succeed. A non-empty one is a hope.
    Heights with ``level_com`` are not taken here; screen those with ``barrier_region``.

    Returns:
        One row per transition: least and greatest velocity [m/s].
    """
    if any(transition.level_com and transition.height_change_m for transition in transitions):
        raise InputError("screening takes no transitions with a level CoM; use barrier_region for them")
    lengths = np.array([t.step_length_m for t in transitions], np.float64)
    windows = np.array([t.apex_velocity_mps for t in transitions], np.float64).reshape(-1, 2)
    feet = np.array([t.first_foot_m for t in transitions], np.float64)
    return screen_arrays(lengths, windows, feet, settings)


def screen_arrays(lengths_m: Floats, windows_mps: Floats, feet_m: Floats, settings: Settings) -> Floats:
    """Screen transitions given as arrays; see ``screen``."""
    funnel = _funnel(settings, 1.0, 0.0)
    half_width = settings.target_half_width_m
    return np.asarray(_arcs.screen_many(funnel, funnel, lengths_m, windows_mps, feet_m, half_width, _tube(settings)))


def funnels(transition: Transition, settings: Settings) -> tuple[_arcs.Funnel, _arcs.Funnel]:
    """Return what bounds the two half steps."""
    first = _funnel(settings, 1.0, transition.first_foot_m)
    return first, _funnel(settings, transition.second_omega_scale, transition.step_length_m)


def _funnel(settings: Settings, scale: float, foot_m: float) -> _arcs.Funnel:
    omegas = settings.omegas.values_radps
    lower, upper = _chains(omegas[0] * scale, omegas[-1] * scale, settings.disturbance)
    grid = settings.grid
    return _arcs.Funnel(lower, upper, float(foot_m), float(grid.slowest_mps), float(grid.fastest_mps))


def _tube(settings: Settings) -> tuple[float, float, float]:
    guard = settings.guard
    return float(guard.omega_radps), float(guard.slowest_mps), float(guard.fastest_mps)


def _chains(least: float, most: float, disturbance: Disturbance) -> tuple[_arcs.Chain, _arcs.Chain]:
    """Return the chains of the lower and the upper barrier for the least and the greatest omega."""
    if disturbance.reading is Reading.JUMP:
        raise InputError("jumps at every sample have no closed form; choose rate or inside_phi", key="disturbance")
    if disturbance.reading is Reading.INSIDE_PHI:
        d1, shift = float(disturbance.second), float(disturbance.first)
        d2_least, d2_most = least**2 * shift, most**2 * shift
        control = turn = shift
    else:
        d1, d2_least = float(disturbance.first), float(disturbance.second)
        d2_most, control, turn = d2_least, 0.0, float(disturbance.second) / most**2
    lower = _arcs.Chain(control, turn, (least, most, most), (-d1, -d1, d1), (-d2_least, -d2_most, -d2_most))
    upper = _arcs.Chain(-turn, -control, (most, most, least), (d1, -d1, -d1), (d2_most, d2_most, d2_least))
    return lower, upper

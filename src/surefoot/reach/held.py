"""Barrier curves under zero-order hold, and what one sample with a held omega can do (proof in docs/reach.md).

With a < b the least and the greatest omega: L2, U2 are the lowest and the highest orbit of the second half step that
still meet the window; B, H are the lower and the upper edge of the first half step's band.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from surefoot.reach._arcs import Chain, back


@dataclass(frozen=True, slots=True)
class Frame:
    """The numbers of the proof: omegas a < b, bounds of the rates, sampling time, band of velocities, feet, window."""

    a: float
    b: float
    d1: float
    d2: float
    tau: float
    slowest: float
    fastest: float
    foot: float
    next_foot: float
    window: tuple[float, float]
    tube: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Band:
    """The band of the first half step between its lowest and its highest orbit.

    Attributes:
        frame: the numbers.
        entry_low: position where the lowest orbit enters the guard.
        entry_high: position where the highest orbit comes down into the guard.
        foot_low: least velocity left of the first foot, at the foot.
        foot_high: greatest velocity left of the first foot, at the foot.
    """

    frame: Frame
    entry_low: float
    entry_high: float
    foot_low: float = 0.0
    foot_high: float = 0.0


def second_low(f: Frame, x: float) -> float:
    """L2: backwards from the window's lower bound at the next foot."""
    return float(back(_lower(f), f.next_foot, f.window[0], x, f.next_foot, 0.0))


def second_high(f: Frame, x: float) -> float:
    """U2: backwards from the window's upper bound at the next foot."""
    return float(back(_upper(f), f.next_foot, f.window[1], x, f.next_foot, 0.0))


def orbit_low(c: Band, x: float) -> float:
    """The lowest orbit into the guard, on both sides of where it enters; x at the foot or ahead of it."""
    f, at = c.frame, c.entry_low
    v = tube(f, at, f.tube[1])
    if x <= at:
        return float(back(_lower(f), at, v, x, f.foot, 0.0))
    return ahead(x - f.foot, at - f.foot, v, f.b, f.d1, -f.d2)


def orbit_high(c: Band, x: float) -> float:
    """The highest orbit into the guard; x at the foot or ahead of it."""
    f, at = c.frame, c.entry_high
    v = tube(f, at, f.tube[2])
    if x <= at:
        return float(back(_upper(f), at, v, x, f.foot, 0.0))
    return ahead(x - f.foot, at - f.foot, v, f.a, -f.d1, f.d2)


def first_low(c: Band, x: float) -> float:
    """B: the lower edge of the first half's band."""
    f, z = c.frame, x - c.frame.foot
    if z < 0:
        return float(back(held_low(f, f.a), f.foot, c.foot_low, x, f.foot, 0.0))
    dip = float(back(_lower(f), f.foot + f.d2 / f.b**2, f.slowest, x, f.foot, 0.0)) if z < f.d2 / f.b**2 else f.slowest
    return max(orbit_low(c, x), dip, f.a * z)


def first_high(c: Band, x: float) -> float:
    """H: the upper edge of the first half's band."""
    f = c.frame
    if x < f.foot:
        return min(float(back(held_high(f, f.b), f.foot, c.foot_high, x, f.foot, 0.0)), f.fastest)
    return orbit_high(c, x)


def second_top_of_a(f: Frame, x: float) -> float:
    """Largest velocity from which holding a stays below U2 for a sample."""
    x1 = min(x + _second_reach(f, x), f.next_foot)
    return float(back(held_high(f, f.a), x1, second_high(f, x1), x, f.next_foot, 0.0))


def second_bottom_of_b(f: Frame, x: float) -> float:
    """Least velocity from which holding b stays above L2 for a sample."""
    x1 = min(x + _second_reach(f, x), f.next_foot)
    return float(back(held_low(f, f.b), x1, second_low(f, x1), x, f.next_foot, 0.0))


def _second_reach(f: Frame, x: float) -> float:
    return (min(second_high(f, x), f.fastest) + f.d2 * f.tau + f.d1) * f.tau


def first_reach(f: Frame, x: float, v: float) -> tuple[float, float]:
    """Return how far position and velocity can grow in a sample of the first half step, from (x, v) or below."""
    lead = max(x - f.foot + 2 * f.fastest * f.tau, 0.0)
    far = (v + (f.b**2 * lead + f.d2) * f.tau + f.d1) * f.tau
    gain = (f.b**2 * max(x - f.foot + far, 0.0) + f.d2) * f.tau
    return (v + gain + f.d1) * f.tau, gain


def first_top_of_b(c: Band, x: float) -> float:
    """Largest velocity ahead of the foot from which holding b stays below H for a sample."""
    f = c.frame
    x1 = x + first_reach(f, x, first_high(c, x))[0]
    return float(back(held_high(f, f.b), x1, orbit_high(c, x1), x, f.foot, 0.0))


def first_bottom_of_a(c: Band, x: float) -> float:
    """Least velocity ahead of the foot from which holding a stays above B for a sample."""
    f = c.frame
    x1 = x + first_reach(f, x, first_high(c, x))[0]
    orbit = float(back(held_low(f, f.a), x1, orbit_low(c, x1), x, f.foot, 0.0))
    asymptote = f.a * (x - f.foot) + (f.d2 + f.a * f.d1) * math.expm1(f.a * f.tau) / f.a
    return max(orbit, asymptote, f.slowest + f.d2 * f.tau)


def left_top_of_a(c: Band, x: float) -> float:
    """Largest velocity left of the foot from which holding a stays below H for a sample."""
    f = c.frame
    x1 = min(x + first_reach(f, x, first_high(c, x))[0], f.foot)
    edge = c.foot_high if x1 >= f.foot else first_high(c, x1)
    return float(back(held_high(f, f.a), x1, edge, x, f.foot, 0.0))


def left_bottom_of_b(c: Band, x: float) -> float:
    """Least velocity left of the foot from which holding b stays above B for a sample."""
    f = c.frame
    x1 = min(x + first_reach(f, x, first_high(c, x))[0], f.foot)
    edge = c.foot_low if x1 >= f.foot else first_low(c, x1)
    return float(back(held_low(f, f.b), x1, edge, x, f.foot, 0.0))


def tube(f: Frame, x: float, apex_velocity: float) -> float:
    """Return the velocity of the first half's tangent manifold of an apex velocity."""
    return math.hypot(apex_velocity, f.tube[0] * (x - f.foot))


def ahead(z: float, from_z: float, v: float, w: float, d1: float, d2: float) -> float:
    """Follow an orbit ahead of the foot from one offset to a larger one."""
    shift = d2 / w**2
    return math.sqrt((v + d1) ** 2 + w * w * ((z + shift) ** 2 - (from_z + shift) ** 2)) - d1


def _lower(f: Frame) -> Chain:
    """The slowest saved orbit: a left of the foot, b ahead of it."""
    return Chain(0.0, f.d2 / f.b**2, (f.a, f.b, f.b), (-f.d1, -f.d1, f.d1), (-f.d2, -f.d2, -f.d2))


def _upper(f: Frame) -> Chain:
    """The fastest saved orbit: b left of the foot, a ahead of it."""
    return Chain(-f.d2 / f.b**2, 0.0, (f.b, f.b, f.a), (f.d1, -f.d1, -f.d1), (f.d2, f.d2, f.d2))


def held_low(f: Frame, w: float) -> Chain:
    """The lowest orbit while one omega is held."""
    turn = f.d2 / w**2
    return Chain(turn, turn, (w, w, w), (-f.d1, -f.d1, f.d1), (-f.d2, -f.d2, -f.d2))


def held_high(f: Frame, w: float) -> Chain:
    """The highest orbit while one omega is held."""
    turn = f.d2 / w**2
    return Chain(-turn, -turn, (w, w, w), (f.d1, f.d1, -f.d1), (f.d2, f.d2, f.d2))

"""A certificate in closed form: barrier curves that hold under zero-order hold (proof in docs/reach.md).

The curves of ``barriers`` are kept as they are for the second half step. In the first half step they are moved inward so
that every orbit spends at least one sample in the guard, and a little left of the foot, where the omega that lifts and
the omega that lowers change roles within a sample. What the proof asks of the numbers is checked on a fine grid of
positions with a slack for what lies between. The target counts as met when the orbit crosses the next apex position
inside the window.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.reach._arcs import Chain, back
from surefoot.reach.barriers import barrier_region
from surefoot.reach.parameters import Disturbance, Reading, Settings, Transition

CHECK_STEP_M = 5e-5
Floats = NDArray[np.float64]
Curve = Callable[[float], float]


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
class Certified:
    """A certified region.

    Attributes:
        valid: whether every condition of the proof holds; otherwise nothing is promised.
        reason: the first condition that failed, or None.
        frame: the numbers.
        entry_low: position where the lowest orbit enters the guard.
        entry_high: position where the highest orbit comes down into the guard.
        foot_low: least velocity left of the first foot, at the foot.
        foot_high: greatest velocity left of the first foot, at the foot.
    """

    valid: bool
    reason: str | None
    frame: Frame
    entry_low: float
    entry_high: float
    foot_low: float
    foot_high: float

    def second_half(self, x: float) -> tuple[float, float]:
        """Return the certified velocities of the second half step at a position; low > high beyond the next apex."""
        f = self.frame
        if x > f.next_foot:
            return math.inf, -math.inf
        return second_low(f, x), min(second_high(f, x), f.fastest)

    def guard(self, x: float) -> tuple[float, float]:
        """Return the velocities at which a sample may switch the foot."""
        f = self.frame
        if x <= f.foot:
            return math.inf, -math.inf
        low, high = self.second_half(x)
        return max(low, _tube(f, x, f.tube[1])), min(high, _tube(f, x, f.tube[2]))

    def first_half(self, x: float) -> tuple[float, float]:
        """Return the certified velocities of the first half step at a position, the guard included."""
        f = self.frame
        low, high = first_low(self, x), min(first_high(self, x), second_high(f, x))
        guard_low, guard_high = self.guard(x)
        if guard_low <= guard_high:
            return min(low, guard_low), max(high, guard_high)
        return low, high

    def contains(self, x: float, v: float, half: str = "first") -> bool:
        """Tell whether the next apex is surely met from a state."""
        low, high = self.first_half(x) if half == "first" else self.second_half(x)
        return self.valid and low <= v <= high

    def switches(self, x: float, v: float) -> bool:
        """Tell whether the foot is switched at a sample in this state."""
        low, high = self.guard(x)
        return low <= v <= high

    def omega(self, x: float, v: float, half: str = "first") -> float:
        """Return the omega to hold for the next sample: the least or the greatest one, whichever is proven safe."""
        f = self.frame
        if half == "second":
            return f.a if v <= _second_top_of_a(f, x) else f.b
        if x >= f.foot:
            return f.b if v <= _first_top_of_b(self, x) else f.a
        return f.b if v >= _left_bottom_of_b(self, x) else f.a

    def area(self, begin_m: float, points: int = 4001) -> dict[str, float]:
        """Return the areas of both regions from a position on [m m/s]; 0 when nothing is certified."""
        found = {}
        for name, spans in (("shws", self.second_half), ("fhws", self.first_half)):
            x = np.linspace(begin_m, self.frame.next_foot, points)
            heights = [max(high - low, 0.0) if low <= high else 0.0 for low, high in map(spans, x)]
            found[name] = float(np.trapezoid(heights, x)) if self.valid else 0.0
        return found


def certified_region(transition: Transition, settings: Settings) -> Certified:
    """Return the certified region of a transition; invalid, with the reason, where the proof does not apply.

    The reading ``inside_phi`` is covered by the rates that contain it; jumps are not covered.
    """
    if settings.disturbance.reading is Reading.JUMP:
        return Certified(
            False, "jumps at every sample have no barrier curves", _frame(transition, settings), 0, 0, 0, 0
        )
    f = _frame(transition, settings)
    plain = Settings(Disturbance(Reading.RATE, f.d1, f.d2), f.tau, settings.grid, settings.omegas, settings.guard)
    corners = barrier_region(transition, plain, at_apex=True).guard
    reason = _premises(transition, f, bool(corners.empty))
    if reason is not None:
        return Certified(False, reason, f, 0, 0, 0, 0)
    low = _last(lambda x: _low_entry_holds(f, x), f.foot, corners.right_x)
    high = _last(lambda x: _high_entry_holds(f, x), f.foot, corners.top_x)
    if low is None or high is None:
        return Certified(False, "the guard is too short for a sample to fall into it", f, 0, 0, 0, 0)
    if not (_climbs(f, low) and _sinks(f, high)):
        return Certified(False, "near the foot omega cannot outdo the disturbance along the guard", f, low, high, 0, 0)
    open_foot = Certified(True, None, f, low, high, 0.0, 0.0)
    found = Certified(True, None, f, low, high, _foot_low(open_foot), _foot_high(open_foot))
    reason = _second_gap(f, -settings.grid.behind_m) or _first_gap(found, -settings.grid.behind_m)
    return found if reason is None else Certified(False, reason, f, low, high, found.foot_low, found.foot_high)


# The curves.


def second_low(f: Frame, x: float) -> float:
    """L2: backwards from the window's lower bound at the next foot."""
    return float(back(_lower(f), f.next_foot, f.window[0], x, f.next_foot, 0.0))


def second_high(f: Frame, x: float) -> float:
    """U2: backwards from the window's upper bound at the next foot."""
    return float(back(_upper(f), f.next_foot, f.window[1], x, f.next_foot, 0.0))


def orbit_low(c: Certified, x: float) -> float:
    """The lowest orbit into the guard, on both sides of where it enters; x at the foot or ahead of it."""
    f, at = c.frame, c.entry_low
    v = _tube(f, at, f.tube[1])
    if x <= at:
        return float(back(_lower(f), at, v, x, f.foot, 0.0))
    return _ahead(x - f.foot, at - f.foot, v, f.b, f.d1, -f.d2)


def orbit_high(c: Certified, x: float) -> float:
    """The highest orbit into the guard; x at the foot or ahead of it."""
    f, at = c.frame, c.entry_high
    v = _tube(f, at, f.tube[2])
    if x <= at:
        return float(back(_upper(f), at, v, x, f.foot, 0.0))
    return _ahead(x - f.foot, at - f.foot, v, f.a, -f.d1, f.d2)


def first_low(c: Certified, x: float) -> float:
    """B: the lower edge of the first half's band."""
    f, z = c.frame, x - c.frame.foot
    if z < 0:
        return float(back(_held_low(f, f.a), f.foot, c.foot_low, x, f.foot, 0.0))
    dip = float(back(_lower(f), f.foot + f.d2 / f.b**2, f.slowest, x, f.foot, 0.0)) if z < f.d2 / f.b**2 else f.slowest
    return max(orbit_low(c, x), dip, f.a * z)


def first_high(c: Certified, x: float) -> float:
    """H: the upper edge of the first half's band."""
    f = c.frame
    if x < f.foot:
        return min(float(back(_held_high(f, f.b), f.foot, c.foot_high, x, f.foot, 0.0)), f.fastest)
    return orbit_high(c, x)


# What a sample can do.


def _second_top_of_a(f: Frame, x: float) -> float:
    """Largest velocity from which holding a stays below U2 for a sample."""
    x1 = min(x + _second_reach(f, x), f.next_foot)
    return float(back(_held_high(f, f.a), x1, second_high(f, x1), x, f.next_foot, 0.0))


def _second_bottom_of_b(f: Frame, x: float) -> float:
    """Least velocity from which holding b stays above L2 for a sample."""
    x1 = min(x + _second_reach(f, x), f.next_foot)
    return float(back(_held_low(f, f.b), x1, second_low(f, x1), x, f.next_foot, 0.0))


def _second_reach(f: Frame, x: float) -> float:
    return (min(second_high(f, x), f.fastest) + f.d2 * f.tau + f.d1) * f.tau


def _first_reach(f: Frame, x: float, v: float) -> tuple[float, float]:
    """Return how far position and velocity can grow in a sample of the first half step, from (x, v) or below."""
    lead = max(x - f.foot + 2 * f.fastest * f.tau, 0.0)
    far = (v + (f.b**2 * lead + f.d2) * f.tau + f.d1) * f.tau
    gain = (f.b**2 * max(x - f.foot + far, 0.0) + f.d2) * f.tau
    return (v + gain + f.d1) * f.tau, gain


def _first_top_of_b(c: Certified, x: float) -> float:
    """Largest velocity ahead of the foot from which holding b stays below H for a sample."""
    f = c.frame
    x1 = x + _first_reach(f, x, first_high(c, x))[0]
    return float(back(_held_high(f, f.b), x1, orbit_high(c, x1), x, f.foot, 0.0))


def _first_bottom_of_a(c: Certified, x: float) -> float:
    """Least velocity ahead of the foot from which holding a stays above B for a sample."""
    f = c.frame
    x1 = x + _first_reach(f, x, first_high(c, x))[0]
    orbit = float(back(_held_low(f, f.a), x1, orbit_low(c, x1), x, f.foot, 0.0))
    asymptote = f.a * (x - f.foot) + (f.d2 + f.a * f.d1) * math.expm1(f.a * f.tau) / f.a
    return max(orbit, asymptote, f.slowest + f.d2 * f.tau)


def _left_top_of_a(c: Certified, x: float) -> float:
    """Largest velocity left of the foot from which holding a stays below H for a sample."""
    f = c.frame
    x1 = min(x + _first_reach(f, x, first_high(c, x))[0], f.foot)
    edge = c.foot_high if x1 >= f.foot else first_high(c, x1)
    return float(back(_held_high(f, f.a), x1, edge, x, f.foot, 0.0))


def _left_bottom_of_b(c: Certified, x: float) -> float:
    """Least velocity left of the foot from which holding b stays above B for a sample."""
    f = c.frame
    x1 = min(x + _first_reach(f, x, first_high(c, x))[0], f.foot)
    edge = c.foot_low if x1 >= f.foot else first_low(c, x1)
    return float(back(_held_low(f, f.b), x1, edge, x, f.foot, 0.0))


# The conditions of the proof.


def _premises(transition: Transition, f: Frame, empty: bool) -> str | None:
    if empty:
        return "the guard is empty"
    if transition.level_com and transition.height_change_m:
        return "the two half steps have different omegas, which the proof does not cover"
    if not f.a < f.tube[0] < f.b:
        return "the guard's omega has to lie strictly between the least and the greatest omega"
    if f.slowest <= 2 * f.d1 or f.window[0] <= 2 * f.d1:
        return "the disturbance's rate is not small against the velocities"
    if f.slowest / f.a < (f.d2 + f.a * f.d1) / (f.b**2 - f.a**2):
        return "near the foot the disturbance is stronger than what omega can do along the asymptote"
    if f.window[1] + f.d2 * f.tau + f.d1 >= f.fastest:
        return "the window reaches the fastest velocity"
    return None


def _low_entry_holds(f: Frame, x: float) -> bool:
    """A sample that starts below the tube and left of x ends left of U2."""
    v = _tube(f, x, f.tube[1])
    far, gain = _first_reach(f, x, v)
    return x + far < f.next_foot and v + gain <= second_high(f, x + far)


def _high_entry_holds(f: Frame, x: float) -> bool:
    """The highest orbit through the tube's upper edge at x is left of U2 for one more sample."""
    v, far = _tube(f, x, f.tube[2]), 0.0
    for _ in range(30):
        end = _ahead(x + far - f.foot, x - f.foot, v, f.a, -f.d1, f.d2)
        far, before = (end + f.d1) * f.tau, far
        if abs(far - before) < 1e-12:
            break
    far += 1e-9
    end = _ahead(x + far - f.foot, x - f.foot, v, f.a, -f.d1, f.d2)
    return end <= f.fastest and x + far < f.next_foot and end <= second_high(f, x + far)


def _climbs(f: Frame, x: float) -> bool:
    """From x on the lowest orbit rises faster than the guard's lower manifold."""
    z, v = x - f.foot, _tube(f, x, f.tube[1])
    return z > 0 and f.b**2 - f.tube[0] ** 2 >= f.d2 / z + f.tube[0] ** 2 * f.d1 / v


def _sinks(f: Frame, x: float) -> bool:
    """From x on the highest orbit rises slower than the guard's upper manifold."""
    z, v = x - f.foot, _tube(f, x, f.tube[2])
    return z > 0 and f.tube[0] ** 2 - f.a**2 >= f.d2 / z + f.tube[0] ** 2 * f.d1 / v


def _foot_low(c: Certified) -> float:
    """Least velocity at the foot for samples that begin left of it: enough for all of a sample with a held."""
    f = c.frame
    far = _first_reach(f, f.foot, orbit_high(c, f.foot))[0]
    edge = max(first_low(c, f.foot), orbit_low(c, f.foot + far), f.slowest, f.a * far)
    return f.d1 + math.hypot(edge - f.d1, f.d2 / f.a)


def _foot_high(c: Certified) -> float:
    """Greatest velocity at the foot for samples that begin left of it: with b held a sample still ends below H."""
    f = c.frame
    x1 = f.foot + _first_reach(f, f.foot, orbit_high(c, f.foot))[0]
    return float(back(_held_high(f, f.b), x1, orbit_high(c, x1), f.foot, f.foot, 0.0))


def _second_gap(f: Frame, begin: float) -> str | None:
    """From every state of the second half's region one of a and b is safe."""
    for x in np.arange(begin, f.next_foot + CHECK_STEP_M, CHECK_STEP_M):
        at = min(float(x), f.next_foot)
        top, bottom, low = _second_top_of_a(f, at), _second_bottom_of_b(f, at), second_low(f, at)
        if low > f.fastest or top >= f.fastest:
            continue
        if top < bottom + _slack(f, f.next_foot - at, low):
            return f"the second half's region is narrower than what one sample moves the state at x = {at:.3f} m"
    return None


def _first_gap(c: Certified, begin: float) -> str | None:
    """From every state of the first half's band outside the guard one of a and b is safe and none jumps over U2."""
    f = c.frame
    for x in np.arange(begin, max(c.entry_low, c.entry_high) + CHECK_STEP_M, CHECK_STEP_M):
        at = float(x)
        low, high = first_low(c, at), first_high(c, at)
        if low > min(high, second_high(f, at)):
            return f"the first half's band is empty at x = {at:.3f} m"
        ahead = at >= f.foot
        top = _first_top_of_b(c, at) if ahead else _left_top_of_a(c, at)
        bottom = _first_bottom_of_a(c, at) if ahead else _left_bottom_of_b(c, at)
        slack = _slack(f, at - f.foot, low)
        if top < bottom + slack:
            return f"the first half's band is narrower than what one sample moves the state at x = {at:.3f} m"
        v = min(second_low(f, at), high)
        far, gain = _first_reach(f, at, v)
        if at + far >= f.next_foot or v + gain + slack > second_high(f, at + far):
            return f"a sample may jump over the guard at x = {at:.3f} m"
    return _tail_gap(c)


def _tail_gap(c: Certified) -> str | None:
    """Beyond both entries every state of the band is in the guard."""
    f = c.frame
    for x in np.arange(max(c.entry_low, c.entry_high), f.next_foot, CHECK_STEP_M):
        low = first_low(c, float(x))
        if low > min(first_high(c, float(x)), second_high(f, float(x))):
            return None
        if second_low(f, float(x)) > low:
            return f"the band leaves the guard behind its entry at x = {x:.3f} m"
    return None


def _slack(f: Frame, z: float, v: float) -> float:
    """What a curve can change between two checked positions, four times over."""
    return 4 * CHECK_STEP_M * (f.b**2 * (abs(z) + 2 * f.fastest * f.tau) + f.d2) / (max(v, f.slowest) - f.d1)


# Small helpers.


def _frame(transition: Transition, settings: Settings) -> Frame:
    omegas, bound, grid, tube = settings.omegas.values_radps, settings.disturbance, settings.grid, settings.guard
    d1, d2 = bound.first, bound.second
    if bound.reading is Reading.INSIDE_PHI:
        d1, d2 = bound.second, omegas[-1] ** 2 * bound.first
    low, high = transition.apex_velocity_mps
    return Frame(
        float(omegas[0]),
        float(omegas[-1]),
        float(d1),
        float(d2),
        float(settings.tau_s),
        float(grid.slowest_mps),
        float(grid.fastest_mps),
        float(transition.first_foot_m),
        float(transition.step_length_m),
        (float(low), float(high)),
        (float(tube.omega_radps), float(tube.slowest_mps), float(tube.fastest_mps)),
    )


def _tube(f: Frame, x: float, apex_velocity: float) -> float:
    return math.hypot(apex_velocity, f.tube[0] * (x - f.foot))


def _ahead(z: float, from_z: float, v: float, w: float, d1: float, d2: float) -> float:
    """Follow an orbit ahead of the foot from one offset to a larger one."""
    shift = d2 / w**2
    return math.sqrt((v + d1) ** 2 + w * w * ((z + shift) ** 2 - (from_z + shift) ** 2)) - d1


def _lower(f: Frame) -> Chain:
    """The slowest saved orbit: a left of the foot, b ahead of it."""
    return Chain(0.0, f.d2 / f.b**2, (f.a, f.b, f.b), (-f.d1, -f.d1, f.d1), (-f.d2, -f.d2, -f.d2))


def _upper(f: Frame) -> Chain:
    """The fastest saved orbit: b left of the foot, a ahead of it."""
    return Chain(-f.d2 / f.b**2, 0.0, (f.b, f.b, f.a), (f.d1, -f.d1, -f.d1), (f.d2, f.d2, f.d2))


def _held_low(f: Frame, w: float) -> Chain:
    """The lowest orbit while one omega is held."""
    turn = f.d2 / w**2
    return Chain(turn, turn, (w, w, w), (-f.d1, -f.d1, f.d1), (-f.d2, -f.d2, -f.d2))


def _held_high(f: Frame, w: float) -> Chain:
    """The highest orbit while one omega is held."""
    turn = f.d2 / w**2
    return Chain(-turn, -turn, (w, w, w), (f.d1, f.d1, -f.d1), (f.d2, f.d2, f.d2))


def _last(holds: Callable[[float], bool], low: float, high: float) -> float | None:
    """Return the last position at which a condition holds, that holds up to there."""
    if not holds(low):
        return None
    if holds(high):
        return high
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low

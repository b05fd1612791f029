"""A certificate in closed form: barrier curves that hold under zero-order hold (proof in docs/reach.md).

The curves of ``barriers`` are kept as they are for the second half step. In the first half step they are moved inward
so that every orbit spends at least one sample in the guard, and a little left of the foot, where the omega that lifts
and the omega that lowers change roles within a sample. What the proof asks of the numbers is checked on a fine grid of
positions, with a slack for what lies between. The target counts as met when the orbit crosses the next apex position
inside the window.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from surefoot.reach import held
from surefoot.reach._arcs import back
from surefoot.reach.barriers import barrier_region
from surefoot.reach.held import Band, Frame
from surefoot.reach.parameters import Disturbance, Reading, Settings, Transition

CHECK_STEP_M = 5e-5


@dataclass(frozen=True, slots=True)
class Certified:
    """A certified region.

    Attributes:
        valid: whether every condition of the proof holds; otherwise nothing is promised.
        reason: the first condition that failed, or None.
        band: of the first half step, and the numbers of the proof.
    """

    valid: bool
    reason: str | None
    band: Band

    def second_half(self, x: float) -> tuple[float, float]:
        """Return the certified velocities of the second half step at a position; low > high beyond the next apex."""
        f = self.band.frame
        if x > f.next_foot:
            return math.inf, -math.inf
        return held.second_low(f, x), min(held.second_high(f, x), f.fastest)

    def guard(self, x: float) -> tuple[float, float]:
        """Return the velocities at which a sample may switch the foot."""
        f = self.band.frame
        if x <= f.foot:
            return math.inf, -math.inf
        low, high = self.second_half(x)
        return max(low, held.tube(f, x, f.tube[1])), min(high, held.tube(f, x, f.tube[2]))

    def first_half(self, x: float) -> tuple[float, float]:
        """Return the certified velocities of the first half step at a position, the guard included."""
        f = self.band.frame
        low, high = held.first_low(self.band, x), min(held.first_high(self.band, x), held.second_high(f, x))
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
        f = self.band.frame
        if half == "second":
            return f.a if v <= held.second_top_of_a(f, x) else f.b
        if x >= f.foot:
            return f.b if v <= held.first_top_of_b(self.band, x) else f.a
        return f.b if v >= held.left_bottom_of_b(self.band, x) else f.a

    def area(self, begin_m: float, points: int = 4001) -> dict[str, float]:
        """Return the areas of both regions from a position on [m m/s]; 0 when nothing is certified."""
        found = {}
        for name, spans in (("shws", self.second_half), ("fhws", self.first_half)):
            x = np.linspace(begin_m, self.band.frame.next_foot, points)
            heights = [max(high - low, 0.0) if low <= high else 0.0 for low, high in map(spans, x)]
            found[name] = float(np.trapezoid(heights, x)) if self.valid else 0.0
        return found


def certified_region(transition: Transition, settings: Settings) -> Certified:
    """Return the certified region of a transition; invalid, with the reason, where the proof does not apply.

    The reading ``inside_phi`` is covered by the rates that contain it; jumps are not covered.
    """
    f = _frame(transition, settings)
    nothing = Band(f, f.foot, f.foot)
    if settings.disturbance.reading is Reading.JUMP:
        return Certified(False, "jumps at every sample have no barrier curves", nothing)
    plain = Settings(Disturbance(Reading.RATE, f.d1, f.d2), f.tau, settings.grid, settings.omegas, settings.guard)
    corners = barrier_region(transition, plain, at_apex=True).guard
    reason = _premises(transition, f, bool(corners.empty))
    if reason is not None:
        return Certified(False, reason, nothing)
    low = _last(lambda x: _low_entry_holds(f, x), f.foot, corners.right_x)
    high = _last(lambda x: _high_entry_holds(f, x), f.foot, corners.top_x)
    if low is None or high is None:
        return Certified(False, "the guard is too short for a sample to fall into it", nothing)
    if not (_climbs(f, low) and _sinks(f, high)):
        return Certified(False, "near the foot omega cannot outdo the disturbance along the guard", nothing)
    ahead = Band(f, low, high)
    band = Band(f, low, high, _foot_low(ahead), _foot_high(ahead))
    reason = _second_gap(f, -settings.grid.behind_m) or _first_gap(band, -settings.grid.behind_m)
    return Certified(reason is None, reason, band)


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
    if (f.b**2 * (f.next_foot - f.foot + 2 * f.fastest * f.tau) + f.d2) * f.tau + f.d1 > f.fastest:
        return "a sample is too long: it can double the fastest velocity"
    if f.window[1] + f.d2 * f.tau + f.d1 >= f.fastest:
        return "the window reaches the fastest velocity"
    return None


def _low_entry_holds(f: Frame, x: float) -> bool:
    """A sample that starts below the tube and left of x ends left of U2."""
    v = held.tube(f, x, f.tube[1])
    far, gain = held.first_reach(f, x, v)
    return x + far < f.next_foot and v + gain <= held.second_high(f, x + far)


def _high_entry_holds(f: Frame, x: float) -> bool:
    """The highest orbit through the tube's upper edge at x is left of U2 for one more sample."""
    v, far = held.tube(f, x, f.tube[2]), 0.0
    for _ in range(30):
        end = held.ahead(x + far - f.foot, x - f.foot, v, f.a, -f.d1, f.d2)
        far, before = (end + f.d1) * f.tau, far
        if abs(far - before) < 1e-12:
            break
    far += 1e-9
    end = held.ahead(x + far - f.foot, x - f.foot, v, f.a, -f.d1, f.d2)
    gates = x + far < f.next_foot and end <= held.second_high(f, x + far)
    return gates and _below_fastest(f, x, v)


def _below_fastest(f: Frame, x: float, v: float) -> bool:
    """The highest orbit through (x, v) meets U2 before it exceeds the fastest velocity."""
    if v > f.fastest:
        return False
    shift = f.d2 / f.a**2
    rest = ((f.fastest - f.d1) ** 2 - (v - f.d1) ** 2) / f.a**2
    at = f.foot + math.sqrt((x - f.foot + shift) ** 2 + rest) - shift
    return at >= f.next_foot or held.second_high(f, at) <= f.fastest


def _climbs(f: Frame, x: float) -> bool:
    """From x on the lowest orbit rises faster than the guard's lower manifold."""
    z, v = x - f.foot, held.tube(f, x, f.tube[1])
    return z > 0 and f.b**2 - f.tube[0] ** 2 >= f.d2 / z + f.tube[0] ** 2 * f.d1 / v


def _sinks(f: Frame, x: float) -> bool:
    """From x on the highest orbit rises slower than the guard's upper manifold."""
    z, v = x - f.foot, held.tube(f, x, f.tube[2])
    return z > 0 and f.tube[0] ** 2 - f.a**2 >= f.d2 / z + f.tube[0] ** 2 * f.d1 / v


def _foot_low(c: Band) -> float:
    """Least velocity at the foot for samples that begin left of it: enough for all of a sample with a held."""
    f = c.frame
    far = held.first_reach(f, f.foot, held.orbit_high(c, f.foot))[0]
    edge = max(held.first_low(c, f.foot), held.orbit_low(c, f.foot + far), f.slowest, f.a * far)
    return f.d1 + math.hypot(edge - f.d1, f.d2 / f.a)


def _foot_high(c: Band) -> float:
    """Greatest velocity at the foot for samples that begin left of it: with b held a sample still ends below H."""
    f = c.frame
    x1 = f.foot + held.first_reach(f, f.foot, held.orbit_high(c, f.foot))[0]
    return float(back(held.held_high(f, f.b), x1, held.orbit_high(c, x1), f.foot, f.foot, 0.0))


def _second_gap(f: Frame, begin: float) -> str | None:
    """From every state of the second half's region one of a and b is safe."""
    for x in np.arange(begin, f.next_foot + CHECK_STEP_M, CHECK_STEP_M):
        at = min(float(x), f.next_foot)
        top, bottom, low = held.second_top_of_a(f, at), held.second_bottom_of_b(f, at), held.second_low(f, at)
        if low > f.fastest or top >= f.fastest:
            continue
        if top < bottom + _slack(f, f.next_foot - at, low):
            return f"the second half's region is narrower than what one sample moves the state at x = {at:.3f} m"
    return None


def _first_gap(c: Band, begin: float) -> str | None:
    """From every state of the first half's band outside the guard one of a and b is safe and none jumps over U2."""
    f = c.frame
    for x in np.arange(begin, max(c.entry_low, c.entry_high) + CHECK_STEP_M, CHECK_STEP_M):
        at = float(x)
        low, high = held.first_low(c, at), held.first_high(c, at)
        if low > min(high, held.second_high(f, at)):
            return f"the first half's band is empty at x = {at:.3f} m"
        ahead = at >= f.foot
        top = held.first_top_of_b(c, at) if ahead else held.left_top_of_a(c, at)
        bottom = held.first_bottom_of_a(c, at) if ahead else held.left_bottom_of_b(c, at)
        slack = _slack(f, at - f.foot, low)
        if top < bottom + slack:
            return f"the first half's band is narrower than what one sample moves the state at x = {at:.3f} m"
        v = min(held.second_low(f, at), high) if ahead else high
        far, gain = held.first_reach(f, at, v)
        if at + far >= f.next_foot or v + gain + _slack(f, f.next_foot - at, v) > held.second_high(f, at + far):
            return f"a sample may jump over the guard at x = {at:.3f} m"
    return _tail_gap(c)


def _tail_gap(c: Band) -> str | None:
    """Beyond both entries every state of the band is in the guard: B rises and L2 falls, so one position tells."""
    f, x = c.frame, max(c.entry_low, c.entry_high)
    low = held.first_low(c, x)
    if low > min(held.first_high(c, x), held.second_high(f, x)) or held.second_low(f, x) <= low:
        return None
    return f"the band leaves the guard behind its entry at x = {x:.3f} m"


def _slack(f: Frame, z: float, v: float) -> float:
    """What the compared quantities can change between two checked positions: six slopes, and two to spare."""
    return 8 * CHECK_STEP_M * (f.b**2 * (abs(z) + 2 * f.fastest * f.tau) + f.d2) / (max(v, f.slowest) - f.d1)


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

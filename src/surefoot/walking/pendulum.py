"""Closed forms of the linear pendulum x'' = omega^2 (x - x_foot) over one walking step.

The frame is that of the step: origin at the waypoint, x along the new heading (sagittal), y to its left (lateral). The
next apex and the next foot lie at the same sagittal coordinate. How long a half step lasts is kept as its *growth*
e^(omega t), which needs no logarithm. Source: Shamsah et al., T-RO 2023, Appendix A.
"""

from __future__ import annotations

import math

from numba import njit


@njit(cache=True)
def propagate(
    position_m: float, speed_mps: float, foot_m: float, omega_radps: float, growth: float
) -> tuple[float, float]:
    """Return position and speed of the pendulum after a time with e^(omega t) = growth (Eqs. 10-11)."""
    rising = 0.5 * ((position_m - foot_m) + speed_mps / omega_radps) * growth
    falling = 0.5 * ((position_m - foot_m) - speed_mps / omega_radps) / growth
    return foot_m + rising + falling, omega_radps * (rising - falling)


@njit(cache=True)
def switch_position(
    com_m: float,
    speed_mps: float,
    foot_m: float,
    next_apex_m: float,
    next_speed_mps: float,
    next_foot_m: float,
    omega_radps: float,
) -> float:
    """Return where the sagittal orbits of two apexes meet (Eqs. 17-18)."""
    c = (com_m - foot_m) ** 2 - (next_apex_m - next_foot_m) ** 2
    c += (next_speed_mps**2 - speed_mps**2) / omega_radps**2
    return 0.5 * (c / (next_foot_m - foot_m) + foot_m + next_foot_m)


@njit(cache=True)
def switch_speed(com_m: float, speed_mps: float, foot_m: float, switch_m: float, omega_radps: float) -> float:
    """Return the speed of the orbit at a position ahead (Eq. 16), or NaN when the orbit never gets there."""
    square = speed_mps**2 + omega_radps**2 * ((switch_m - foot_m) ** 2 - (com_m - foot_m) ** 2)
    return math.sqrt(square) if square >= 0 else math.nan


@njit(cache=True)
def growth_to(
    com_m: float, speed_mps: float, foot_m: float, switch_m: float, switch_speed_mps: float, omega_radps: float
) -> float:
    """Return e^(omega t) of the way to a state on the orbit (Eq. 12); NaN when the orbit falls back before the foot."""
    start = com_m - foot_m + speed_mps / omega_radps
    end = switch_m - foot_m + switch_speed_mps / omega_radps
    return end / start if start > 0 else math.nan


@njit(cache=True)
def growth_to_apex(switch_m: float, apex_m: float, apex_speed_mps: float, omega_radps: float) -> float:
    """Return e^(omega t) of the second half, from the switch to an apex above the foot."""
    sinh = omega_radps * (apex_m - switch_m) / apex_speed_mps
    return sinh + math.sqrt(1 + sinh * sinh)


@njit(cache=True)
def next_lateral_foot(
    switch_m: float, switch_speed_mps: float, growth: float, omega_radps: float
) -> tuple[float, float]:
    """Return the lateral foot that brings the lateral speed to zero at the next apex, and where the CoM is then.

    It is the root that the papers find by a Newton search; the residual is linear in the foot:
    y_foot = y + y' coth(omega t2) / omega and y_apex = y_foot - y' / (omega sinh(omega t2)).
    """
    cosh = 0.5 * (growth + 1 / growth)
    sinh = 0.5 * (growth - 1 / growth)
    foot = switch_m + switch_speed_mps * cosh / (sinh * omega_radps)
    return foot, foot - switch_speed_mps / (omega_radps * sinh)

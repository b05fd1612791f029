"""The safety theorems of walking, as margins: a condition holds when its margin is not negative.

Source: Shamsah et al., T-RO 2023, Section IV-A and Appendices B-C, with these corrections. Theorem IV.1 holds as
printed for apexes above their feet. Corollary IV.3 is the case of a turn away from the stance foot (the foot is
behind the CoM in the new frame), Corollary IV.4 that of a turn toward it; their d runs from the CoM, not from the
waypoint, to the next apex. Theorem IV.2 merges two cases of which only one applies: a turn toward the stance foot
must get over the foot (Eq. 23), a turn away from it must not cross over the foot sideways (Eq. 24). Distances are
metres, speeds metres per second, squares of speed (m/s)^2; ``dy2_m`` and ``turn_rad`` are magnitudes.
"""

from __future__ import annotations

import math

from numba import njit


@njit(cache=True)
def straight_margin(speed_mps: float, next_speed_mps: float, distance_m: float, omega_radps: float) -> float:
    """Return the margin of Theorem IV.1: |v_n^2 - v_c^2| <= omega^2 d^2."""
    return omega_radps**2 * distance_m**2 - abs(next_speed_mps**2 - speed_mps**2)


@njit(cache=True)
def turn_away_margin(
    speed_mps: float, next_speed_mps: float, distance_m: float, dy2_m: float, turn_rad: float, omega_radps: float
) -> float:
    """Return the margin of Corollary IV.3: -omega^2 d^2 <= v_n^2 - (v_c cos)^2 <= omega^2 d_+^2."""
    difference = next_speed_mps**2 - (speed_mps * math.cos(turn_rad)) ** 2
    d2_plus = distance_m**2 + 2 * dy2_m * distance_m * math.sin(turn_rad)
    return min(difference + omega_radps**2 * distance_m**2, omega_radps**2 * d2_plus - difference)


@njit(cache=True)
def turn_toward_margin(
    speed_mps: float, next_speed_mps: float, distance_m: float, dy2_m: float, turn_rad: float, omega_radps: float
) -> float:
    """Return the margin of Corollary IV.4: -omega^2 d^2 <= v_n^2 - (v_c cos)^2 <= omega^2 d_-^2."""
    difference = next_speed_mps**2 - (speed_mps * math.cos(turn_rad)) ** 2
    d2_minus = distance_m**2 - 2 * dy2_m * distance_m * math.sin(turn_rad)
    return min(difference + omega_radps**2 * distance_m**2, omega_radps**2 * d2_minus - difference)


@njit(cache=True)
def toward_margin(speed_mps: float, dy2_m: float, turn_rad: float, omega_radps: float) -> float:
    """Return the margin of Theorem IV.2 for a turn toward the stance foot: v >= dy2 omega tan (Eq. 23)."""
    return speed_mps - dy2_m * omega_radps * math.tan(turn_rad)


@njit(cache=True)
def away_margin(speed_mps: float, dy2_m: float, turn_rad: float, omega_radps: float) -> float:
    """Return the margin of Theorem IV.2 for a turn away from the stance foot: v <= dy2 omega / tan (Eq. 24)."""
    return dy2_m * omega_radps / math.tan(turn_rad) - speed_mps


@njit(cache=True)
def heading_margin(
    speed_mps: float, dy2_m: float, stance_side: float, heading_change_rad: float, omega_radps: float
) -> float:
    """Return the margin of the applicable side of Theorem IV.2 at an apex; infinite when the heading stays.

    Args:
        speed_mps: apex speed.
        dy2_m: magnitude of the distance of the stance foot from the apex CoM.
        stance_side: +1 when the left foot stands, -1 when the right one does.
        heading_change_rad: left positive.
        omega_radps: of the pendulum.
    """
    if heading_change_rad == 0:
        return math.inf
    if stance_side * heading_change_rad > 0:
        return toward_margin(speed_mps, dy2_m, abs(heading_change_rad), omega_radps)
    return away_margin(speed_mps, dy2_m, abs(heading_change_rad), omega_radps)


@njit(cache=True)
def apex_margin(
    speed_mps: float,
    next_speed_mps: float,
    distance_m: float,
    dy2_m: float,
    stance_side: float,
    heading_change_rad: float,
    omega_radps: float,
) -> float:
    """Return the margin of the applicable one of Theorem IV.1, Corollary IV.3 and Corollary IV.4."""
    turn = abs(heading_change_rad)
    if turn == 0:
        return straight_margin(speed_mps, next_speed_mps, distance_m, omega_radps)
    if stance_side * heading_change_rad > 0:
        return turn_toward_margin(speed_mps, next_speed_mps, distance_m, dy2_m, turn, omega_radps)
    return turn_away_margin(speed_mps, next_speed_mps, distance_m, dy2_m, turn, omega_radps)


@njit(cache=True)
def pushed_heading_margin(
    speed_mps: float, toward_mps: float, ahead_m: float, aside_m: float, omega_radps: float
) -> float:
    """Return the margin of the two conditions behind Theorem IV.2 for an apex that a push has left with any velocity.

    The CoM must get over the foot when that lies ahead (Eq. 23), and must not cross over it sideways (Eq. 24).

    Args:
        speed_mps: along the heading after the turn.
        toward_mps: sideways, toward the stance foot.
        ahead_m: how far the stance foot is ahead of the CoM.
        aside_m: how far it is aside, on its own side positive.
        omega_radps: of the pendulum.
    """
    return min(speed_mps - omega_radps * max(ahead_m, 0.0), omega_radps * aside_m - toward_mps)


@njit(cache=True)
def orbits_margin(
    speed_mps: float, next_speed_mps: float, distance_m: float, foot_distance_m: float, omega_radps: float
) -> float:
    """Return the margin of Eqs. (19)-(21) for an apex that need not be above its foot.

    The orbits of both apexes meet between them: -omega^2 d^2 <= v_n^2 - v_c^2 <= omega^2 (d_f^2 - (d_f - d)^2), where d
    runs from the CoM and d_f from the stance foot to the next apex.
    """
    gain = next_speed_mps**2 - speed_mps**2
    most = omega_radps**2 * (foot_distance_m**2 - (foot_distance_m - distance_m) ** 2)
    return min(most - gain, gain + omega_radps**2 * distance_m**2)

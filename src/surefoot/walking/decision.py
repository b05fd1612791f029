"""Algorithm 1: which speed the next apex gets.

The speeds of the allowed range are tried one by one; of those that satisfy every hard rule and leave a safe step for every
command that may follow, the one with the least cost is taken. Source: Shamsah et al., T-RO 2023, Section V, Algorithm 1.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from surefoot.walking.rules import (
    SLACK,
    Apex,
    Candidate,
    Limits,
    apex_from,
    lateral_candidate,
    sagittal_candidate,
)
from surefoot.walking.theorems import heading_margin


class Goal(NamedTuple):
    """What Algorithm 1 aims at; ``dy1_m`` and ``dy2_m`` are magnitudes on the side of the next foot."""

    dy1_m: float
    dy2_m: float
    duration_s: float
    width_m: float
    c1: float
    c2: float
    c3: float
    c4: float


class Choice(NamedTuple):
    """The chosen candidate; ``furthest`` is the last rule that a candidate reached, when there is none."""

    found: bool
    furthest: int
    next_speed_mps: float
    com_left_m: float
    shift_cells: int
    candidate: Candidate


@njit(cache=True)
def cost(goal: Goal, side: float, dy1_m: float, dy2_m: float, duration_s: float, width_m: float) -> float:
    """Return the cost of Algorithm 1 (line 6); the desired values carry the sign of the next foot."""
    return (
        goal.c1 * abs(side * goal.dy1_m - dy1_m)
        + goal.c2 * abs(side * goal.dy2_m - dy2_m)
        + goal.c3 * abs(goal.duration_s - duration_s)
        + goal.c4 * abs(goal.width_m - abs(width_m))
    )


@njit(cache=True)
def next_heading_allowed(
    speed_mps: float, dy2_m: float, side: float, followers: NDArray[np.float64], omega_radps: float
) -> bool:
    """Tell whether an apex satisfies Theorem IV.2 for every heading change that may be commanded there."""
    for i in range(followers.shape[0]):
        if heading_margin(speed_mps, abs(dy2_m), side, followers[i, 0], omega_radps) < SLACK:
            return False
    return True


@njit(cache=True)
def can_go_on(
    dy1_m: float, dy2_m: float, speed_mps: float, side: float, followers: NDArray[np.float64], limits: Limits
) -> bool:
    """Tell whether every command that may follow has a candidate that satisfies the rules of its own step.

    Args:
        dy1_m: lateral apex CoM minus waypoint.
        dy2_m: lateral foot minus apex CoM.
        speed_mps: apex speed.
        side: of the stance foot, left +1.
        followers: rows of (heading change, length, least next speed, most next speed).
        limits: of the rules.
    """
    for i in range(followers.shape[0]):
        apex = apex_from(dy1_m, dy2_m, speed_mps, side, followers[i, 0])
        length, low, high = followers[i, 1], followers[i, 2], followers[i, 3]
        steps = round((high - low) * 100)
        found = False
        for j in range(steps + 1):
            sagittal = sagittal_candidate(apex, length, min(low + 0.01 * j, high), limits)
            if sagittal.broken:
                continue
            candidate = lateral_candidate(apex, apex.com_left_m, sagittal, limits)
            if candidate.broken == 0 and abs(candidate.next_foot_left_m) <= limits.safety_distance_m - SLACK:
                found = True
                break
        if not found:
            return False
    return True


@njit(cache=True)
def choose(
    apex: Apex,
    length_m: float,
    speeds_mps: NDArray[np.float64],
    com_lefts_m: NDArray[np.float64],
    shifts_cells: NDArray[np.int64],
    fine_cell_m: float,
    followers: NDArray[np.float64],
    limits: Limits,
    goal: Goal,
) -> Choice:
    """Return the cheapest candidate that satisfies every hard rule and lets every command that may follow go on.

    Args:
        apex: the current one.
        length_m: from waypoint to waypoint.
        speeds_mps: next apex speeds to try.
        com_lefts_m: lateral positions of the CoM at the current apex to try: where it is, or when starting, where it may be.
        shifts_cells: corrections of the next waypoint to try, left positive.
        fine_cell_m: one cell of correction.
        followers: the commands that may follow, see ``can_go_on``.
        limits: of the rules.
        goal: of the costs.
    """
    side = -apex.side
    furthest = 0
    none = Candidate(0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    lateral = com_lefts_m.size * shifts_cells.size
    costs = np.full(speeds_mps.size * lateral, np.inf)
    for i in range(speeds_mps.size):
        sagittal = sagittal_candidate(apex, length_m, speeds_mps[i], limits)
        furthest = max(furthest, sagittal.broken)
        if sagittal.broken:
            continue
        for j in range(com_lefts_m.size):
            candidate = lateral_candidate(apex, com_lefts_m[j], sagittal, limits)
            furthest = max(furthest, candidate.broken)
            if candidate.broken:
                continue
            dy2 = candidate.next_foot_left_m - candidate.next_com_left_m
            allowed = next_heading_allowed(speeds_mps[i], dy2, side, followers, limits.omega_radps)
            for k in range(shifts_cells.size):
                shift = shifts_cells[k] * fine_cell_m
                if abs(candidate.next_foot_left_m - shift) > limits.safety_distance_m - SLACK:
                    furthest = max(furthest, 5)
                    continue
                if not allowed:
                    furthest = max(furthest, 6)
                    continue
                costs[i * lateral + j * shifts_cells.size + k] = cost(
                    goal,
                    side,
                    candidate.next_com_left_m - shift,
                    dy2,
                    candidate.first_half_s + candidate.second_half_s,
                    candidate.next_foot_left_m - apex.foot_left_m,
                )
    while True:
        best = np.argmin(costs)
        if costs[best] == np.inf:
            return Choice(False, furthest, 0.0, 0.0, 0, none)
        speed = speeds_mps[best // lateral]
        com_left = com_lefts_m[best % lateral // shifts_cells.size]
        shift_cells = shifts_cells[best % shifts_cells.size]
        candidate = lateral_candidate(apex, com_left, sagittal_candidate(apex, length_m, speed, limits), limits)
        dy1 = candidate.next_com_left_m - shift_cells * fine_cell_m
        dy2 = candidate.next_foot_left_m - candidate.next_com_left_m
        if can_go_on(dy1, dy2, speed, side, followers, limits):
            return Choice(True, 0, speed, com_left, shift_cells, candidate)
        costs[best] = math.inf
        furthest = 7

"""Algorithm 1: which speed the next apex gets.

The speeds of the allowed range are tried one by one; of those that satisfy every hard rule the one with the least
cost is taken. To the cost of the paper the risk of the next apex is added (``risk``). Beside the speed, the algorithm
picks what a step leaves free: the lateral correction of its waypoint, a deviation of its length, and the place of the
CoM when the robot starts. Source: Shamsah et al., T-RO 2023, Section V, Algorithm 1.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from surefoot.walking.costs import Aim, step_cost
from surefoot.walking.risk import COST_WEIGHT, RiskTable, risk_at
from surefoot.walking.rules import SLACK, Apex, Candidate, Limits, lateral_candidate, sagittal_candidate
from surefoot.walking.theorems import heading_margin


class Freedom(NamedTuple):
    """What Algorithm 1 may pick.

    Attributes:
        lengths_m: from waypoint to waypoint, the commanded one first.
        speeds_mps: of the next apex.
        com_lefts_m: lateral places of the CoM at the current apex: where it is, or when starting, where it may be.
        shifts_cells: corrections of the next waypoint, left positive.
    """

    lengths_m: NDArray[np.float64]
    speeds_mps: NDArray[np.float64]
    com_lefts_m: NDArray[np.float64]
    shifts_cells: NDArray[np.int64]


class Choice(NamedTuple):
    """What was picked; when nothing could be, ``furthest`` is the last rule that a candidate reached."""

    found: bool
    furthest: int
    length: int
    speed_mps: float
    com_left_m: float
    shift_cells: int
    candidate: Candidate


@njit(cache=True)
def choose(
    apex: Apex,
    freedom: Freedom,
    next_changes_rad: NDArray[np.float64],
    limits: Limits,
    aim: Aim,
    table: RiskTable,
    next_node: int,
) -> Choice:
    """Return the cheapest candidate that satisfies every hard rule.

    Args:
        apex: the current one, in the frame of the step.
        freedom: what may be picked.
        next_changes_rad: heading changes that may be commanded at the next apex.
        limits: of the rules.
        aim: of the costs.
        table: of the risks.
        next_node: node of the commands that may follow.
    """
    best = Choice(False, 0, 0, 0.0, 0.0, 0, Candidate(0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    least = math.inf
    furthest = 0
    for i in range(freedom.lengths_m.size):
        for speed in freedom.speeds_mps:
            sagittal = sagittal_candidate(apex, freedom.lengths_m[i], speed, limits)
            furthest = max(furthest, sagittal.broken)
            if sagittal.broken:
                continue
            for left in freedom.com_lefts_m:
                candidate = lateral_candidate(apex, left, sagittal, limits)
                furthest = max(furthest, candidate.broken)
                if candidate.broken:
                    continue
                for shift in freedom.shifts_cells:
                    broken = _rule_broken_next(apex, candidate, shift, speed, next_changes_rad, limits, aim)
                    furthest = max(furthest, broken)
                    if broken:
                        continue
                    cost = _cost(apex, candidate, shift, speed, limits, aim, table, next_node)
                    if cost < least:
                        least = cost
                        best = Choice(True, 0, i, speed, left, shift, candidate)
    return best if best.found else Choice(False, furthest, 0, 0.0, 0.0, 0, best.candidate)


@njit(cache=True)
def _rule_broken_next(
    apex: Apex,
    candidate: Candidate,
    shift_cells: int,
    speed_mps: float,
    next_changes_rad: NDArray[np.float64],
    limits: Limits,
    aim: Aim,
) -> int:
    """Return which rule the next apex breaks: the safety distance, or Theorem IV.2 for what may be commanded there."""
    if abs(candidate.next_foot_left_m - shift_cells * aim.fine_cell_m) > limits.safety_distance_m - SLACK:
        return 5
    dy2 = abs(candidate.next_foot_left_m - candidate.next_com_left_m)
    for change in next_changes_rad:
        if heading_margin(speed_mps, dy2, -apex.side, change, limits.omega_radps) < SLACK:
            return 6
    return 0


@njit(cache=True)
def _cost(
    apex: Apex,
    candidate: Candidate,
    shift_cells: int,
    speed_mps: float,
    limits: Limits,
    aim: Aim,
    table: RiskTable,
    next_node: int,
) -> float:
    """Return the cost of Algorithm 1 and the risk of the next apex."""
    side = -apex.side
    dy1 = candidate.next_com_left_m - shift_cells * aim.fine_cell_m
    dy2 = candidate.next_foot_left_m - candidate.next_com_left_m
    duration = math.log(candidate.growth * candidate.next_growth) / limits.omega_radps
    cost = step_cost(aim, side, dy1, dy2, duration, candidate.next_foot_left_m - apex.foot_left_m)
    return COST_WEIGHT * cost + risk_at(table, next_node, side * dy1, side * dy2, speed_mps)

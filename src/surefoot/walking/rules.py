"""The hard rules of a walking step, and one candidate of it measured against them.

The frame is that of the step (``pendulum``). A *candidate* is a speed of the next apex. The rules are those of
docs/rules.md, section 6; everything here is compiled, because Algorithm 1 tries about fifty candidates a step.
"""

from __future__ import annotations

import math
from enum import IntEnum
from typing import NamedTuple

from numba import njit

from surefoot.walking.pendulum import (
    growth_to,
    growth_to_apex,
    next_lateral_foot,
    propagate,
    switch_position,
    switch_speed,
)
from surefoot.walking.theorems import apex_margin, heading_margin, orbits_margin, pushed_heading_margin

SLACK = 1e-9  # margins have to exceed it, so that another rounding of the same numbers still finds them not negative


class Rule(IntEnum):
    """The rules in the order in which a candidate has to pass them."""

    NONE = 0
    HEADING = 1
    APEX = 2
    SWITCH_SPEED = 3
    FOOT_SIDE = 4
    SAFETY_DISTANCE = 5
    NEXT_HEADING = 6
    NEXT_STEP = 7


REASONS = {
    Rule.NONE: "there was no candidate",
    Rule.HEADING: "the turn breaks Theorem IV.2 at the current apex",
    Rule.APEX: "no next apex speed satisfies Theorem IV.1 or Corollaries IV.3 and IV.4",
    Rule.SWITCH_SPEED: "every admissible next apex speed exceeds the bound on the switch speed",
    Rule.FOOT_SIDE: "the next foot would not be on its own side of the centre of mass",
    Rule.SAFETY_DISTANCE: "the next foot would be farther from the waypoint than the safety distance",
    Rule.NEXT_HEADING: "the next apex would break Theorem IV.2 for a turn that may be commanded there",
}


class Limits(NamedTuple):
    """The numbers behind the rules: of the pendulum, and of the parameters of a walk."""

    omega_radps: float
    switch_speed_max_mps: float
    safety_distance_m: float


class Apex(NamedTuple):
    """The current apex in the frame of the step.

    The speeds are those along the heading before the turn and to its left, where only a push leaves one; ``side`` is +1
    when the left foot stands, -1 when the right one does.
    """

    com_m: float
    com_left_m: float
    foot_m: float
    foot_left_m: float
    speed_mps: float
    side: float
    heading_change_rad: float
    side_speed_mps: float = 0.0


class Candidate(NamedTuple):
    """What a next apex speed leads to, in the frame of the step.

    ``broken`` is the first rule that it breaks; ``growth`` and ``next_growth`` are e^(omega t) of the halves.
    """

    broken: int
    growth: float
    next_growth: float
    switch_m: float
    switch_left_m: float
    switch_speed_mps: float
    switch_left_speed_mps: float
    next_foot_left_m: float
    next_com_left_m: float


@njit(cache=True)
def apex_from(dy1_m: float, dy2_m: float, speed_mps: float, side: float, heading_change_rad: float) -> Apex:
    """Return an apex above its waypoint, given sideways in the heading before the turn, in the frame after the turn."""
    cos, sin = math.cos(heading_change_rad), math.sin(heading_change_rad)
    foot = dy1_m + dy2_m
    return Apex(sin * dy1_m, cos * dy1_m, sin * foot, cos * foot, speed_mps, side, heading_change_rad, 0.0)


@njit(cache=True)
def turned_speeds(apex: Apex) -> tuple[float, float]:
    """Return the speeds at an apex along the heading after the turn, and to its left."""
    cos, sin = math.cos(apex.heading_change_rad), math.sin(apex.heading_change_rad)
    return apex.speed_mps * cos + apex.side_speed_mps * sin, apex.side_speed_mps * cos - apex.speed_mps * sin


@njit(cache=True)
def _heading_margin(apex: Apex, dy2_m: float, omega_radps: float) -> float:
    """Return the margin of Theorem IV.2 at an apex; after a push the condition behind it for any velocity."""
    if apex.side_speed_mps == 0.0:
        return heading_margin(apex.speed_mps, dy2_m, apex.side, apex.heading_change_rad, omega_radps)
    speed, side_speed = turned_speeds(apex)
    ahead, aside = apex.foot_m - apex.com_m, apex.side * (apex.foot_left_m - apex.com_left_m)
    return pushed_heading_margin(speed, apex.side * side_speed, ahead, aside, omega_radps)


@njit(cache=True)
def _apex_margin(apex: Apex, length_m: float, next_speed_mps: float, dy2_m: float, omega_radps: float) -> float:
    """Return the margin of the condition on the speeds of two apexes; the next one has to lie ahead."""
    distance, turn = length_m - apex.com_m, apex.heading_change_rad
    if min(distance, length_m - apex.foot_m) <= 0:
        return -math.inf
    if apex.side_speed_mps == 0.0:
        return apex_margin(apex.speed_mps, next_speed_mps, distance, dy2_m, apex.side, turn, omega_radps)
    speed, _ = turned_speeds(apex)
    return orbits_margin(speed, next_speed_mps, distance, length_m - apex.foot_m, omega_radps)


@njit(cache=True)
def sagittal_candidate(apex: Apex, length_m: float, next_speed_mps: float, limits: Limits) -> Candidate:
    """Check the sagittal rules of a candidate and find its switch; the lateral half stays open."""
    omega = limits.omega_radps
    speed, _ = turned_speeds(apex)
    dy2 = math.hypot(apex.foot_m - apex.com_m, apex.foot_left_m - apex.com_left_m)
    if _heading_margin(apex, dy2, omega) < SLACK:
        return Candidate(1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    margin = _apex_margin(apex, length_m, next_speed_mps, dy2, omega)
    if margin < SLACK:
        return Candidate(2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    at = switch_position(apex.com_m, speed, apex.foot_m, length_m, next_speed_mps, length_m, omega)
    fast = switch_speed(apex.com_m, speed, apex.foot_m, at, omega)
    if not fast <= limits.switch_speed_max_mps - SLACK:
        return Candidate(3, 0.0, 0.0, at, 0.0, fast, 0.0, 0.0, 0.0)
    growth = growth_to(apex.com_m, speed, apex.foot_m, at, fast, omega)
    next_growth = growth_to_apex(at, length_m, next_speed_mps, omega)
    return Candidate(0, growth, next_growth, at, 0.0, fast, 0.0, 0.0, 0.0)


@njit(cache=True)
def lateral_candidate(apex: Apex, com_left_m: float, sagittal: Candidate, limits: Limits) -> Candidate:
    """Complete a sagittal candidate with its lateral half; the CoM starts at ``com_left_m``."""
    omega = limits.omega_radps
    _, speed = turned_speeds(apex)
    left, left_speed = propagate(com_left_m, speed, apex.foot_left_m, omega, sagittal.growth)
    foot, com = next_lateral_foot(left, left_speed, sagittal.next_growth, omega)
    broken = 0 if -apex.side * (foot - com) > SLACK else 4
    return Candidate(
        broken,
        sagittal.growth,
        sagittal.next_growth,
        sagittal.switch_m,
        left,
        sagittal.switch_speed_mps,
        left_speed,
        foot,
        com,
    )


@njit(cache=True)
def full_candidate(apex: Apex, length_m: float, next_speed_mps: float, limits: Limits) -> Candidate:
    """Check a candidate from an apex whose CoM is known, all but the safety distance and what comes next."""
    sagittal = sagittal_candidate(apex, length_m, next_speed_mps, limits)
    return sagittal if sagittal.broken else lateral_candidate(apex, apex.com_left_m, sagittal, limits)

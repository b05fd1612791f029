"""The heuristic planner: every foot steps to the nearest polygon, while the base moves on at a constant speed.

Nothing asks whether a foot reaches its foothold, or whether the robot can stand there: that is the point of the
comparison. Source: Zhou et al. 2025, X-D and Fig. 15.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from surefoot.footholds.gaits import Gait, mode_contacts
from surefoot.footholds.problem import Array
from surefoot.footholds.terrain import Polygon
from surefoot.robots.quadruped import Quadruped


@dataclass(frozen=True, slots=True, eq=False)
class NearestFoothold:
    """One foothold of the heuristic planner; world frame.

    Attributes:
        foot: index of the foot.
        touch_s, leave_s: when the foot stands there.
        wished_m: below the hip, half a stance ahead.
        chosen_m: the nearest point of a polygon.
        landed_m: the chosen point, or where the foot comes to rest when its reach ends before.
        beyond_reach_m: how far the chosen point lies out of reach, at touch-down or at lift-off.
        off_polygon_m: how far the foot lands beside its polygon.
    """

    foot: int
    touch_s: float
    leave_s: float
    wished_m: Array
    chosen_m: Array
    landed_m: Array
    beyond_reach_m: float
    off_polygon_m: float


def nearest_footholds(
    robot: Quadruped,
    polygons: tuple[Polygon, ...],
    gait: Gait,
    speed_mps: float,
    cycles: int,
    start_m: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> tuple[NearestFoothold, ...]:
    """Plan by the heuristic along x.

    Args:
        robot: its numbers.
        polygons: where feet may stand.
        gait: one cycle; the feet stand at its ends.
        speed_mps: of the base.
        cycles: how often the gait is repeated.
        start_m: the ground below the base at first.
    """
    return tuple(
        _foothold(robot, polygons, speed_mps, np.array(start_m), foot, touch_s, leave_s)
        for foot, touch_s, leave_s in sorted(_stances(gait, cycles), key=lambda stance: stance[1])
    )


def _stances(gait: Gait, cycles: int) -> Iterator[tuple[int, float, float]]:
    """Yield foot, touch-down and next lift-off of every stance that follows a swing."""
    times = pairwise(gait.switching_times_s)
    modes = [(mode_contacts(mode), *both) for mode, both in zip(gait.modes, times, strict=True)]
    for foot in range(4):
        swings = [
            (cycle * gait.horizon_s + begin, cycle * gait.horizon_s + end)
            for cycle in range(cycles)
            for contacts, begin, end in modes
            if not contacts[foot]
        ]
        ends = [begin for begin, _ in swings[1:]] + [cycles * gait.horizon_s]
        yield from ((foot, end, leave) for (_, end), leave in zip(swings, ends, strict=True))


def _foothold(
    robot: Quadruped,
    polygons: tuple[Polygon, ...],
    speed_mps: float,
    start_m: Array,
    foot: int,
    touch_s: float,
    leave_s: float,
) -> NearestFoothold:
    below = start_m + np.array(robot.feet_m[foot]) - np.array([0.0, 0.0, robot.foot_reference_m[2]])
    ahead = np.array([speed_mps, 0.0, 0.0])
    wished = below + (touch_s + (leave_s - touch_s) / 2) * ahead
    chosen = min((one.nearest(wished) for one in polygons), key=lambda point: float(np.linalg.norm(point - wished)))
    reach = np.array(robot.foot_reach_m)
    offset = chosen - below - touch_s * ahead
    landed = below + touch_s * ahead + np.clip(offset, -reach, reach)
    late = chosen - below - leave_s * ahead
    beyond = max(float((np.abs(one) - reach).max()) for one in (offset, late))
    off = min(float(np.linalg.norm(one.nearest(landed) - landed)) for one in polygons)
    return NearestFoothold(foot, touch_s, leave_s, wished, chosen, landed, max(0.0, beyond), off)

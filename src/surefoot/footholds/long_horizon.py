"""The pure long-horizon planner: one program over the whole way, against short segments that follow each other.

Source: Zhou et al. 2025, IX-E and Fig. 9. A trot of 1 s is repeated, and the region grows linearly with the horizon.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surefoot.footholds.fields import Field, field_polygons
from surefoot.footholds.gaits import Gait
from surefoot.footholds.problem import Array, Options, Problem, nominal_feet
from surefoot.footholds.retarget import retarget, retargeted
from surefoot.footholds.solve import Solution, solve
from surefoot.footholds.terrain import Polygon
from surefoot.robots.quadruped import CHOTU, GO2, Quadruped

STEP_S = 0.025
_STONES_MPS, _BARS_MPS = 0.4, 0.3
_CYCLE_MODES = ("LF_RH", "STANCE", "RF_LH", "STANCE")
_CYCLE_TIMES_S = (0.0, 0.45, 0.5, 0.95)
_NEARER_M, _LEAST_M = 0.1, 0.05


@dataclass(frozen=True, slots=True)
class Timing:
    """What it took to plan a way.

    Attributes:
        verdict: of the whole way.
        solve_cpu_ms: of all programs together, those included that found a goal to be too far.
        gap: worst relative gap; None without a plan.
        distance_m: how far the plan goes.
        programs: how many plans follow each other.
        censored: whether a time limit stopped the search.
    """

    verdict: str
    solve_cpu_ms: float
    gap: float | None
    distance_m: float
    programs: int
    censored: bool


def plan_whole(kind: Field, horizon_s: int, seed: int, time_limit_s: float) -> Timing:
    """Plan the whole way at once, to the farthest goal ahead that can be reached."""
    problem = _standing(kind, horizon_s, seed, time_limit_s)
    answer, goal_m, spent_ms = _farthest(problem, speed_mps(kind) * horizon_s)
    return Timing(answer.verdict, spent_ms, answer.gap, goal_m, 1, answer.limit is not None)


def plan_segments(kind: Field, horizon_s: int, seed: int, time_limit_s: float) -> Timing:
    """Plan the same way in segments of 2 and 3 s, each from where the one before ends."""
    problem = _standing(kind, horizon_s, seed, time_limit_s)
    gaits = [repeated_trot(length) for length in segments_s(horizon_s)]
    return chained(problem, gaits, [speed_mps(kind) * gait.horizon_s for gait in gaits])


def chained(problem: Problem, gaits: Sequence[Gait], strides_m: Sequence[float], enough_m: float = math.inf) -> Timing:
    """Plan segments that follow each other, until one of them cannot be planned or the way is long enough.

    Args:
        problem: where the robot stands at first, and on what ground.
        gaits: of the segments.
        strides_m: how far every segment is to go at most, along x.
        enough_m: the x to reach.
    """
    spent_ms, worst, goal_m, censored = 0.0, 0.0, float(problem.start_m[0]), False
    for count, (gait, stride_m) in enumerate(zip(gaits, strides_m, strict=True), 1):
        answer, aimed_m, took_ms = _farthest(replace(problem, gait=gait), goal_m + stride_m)
        spent_ms, censored = spent_ms + took_ms, censored or answer.limit is not None
        if answer.plan is None:
            return Timing(answer.verdict, spent_ms, None, goal_m, count, answer.limit is not None)
        worst, goal_m = max(worst, answer.gap or 0.0), aimed_m
        if goal_m >= enough_m:
            break
        problem = replace(problem, start_m=answer.plan.base_m[-1], feet_m=answer.plan.feet_m[-1])
    return Timing("feasible", spent_ms, worst, goal_m, count, censored)


def speed_mps(kind: Field) -> float:
    """Return how fast the way is aimed to be walked: a cell of 0.8 m (stones) or 0.6 m (rebar) in 2 s."""
    return _BARS_MPS if kind.bars else _STONES_MPS


def repeated_trot(cycles: int) -> Gait:
    """Return the trot with a cycle of 1 s, some times over."""
    times = [round(cycle + part, 3) for cycle in range(cycles) for part in _CYCLE_TIMES_S]
    return Gait(_CYCLE_MODES * cycles, (*times, float(cycles)))


def segments_s(horizon_s: int) -> tuple[int, ...]:
    """Return whole seconds that add up to a horizon: twos, and a three where it is odd."""
    if horizon_s < 4:
        return (horizon_s,)
    return (2, *segments_s(horizon_s - 2))


def feet_nearby(polygons: tuple[Polygon, ...], wished_m: Array) -> Array:
    """Return the places on polygons nearest to where feet should be, shape (4, 3)."""
    return np.array([min((one.nearest(foot) for one in polygons), key=_distance_to(foot)) for foot in wished_m])


def _distance_to(point_m: Array) -> Callable[[Array], float]:
    return lambda other_m: float(np.linalg.norm(other_m - point_m))


def _standing(kind: Field, horizon_s: int, seed: int, time_limit_s: float) -> Problem:
    """Return the program of staying where the robot starts, with all the region's polygons."""
    robot = CHOTU if kind.bars else GO2
    polygons = field_polygons(kind, speed_mps(kind) * horizon_s, seed)
    return standing(robot, polygons, repeated_trot(horizon_s), time_limit_s)


def standing(robot: Quadruped, polygons: tuple[Polygon, ...], gait: Gait, time_limit_s: float) -> Problem:
    """Return the program of staying at the origin, on the footholds nearest to the nominal ones."""
    start, level = np.array([0.0, 0.0, -robot.foot_reference_m[2]]), np.zeros(3)
    return Problem(
        robot=robot,
        gait=gait,
        step_s=STEP_S,
        start_m=start,
        start_rpy_rad=level,
        feet_m=feet_nearby(polygons, nominal_feet(robot, start, level)),
        goal_m=start,
        goal_rpy_rad=level,
        polygons=polygons,
        options=Options(time_limit_s=time_limit_s),
    )


def _farthest(problem: Problem, wished_m: float) -> tuple[Solution, float, float]:
    """Solve for a goal ahead, and for nearer ones while it is infeasible; return the answer, the goal's x, the CPU ms.

    The goal moves to the nearest pose in which the robot can stand.
    """
    spent_ms, x = 0.0, wished_m
    while True:
        aimed = replace(problem, goal_m=np.array([x, 0.0, problem.goal_m[2]]))
        found = retarget(aimed)
        aimed = aimed if found.position_m is None else retargeted(aimed, found)
        answer = solve(aimed, certify=False, why=False)
        spent_ms += answer.solve_cpu_ms
        if answer.verdict != "infeasible" or x - _NEARER_M < problem.start_m[0] + _LEAST_M:
            return answer, float(aimed.goal_m[0]), spent_ms
        x -= _NEARER_M

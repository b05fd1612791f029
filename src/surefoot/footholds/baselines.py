"""Measures the two planners that segments of certified programs are compared with.

Source: Zhou et al. 2025, IX-E (Fig. 9, one program over the whole way) and X-D (Fig. 15, the nearest foothold).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from surefoot.footholds.fields import FIELDS, Field, bars_with_gap
from surefoot.footholds.gaits import NAMED
from surefoot.footholds.long_horizon import Timing, chained, plan_segments, plan_whole, standing
from surefoot.footholds.nearest import NearestFoothold, nearest_footholds
from surefoot.robots.quadruped import CHOTU

HORIZONS_S = (1, 2, 3, 4, 5)
WIDEST_M = (0.15, 0.30, 0.40, 0.48)
SPEEDS_MPS = (0.1, 0.2)
WAY_M = 2.0
_WALK = NAMED["walk-2.25s"]
_STRIDE_M = 0.45
_TOLERANCE_M = 1e-6


@dataclass(frozen=True, slots=True)
class HorizonRow:
    """What planning a horizon took on one kind of ground, over all seeds.

    Attributes:
        field: name of the ground.
        horizon_s: of the whole way.
        whole_ms, segments_ms: CPU time of every seed, one program or segments that follow each other.
        whole_infeasible, segments_infeasible: seeds without any plan.
        censored: seeds at which the one program ran into the time limit.
        whole_m, segments_m: mean distance that was planned.
    """

    field: str
    horizon_s: int
    whole_ms: tuple[float, ...]
    segments_ms: tuple[float, ...]
    whole_infeasible: int
    segments_infeasible: int
    censored: int
    whole_m: float
    segments_m: float


@dataclass(frozen=True, slots=True)
class NearestRow:
    """What the heuristic planner does on bars with one widest gap, over all seeds.

    Attributes:
        widest_m: the widest free distance between bars.
        speed_mps: of the base.
        footholds: how many there were.
        beyond_reach: share of footholds out of the leg's reach, at touch-down or lift-off.
        off_polygon: share of footholds that land beside their bar because the reach ends.
        worst_beyond_m, worst_off_m: the worst of each.
    """

    widest_m: float
    speed_mps: float
    footholds: int
    beyond_reach: float
    off_polygon: float
    worst_beyond_m: float
    worst_off_m: float


@dataclass(frozen=True, slots=True)
class CertifiedRow:
    """What segments of certified programs do on the same bars.

    Attributes:
        widest_m: the widest free distance between bars.
        crossed, refused, unknown: seeds at which the whole way is certified; at which no certified segment leads on,
            so that the robot stays where it stands safely; at which a limit was reached.
        segment_ms: mean CPU time of a segment.
    """

    widest_m: float
    crossed: int
    refused: int
    unknown: int
    segment_ms: float


def measure_horizons(
    seeds: int, time_limit_s: float, horizons_s: Sequence[int] = HORIZONS_S, say: Callable[[str], None] = lambda _: None
) -> tuple[HorizonRow, ...]:
    """Plan every ground and horizon for a number of seeds, whole and in segments."""
    rows = []
    for kind in FIELDS:
        for horizon_s in horizons_s:
            say(f"{kind.name}, {horizon_s} s: {seeds} seeds")
            rows.append(_horizon_row(kind, horizon_s, seeds, time_limit_s))
    return tuple(rows)


def _horizon_row(kind: Field, horizon_s: int, seeds: int, time_limit_s: float) -> HorizonRow:
    whole = [plan_whole(kind, horizon_s, seed, time_limit_s) for seed in range(seeds)]
    parts = [plan_segments(kind, horizon_s, seed, time_limit_s) for seed in range(seeds)]
    return HorizonRow(
        field=kind.name,
        horizon_s=horizon_s,
        whole_ms=tuple(one.solve_cpu_ms for one in whole),
        segments_ms=tuple(one.solve_cpu_ms for one in parts),
        whole_infeasible=_count(whole, "infeasible"),
        segments_infeasible=_count(parts, "infeasible"),
        censored=sum(one.censored for one in whole),
        whole_m=float(np.mean([one.distance_m for one in whole])),
        segments_m=float(np.mean([one.distance_m for one in parts])),
    )


def _count(timings: Sequence[Timing], verdict: str) -> int:
    return sum(one.verdict == verdict for one in timings)


def measure_nearest(
    seeds: int, widest_m: Sequence[float] = WIDEST_M, say: Callable[[str], None] = lambda _: None
) -> tuple[tuple[NearestRow, ...], tuple[CertifiedRow, ...]]:
    """Walk over bars by the heuristic, and plan the same ways with certified segments."""
    heuristic, certified = [], []
    for widest in widest_m:
        say(f"bars up to {widest:g} m apart: {seeds} seeds")
        heuristic += [_nearest_row(widest, speed, seeds) for speed in SPEEDS_MPS]
        certified.append(_certified_row(widest, seeds))
    return tuple(heuristic), tuple(certified)


def nearest_on_bars(widest_m: float, speed_mps: float, seed: int) -> tuple[NearestFoothold, ...]:
    """Return the footholds of the heuristic on bars with one widest gap."""
    cycles = math.ceil(WAY_M / (speed_mps * _WALK.horizon_s))
    return nearest_footholds(CHOTU, bars_with_gap(WAY_M, widest_m, seed), _WALK, speed_mps, cycles)


def _nearest_row(widest_m: float, speed_mps: float, seeds: int) -> NearestRow:
    found = [foothold for seed in range(seeds) for foothold in nearest_on_bars(widest_m, speed_mps, seed)]
    beyond = np.array([one.beyond_reach_m for one in found])
    off = np.array([one.off_polygon_m for one in found])
    return NearestRow(
        widest_m=widest_m,
        speed_mps=speed_mps,
        footholds=len(found),
        beyond_reach=float((beyond > _TOLERANCE_M).mean()),
        off_polygon=float((off > _TOLERANCE_M).mean()),
        worst_beyond_m=float(beyond.max()),
        worst_off_m=float(off.max()),
    )


def _certified_row(widest_m: float, seeds: int) -> CertifiedRow:
    segments = 2 * math.ceil(WAY_M / _STRIDE_M)
    ways = []
    for seed in range(seeds):
        problem = standing(CHOTU, bars_with_gap(WAY_M, widest_m, seed), _WALK, 10.0)
        ways.append(chained(problem, [_WALK] * segments, [_STRIDE_M] * segments, enough_m=WAY_M))
    crossed, unknown = sum(one.distance_m >= WAY_M for one in ways), _count(ways, "unknown")
    return CertifiedRow(
        widest_m=widest_m,
        crossed=crossed,
        refused=seeds - crossed - unknown,
        unknown=unknown,
        segment_ms=sum(one.solve_cpu_ms for one in ways) / sum(one.programs for one in ways),
    )

"""A mission against the planner that steps to the nearest foothold and walks straight on.

Source: Zhou et al. 2025, X-D, Fig. 15.

Both cross the same bars from the same start to the cell straight ahead: as they are drawn, and with bars taken away
half way until the widest distance there is about 0.48 m. The skills were made for the bars as drawn.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from surefoot.errors import InputError
from surefoot.footholds.fields import rectangle
from surefoot.footholds.gaits import NAMED
from surefoot.footholds.nearest import NearestFoothold, nearest_footholds
from surefoot.footholds.problem import Array
from surefoot.footholds.terrain import Polygon
from surefoot.missions.bench.campaign import Campaign
from surefoot.missions.bench.detours import records
from surefoot.missions.bench.quadruped_missions import Ended, walked, way_exists
from surefoot.missions.quadruped.mission import QuadrupedOrder
from surefoot.missions.quadruped.world import World
from surefoot.robots.quadruped import CHOTU, Quadruped, quadruped
from surefoot.skills import LocalGrid, QuadrupedTerrain, generated, read_library, write_terrain
from surefoot.skills.values import Cell

SCENES = ("rebar-7", "rebar-14")
SPEEDS_MPS = (0.1, 0.2)
WIDEST_M = 0.48
GAITS = ("walk-2.25s", "trot-2s")
"""The walk is the paper's; at 0.2 m/s it is out of reach on whole ground too, the trot is not."""
_LEAST_CELLS, _CYCLES = 4, 10
_TOLERANCE_M = 1e-6


@dataclass(frozen=True, slots=True)
class Steps:
    """The footholds of a way.

    Attributes:
        footholds: how many there are.
        out_of_reach: of these, at touch-down or at lift-off.
        off_polygon: of these, where the foot comes to rest beside every polygon.
        worst_out_m, worst_off_m: by how much.
    """

    footholds: int
    out_of_reach: int
    off_polygon: int
    worst_out_m: float
    worst_off_m: float

    @property
    def sound(self) -> bool:
        """Whether every foothold is in reach and on a polygon."""
        return self.out_of_reach == 0 and self.off_polygon == 0


@dataclass(frozen=True, slots=True)
class Heuristic:
    """The footholds of the nearest-foothold planner in a gait at a speed."""

    gait: str
    speed_mps: float
    steps: Steps


@dataclass(frozen=True, slots=True)
class Straight:
    """Both planners on one map.

    Attributes:
        scene, seed: of the map.
        thinned: whether bars were taken away.
        widest_m: free distance between the bars across the way, the widest one straight ahead.
        way: whether the oracle says that a way exists.
        ended: how the mission ended.
        bent: whether the mission left the straight way.
        ours: its footholds.
        heuristic: those of the nearest-foothold planner, in each of ``GAITS`` at each of ``SPEEDS_MPS``.
    """

    scene: str
    seed: int
    thinned: bool
    widest_m: float
    way: bool
    ended: Ended
    bent: bool
    ours: Steps
    heuristic: tuple[Heuristic, ...]


def measure_straight(campaign: Campaign, scene: str, seed: int) -> tuple[Straight, ...]:
    """Walk a map straight ahead by both planners, as it is drawn and with bars taken away.

    There is no answer where the way straight ahead is short, or the scene has no bars.
    """
    if scene not in SCENES:
        return ()
    drawn = straight_ahead(generated(scene, seed))
    thin = None if drawn is None else thinned(drawn)
    if drawn is None or thin is None:
        return ()
    rows = [_measured(campaign, scene, seed, terrain, thin=terrain is thin) for terrain in (drawn, thin)]
    return tuple(one for one in rows if one is not None)


def _measured(campaign: Campaign, scene: str, seed: int, terrain: QuadrupedTerrain, *, thin: bool) -> Straight | None:
    name = "thinned" if thin else "straight"
    place, library = campaign.place(scene, seed), campaign.library(scene)
    file, out = place / f"{name}.yaml", place / name
    place.mkdir(parents=True, exist_ok=True)
    write_terrain(file, terrain)
    try:
        _, ended = walked(QuadrupedOrder(file, library), out)
    except InputError as refused:
        campaign.say(f"{scene}, seed {seed}, {name}: left out: {refused}")
        return None
    start, goal = _ends(terrain)
    way = way_exists(World(terrain), start, goal, read_library(library).knowledge)
    heuristic = tuple(judged_heuristic(terrain, gait, speed) for gait in GAITS for speed in SPEEDS_MPS)
    cells = [tuple(one["cells"][1]) for one in records(out, "segment")]
    each = (one.steps for one in heuristic)
    shares = ", ".join(f"{one.out_of_reach}+{one.off_polygon} of {one.footholds}" for one in each)
    campaign.say(f"{scene}, seed {seed}, {name}: {ended.told}; nearest footholds out of reach + beside: {shares}")
    return Straight(
        scene=scene,
        seed=seed,
        thinned=thin,
        widest_m=widest_m(terrain),
        way=way,
        ended=ended,
        bent=any(column != start[1] for _, column in cells),
        ours=_judged_plans(quadruped(terrain.robot), terrain, out),
        heuristic=heuristic,
    )


def straight_ahead(terrain: QuadrupedTerrain) -> QuadrupedTerrain | None:
    """Return the terrain with its goal in the farthest cell straight ahead; None where that is near."""
    if terrain.start_m is None:
        return None
    row, column = terrain.cell_at(terrain.start_m)
    for far in range(row - _LEAST_CELLS + 1):
        if LocalGrid(terrain, terrain.centre_m((far, column))).standing:
            return replace(terrain, goal_m=terrain.centre_m((far, column)))
    return None


def thinned(terrain: QuadrupedTerrain) -> QuadrupedTerrain | None:
    """Take one or two neighbouring bars away, half way, so that the distance there is nearest to ``WIDEST_M``."""
    (x0, y), (x1, _) = _places(terrain)
    middle, side = (x0 + x1) / 2, terrain.cell_m
    bars = _across(terrain, y)
    found: list[tuple[float, tuple[Polygon, ...]]] = []
    for count in (1, 2):
        for first in range(1, len(bars) - count):
            before, after = bars[first - 1], bars[first + count]
            low, high = _place(before, y), _place(after, y)
            if abs((low + high) / 2 - middle) < side:
                found.append((abs(_free(low, high, terrain) - WIDEST_M), tuple(bars[first : first + count])))
    if not found:
        return None
    gone = min(found, key=lambda one: one[0])[1]
    left = tuple(one for one in terrain.polygons if not any(one is other for other in gone))
    return replace(terrain, name=f"{terrain.name}, thinned", polygons=left)


def widest_m(terrain: QuadrupedTerrain) -> float:
    """Return the widest free distance between bars across the straight way."""
    (x0, y), (x1, _) = _places(terrain)
    places = [_place(one, y) for one in _across(terrain, y)]
    return max((_free(a, b, terrain) for a, b in pairwise(places) if b > x0 and a < x1), default=x1 - x0)


def _free(low_m: float, high_m: float, terrain: QuadrupedTerrain) -> float:
    """Return the free distance of two bars' centre lines; what was taken off their edges is put back."""
    return high_m - low_m - _BAR_WIDTH_M - 2 * terrain.margin_m


_BAR_WIDTH_M = 0.01
"""What is left of a bar to stand on."""


def _across(terrain: QuadrupedTerrain, y: float) -> list[Polygon]:
    """Return the bars that lie across the line of a y, in the order of x."""
    found = []
    for one in terrain.polygons:
        (west, south), (east, north) = one.vertices_m[:, :2].min(axis=0), one.vertices_m[:, :2].max(axis=0)
        if north - south > east - west and south <= y <= north:
            found.append(one)
    return sorted(found, key=lambda one: _place(one, y))


def _place(bar: Polygon, y: float) -> float:
    """Return the x of a bar's middle."""
    return float(bar.vertices_m[:, 0].mean())


def _ends(terrain: QuadrupedTerrain) -> tuple[Cell, Cell]:
    start, goal = _places(terrain)
    return terrain.cell_at(start), terrain.cell_at(goal)


def _places(terrain: QuadrupedTerrain) -> tuple[tuple[float, float], tuple[float, float]]:
    assert terrain.start_m is not None
    assert terrain.goal_m is not None
    return terrain.centre_m(terrain.cell_at(terrain.start_m)), terrain.goal_m


def by_heuristic(terrain: QuadrupedTerrain, gait: str, speed_mps: float) -> tuple[NearestFoothold, ...]:
    """Return the footholds of the heuristic from the start straight ahead to the goal."""
    (x0, y), (x1, _) = _places(terrain)
    cycle = NAMED[gait]
    cycles = math.ceil((x1 - x0) / (speed_mps * cycle.horizon_s))
    robot = quadruped(terrain.robot)
    return nearest_footholds(robot, terrain.polygons, cycle, speed_mps, cycles, start_m=(x0, y, 0.0))


def judged_heuristic(terrain: QuadrupedTerrain, gait: str, speed_mps: float) -> Heuristic:
    """Return how many of the heuristic's footholds are out of reach or beside the ground."""
    return _judged(gait, speed_mps, by_heuristic(terrain, gait, speed_mps))


def on_whole_ground(gait: str, speed_mps: float) -> Heuristic:
    """Return the same on ground without a hole, where every foot steps to the place it wishes for."""
    ground = (rectangle(0.0, 0.0, 100.0, 100.0),)
    return _judged(gait, speed_mps, nearest_footholds(CHOTU, ground, NAMED[gait], speed_mps, _CYCLES))


def _judged(gait: str, speed_mps: float, found: Sequence[NearestFoothold]) -> Heuristic:
    steps = _steps([one.beyond_reach_m for one in found], [one.off_polygon_m for one in found])
    return Heuristic(gait, speed_mps, steps)


def _steps(beyond_m: Sequence[float], off_m: Sequence[float]) -> Steps:
    return Steps(
        footholds=len(beyond_m),
        out_of_reach=sum(one > _TOLERANCE_M for one in beyond_m),
        off_polygon=sum(one > _TOLERANCE_M for one in off_m),
        worst_out_m=max(beyond_m, default=0.0),
        worst_off_m=max(off_m, default=0.0),
    )


def _judged_plans(robot: Quadruped, terrain: QuadrupedTerrain, run: Path) -> Steps:
    """Judge the footholds of a mission by the same two questions, from its plans on disk."""
    beyond, off = [], []
    for one in records(run, "segment"):
        motion = json.loads((run / one["plan"]["path"]).read_text("utf-8"))["motion"]
        base, feet = np.array(motion["base_m"]), np.array(motion["feet_m"])
        for step in motion["footsteps"]:
            foot, touch = step["foot"], step["touch"]
            leave = min(_leaves(motion["footsteps"], foot, touch, len(base)), len(base)) - 1
            out = _beyond(robot, base, feet[:, foot], foot)
            beyond.append(max(out(touch), out(leave)))
            off.append(min(max(polygon.excess(feet[touch, foot]), 0.0) for polygon in terrain.polygons))
    return _steps(beyond, off)


def _beyond(robot: Quadruped, base_m: Array, foot_m: Array, foot: int) -> Callable[[int], float]:
    """Return what tells how far a foot is out of reach at a sample; the robot faces ahead."""
    reference, reach = np.array(robot.feet_m[foot]), np.array(robot.foot_reach_m)
    return lambda i: max(0.0, float((np.abs(foot_m[i] - base_m[i] - reference) - reach).max()))


def _leaves(footsteps: Sequence[dict[str, int]], foot: int, touch: int, samples: int) -> int:
    """Return the sample at which a foot leaves again."""
    return min((one["lift"] for one in footsteps if one["foot"] == foot and one["lift"] > touch), default=samples)

"""The same transitions on ground that is turned below the robot (Zhou et al. 2025, X-E, Table IV).

The paper's hardware needed longer for its programs than the simulation, and holds misaligned stones and bars
responsible. Here every transition of a mission is solved again, from a stance of its own, with the whole map turned
about the middle of the two cells; at 0 degrees too. A mat like the paper's, which its robot crosses in a static walk,
is measured the same way.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from surefoot.footholds import Gait
from surefoot.footholds.fields import BAR_M
from surefoot.footholds.gaits import NAMED
from surefoot.footholds.terrain import Polygon, polygon
from surefoot.missions.bench.campaign import Campaign
from surefoot.missions.bench.detours import records
from surefoot.missions.bench.quadruped_missions import Mission
from surefoot.missions.quadruped.crossing import Certificate, Crossed, OnlineLimits, cross, crossing
from surefoot.missions.quadruped.skills import certificate_of
from surefoot.missions.quadruped.stance import stance_about
from surefoot.missions.quadruped.world import World
from surefoot.robots.quadruped import quadruped
from surefoot.skills import QuadrupedTerrain, class_set, generated
from surefoot.skills.ground_pieces import bar_corners
from surefoot.skills.quadruped_terrain import Point
from surefoot.skills.values import Cell

ANGLES_DEG = (0, 5, 10, 15)
SCENES = ("unstructured-4", "rebar-7", "rebar-14")
"""Level scenes: the edges of steps have to lie along the cells."""
MAT = "mat"
MOST_SEEDS = 5
"""More add nothing: a seed has some ten transitions."""
_WALK = NAMED["walk-2.25s"]
SLOW_WALK = Gait(
    (*_WALK.modes[:-1], *_WALK.modes),
    (*_WALK.switching_times_s[:-1], *(round(_WALK.switching_times_s[-2] + t, 3) for t in _WALK.switching_times_s[1:])),
)
"""The walk, twice: with one step of each foot for every 0.45 m the base would go 0.15 m in each swing (Table II)."""
_MAT_CELL_M, _MAT_CELLS, _MAT_BARS, _MAT_SPACING_M = 0.45, (6, 3), 6, (0.1, 0.3)


@dataclass(frozen=True, slots=True)
class Turned:
    """The transitions of a map, on ground that is turned by an angle.

    Attributes:
        scene, seed: of the map.
        angle_deg: by which it is turned.
        solve_ms: processor times of the programs that have a motion.
        refuted_ms: of those that are proved to have none.
        limits: programs that a limit left open.
        no_stance: transitions whose start or end is no place to stand.
        polygons, continuous, binaries: means of the programs' sizes.
    """

    scene: str
    seed: int
    angle_deg: int
    solve_ms: tuple[float, ...]
    refuted_ms: tuple[float, ...]
    limits: int
    no_stance: int
    polygons: float
    continuous: float
    binaries: float


@dataclass(frozen=True, slots=True)
class _Step:
    here: Cell
    there: Cell
    gait: Gait


def measure_turned(campaign: Campaign, mission: Mission) -> tuple[Turned, ...]:
    """Solve the transitions of a mission again at every angle."""
    if mission.ended is None or mission.scene not in SCENES or mission.seed >= MOST_SEEDS:
        return ()
    terrain = generated(mission.scene, mission.seed)
    steps = tuple(_steps_of(campaign.place(mission.scene, mission.seed) / "run"))
    return _at_angles(campaign, terrain, mission.scene, mission.seed, steps) if steps else ()


def measure_mat(campaign: Campaign, seed: int) -> tuple[Turned, ...]:
    """Solve the transitions straight over a mat, in a static walk."""
    terrain, (rows, columns) = mat(seed), _MAT_CELLS
    steps = tuple(_Step((row, columns // 2), (row - 1, columns // 2), SLOW_WALK) for row in range(rows - 1, 0, -1))
    return _at_angles(campaign, terrain, MAT, seed, steps)


def mat(seed: int) -> QuadrupedTerrain:
    """Return a mat of bars 0.1 to 0.3 m apart, six of them along the way, in cells of 0.45 m (X-A, X-C)."""
    rng = np.random.default_rng([seed, 29])
    (rows, columns), side = _MAT_CELLS, _MAT_CELL_M
    length, width = rows * side, columns * side
    across, x = [], float(rng.uniform(0.0, 0.1))
    while x < length:
        across.append(bar_corners((x, 0.0), (x, width), rng))
        x += BAR_M + float(rng.uniform(*_MAT_SPACING_M))
    along = [
        bar_corners((0.0, y + float(rng.uniform(-0.03, 0.03))), (length, y), rng)
        for y in np.linspace(0.05, width - 0.05, _MAT_BARS).tolist()
    ]
    rules = class_set("rebar-14")
    return QuadrupedTerrain(
        f"{MAT}, seed {seed}", rules.robot, rules, side, (3, 3), (0.0, 0.0), _MAT_CELLS,
        tuple(polygon(one) for one in (*across, *along)), rules.margin_m,
    )  # fmt: skip


def _steps_of(run: Path) -> Iterator[_Step]:
    """Yield cells and gait of every transition of a run."""
    for one in records(run, "segment"):
        if one["primitive"] is not None:
            (a, b), (c, d) = one["cells"]
            plan = json.loads((run / one["plan"]["path"]).read_text("utf-8"))
            yield _Step((a, b), (c, d), certificate_of(plan).gait)


def _at_angles(
    campaign: Campaign, terrain: QuadrupedTerrain, scene: str, seed: int, steps: tuple[_Step, ...]
) -> tuple[Turned, ...]:
    rows = tuple(_at_angle(terrain, scene, seed, steps, angle) for angle in ANGLES_DEG)
    told = ", ".join(f"{one.angle_deg} degrees {np.mean(one.solve_ms or [math.nan]):.0f} ms" for one in rows)
    campaign.say(f"{scene}, seed {seed}, turned: {told}")
    return rows


def _at_angle(terrain: QuadrupedTerrain, scene: str, seed: int, steps: tuple[_Step, ...], angle_deg: int) -> Turned:
    found = [one for step in steps if (one := _crossed(terrain, step, angle_deg)) is not None]
    return Turned(
        scene=scene,
        seed=seed,
        angle_deg=angle_deg,
        solve_ms=tuple(one.solve_ms for one in found if not one.reason),
        refuted_ms=tuple(one.solve_ms for one in found if one.infeasible),
        limits=sum(bool(one.reason) and not one.infeasible for one in found),
        no_stance=len(steps) - len(found),
        polygons=_mean([len(one.problem.polygons) for one in found]),
        continuous=_mean([one.continuous for one in found]),
        binaries=_mean([one.binaries for one in found]),
    )


def _mean(values: list[int]) -> float:
    return float(np.mean(values)) if values else 0.0


def _crossed(terrain: QuadrupedTerrain, step: _Step, angle_deg: int) -> Crossed | None:
    """Solve one transition on turned ground; None where the robot cannot stand at one of its ends."""
    a, b = terrain.centre_m(step.here), terrain.centre_m(step.there)
    world = World(turned(terrain, ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2), angle_deg))
    robot, limits = quadruped(terrain.robot), OnlineLimits()
    stance = stance_about(robot, world, a, 0)
    if stance is None:
        return None
    found = cross(
        crossing(robot, world, stance, step.there, 0, step.gait, limits),
        Certificate(step.gait, np.zeros((0, 3)), ()),
        limits,
    )
    return None if found.solution is None else found


def turned(terrain: QuadrupedTerrain, about_m: Point, angle_deg: float) -> QuadrupedTerrain:
    """Return level ground turned about a place; what was measured of its cells, their heights, is kept."""
    cos, sin = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    matrix, centre = np.array([[cos, -sin], [sin, cos]]), np.array(about_m)

    def moved(one: Polygon) -> Polygon:
        flat = (one.vertices_m[:, :2] - centre) @ matrix.T + centre
        return polygon(np.column_stack((flat, one.vertices_m[:, 2])).tolist(), one.friction)

    polygons = tuple(moved(one) for one in terrain.polygons)
    return terrain.with_polygons(polygons, terrain.measured)

"""Online: a quadruped walks over real polygons with the skills of a library (docs/quadruped.md)."""

from __future__ import annotations

import math
import platform
import statistics
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from surefoot import __version__
from surefoot.compute import process_pool
from surefoot.errors import InputError
from surefoot.footholds.solve import load_backends
from surefoot.missions.quadruped.blocked import Blockade
from surefoot.missions.quadruped.crossing import OnlineLimits
from surefoot.missions.quadruped.events import Event, read_events
from surefoot.missions.quadruped.outcome import Outcome
from surefoot.missions.quadruped.records import Log
from surefoot.missions.quadruped.skills import SkillBook
from surefoot.missions.quadruped.stance import Stance, stance_about
from surefoot.missions.quadruped.timeline import delays
from surefoot.missions.quadruped.walk import QuadrupedWalk
from surefoot.missions.quadruped.world import World
from surefoot.missions.references import reference
from surefoot.missions.run_writer import RunWriter
from surefoot.robots.quadruped import Quadruped, quadruped
from surefoot.skills import QuadrupedTerrain, read_terrain
from surefoot.skills.blocking import Barrier
from surefoot.skills.headings import turning_of
from surefoot.skills.library import LIBRARY, SkillLibrary, read_library
from surefoot.skills.obstacles import in_words, why_obstacle
from surefoot.skills.physics import PRELOAD
from surefoot.skills.quadruped_terrain import Point
from surefoot.skills.skill_game import pair_game, solve_game
from surefoot.skills.terrain_checks import terrain_checks
from surefoot.skills.values import Cell, TerrainState
from surefoot.verify import verify_path

_SEGMENTS_PER_CELL = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class QuadrupedAnswer(Outcome):
    """What a run did: how it ended, and what is told of it besides.

    Attributes:
        blocked_by: what stands in the way where none leads to the goal, with the measures that decide.
        prepared_ms: what strategies took for which skills were made before the robot set out, in all, physics not
            counted.
        no_stance: moves whose target has no pose in which the robot can stand, so that no program was solved.
        left: how often the robot left its own cell at once, because that had become an obstacle.
        withdrawn: motions that were planned, and not walked because of what happened before they began.
        violations: assumptions of a strategy that did not hold any more.
        first_s: what planning the first motion took, before which the robot stands anyway [s].
        solve_ms_mean, solve_ms_p95: of the online programs, in processor time [ms], re-targeting not counted.
        retarget_ms_mean: of re-targeting.
        polygons_mean, continuous_mean, binaries_mean: size of the programs, as the paper counts variables.
        out: the run folder.
    """

    blocked_by: tuple[Barrier, ...]
    prepared_ms: float
    no_stance: int
    left: int
    withdrawn: int
    violations: int
    first_s: float
    solve_ms_mean: float
    solve_ms_p95: float
    retarget_ms_mean: float
    polygons_mean: float
    continuous_mean: float
    binaries_mean: float
    out: Path

    @property
    def succeeded(self) -> bool:
        """Return whether the goal was reached and the log was verified."""
        return self.reached and self.verified


@dataclass(frozen=True, slots=True)
class QuadrupedOrder:
    """What a run is asked to do.

    Attributes:
        terrain: file of the terrain.
        library: folder of the skills; None: none were made, the runtime repair finds what is needed.
        start_m, goal_m: instead of those of the terrain.
        events: file of what happens.
        delay: injected planning delays, in words.
        classes: of a segmented terrain, which names none.
        limits: of online programs.
    """

    terrain: Path
    library: Path | None = None
    start_m: Point | None = None
    goal_m: Point | None = None
    events: Path | None = None
    delay: str | None = None
    classes: str | None = None
    limits: OnlineLimits = field(default_factory=OnlineLimits)


def run_quadruped(
    order: QuadrupedOrder, out: Path, progress: Callable[[str], None] = lambda _: None
) -> QuadrupedAnswer:
    """Walk a mission and have its log verified; see ``walk_quadruped``."""
    return walk_quadruped(order, out, progress)[1]


def walk_quadruped(
    order: QuadrupedOrder, out: Path, progress: Callable[[str], None] = lambda _: None
) -> tuple[QuadrupedWalk, QuadrupedAnswer]:
    """Walk a mission and have its log verified; return also the walk itself, with its segments.

    Raises:
        InputError: an input cannot be used, for instance a library that was made with other rules.
    """
    terrain = _terrain(order)
    start, goal = _place(terrain, "start_m"), _place(terrain, "goal_m")
    events = () if order.events is None else read_events(order.events)
    delays_s = delays(order.delay)
    world, robot = World(terrain), quadruped(terrain.robot)
    stance = _standing(robot, world, terrain.cell_at(start), joint_reach=order.limits.joint_reach)
    with process_pool(preload=PRELOAD) as executor:
        checks = terrain_checks(terrain, executor, at_run_time=True)
        library = None if order.library is None else read_library(order.library, made_with=checks.made_with)
        _warm_up()
        with RunWriter(out) as writer:
            log = Log(writer, progress)
            log.write("header", **_header(order, terrain, library, stance, out, events, delays_s))
            turning = turning_of(terrain.classes, terrain.directions) if terrain.yaw else None
            book = SkillBook(library, checks.physics, out, turning, checks.start_physics)
            most = _SEGMENTS_PER_CELL * math.prod(terrain.cells)
            walk = QuadrupedWalk(
                robot, world, book, stance, terrain.cell_at(goal), log,
                events=events, limits=order.limits, delays_s=delays_s, most_segments=most,
            )  # fmt: skip
            why_not = walk.run()
            blocked = _blocked(walk) if why_not else ()
            log.write("end", reached=not why_not, why_not=why_not, cell=walk.stance.cell, segments=len(walk.segments))
    progress("verifying the log")
    return walk, _answer(walk, why_not, blocked, out)


def _terrain(order: QuadrupedOrder) -> QuadrupedTerrain:
    read = read_terrain(order.terrain) if order.classes is None else read_terrain(order.terrain, classes=order.classes)
    return replace(read, start_m=order.start_m or read.start_m, goal_m=order.goal_m or read.goal_m)


def _place(terrain: QuadrupedTerrain, key: str) -> Point:
    place: Point | None = getattr(terrain, key)
    option = "--" + key.removesuffix("_m")
    if place is None:
        message = f"is missing; give it in the terrain file, or as {option} X,Y in metres of the map"
        raise InputError(message, source=terrain.source, key=key)
    terrain.cell_at(place)
    return place


def _standing(robot: Quadruped, world: World, cell: Cell, *, joint_reach: bool) -> Stance:
    """Return how the robot stands in a cell at the start."""
    terrain = world.terrain
    centre_m = terrain.centre_m(cell)
    free = world.state(cell) is not None
    stance = stance_about(robot, world, centre_m, 0, joint_reach=joint_reach) if free else None
    if stance is None or world.state(stance.cell) is None:
        why = in_words(why_obstacle(terrain, cell)) or "no pose about its centre has ground for all four feet"
        raise InputError(f"the robot cannot stand at the start, in cell {cell}: {why}", key="start_m")
    return stance


def _warm_up() -> None:
    """Import and compile, so that neither counts as time to plan."""
    load_backends()
    solve_game(pair_game(TerrainState((("flat",),)), (0, 0), ()))


def _header(
    order: QuadrupedOrder,
    terrain: QuadrupedTerrain,
    library: SkillLibrary | None,
    stance: Stance,
    out: Path,
    events: Sequence[Event],
    delays_s: Sequence[float],
) -> dict[str, Any]:
    limits = order.limits
    return {
        "kind": "quadruped-run",
        "format": 1,
        "surefoot": __version__,
        "versions": {"python": platform.python_version(), "numpy": np.__version__},
        "terrain": reference(order.terrain, out),
        "library": None if library is None else reference(library.folder / LIBRARY, out),
        "files": [reference(one, out) for one in _other_files(order.terrain, terrain)],
        "classes": terrain.classes.name,
        "robot": terrain.robot,
        "cell_m": terrain.cell_m,
        "grid": terrain.grid,
        "origin_m": terrain.origin_m,
        "cells": terrain.cells,
        "start": {"cell": stance.cell, "base_m": stance.base_m, "feet_m": stance.feet_m},
        "goal": {"place_m": terrain.goal_m, "cell": _cell_of(terrain, terrain.goal_m)},
        "events": [one.described() for one in events],
        "delays_s": delays_s,
        "gap": limits.gap,
        "time_limit_s": limits.time_limit_s,
        "collision": limits.collision,
        "joint_reach": limits.joint_reach,
    }


def _other_files(path: Path, terrain: QuadrupedTerrain) -> Iterator[Path]:
    """Yield the files that a terrain file refers to: rules of classes, and polygons."""
    if terrain.classes.source is not None:
        yield terrain.classes.source
    if terrain.polygons_from is not None and terrain.polygons_from != path:
        yield terrain.polygons_from


def _cell_of(terrain: QuadrupedTerrain, place_m: Point | None) -> Cell | None:
    return None if place_m is None else terrain.cell_at(place_m)


def _blocked(walk: QuadrupedWalk) -> tuple[Barrier, ...]:
    blockade = Blockade(walk.world, walk.book.knowledge, walk.failed, walk.book.turning)
    return blockade.between(walk.stance.cell, walk.goal)


def _answer(walk: QuadrupedWalk, why_not: str, blocked: tuple[Barrier, ...], out: Path) -> QuadrupedAnswer:
    report, tally = verify_path(out), walk.tally
    slots, programs = tally.slots, tally.crossed
    return QuadrupedAnswer(
        reached=not why_not,
        why_not=why_not,
        blocked_by=blocked,
        transitions=len(walk.segments),
        repairs=tally.repairs,
        new_skills=tally.new_skills,
        resynthesis_ms=max(tally.resynthesis_ms, default=0.0),
        repair_ms=max(tally.repair_ms, default=0.0),
        prepared_ms=tally.prepared_ms,
        contradictions=tally.contradictions,
        no_stance=tally.no_stance,
        other_gaits=tally.other_gaits,
        settled=tally.settled,
        left=tally.left,
        withdrawn=tally.withdrawn,
        limits=tally.limits,
        violations=tally.violations,
        detours=tally.detours,
        idle_s=sum(slot.idle_s for slot in slots),
        idle_for_checks_s=tally.idle_for_checks_s,
        first_s=slots[0].start_s if slots else 0.0,
        walked_s=slots[-1].end_s if slots else 0.0,
        solve_ms_mean=_mean([one.solve_ms for one in programs]),
        solve_ms_p95=float(np.percentile([one.solve_ms for one in programs] or [0.0], 95)),
        retarget_ms_mean=_mean([one.retarget_ms for one in programs]),
        polygons_mean=_mean([len(one.problem.polygons) for one in programs]),
        continuous_mean=_mean([one.continuous for one in programs]),
        binaries_mean=_mean([one.binaries for one in programs]),
        verified=report.accepted,
        findings=tuple(map(str, report.findings)),
        out=out,
    )


def _mean(values: Sequence[float]) -> float:
    return statistics.fmean(values) if values else 0.0

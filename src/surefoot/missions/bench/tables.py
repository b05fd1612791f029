"""Tables of a campaign of quadruped missions: against the nearest foothold, on turned ground, and what was missed."""

from __future__ import annotations

import statistics
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from surefoot.missions.bench.quadruped import Measured
from surefoot.missions.bench.straight import GAITS, SPEEDS_MPS, Heuristic, Steps, Straight, on_whole_ground
from surefoot.missions.bench.turned import Turned

WHOLE = "whole ground"


@dataclass(frozen=True, slots=True)
class NearestRow:
    """A planner on the bars of a scene, over all seeds.

    Attributes:
        scene: its name; ``whole ground`` for ground without holes.
        thinned: whether bars were taken away.
        planner: ``mission``, or the gait and the speed of the nearest foothold.
        ways: how many were walked; for the mission those only that have a way.
        whole: of these, the goal reached, with every foothold in reach and on a polygon.
        footholds: of all ways.
        out_of_reach, off_polygon: shares of them.
        worst_out_m, worst_off_m: by how much.
    """

    scene: str
    thinned: bool
    planner: str
    ways: int
    whole: int
    footholds: int
    out_of_reach: float
    off_polygon: float
    worst_out_m: float
    worst_off_m: float


@dataclass(frozen=True, slots=True)
class TurnedRow:
    """The transitions of a scene on ground turned by an angle, over all seeds.

    Attributes:
        scene: its name.
        angle_deg: of the ground.
        polygons, continuous, binaries: means over maps.
        programs: with a motion.
        least_ms, mean_ms, most_ms: their processor times; None without any.
        refuted: programs that are proved to have no motion.
        no_stance: transitions at whose ends the robot cannot stand.
        limits: programs that a limit left open.
    """

    scene: str
    angle_deg: int
    polygons: float
    continuous: float
    binaries: float
    programs: int
    least_ms: float | None
    mean_ms: float | None
    most_ms: float | None
    refuted: int
    no_stance: int
    limits: int


@dataclass(frozen=True, slots=True)
class Miss:
    """A goal that was not reached although there is a way.

    Attributes:
        what: the map, and what happened on it.
        why: what the executive says.
        refuted: moves that no gait could do, and what each lacks.
    """

    what: str
    why: str
    refuted: tuple[str, ...]


def nearest_rows(rows: Sequence[Straight]) -> tuple[NearestRow, ...]:
    """Return both planners' lines for every scene, with and without the bars, and the heuristic's on whole ground."""
    found: list[NearestRow] = []
    for scene, thinned in dict.fromkeys((one.scene, one.thinned) for one in rows):
        mine = [one for one in rows if (one.scene, one.thinned) == (scene, thinned)]
        ways = [one for one in mine if one.way]
        whole = sum(one.ended.reached and one.ended.verified and one.ours.sound for one in ways)
        found.append(_nearest_row(scene, thinned, "mission", whole, [one.ours for one in ways]))
        for planner in dict.fromkeys(_named(each) for one in mine for each in one.heuristic):
            steps = [each.steps for one in mine for each in one.heuristic if _named(each) == planner]
            found.append(_nearest_row(scene, thinned, planner, sum(one.sound for one in steps), steps))
    control = [on_whole_ground(gait, speed) for gait in GAITS for speed in SPEEDS_MPS] if found else []
    found += [_nearest_row(WHOLE, False, _named(one), int(one.steps.sound), [one.steps]) for one in control]
    return tuple(found)


def _named(one: Heuristic) -> str:
    return f"{one.gait}, {one.speed_mps:g} m/s"


def _nearest_row(scene: str, thinned: bool, planner: str, whole: int, steps: Sequence[Steps]) -> NearestRow:
    footholds = sum(one.footholds for one in steps)
    return NearestRow(
        scene=scene,
        thinned=thinned,
        planner=planner,
        ways=len(steps),
        whole=whole,
        footholds=footholds,
        out_of_reach=sum(one.out_of_reach for one in steps) / max(footholds, 1),
        off_polygon=sum(one.off_polygon for one in steps) / max(footholds, 1),
        worst_out_m=max((one.worst_out_m for one in steps), default=0.0),
        worst_off_m=max((one.worst_off_m for one in steps), default=0.0),
    )


def turned_rows(rows: Sequence[Turned]) -> tuple[TurnedRow, ...]:
    """Return a line for every scene and angle."""
    return tuple(
        _turned_row(scene, angle, [one for one in rows if (one.scene, one.angle_deg) == (scene, angle)])
        for scene, angle in dict.fromkeys((one.scene, one.angle_deg) for one in rows)
    )


def _turned_row(scene: str, angle_deg: int, rows: Sequence[Turned]) -> TurnedRow:
    times = [time for one in rows for time in one.solve_ms]
    return TurnedRow(
        scene=scene,
        angle_deg=angle_deg,
        polygons=statistics.fmean(one.polygons for one in rows),
        continuous=statistics.fmean(one.continuous for one in rows),
        binaries=statistics.fmean(one.binaries for one in rows),
        programs=len(times),
        least_ms=min(times, default=None),
        mean_ms=statistics.fmean(times) if times else None,
        most_ms=max(times, default=None),
        refuted=sum(len(one.refuted_ms) for one in rows),
        no_stance=sum(one.no_stance for one in rows),
        limits=sum(one.limits for one in rows),
    )


def misses(found: Measured) -> Iterator[Miss]:
    """Yield every goal that was not reached although there is a way, with what refuted it."""
    for mission in found.missions:
        if mission.way and mission.ended is not None and not mission.ended.reached:
            yield Miss(f"{mission.scene}, seed {mission.seed}", mission.ended.why_not, mission.ended.refuted)
    for detour in found.detours:
        if detour.way and not detour.ended.reached:
            what = f"{detour.scene}, seed {detour.seed}, an obstacle appears"
            yield Miss(what, detour.ended.why_not, detour.ended.refuted)
    for one in found.straight:
        if one.way and not one.ended.reached:
            what = f"{one.scene}, seed {one.seed}, straight ahead{', thinned' if one.thinned else ''}"
            yield Miss(what, one.ended.why_not, one.ended.refuted)

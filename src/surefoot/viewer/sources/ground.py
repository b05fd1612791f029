"""The ground of a quadruped's run: all polygons of its terrain, what appeared and went on the way, way points, goal."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.compute import sha256_of
from surefoot.errors import InputError
from surefoot.missions.quadruped.events import Happening
from surefoot.missions.quadruped.world import World
from surefoot.skills import read_terrain
from surefoot.skills.patches import Rectangle
from surefoot.viewer.remarks import Say, silent
from surefoot.viewer.sources.foothold_motion import records_of

Array = NDArray[np.float64]
Record = Mapping[str, Any]


@dataclass(frozen=True, slots=True, eq=False)
class Phase:
    """The world from a moment on.

    Attributes:
        begin_s: the moment.
        polygons_m: what feet may stand on, each (corners, 3).
        obstacles: what stands there.
    """

    begin_s: float
    polygons_m: tuple[Array, ...]
    obstacles: tuple[Rectangle, ...]


@dataclass(frozen=True, slots=True, eq=False)
class WayPoint:
    """What the robot is asked for from a moment on: a place on the ground, shape (3,)."""

    begin_s: float
    place_m: Array


@dataclass(frozen=True, slots=True, eq=False)
class RunGround:
    """What a run went over.

    Attributes:
        phases: of the world, ascending in time.
        way_points: ascending in time.
        goal_m: on the ground, shape (3,).
    """

    phases: tuple[Phase, ...]
    way_points: tuple[WayPoint, ...]
    goal_m: Array


OBSTACLE_M = 0.45
"""How high obstacles are drawn above the lowest ground; the log has their ground plans only."""


def read_run_ground(run_dir: Path, say: Say = silent, *, growing: bool = False) -> RunGround | None:
    """Read the ground of a quadruped's run; None if its terrain is not there any more, or was changed.

    Args:
        run_dir: the folder of the run.
        say: is told when the terrain is not to be had.
        growing: whether a last line without its end is passed over, because it is still being written.

    Raises:
        InputError: the log or the terrain cannot be read.
    """
    log = run_dir / "run.jsonl"
    records = [record for _, record in records_of(log, growing=growing)]
    try:
        header = records[0]
        terrain = run_dir / str(header["terrain"]["path"])
        if not terrain.is_file() or sha256_of(terrain) != header["terrain"]["sha256"]:
            say("the terrain file of the run is missing or was changed: only the ground that its plans knew is shown")
            return None
        begin = World(read_terrain(terrain, classes=header["classes"]))
        x, y = header["goal"]["place_m"]
        return RunGround(
            phases=tuple(_phases(begin, records)),
            way_points=tuple(_way_points(begin, header, records)),
            goal_m=_on_ground(begin, float(x), float(y)),
        )
    except (KeyError, TypeError, ValueError, IndexError) as problem:
        raise InputError(f"lacks {problem}, or holds another type there", source=log) from problem


def _phases(world: World, records: Sequence[Record]) -> Iterator[Phase]:
    yield _phase(0.0, world)
    for record in (one for one in records if one["record"] == "event"):
        event = record["event"]
        for what, happen in ((Happening.OBSTACLE, World.with_obstacle), (Happening.HOLE, World.without_ground)):
            if what.value in event:
                (west, south), (east, north) = event[what.value]
                world = happen(world, Rectangle(west, south, east, north))
                yield _phase(float(record["seen_s"]), world)


def _phase(begin_s: float, world: World) -> Phase:
    return Phase(begin_s, tuple(one.vertices_m for one in world.terrain.polygons), world.obstacles)


def _way_points(world: World, header: Record, records: Sequence[Record]) -> Iterator[WayPoint]:
    """Yield the cells that were asked for, each from the segment on that follows its request."""
    asked: Array | None = None
    for record in records:
        if record["record"] == "request":
            asked = _on_ground(world, *request_m(header, record))
        if record["record"] == "segment" and asked is not None:
            yield WayPoint(float(record["start_s"]), asked)
            asked = None


def request_m(header: Record, request: Record) -> tuple[float, float]:
    """Return the middle of the cell that a request asks for: cells of a grid lie about the robot's, turned with it."""
    rows, columns = header["grid"]
    row, column = request["request"][0] - rows // 2, request["request"][1] - columns // 2
    for _ in range(request["quarter_turns"] % 4):
        row, column = -column, row
    return cell_m(header, (request["cell"][0] + row, request["cell"][1] + column))


def cell_m(header: Record, cell: tuple[int, int]) -> tuple[float, float]:
    """Return the middle of a cell of the map."""
    (x, y), (rows, columns), side = header["origin_m"], header["cells"], header["cell_m"]
    return x + (rows - cell[0] - 0.5) * side, y + (columns - cell[1] - 0.5) * side


def _on_ground(world: World, x: float, y: float) -> Array:
    """Return a place at the height of the polygon that is nearest to it."""
    away = [_away_m(one.vertices_m, x, y) for one in world.terrain.polygons]
    height_m = float(world.terrain.polygons[int(np.argmin(away))].vertices_m[:, 2].mean())
    return np.array([x, y, height_m])


def _away_m(vertices_m: Array, x: float, y: float) -> float:
    low, high = vertices_m[:, :2].min(axis=0), vertices_m[:, :2].max(axis=0)
    outside = np.maximum(np.maximum(low - (x, y), (x, y) - high), 0.0)
    return float(np.hypot(*outside))

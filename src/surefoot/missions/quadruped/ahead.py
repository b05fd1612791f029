"""Skills that the way to the goal will need, made before the robot sets out, so that it does not wait for them later.

The route is followed from request to request as the executive would, on the ground as it is known; what comes otherwise
is the business of the runtime repair.
"""

from __future__ import annotations

import time
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

from surefoot.missions.quadruped.route import Edge, Pose, Routes, moves_from, pose_on_map
from surefoot.missions.quadruped.skills import SkillBook
from surefoot.missions.quadruped.world import World
from surefoot.skills.headings import Turning
from surefoot.skills.values import Cell, CheckResult, TerrainState, Way

_MOST_REQUESTS = 1000


@dataclass(frozen=True, slots=True)
class Prepared:
    """What was made for one request.

    Attributes:
        checked: what physics was asked, for a strategy or for a shorter one.
        symbolic_ms: processor time without physics.
    """

    checked: tuple[CheckResult, ...]
    symbolic_ms: float


def looked_ahead(
    world: World, book: SkillBook, pose: Pose, goal: Cell, closed: Collection[Edge] = ()
) -> Iterator[Prepared]:
    """Yield what is made for every request on the way, until the goal or the end of all ways.

    Args:
        world: the map.
        book: skills; grows.
        pose: where the robot is.
        goal: cell of the map.
        closed: moves that failed, or that were given up.
    """
    planned: dict[tuple[int, int], Routes] = {}
    for _ in range(_MOST_REQUESTS):
        state = world.state(*pose)
        if state is None or pose[0] == goal:
            return
        known = len(book.knowledge.refused)
        key = pose[1], known
        if key not in planned:
            planned[key] = Routes(world, goal, pose[1], book.knowledge.refused, closed, book.turning)
        routes = planned[key]
        for local in routes.wishes(pose[0], state, world.terrain.requests):
            handled = book.strategy(state, local, ())
            yield Prepared(handled.checked, handled.symbolic_ms)
            if handled.winning:
                begin_s = time.process_time()
                checked = book.short_cuts(state, local)
                handled = book.strategy(state, local, ()) if checked else handled
                yield Prepared(checked, 1e3 * (time.process_time() - begin_s))
                pose = pose_on_map(pose, end_of(handled.ways, state, book.turning), (state.rows, state.columns))
                break
        else:
            if len(book.knowledge.refused) == known:
                return


def end_of(ways: Mapping[Pose, Way | None], state: TerrainState, turning: Turning | None) -> Pose:
    """Return the local pose in which a strategy stays."""
    pose: Pose = (state.centre, 0)
    while (way := ways[pose]) is not None:
        pose = next(after for primitive, after in moves_from(state, pose, turning) if primitive.direction == way)
    return pose

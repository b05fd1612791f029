"""Physics for the library of a terrain: trots for the first skills; for suggestions also what else there is."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import asdict, replace

from surefoot.skills.headings import turn_primitives
from surefoot.skills.making import Checks
from surefoot.skills.physics import INITIAL_GAITS, REPAIR_GAITS, TURN_GAITS, Limits, PhysicsOfClasses, start_primitives
from surefoot.skills.quadruped_terrain import QuadrupedTerrain
from surefoot.skills.values import CheckResult, PhysicsCheck, Primitive, Turn


def terrain_checks(
    terrain: QuadrupedTerrain, executor: Executor, *, time_limit_s: float | None = None, at_run_time: bool = False
) -> Checks:
    """Return who answers about the primitives of a terrain.

    Args:
        terrain: its classes, cell and robot count; its polygons do not.
        executor: where the programs are solved.
        time_limit_s: of one search for a motion; None: as physics has it.
        at_run_time: nothing is known of the start's primitives: their trots are tried where the repair asks for them.
    """
    limits = Limits() if time_limit_s is None else Limits(time_limit_s=time_limit_s)
    start = (*start_primitives(terrain.classes), *(turn_primitives(terrain.classes) if terrain.yaw else ()))

    def physics(gaits: Sequence[str]) -> PhysicsOfClasses:
        tried = replace(limits, gaits=tuple(gaits))
        return PhysicsOfClasses(
            terrain.classes, cell_m=terrain.cell_m, robot=terrain.robot, limits=tried, executor=executor
        )

    trots, every = physics(INITIAL_GAITS), physics((*INITIAL_GAITS, *REPAIR_GAITS))
    turns = {turn: physics((*gaits, *REPAIR_GAITS)) for turn, gaits in TURN_GAITS.items()}
    robot = json.dumps(asdict(trots.robot), sort_keys=True, default=str)
    made_with = {
        "classes": terrain.classes.name,
        "rules_sha256": terrain.classes.digest,
        "robot": terrain.robot,
        "robot_sha256": hashlib.sha256(robot.encode()).hexdigest(),
        "cell_m": terrain.cell_m,
        "start_gaits": list(INITIAL_GAITS),
        "repair_gaits": list(REPAIR_GAITS),
        "collision": limits.collision,
    }
    if terrain.yaw:
        made_with["turn_gaits"] = {turn.value: list(gaits) for turn, gaits in TURN_GAITS.items()}
    failed = frozenset[Primitive]() if at_run_time else frozenset(start)
    repair = _by_need(failed, physics(REPAIR_GAITS), every)
    return Checks(_by_kind(repair, turns), made_with, start, _by_kind(trots, turns))


def _by_kind(moves: PhysicsCheck, turns: Mapping[Turn, PhysicsCheck]) -> PhysicsCheck:
    """Return physics that tries every gait for turns: they are few, and three turns one way are one the other way."""

    def check(primitives: Sequence[Primitive]) -> Iterator[CheckResult]:
        yield from moves([one for one in primitives if not isinstance(one.direction, Turn)])
        for turn, physics in turns.items():
            yield from physics([one for one in primitives if one.direction is turn])

    return check


def _by_need(failed: frozenset[Primitive], others: PhysicsCheck, all_of_them: PhysicsCheck) -> PhysicsCheck:
    """Return physics that does not try again the gaits with which the primitives of the start failed."""

    def check(primitives: Sequence[Primitive]) -> Iterator[CheckResult]:
        yield from all_of_them([one for one in primitives if one not in failed])
        yield from others([one for one in primitives if one in failed])

    return check

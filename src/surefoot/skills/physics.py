"""Physics of primitives: each becomes a foothold problem on class polygons, answered in parallel and with deadlines.

The robot stands at the centre of one cell and goes to the centre of the next; both poses are re-targeted to the nearest
one in which it can stand. Only the difference of the two classes' heights matters, so that ``high->high`` asks the same
as ``flat->flat``, and is answered by it.

Source: Zhou et al. 2025, VI-A, VI-D, VII-A1.
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from surefoot.compute import Deadline, each_answer, process_pool
from surefoot.errors import InputError
from surefoot.footholds import Options, Problem, Solution, retarget, solve
from surefoot.footholds.gaits import NAMED, FreeGait, Gait
from surefoot.footholds.plan_file import plan_document
from surefoot.footholds.problem import Array, nominal_feet
from surefoot.footholds.terrain import Polygon
from surefoot.robots.quadruped import Quadruped, quadruped
from surefoot.skills.class_blocks import GroundBlock
from surefoot.skills.classes import ClassSet
from surefoot.skills.patches import WAYS, class_polygons
from surefoot.skills.values import CheckResult, Direction, Physics, Primitive, Turn, Way

INITIAL_GAITS = ("trot-2s", "trot-3s")
"""The gaits that the first skills come from (IX-C)."""

REPAIR_GAITS = ("leap-1.5s", "walk-2.25s", "free-1.5s", "free-2s", "free-3s")
"""What is tried for suggestions of the repair: two known gaits, which cost milliseconds, and then any gait at all."""

TURN_GAITS = {
    Turn.LEFT: ("trot-2s-mirrored", "trot-3s-mirrored", *INITIAL_GAITS),
    Turn.RIGHT: (*INITIAL_GAITS, "trot-2s-mirrored", "trot-3s-mirrored"),
}
"""What is tried for turns before the gaits of the repair: first the trot whose outer front foot swings first.

The other trot begins a turn with feet that are in each other's way: on dense stones it does half as many turns.
"""

FREE = "free-"
"""Begins the name of a gait that is to be found; its horizon in seconds follows, such as ``free-1.5s``."""

PRELOAD = ("surefoot.skills.physics", "surefoot.footholds.gaitfree", "piqp", "highspy", "scipy.sparse.linalg")
"""What workers need; imported once for all of them."""

_STEP_S = 0.025
_STEP_EDGE_M = 0.03
_EDGE_M = 0.01
_CLOCK = 10


@dataclass(frozen=True, slots=True)
class Limits:
    """How hard physics tries.

    Attributes:
        gaits: tried in order; the first feasible one wins.
        gap: relative gap at which a search for a motion stops; any feasible one is a certificate.
        time_limit_s: of one search, in processor time; by the clock it may take ten times as long.
        deadline_s: of all checks of one call together; None for none.
        collision: whether feet keep clear of the edges of steps (VII-A2).
        explain: whether what is infeasible is explained.
    """

    gaits: tuple[str, ...] = INITIAL_GAITS
    gap: float = 0.9
    time_limit_s: float = 10.0
    deadline_s: float | None = None
    collision: bool = True
    explain: bool = True


@dataclass(frozen=True, slots=True)
class Crossing:
    """What a primitive asks of physics: all that its answer depends on.

    Attributes:
        robot: its numbers.
        cell_m: side of a cell.
        margin_m: taken off every edge.
        direction: where the robot goes, or which way it turns.
        here: pattern of the cell that it leaves, at height 0.
        next: pattern of the cell that it enters, at height 0; of a turn, what it then sees of the same cell.
        rise_m: height of that cell above the first.
    """

    robot: Quadruped
    cell_m: float
    margin_m: float
    direction: Way
    here: GroundBlock
    next: GroundBlock
    rise_m: float


class PhysicsOfClasses:
    """Answers about primitives of a set of classes; a ``PhysicsCheck``.

    Args:
        classes: the set.
        cell_m: side of a cell; None for that of the set.
        robot: name of the robot; None for that of the set.
        limits: how hard to try.
        executor: where to work, for instance ``compute.process_pool(preload=PRELOAD)``; None for a pool of its own for
            every call, and no pool at all for a single question.
        workers: size of that pool; None for one process per core.
    """

    def __init__(
        self,
        classes: ClassSet,
        *,
        cell_m: float | None = None,
        robot: str | None = None,
        limits: Limits | None = None,
        executor: Executor | None = None,
        workers: int | None = None,
    ) -> None:
        self.classes, self.limits = classes, limits or Limits()
        for gait in self.limits.gaits:
            gait_of(gait)
        self.cell_m = cell_m or classes.cell_m
        self.robot = quadruped(robot or classes.robot)
        self.executor, self.workers = executor, workers

    def crossing(self, primitive: Primitive) -> Crossing:
        """Return what a primitive asks, relative to the ground that the robot stands on.

        Raises:
            InputError: a class is not of this set, or a turn leads from one cell to another.
        """
        for label in (primitive.here, primitive.next):
            self.classes.check_label(label)
        if isinstance(primitive.direction, Turn) and primitive.next != self.classes.turned(primitive.here, 1):
            after = self.classes.turned(primitive.here, 1)
            stays = f"a turn stays in its cell, and {primitive.here} is seen as {after} after a quarter turn"
            raise InputError(f"{primitive.name} is no skill: {stays}")
        here, there = (self.classes.classes[label].ground for label in (primitive.here, primitive.next))
        rise = there.height_m - here.height_m
        level = {"height_m": 0.0}
        return Crossing(
            self.robot, self.cell_m, self.classes.margin_m, primitive.direction,
            here.model_copy(update=level), there.model_copy(update=level), round(rise, 9),
        )  # fmt: skip

    def __call__(self, primitives: Sequence[Primitive]) -> Iterator[CheckResult]:
        """Yield the answer about every primitive as soon as it is known."""
        asked: dict[str, list[Primitive]] = {}
        crossings: dict[str, Crossing] = {}
        for primitive in primitives:
            crossing = self.crossing(primitive)
            asked.setdefault(repr(crossing), []).append(primitive)
            crossings[repr(crossing)] = crossing
        work = [(primitives[0], crossings[key], self.limits) for key, primitives in asked.items()]
        sharing = list(asked.values())
        deadline = Deadline.after(self.limits.deadline_s)
        if self.executor is not None:
            yield from self._answers(self.executor, work, sharing, deadline)
        elif len(work) == 1:
            yield from self._shared(check_crossing(*work[0]), sharing[0])
        elif work:
            with process_pool(self.workers, preload=PRELOAD) as executor:
                yield from self._answers(executor, work, sharing, deadline)

    def _answers(
        self, executor: Executor, work: list[Work], sharing: list[list[Primitive]], deadline: Deadline
    ) -> Iterator[CheckResult]:
        for index, result in each_answer(executor, _checked, work, deadline):
            found = self._late(sharing[index][0]) if result is None else result
            yield from self._shared(found, sharing[index])

    @staticmethod
    def _shared(found: CheckResult, primitives: list[Primitive]) -> Iterator[CheckResult]:
        for primitive in primitives:
            yield replace(found, primitive=primitive)

    def _late(self, primitive: Primitive) -> CheckResult:
        limit = f"the deadline of {self.limits.deadline_s:g} s was reached"
        return CheckResult(primitive, Physics.UNKNOWN, ", ".join(self.limits.gaits), limit, 0.0)


Work = tuple[Primitive, Crossing, Limits]


def _checked(work: Work) -> CheckResult:
    primitive, crossing, limits = work
    return check_crossing(primitive, crossing, limits)


def check_crossing(primitive: Primitive, crossing: Crossing, limits: Limits) -> CheckResult:
    """Answer whether any of the gaits crosses from one cell to the next, trying them in order.

    What is unknown for one gait and infeasible for the others is unknown.
    """
    begin = time.process_time()
    said: list[str] = []
    verdict = Physics.INFEASIBLE
    tried = ", ".join(limits.gaits)
    standing = crossing_problem(crossing, limits)
    if isinstance(standing, str):
        return CheckResult(primitive, Physics.INFEASIBLE, tried, standing, time.process_time() - begin)
    for gait in limits.gaits:
        problem, solution = crossed(standing, gait, limits, explain=limits.explain and gait == limits.gaits[-1])
        if solution.plan is not None and solution.objective is not None and solution.verdict == "feasible":
            text = json.dumps(plan_document(problem, solution, Path()))
            took = time.process_time() - begin
            horizon = problem.gait.horizon_s
            return CheckResult(primitive, Physics.FEASIBLE, gait, "", took, horizon, solution.objective, text)
        if reason := _reason(solution, limits):
            said.append(f"{gait}: {reason}")
        if solution.verdict == "unknown":
            verdict = Physics.UNKNOWN
    return CheckResult(primitive, verdict, tried, "; ".join(said), time.process_time() - begin)


def crossed(standing: Problem, name: str, limits: Limits, *, explain: bool) -> tuple[Problem, Solution]:
    """Return a crossing with a gait, and its answer; a gait that is found is certified as a gait of its own.

    The search for a gait ends with the first one that works: a bound over all gaits is not needed here.
    """
    problem = replace(standing, gait=gait_of(name))
    spent = _budget(limits.time_limit_s)
    if not isinstance(problem.gait, FreeGait):
        return problem, answered(problem, spent, explain=explain)
    first = replace(problem, options=replace(problem.options, first_plan=True))
    solution = solve(first, cancelled=spent, why=explain)
    if solution.free is None or solution.free.gait is None:
        return problem, solution
    problem = replace(standing, gait=solution.free.gait)
    return problem, answered(problem, _budget(limits.time_limit_s), explain=False)


def _budget(cpu_s: float) -> Callable[[], bool]:
    """Return what tells whether so much processor time has gone, which a busy machine does not stretch."""
    end = time.process_time() + cpu_s
    return lambda: time.process_time() > end


def gait_of(name: str) -> Gait | FreeGait:
    """Return a gait by its name.

    Raises:
        InputError: there is none of that name.
    """
    if name in NAMED:
        return NAMED[name]
    horizon = name.removeprefix(FREE).removesuffix("s")
    if name.startswith(FREE) and horizon.replace(".", "", 1).isdigit() and 0.5 <= float(horizon) <= 10:
        return FreeGait(float(horizon))
    raise InputError(
        f"there is no gait {name!r}; there are {', '.join(NAMED)}, and free-1.5s and the like: any gait that long"
    )


def answered(problem: Problem, spent: Callable[[], bool], *, explain: bool) -> Solution:
    """Solve a foothold problem; rays suffice as proof, and where they do not, a second method decides."""
    solution = solve(problem, cancelled=spent, certify=False, why=explain)
    if solution.verdict == "unknown" and not spent():
        return solve(problem, cancelled=spent, why=explain)
    return solution


def _reason(solution: Solution, limits: Limits) -> str:
    if solution.limit == "cancelled":
        return f"the limit of {limits.time_limit_s:g} s of processor time was reached"
    return solution.limit or (solution.explanation.text if solution.explanation is not None else "")


def crossing_problem(crossing: Crossing, limits: Limits) -> Problem | str:
    """Return the foothold problem of a crossing (with a trot), both poses re-targeted, or why there is none."""
    level, way = np.zeros(3), crossing.direction
    upright = np.array([0.0, 0.0, way.quarter_turns * math.pi / 2]) if isinstance(way, Turn) else level
    sideways = way in (Direction.LEFT, Direction.RIGHT)
    cell = crossing.cell_m, crossing.margin_m, sideways
    first = standing_pose(crossing.robot, crossing.here, *cell)
    after = crossing.here if isinstance(way, Turn) else crossing.next
    last = standing_pose(crossing.robot, after, *cell, float(upright[2]))
    if first is None:
        return "the robot cannot stand at the centre of the cell that it leaves"
    if last is None:
        return "the robot cannot stand at the centre of the cell that it enters"
    beyond = step_of(crossing)
    regions = free_regions(crossing) if limits.collision else ()
    return Problem(
        robot=crossing.robot,
        gait=NAMED[INITIAL_GAITS[0]],
        step_s=_STEP_S,
        start_m=first[0],
        start_rpy_rad=level,
        feet_m=first[1],
        goal_m=last[0] + beyond,
        goal_rpy_rad=upright,
        polygons=tuple(one for ground in _grounds(crossing) for one in ground),
        free_regions=regions,
        options=Options(gap=limits.gap, time_limit_s=_CLOCK * limits.time_limit_s + 1, collision=bool(regions)),
    )


def _grounds(crossing: Crossing) -> Iterator[tuple[Polygon, ...]]:
    """Yield the ground of both cells; for a turn there is one."""
    sideways = crossing.direction in (Direction.LEFT, Direction.RIGHT)
    places = [(crossing.here, np.zeros(3)), (crossing.next, step_of(crossing))]
    for ground, centre_m in places[:1] if isinstance(crossing.direction, Turn) else places:
        yield class_polygons(ground, crossing.cell_m, crossing.margin_m, centre_m, sideways=sideways)


def step_of(crossing: Crossing) -> Array:
    """Return the way from the centre of one cell to that of the next [m]; a turn stays where it is."""
    if isinstance(crossing.direction, Turn):
        return np.zeros(3)
    x, y = WAYS[crossing.direction]
    return np.array([crossing.cell_m * x, crossing.cell_m * y, crossing.rise_m])


@lru_cache(maxsize=256)
def standing_pose(
    robot: Quadruped, ground: GroundBlock, cell_m: float, margin_m: float, sideways: bool, yaw_rad: float = 0.0
) -> tuple[Array, Array] | None:
    """Return base position and feet of the pose nearest to the centre of a cell in which the robot can stand.

    Only the cell's own ground is stood on; None where that does not do.
    """
    upright, wished = np.array([0.0, 0.0, yaw_rad]), np.array([0.0, 0.0, -robot.foot_reference_m[2]])
    polygons = class_polygons(ground, cell_m, margin_m, np.zeros(3), sideways=sideways)
    found = retarget(
        Problem(
            robot=robot,
            gait=NAMED[INITIAL_GAITS[0]],
            step_s=_STEP_S,
            start_m=wished,
            start_rpy_rad=upright,
            feet_m=nominal_feet(robot, wished, upright),
            goal_m=wished,
            goal_rpy_rad=upright,
            polygons=polygons,
        )
    )
    return None if found.position_m is None or found.feet_m is None else (found.position_m, found.feet_m)


def free_regions(crossing: Crossing) -> tuple[tuple[Array, Array], ...]:
    """Return where feet may be about the edge between cells of different height: on its low side, or above it."""
    if abs(crossing.rise_m) < _STEP_EDGE_M or isinstance(crossing.direction, Turn):
        return ()
    way = np.array([*WAYS[crossing.direction], 0.0])
    lower = way if crossing.rise_m > 0 else -way
    edge = crossing.cell_m / 2 * np.sign(crossing.rise_m) - _EDGE_M
    above = (np.array([[0.0, 0.0, -1.0]]), np.array([-max(crossing.rise_m, 0.0)]))
    return (lower[None, :], np.array([edge])), above


def start_primitives(classes: ClassSet) -> tuple[Primitive, ...]:
    """Return what the first skills are looked for among: moves between classes that the set calls easy."""
    return tuple(Primitive(way, here, there) for here, there in classes.easy for way in Direction)


def all_primitives(classes: ClassSet) -> tuple[Primitive, ...]:
    """Return every primitive of a set: four directions times all pairs of classes."""
    return tuple(Primitive(way, here, there) for way in Direction for here in classes.names for there in classes.names)

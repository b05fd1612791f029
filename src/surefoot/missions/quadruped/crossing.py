"""The online program of one transition: re-targeting, then the gait-fixed program on the real polygons.

Source: Zhou et al. 2025, VII-A.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from surefoot.footholds import FreeGait, Gait, Options, Problem, Solution, retarget, retargeted, solve
from surefoot.footholds.gaits import NAMED
from surefoot.footholds.model import Choice
from surefoot.footholds.problem import Array
from surefoot.footholds.solve import no_plan
from surefoot.missions.quadruped.ground import ground_between
from surefoot.missions.quadruped.stance import STEP_S, Stance, heading_rpy_rad
from surefoot.missions.quadruped.world import World
from surefoot.robots.quadruped import Quadruped
from surefoot.skills.values import Cell

SETTLING = NAMED["trot-1s"]
"""The gait in which the robot steps in place."""
OTHER_GAITS: tuple[Gait | FreeGait, ...] = (
    NAMED["trot-2s"],
    NAMED["trot-2s-mirrored"],
    NAMED["trot-3s"],
    NAMED["trot-3s-mirrored"],
    NAMED["leap-1.5s"],
    NAMED["walk-2.25s"],
    FreeGait(2.0),
    FreeGait(3.0),
)
"""What is tried where the certificate's gait fails on the real polygons: the known gaits, and last any gait at all."""
LIMIT = "limit:"
"""Begins the reason of a program that was left open."""
_CANCELLED = "cancelled"


@dataclass(frozen=True, slots=True)
class OnlineLimits:
    """How hard an online program tries.

    Attributes:
        gap: relative gap at which the search for a better motion stops.
        time_limit_s: of one search, in processor time.
        better_s: how much of it is spent on better motions; after that any motion will do.
        collision: whether feet keep clear of the edges of steps.
        joint_reach: whether feet keep to where the legs reach with their joints' limits.
    """

    gap: float = 0.01
    time_limit_s: float = 5.0
    better_s: float = 0.5
    collision: bool = True
    joint_reach: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Certificate:
    """What a skill brings along from its offline plan.

    Attributes:
        gait: its contact modes.
        footholds_m: of every footstep, relative to the straight way of the base, in the robot's frame.
        regions: the free region of every foot and window; empty without.
    """

    gait: Gait
    footholds_m: Array
    regions: tuple[int, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Crossed:
    """The answer of an online program.

    Attributes:
        problem: the program; its goal is the re-targeted one.
        solution: its answer; None where there is no pose to end in.
        shift_m: how far the goal was moved.
        retarget_ms, solve_ms: processor times.
        clock_ms: of both together, by the clock.
        reason: why there is no motion; empty if there is one.
    """

    problem: Problem
    solution: Solution | None
    shift_m: float
    retarget_ms: float
    solve_ms: float
    clock_ms: float
    reason: str

    @property
    def infeasible(self) -> bool:
        """Whether it is proved that there is no motion."""
        return bool(self.reason) and not self.reason.startswith(LIMIT)

    @property
    def standing(self) -> bool:
        """Whether there is a pose to end in."""
        return self.solution is not None

    @property
    def refuted(self) -> bool:
        """Whether the program of the motion was solved, and has none: a pose to end in is not enough."""
        return self.infeasible and self.standing

    @property
    def outcome(self) -> str:
        """How the program ended, as run logs call it."""
        if not self.reason:
            return "feasible"
        return "limit" if not self.infeasible else "infeasible" if self.standing else "no pose"

    @property
    def binaries(self) -> int:
        """How many binary variables the program of the paper would have."""
        problem = self.problem
        windows = problem.options.collision_windows if problem.options.collision else 0
        return len(problem.footsteps) * len(problem.polygons) + 4 * windows * len(problem.free_regions)

    @property
    def continuous(self) -> int:
        """How many continuous variables it would have."""
        return 66 * self.problem.samples


def crossing(
    robot: Quadruped,
    world: World,
    stance: Stance,
    there: Cell,
    quarter_turns: int,
    gait: Gait | FreeGait,
    limits: OnlineLimits,
) -> Problem:
    """Return the program from where the robot stands to the centre of a cell, with a heading, before re-targeting."""
    ground = ground_between(world, stance.cell, there, stance.feet_m, collision=limits.collision)
    x, y = world.terrain.centre_m(there)
    goal = np.array([x, y, world.height_m(there) - robot.foot_reference_m[2]])
    return Problem(
        robot=robot,
        gait=gait,
        step_s=STEP_S,
        start_m=stance.base_m,
        start_rpy_rad=stance.rpy_rad,
        feet_m=stance.feet_m,
        goal_m=goal,
        goal_rpy_rad=heading_rpy_rad(quarter_turns),
        polygons=ground.polygons,
        free_regions=ground.free_regions,
        options=Options(
            gap=limits.gap,
            time_limit_s=20 * limits.time_limit_s,
            collision=bool(ground.free_regions),
            joint_reach=limits.joint_reach,
        ),
    )


def cross(problem: Problem, certificate: Certificate | None, limits: OnlineLimits) -> Crossed:
    """Re-target and solve: a motion on the real polygons, or why there is none.

    Args:
        problem: as ``crossing`` returns it.
        certificate: of the skill; None to try a gait that none is known for.
        limits: how hard to try.
    """
    begin, clock = time.process_time(), time.perf_counter()
    found = retarget(problem)
    retarget_ms = 1e3 * (time.process_time() - begin)
    done = partial(_crossed, retarget_ms=retarget_ms, clock=clock)
    if found.position_m is None:
        reason = "no pose near the centre of the cell is one that the robot can stand in"
        return done(
            problem, None, 0.0, 0.0, reason=reason if found.verdict == "infeasible" else f"{LIMIT} re-targeting"
        )
    problem = retargeted(problem, found)
    begin = time.process_time()
    problem = _with_gait(problem, limits)
    if isinstance(problem.gait, FreeGait):
        solve_ms = 1e3 * (time.process_time() - begin)
        return done(problem, no_plan("unknown", "none", None), 0.0, solve_ms, reason=f"{LIMIT} no gait was found")
    solution = _solved(problem, guesses(problem, certificate), limits)
    solve_ms = 1e3 * (time.process_time() - begin)
    reason = "" if solution.verdict == "feasible" else _reason(solution)
    return done(problem, solution, found.shift_m or 0.0, solve_ms, reason=reason)


def _with_gait(problem: Problem, limits: OnlineLimits) -> Problem:
    """Return a problem whose gait is to be found with one that works; as it is where there is none in time."""
    if not isinstance(problem.gait, FreeGait):
        return problem
    any_gait = replace(problem, options=replace(problem.options, first_plan=True, joint_reach=False))
    found = solve(any_gait, cancelled=_budget(limits.time_limit_s), certify=False, why=False).free
    return problem if found is None or found.gait is None else replace(problem, gait=found.gait)


def _solved(problem: Problem, tried_first: tuple[Choice, ...], limits: OnlineLimits) -> Solution:
    """Search for a good motion for a while, then for any motion, and last for a proof by the second method.

    The robot stands when the motion before ends, so that a good motion in time is worth more than the best one late.
    """
    better, spent = _budget(min(limits.better_s, limits.time_limit_s)), _budget(limits.time_limit_s)
    solution = solve(problem, cancelled=better, certify=False, why=False, guesses=tried_first)
    if solution.verdict == "unknown" and solution.limit == _CANCELLED and not spent():
        any_motion = replace(problem, options=replace(problem.options, first_plan=True))
        solution = solve(any_motion, cancelled=spent, certify=False, why=False)
    if solution.verdict == "unknown" and not spent():
        solution = solve(problem, cancelled=spent, why=False)
    return solution


def _budget(cpu_s: float) -> Callable[[], bool]:
    """Return what tells whether so much processor time has gone since it was asked first.

    What is compiled or imported before the first program counts for no search.
    """
    ends: list[float] = []

    def spent() -> bool:
        if not ends:
            ends.append(time.process_time() + cpu_s)
        return time.process_time() >= ends[0]

    return spent


def _crossed(
    problem: Problem,
    solution: Solution | None,
    shift_m: float,
    solve_ms: float,
    *,
    reason: str,
    retarget_ms: float,
    clock: float,
) -> Crossed:
    return Crossed(problem, solution, shift_m, retarget_ms, solve_ms, 1e3 * (time.perf_counter() - clock), reason)


def _reason(solution: Solution) -> str:
    if solution.verdict == "infeasible":
        return f"the program is infeasible on the real polygons ({solution.certificate})"
    return f"{LIMIT} {solution.limit or 'no answer'}"


def guesses(problem: Problem, certificate: Certificate | None) -> tuple[Choice, ...]:
    """Return the polygons nearest to where the skill's own plan stepped; none where its gait is another one."""
    steps = problem.footsteps
    if certificate is None or len(certificate.footholds_m) != len(steps):
        return ()
    last = problem.samples - 1
    nearest = []
    for step, foothold in zip(steps, certificate.footholds_m, strict=True):
        part = step.touch / last
        base = problem.start_m + part * (problem.goal_m - problem.start_m)
        nearest.append((_nearest(problem, base + problem.rotations[step.touch] @ foothold),))
    regions = _regions(problem, certificate.regions)
    return () if regions is None else ((*nearest, *regions),)


def _regions(problem: Problem, regions: Sequence[int]) -> tuple[tuple[int, ...], ...] | None:
    if not problem.options.collision:
        return ()
    if len(regions) != 4 * problem.options.collision_windows or len(problem.free_regions) != 2:
        return None
    return tuple((region,) for region in regions)


def _nearest(problem: Problem, place_m: Array) -> int:
    spans = [float(np.linalg.norm(one.nearest(place_m) - place_m)) for one in problem.polygons]
    return int(np.argmin(spans))

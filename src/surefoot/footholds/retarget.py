"""Re-targeting: the feasible standing pose nearest to a wished one, before the whole program is solved (VII-A1).

A kinematic program: base position, four feet each on one polygon, forces that carry the weight within friction and
torque, all below the rows of Eqs. (6)-(11), (14) and (16). "The base above the support polygon" of unknown feet is
bilinear; here the base keeps near the mean of the feet, which is linear and lies in it.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from surefoot.footholds.gaits import Gait
from surefoot.footholds.leg_reach import leg_cuts
from surefoot.footholds.model import INF, Choice
from surefoot.footholds.nodes import Node
from surefoot.footholds.problem import Array, Problem, nominal_feet
from surefoot.footholds.qp import solve_qp
from surefoot.footholds.rows import FAMILIES, Cost, CostBuilder, Quantity, RowBuilder, Rows, stacked
from surefoot.footholds.search import search
from surefoot.footholds.terrain import cone_hull, hull_of
from surefoot.robots.quadruped import FOOT_NAMES

SHIFT_MAX_M = (0.15, 0.10, 0.10)
NEAR_MEAN_M = 0.05
_SLACK_M = 1e-6
_DEMANDS = {
    "support": "the base near the goal and the mean of the feet",
    "reach": "all feet within reach of one base",
    "friction": "friction",
    "torque": "torque",
}
_FOOT_WEIGHT, _FORCE_WEIGHT = 1.0, 1e-5
_FEET = np.arange(3, 15).reshape(4, 3)
_FORCES = np.arange(15, 27).reshape(4, 3)
_BASE, _STANDING_FEET, _STANDING_FORCES = (Quantity.unknown(index) for index in (np.arange(3), _FEET, _FORCES))


@dataclass(frozen=True, slots=True, eq=False)
class Retargeted:
    """A pose to stand in.

    Attributes:
        verdict: ``feasible``, ``infeasible`` or ``unknown``.
        position_m: of the base; None without a pose.
        feet_m: shape (4, 3); None without a pose.
        polygons: of the four feet.
        shift_m: distance from the wished position.
        solve_ms: what it took, without finding a reason.
        reason: why there is no pose, or why that is not known; empty with a pose.
    """

    verdict: str
    position_m: Array | None
    feet_m: Array | None
    polygons: tuple[int, ...]
    shift_m: float | None
    solve_ms: float
    reason: str = ""


def retarget(problem: Problem, *, why: bool = False) -> Retargeted:
    """Return the feasible standing pose nearest to the goal of a problem, with the goal's orientation.

    Args:
        problem: its goal and its terrain.
        why: whether to look for the demand that is in the way where there is no pose.
    """
    begin = time.perf_counter()
    end = begin + problem.options.time_limit_s
    standing = _standing(problem)
    program, root = StandingProgram(standing), _in_reach(standing)
    if not all(root):
        elapsed_ms = (time.perf_counter() - begin) * 1e3
        return Retargeted("infeasible", None, None, (), None, elapsed_ms, _out_of_reach(standing))

    def stop() -> bool:
        return time.perf_counter() > end

    outcome = search(standing, program, root, gap=1e-6, stop=stop)
    elapsed_ms = (time.perf_counter() - begin) * 1e3
    if outcome.best is None or outcome.node is None:
        if not outcome.complete:
            return Retargeted("unknown", None, None, (), None, elapsed_ms, "the time limit was reached")
        reason = _contradiction(standing, root, stop) if why else "no pose meets all demands"
        return Retargeted("infeasible", None, None, (), None, elapsed_ms, reason)
    unknowns = outcome.node.answer.unknowns
    position = unknowns[:3]
    shift = float(np.linalg.norm(position - problem.goal_m))
    ids = tuple(left[0] for left in outcome.best)
    return Retargeted("feasible", position, unknowns[_FEET], ids, shift, elapsed_ms)


def retargeted(problem: Problem, found: Retargeted) -> Problem:
    """Return a problem with the goal moved to a pose that was found; it is no longer that of its file."""
    assert found.position_m is not None
    return replace(problem, goal_m=found.position_m, source=None)


def _standing(problem: Problem) -> Problem:
    """Return a problem of one step per foot that ends in the goal: what the search needs to know of polygons."""
    dt = problem.step_s
    gait = Gait(("STANCE", "FLY", "STANCE"), (0.0, dt, 3 * dt, 4 * dt))
    options = replace(problem.options, collision=False, moment_balance=False)
    return replace(
        problem, gait=gait, options=options, start_m=problem.goal_m, start_rpy_rad=problem.goal_rpy_rad, free_regions=()
    )


def _in_reach(standing: Problem) -> Choice:
    """Return for every foot the polygons that meet the box in which it can be, wherever the base may be moved to."""
    meets: NDArray[np.bool_] = np.all(_beyond_m(standing) <= _SLACK_M, axis=2)
    return tuple(tuple(map(int, np.flatnonzero(meets[step.foot]))) for step in standing.footsteps)


def _beyond_m(standing: Problem) -> Array:
    """Return by how much every polygon is beyond the box of every foot, shape (4, polygons, 3)."""
    wished = nominal_feet(standing.robot, standing.goal_m, standing.goal_rpy_rad)[:, None]
    around = np.abs(standing.rotations[-1]) @ np.array(standing.robot.foot_reach_m) + np.array(SHIFT_MAX_M)
    low = np.array([one.vertices_m.min(axis=0) for one in standing.polygons]) - around
    high = np.array([one.vertices_m.max(axis=0) for one in standing.polygons]) + around
    beyond: Array = np.maximum(np.maximum(low - wished, wished - high), 0.0)
    return beyond


def _out_of_reach(standing: Problem) -> str:
    """Return which feet find no polygon, and how far away the nearest is from what they reach."""
    away_m = np.linalg.norm(_beyond_m(standing), axis=2).min(axis=1)
    short = [f"{name} by {away_m[j] * 100:.3g} cm" for j, name in enumerate(FOOT_NAMES) if away_m[j] > _SLACK_M]
    return f"no polygon is within reach, wherever the base may be moved to: {', '.join(short)}"


def _contradiction(standing: Problem, root: Choice, stop: Callable[[], bool]) -> str:
    """Return which demands, if one of them were dropped, would leave a pose to stand in."""
    freed = [said for family, said in _DEMANDS.items() if _stands_without(standing, root, family, stop)]
    found = f"one is found without {', or without '.join(freed)}" if freed else "more than one of them would have to go"
    return f"every foot finds a polygon, but no pose meets all demands ({'; '.join(_DEMANDS.values())}): {found}"


def _stands_without(standing: Problem, root: Choice, family: str, stop: Callable[[], bool]) -> bool:
    return search(standing, StandingProgram(standing, without=family), root, gap=0.5, stop=stop).best is not None


class StandingProgram:
    """The program of the search: one pose.

    Args:
        problem: as ``_standing`` returns it; its start and goal are the wished pose.
        without: a family of rows that is left out, to find out whether it is in the way.
    """

    def __init__(self, problem: Problem, without: str = "") -> None:
        self.problem, self.without = problem, without
        build = CostBuilder(27)
        wished = nominal_feet(problem.robot, problem.goal_m, problem.goal_rpy_rad)
        build.add(problem.weights.position, [(1.0, Quantity.unknown(np.arange(3)))], problem.goal_m)
        build.add(_FOOT_WEIGHT, [(1.0, Quantity.unknown(_FEET))], wished)
        build.add(_FORCE_WEIGHT, [(1.0, Quantity.unknown(_FORCES))], 0.0)
        self.cost: Cost = build.cost()
        self.fixed = self._ungrounded()

    def rows(self, choice: Choice) -> Rows:
        """Return the rows for what a choice leaves open."""
        rows = stacked((self.fixed, self._grounded(choice)))
        return rows.pick(rows.family != FAMILIES.index(self.without)) if self.without else rows

    def _ungrounded(self) -> Rows:
        """Return the rows that no choice changes."""
        problem, build = self.problem, RowBuilder(27)
        base, feet, forces = _BASE, _STANDING_FEET, _STANDING_FORCES
        shift = np.array(SHIFT_MAX_M)
        build.add("support", problem.goal_m - shift, problem.goal_m + shift, [(1.0, base)])
        mean = [(-0.25, feet[foot, :2]) for foot in range(4)]
        build.add("support", -NEAR_MEAN_M, NEAR_MEAN_M, [(1.0, base[:2]), *mean])
        weight = np.array([0.0, 0.0, problem.robot.mass_kg * problem.gravity_mps2])
        build.add("dynamics", weight, weight, [(1.0, forces[foot]) for foot in range(4)])
        turn, reach = problem.rotations[-1], np.array(problem.robot.foot_reach_m)
        limit = np.array(problem.robot.torque_max_nm)
        for foot in range(4):
            nominal, arm = np.array(problem.robot.feet_m[foot]), np.array(problem.robot.jacobians[foot])
            terms = [(turn[b], feet[foot, b][None]) for b in range(3)]
            terms += [(-turn[b], base[b][None]) for b in range(3)]
            build.add("reach", nominal - reach, nominal + reach, terms)
            if problem.options.joint_reach:
                normals, bounds = (part[foot] for part in leg_cuts(problem.robot))
                turned = normals @ turn.T
                places = [(turned[:, b], feet[foot, b][None]) for b in range(3)]
                build.add("leg", -INF, bounds, [*places, *((-turned[:, b], base[b][None]) for b in range(3))])
            build.add("torque", -limit, limit, [(arm[a], forces[foot, a][None]) for a in range(3)])
        return build.rows()

    def _grounded(self, choice: Choice) -> Rows:
        """Return the rows that keep feet and forces to the polygons left."""
        problem, build = self.problem, RowBuilder(27)
        feet, forces = _STANDING_FEET, _STANDING_FORCES
        for number, step in enumerate(problem.footsteps):
            foot = step.foot
            ground = [problem.polygons[r] for r in choice[number]]
            hull, cone = hull_of(ground), cone_hull(ground)
            build.add("region", -INF, hull.bounds, [(hull.planes[:, a], feet[foot, a][None]) for a in range(3)])
            if hull.normal is not None:
                build.add("region", hull.offset, hull.offset, [(hull.normal[a], feet[foot, a][None]) for a in range(3)])
            build.add("friction", -INF, 0.0, [(cone[:, a], forces[foot, a][None]) for a in range(3)])
        return build.rows()

    def solve(self, choice: Choice) -> Node:
        """Solve the program; the feet stand where they are at the last sample."""
        rows = self.rows(choice)
        answer = solve_qp(self.cost, rows)
        return Node(rows, answer, np.broadcast_to(answer.unknowns[_FEET], (4, 4, 3)))

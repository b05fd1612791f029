"""Why no gait is feasible: the least that has to give in relaxations of the program, so that no less will do.

Three questions, the first of which is answered: does every foot find ground at the goal, can the base be turned in
time, and by how much would the skeleton's rows of reach, friction and force limits have to give (L1)? Then the least
horizon is sought at which the skeleton is feasible.
"""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from surefoot.footholds.cells import MOST_CELLS, cell_count
from surefoot.footholds.explain import Explanation, Lack, in_digits, linear_form
from surefoot.footholds.gaits import FreeGait
from surefoot.footholds.problem import Problem
from surefoot.footholds.reduction import at_rest, differences
from surefoot.footholds.rows import FAMILIES, Array, Quantity, RowBuilder, stacked
from surefoot.footholds.skeleton import skeleton
from surefoot.footholds.solvers import run_highs
from surefoot.robots.quadruped import FOOT_NAMES

_AXES = ("lengthwise", "sideways", "in height")
_WAYS = ("forwards", "backwards", "to the left", "to the right", "upwards", "downwards")
_FORCE_WEIGHT = 0.003
_GAP = 1e-3
_SLACKS = 10
_SHOWN = 1e-6
_LONGEST = 3.0
_HORIZON_S = 5.0
_NONE = np.zeros(0, dtype=np.int64)


def explain_free(problem: Problem, time_limit_s: float = 3.0) -> Explanation | None:
    """Return what every gait lacks at least, or None when that is not found in time."""
    lacks = unreached_goal(problem) or _turned_too_fast(problem, time_limit_s)
    if not lacks:
        lacks = _skeleton_lacks(problem, time_limit_s)
        if lacks:
            lacks += _longer(problem)
    if not lacks:
        return None
    return Explanation(tuple(lacks), (), "; ".join(lack.text for lack in lacks[:4]))


def unreached_goal(problem: Problem) -> list[Lack]:
    """Return the feet that find no polygon within reach of the goal pose, in which all four stand."""
    found, turn = [], problem.rotations[-1]
    for foot, name in enumerate(FOOT_NAMES):
        nominal = problem.goal_m + problem.levers_m[-1, foot]
        short = [_beyond(problem, one.vertices_m, nominal, turn) for one in problem.polygons]
        worst = min(short, key=lambda amounts: float(amounts.max()))
        axis = int(worst.argmax())
        if worst[axis] > _SHOWN:
            much = f"{_cm(worst[axis])} {_AXES[axis]}"
            text = f"no gait reaches the goal: {name} foot finds no polygon there, short by {much}"
            found.append(Lack("reach", name, 0, float(worst[axis]), "m", text))
    return sorted(found, key=lambda lack: -lack.amount)


def _beyond(problem: Problem, corners_m: Array, nominal_m: Array, turn: Array) -> Array:
    """Return by how much a polygon's extent is beyond the reach box, along the axes of the base."""
    seen = (corners_m - nominal_m) @ turn
    away = np.maximum(seen.min(axis=0), -seen.max(axis=0))
    beyond: Array = np.maximum(away - np.array(problem.robot.foot_reach_m), 0.0)
    return beyond


def _turned_too_fast(problem: Problem, time_limit_s: float) -> list[Lack]:
    """Return the least torque that turns the base in time, where the limit does not."""
    if problem.options.moment_balance or not np.abs(problem.goal_rpy_rad - problem.start_rpy_rad).any():
        return []
    angle, count = at_rest(problem.samples, problem.start_rpy_rad, problem.goal_rpy_rad)
    inertia, build = np.array(problem.robot.inertia_kgm2), RowBuilder(count + 1)
    torque = [(factor * inertia, quantity) for factor, quantity in differences(angle, problem.step_s)]
    most = Quantity.unknown(np.array([[count]]))
    for sign in (1.0, -1.0):
        build.add("base torque", -np.inf, 0.0, [*((sign * factor, q) for factor, q in torque), (-1.0, most)])
    status, unknowns = run_highs(linear_form(build.rows(), _NONE), np.eye(count + 1)[-1], time_limit_s)
    short = 0.0 if not status or unknowns is None else float(unknowns[-1]) - problem.robot.base_torque_max_nm
    if short <= _SHOWN:
        return []
    text = (
        f"no gait turns the base in {problem.gait.horizon_s:g} s: that takes {in_digits(short, 3)} N m more than the "
        f"{problem.robot.base_torque_max_nm:g} N m that the model allows"
    )
    return [Lack("base torque", "", 0, short, "N m", text)]


def _skeleton_lacks(problem: Problem, time_limit_s: float) -> list[Lack]:
    """Return the smallest relaxation of the skeleton: reach along each axis, force each way, friction."""
    form, begin = skeleton(problem), time.monotonic()
    rows = form.rows
    groups = np.full(len(rows.lower), -1)
    for family, first, column in (("reach", 0, 1), ("torque", 3, 1), ("friction", 9, 3)):
        chosen = rows.family == FAMILIES.index(family)
        groups[chosen] = first + rows.where[chosen, column]
    given, size = np.flatnonzero(groups >= 0), rows.matrix.shape[1]
    signs = np.where(np.isfinite(rows.upper[given]), -1.0, 1.0)
    slack = sp.csr_matrix((signs, (given, groups[given])), shape=(len(groups), _SLACKS))
    build = RowBuilder(size + _SLACKS)
    build.add("reach", 0.0, np.inf, [(1.0, Quantity.unknown(np.arange(size, size + _SLACKS)))])
    elastic = stacked([replace(rows, matrix=sp.csr_matrix(sp.hstack([rows.matrix, slack]))), build.rows()])
    weights = np.concatenate([np.zeros(size), np.ones(3), np.full(7, _FORCE_WEIGHT)])
    status, unknowns = run_highs(linear_form(elastic, form.binaries), weights, time_limit_s, gap=_GAP)
    if not status or unknowns is None or time.monotonic() - begin > time_limit_s:
        return []
    return [_lack(place, float(amount)) for place, amount in enumerate(unknowns[size:]) if amount > _SHOWN]


def _lack(place: int, amount: float) -> Lack:
    if place < 3:
        much = f"{_cm(amount)} {_AXES[place]}"
        text = f"no gait: the base passes where no foot reaches any polygon, short by {much}"
        return Lack("reach", "", 0, amount, "m", text)
    if place < 9:
        text = f"no gait: four legs push {in_digits(amount, 3)} N too little {_WAYS[place - 3]}"
        return Lack("torque", "", 0, amount, "N", text)
    return Lack("friction", "", 0, amount, "N", f"no gait: friction holds {in_digits(amount, 3)} N too little")


def _longer(problem: Problem) -> list[Lack]:
    """Return how much longer the horizon has to be at least, as far as the skeleton knows."""
    count, end = cell_count(problem), time.monotonic() + _HORIZON_S
    cell_s = problem.options.cell_s
    for more in range(1, min(int(_LONGEST * count), MOST_CELLS) - count + 1):
        longer = replace(problem, gait=FreeGait(problem.gait.horizon_s + more * cell_s))
        form = skeleton(longer)
        feasible = run_highs(form, np.zeros(len(form.cost.linear)), max(end - time.monotonic(), 0.01))[0]
        if feasible is False:
            continue
        if feasible is None and more == 1:
            return []
        amount = more * cell_s
        text = f"a horizon of less than {problem.gait.horizon_s + amount:g} s is too short for any gait"
        return [Lack("horizon", "", 0, amount, "s", text)]
    return []


def _cm(amount_m: float) -> str:
    return f"{in_digits(amount_m * 100, 3)} cm"

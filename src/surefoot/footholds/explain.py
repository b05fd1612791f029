"""Why a problem is infeasible: the least that has to give, by family, foot, footstep and metres or newtons.

Two elastic programs. The first takes positions only and chooses polygons: rows of reach, clearance, support and
collision may give, one slack for all samples of a foot's step, and the sum of the slacks is least (L1). Where nothing
has to give there, the polygons that it chose are kept, forces come in, and friction and torque may give too.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from surefoot.footholds.form import StandardForm, collision_implications, region_implications
from surefoot.footholds.model import (
    INF,
    Choice,
    Motion,
    clearance_rows,
    collision_rows,
    dynamics_rows,
    friction_rows,
    leg_rows,
    reach_rows,
    region_rows,
    support_rows,
    torque_rows,
)
from surefoot.footholds.problem import Problem
from surefoot.footholds.reduction import reduced_motion
from surefoot.footholds.rows import FAMILIES, Cost, Index, Quantity, RowBuilder, Rows
from surefoot.footholds.solvers import run_highs
from surefoot.robots.quadruped import FOOT_NAMES

_UNITS = {
    "reach": "m",
    "leg": "m",
    "clearance": "m",
    "support": "m",
    "collision": "m",
    "friction": "N",
    "torque": "N m",
}
_WEIGHTS = {
    "reach": 1.0,
    "leg": 1.0,
    "clearance": 1.0,
    "support": 1.0,
    "collision": 1.0,
    "friction": 0.01,
    "torque": 0.03,
}
_SHOWN = 1e-7
_AXES = ("lengthwise", "sideways", "in height")
_JOINTS = ("hip abduction", "hip pitch", "knee")


@dataclass(frozen=True, slots=True)
class Lack:
    """One thing that has to give.

    Attributes:
        family: of the rows.
        foot: name of the foot, or empty for the base.
        step: the how-manieth footstep of that foot, from 1; 0 for its first stance.
        amount: by how much.
        unit: of the amount.
        text: the same for a person.
    """

    family: str
    foot: str
    step: int
    amount: float
    unit: str
    text: str


@dataclass(frozen=True, slots=True)
class Explanation:
    """The least that has to give for the problem to become feasible.

    Attributes:
        lacks: largest first.
        polygons: of every footstep, in the motion that lacks least.
        text: for a person.
    """

    lacks: tuple[Lack, ...]
    polygons: tuple[int, ...]
    text: str


def explain(problem: Problem, time_limit_s: float = 5.0) -> Explanation | None:
    """Return the smallest relaxation that makes a problem feasible, or None when it is not found in time."""
    falls = _falls(problem)
    if falls is not None:
        return falls
    found = _positions(problem, time_limit_s)
    if found is None:
        return None
    choice, lacks = found
    if not lacks:
        forced = _forces(problem, choice, time_limit_s)
        if forced is None:
            return None
        lacks = forced
    text = "; ".join(lack.text for lack in lacks[:4]) or "nothing has to give by more than the solver's tolerance"
    steps = len(problem.footsteps)
    return Explanation(tuple(lacks), tuple(left[0] for left in choice[:steps]), text)


def _falls(problem: Problem) -> Explanation | None:
    """Return that no foot ever carries the base, which then cannot be at rest in the end; None where one does.

    Rows of the ends and of Newton contradict each other then, and no slack on other rows helps.
    """
    if problem.contacts[1:].any():
        return None
    text = "no foot is in contact after the first sample, so that the base falls and cannot be at rest in the end"
    lasts_s = (problem.samples - 1) * problem.step_s
    return Explanation((Lack("dynamics", "", 0, lasts_s, "s", text),), (), text)


def _positions(problem: Problem, time_limit_s: float) -> tuple[Choice, list[Lack]] | None:
    motion = reduced_motion(problem, forces=False)
    elastic = _built(motion, [reach_rows, leg_rows, clearance_rows, support_rows], problem)
    steps, polygons = len(problem.footsteps), len(problem.polygons)
    regions = len(problem.free_regions) if problem.options.collision else 0
    windows = problem.windows() if regions else ()
    binaries = steps * polygons + 4 * len(windows) * regions
    groups, names = np.unique(_groups(problem, elastic), axis=0, return_inverse=True)
    first_slack = motion.size + binaries
    collision_slack = first_slack + len(groups)
    size = collision_slack + 4 * len(windows)
    build = RowBuilder(size)
    _add_elastic(build, elastic, Quantity.unknown(first_slack + names.ravel()))
    dynamics_rows(build, problem, motion)
    chosen = Quantity.unknown(np.arange(motion.size, motion.size + steps * polygons).reshape(steps, polygons))
    for step in range(steps):
        build.add("region", 1.0, 1.0, [(1.0, chosen[step, r][None]) for r in range(polygons)])
    region_implications(build, problem, motion.feet, chosen)
    if windows:
        first = motion.size + steps * polygons
        free = Quantity.unknown(np.arange(first, first_slack).reshape(4, len(windows), regions))
        build.add("collision", 1.0, 1.0, [(1.0, free[:, :, s]) for s in range(regions)])
        slack = Quantity.unknown(np.arange(collision_slack, size).reshape(4, len(windows)))
        collision_implications(build, problem, motion.feet, free, slack)
    slacks = Quantity.unknown(np.arange(first_slack, size))
    build.add("reach", 0.0, INF, [(1.0, slacks)])
    rows = _used(build.rows())
    weights = np.zeros(size)
    weights[first_slack:] = 1.0
    status, unknowns = run_highs(
        linear_form(rows, np.arange(motion.size, first_slack)), weights, time_limit_s, gap=1e-3
    )
    if not status or unknowns is None:
        return None
    picks = [int(unknowns[chosen.index[step]].argmax()) for step in range(steps)]
    choice: Choice = tuple((r,) for r in picks)
    if windows:
        choice += tuple((int(s),) for s in unknowns[free.index].argmax(axis=2).ravel())
    lacks = _lacks(problem, groups, unknowns[first_slack:collision_slack])
    for number, amount in enumerate(unknowns[collision_slack:]):
        if amount > _SHOWN:
            foot, window = divmod(number, len(windows))
            lacks.append(_lack("collision", FOOT_NAMES[foot], window, float(amount), f"window {window}, free region"))
    return choice, sorted(lacks, key=lambda lack: -lack.amount)


def _forces(problem: Problem, choice: Choice, time_limit_s: float) -> list[Lack] | None:
    motion = reduced_motion(problem, forces=True)

    def friction(build: RowBuilder, problem: Problem, motion: Motion) -> None:
        friction_rows(build, problem, motion, choice)

    elastic = _built(motion, [reach_rows, leg_rows, clearance_rows, support_rows, torque_rows, friction], problem)
    groups, names = np.unique(_groups(problem, elastic), axis=0, return_inverse=True)
    size = motion.size + len(groups)
    build = RowBuilder(size)
    _add_elastic(build, elastic, Quantity.unknown(motion.size + names.ravel()))
    dynamics_rows(build, problem, motion)
    region_rows(build, problem, motion, choice)
    collision_rows(build, problem, motion, choice)
    build.add("reach", 0.0, INF, [(1.0, Quantity.unknown(np.arange(motion.size, size)))])
    weights = np.zeros(size)
    weights[motion.size :] = [_WEIGHTS[FAMILIES[family]] for family in groups[:, 0]]
    none = np.zeros(0, dtype=np.int64)
    status, unknowns = run_highs(linear_form(_used(build.rows()), none), weights, time_limit_s)
    if not status or unknowns is None:
        return None
    lacks = _lacks(problem, groups, unknowns[motion.size :])
    return sorted(lacks, key=lambda lack: -lack.amount * _WEIGHTS[lack.family])


def _built(motion: Motion, blocks: list[Callable[[RowBuilder, Problem, Motion], None]], problem: Problem) -> Rows:
    build = RowBuilder(motion.size)
    for block in blocks:
        block(build, problem, motion)
    return _used(build.rows())


def _used(rows: Rows) -> Rows:
    return rows.pick(np.diff(rows.matrix.indptr) > 0)


def linear_form(rows: Rows, binaries: Index) -> StandardForm:
    """Return a form without a cost."""
    size = rows.matrix.shape[1]
    return StandardForm(Cost(sp.csc_matrix((size, size)), np.zeros(size), 0.0, np.zeros(size)), rows, binaries)


def _groups(problem: Problem, rows: Rows) -> Index:
    """Return family, foot, footstep (0 for the first stance), axis of every row; one slack stands for each group."""
    where = rows.where
    foot = np.where(rows.family == FAMILIES.index("support"), -1, where[:, 1])
    step = np.zeros(len(where), dtype=np.int64)
    axis = where[:, 2].copy()
    clearance = rows.family == FAMILIES.index("clearance")
    for k in np.flatnonzero(clearance):
        footstep = problem.footsteps[where[k, 1]]
        foot[k], step[k], axis[k] = footstep.foot, footstep.step + 1, 0
    friction = rows.family == FAMILIES.index("friction")
    axis[friction | (rows.family == FAMILIES.index("leg"))] = 0
    starts = [[s.lift for s in problem.footsteps if s.foot == j] for j in range(4)]
    other = ~clearance & (foot >= 0)
    step[other] = [
        int(np.searchsorted(starts[j], i, side="right")) for i, j in zip(where[other, 0], foot[other], strict=True)
    ]
    support = rows.family == FAMILIES.index("support")
    axis[support] = where[support, 1]
    return np.stack([rows.family, foot, step, axis], axis=1)


def _add_elastic(build: RowBuilder, rows: Rows, slack: Quantity) -> None:
    """Add rows that a slack lets give to either side."""
    entries = rows.matrix.tocoo()
    for sign, limits in ((1.0, rows.upper), (-1.0, rows.lower)):
        kept = np.flatnonzero(np.isfinite(limits))
        place = np.full(len(limits), -1)
        place[kept] = np.arange(len(kept))
        chosen = place[entries.row] >= 0
        build.splice(
            rows=place[entries.row[chosen]],
            columns=entries.col[chosen],
            values=sign * entries.data[chosen],
            slack=slack.index[kept],
            upper=sign * limits[kept],
        )


def _lacks(problem: Problem, groups: Index, amounts: np.ndarray) -> list[Lack]:
    found = []
    for (family, foot, step, axis), amount in zip(groups, amounts, strict=True):
        if amount > _SHOWN:
            name = FAMILIES[family]
            how = {"reach": _AXES, "torque": _JOINTS, "support": _AXES}.get(name)
            detail = "" if how is None else how[axis]
            found.append(_lack(name, "" if foot < 0 else FOOT_NAMES[foot], int(step), float(amount), detail))
    return found


def _lack(family: str, foot: str, step: int, amount: float, detail: str) -> Lack:
    unit = _UNITS[family]
    much = (
        f"{in_digits(amount * 100, 2)} cm"
        if unit == "m" and amount >= 1e-3
        else f"{in_digits(amount * 1000, 2)} mm"
        if unit == "m"
        else f"{in_digits(amount, 3)} {unit}"
    )
    whose = f"{foot} foot, " + (f"step {step}, " if step else "first stance, ") if foot else "base, "
    return Lack(family, foot, step, amount, unit, f"{whose}{family} short by {much}" + (f" {detail}" if detail else ""))


def in_digits(value: float, digits: int) -> str:
    """Return a number with so many digits, or as a whole number where it has more before the point."""
    return f"{value:.{digits}g}" if value < 10**digits - 0.5 else f"{value:.0f}"

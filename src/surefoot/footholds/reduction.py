"""The exact reduction: what the equations of the model pin or tie is substituted, and only positions remain.

* Velocities and accelerations are differences of positions (backward Euler), so they are no unknowns.
* A foot does not move in stance, and reaches its foothold at the last swing sample: one unknown point per footstep.
* Both ends are at rest, which pins two samples of the base at the end.
* Forces that are shared equally cost least; while friction and torque stay slack, they need no unknowns. Otherwise the
  forces of the feet in contact are kept (``forces``).
* The orientation is coupled to nothing (the paper's forces exert no moment), and is solved apart (see ``orientation``).
"""

from __future__ import annotations

import numpy as np

from surefoot.footholds.model import Motion
from surefoot.footholds.problem import Problem
from surefoot.footholds.rows import Array, Index, Quantity, Term


def reduced_motion(problem: Problem, *, forces: bool) -> Motion:
    """Return the motion whose unknowns are base positions, swing points and footholds, and forces if wanted."""
    base, acceleration, count = base_motion(problem)
    legs = []
    for foot in range(4):
        legs.append(_leg(problem, foot, count, forces=forces))
        count += leg_size(problem, foot, forces=forces)
    feet, force = (_stacked([leg[part] for leg in legs]) for part in (0, 1))
    return Motion(
        size=count,
        base=base,
        base_acceleration=acceleration,
        feet=feet,
        feet_acceleration=differences(feet, problem.step_s),
        force=force if forces else None,
    )


def _stacked(legs: list[tuple[Index, Array]]) -> Quantity:
    return Quantity(np.stack([index for index, _ in legs], axis=1), np.stack([value for _, value in legs], axis=1))


def base_motion(problem: Problem) -> tuple[Quantity, tuple[Term, ...], int]:
    """Return r, the terms whose sum is rdd, and how many unknowns these have.

    rdd is the second difference of r, and at sample 0 an unknown of its own, which only the cost and Newton see.
    """
    base, count = at_rest(problem.samples, problem.start_m, problem.goal_m)
    first = np.broadcast_to(np.arange(count, count + 3), base.index.shape)
    alone = np.zeros((problem.samples, 1))
    alone[0] = 1.0
    terms = (*differences(base, problem.step_s), (alone, Quantity.unknown(first.copy())))
    return base, terms, count + 3


def at_rest(size: int, start: Array, goal: Array) -> tuple[Quantity, int]:
    """Return a path of three numbers that is at rest at both ends: known at the first and the last two samples."""
    index = np.full((size, 3), -1, dtype=np.int64)
    value = np.zeros((size, 3))
    value[0], value[-2:] = start, goal
    free = max(size - 3, 0)
    index[1 : size - 2] = np.arange(3 * free).reshape(free, 3)
    return Quantity(index, value), 3 * free


def leg_size(problem: Problem, foot: int, *, forces: bool) -> int:
    """Return how many unknowns a foot has: a point per swing sample, and a force per stance sample if wanted."""
    held = int(problem.contacts[:, foot].sum())
    return 3 * (problem.samples - held + (held if forces else 0))


def _leg(problem: Problem, foot: int, count: int, *, forces: bool) -> tuple[tuple[Index, Array], tuple[Index, Array]]:
    """Return places and known numbers of a foot's positions and of its forces.

    There is one unknown point per sample of a swing; the last of them is the foothold, at which the foot stays.
    """
    held, axes = problem.contacts[:, foot], np.arange(3)
    known = np.zeros((problem.samples, 3))
    since = np.maximum.accumulate(np.where(held, -1, np.arange(problem.samples)))
    swung = count + 3 * (np.cumsum(~held) - 1)
    index = np.where(since[:, None] >= 0, swung[since][:, None] + axes, -1)
    pushed = count + 3 * (int((~held).sum()) + np.cumsum(held) - 1)
    force = np.where(held[:, None] & forces, pushed[:, None] + axes, -1)
    return (index, np.where(since[:, None] >= 0, known, problem.feet_m[foot])), (force, known)


def differences(position: Quantity, step_s: float) -> tuple[Term, ...]:
    """Return the second differences of a position that is at rest at sample 0; nothing at sample 0."""
    size = len(position.index)
    shape = (size,) + (1,) * (position.index.ndim - 1)
    rate = np.full(shape, step_s**-2)
    rate[0] = 0.0
    before = np.where(np.arange(size) > 1, 1.0, 0.0).reshape(shape)
    now, last = np.arange(size), np.maximum(np.arange(size) - 1, 0)
    earlier = np.maximum(np.arange(size) - 2, 0)
    return (
        (rate, position[now]),
        (-rate * (1 + before), position[last]),
        (rate * before, position[earlier]),
    )

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
from surefoot.footholds.rows import Array, Quantity, Term


def reduced_motion(problem: Problem, *, forces: bool) -> Motion:
    """Return the motion whose unknowns are base positions, swing points and footholds, and forces if wanted."""
    base, count = at_rest(problem.samples, problem.start_m, problem.goal_m)
    first = Quantity.unknown(np.arange(count, count + 3))
    feet, count = _feet(problem, count + 3)
    force = None
    if forces:
        index = np.full((problem.samples, 4, 3), -1, dtype=np.int64)
        held = int(problem.contacts.sum())
        index[problem.contacts] = np.arange(count, count + 3 * held).reshape(held, 3)
        force, count = Quantity(index, np.zeros(index.shape)), count + 3 * held
    return Motion(
        size=count,
        base=base,
        base_acceleration=_base_acceleration(problem, base, first),
        feet=feet,
        feet_acceleration=differences(feet, problem.step_s),
        force=force,
    )


def at_rest(size: int, start: Array, goal: Array) -> tuple[Quantity, int]:
    """Return a path of three numbers that is at rest at both ends: known at the first and the last two samples."""
    index = np.full((size, 3), -1, dtype=np.int64)
    value = np.zeros((size, 3))
    value[0], value[-2:] = start, goal
    free = max(size - 3, 0)
    index[1 : size - 2] = np.arange(3 * free).reshape(free, 3)
    return Quantity(index, value), 3 * free


def _feet(problem: Problem, count: int) -> tuple[Quantity, int]:
    """Return the foot positions: one unknown point per foothold, and one per sample within a swing."""
    size = problem.samples
    index = np.full((size, 4, 3), -1, dtype=np.int64)
    value = np.zeros((size, 4, 3))
    for foot in range(4):
        value[0, foot] = problem.feet_m[foot]
        for sample in range(1, size):
            if problem.contacts[sample, foot]:
                index[sample, foot], value[sample, foot] = index[sample - 1, foot], value[sample - 1, foot]
            else:
                index[sample, foot] = np.arange(count, count + 3)
                count += 3
    return Quantity(index, value), count


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


def _base_acceleration(problem: Problem, base: Quantity, first: Quantity) -> tuple[Term, ...]:
    """Return rdd: second differences, and at sample 0 an unknown of its own, which only the cost and Newton see."""
    index = np.broadcast_to(first.index, base.index.shape)
    alone = np.zeros((problem.samples, 1))
    alone[0] = 1.0
    return (*differences(base, problem.step_s), (alone, Quantity(index.copy(), np.zeros(index.shape))))

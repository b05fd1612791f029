"""Interval propagation: which polygons a footstep can reach at all, from both ends of the motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.footholds.model import Choice, all_open
from surefoot.footholds.problem import Problem
from surefoot.footholds.rows import Array

SLACK_M = 1e-7
_ROUNDS = 50


@dataclass(frozen=True, slots=True, eq=False)
class Boxes:
    """Boxes that hold every motion: lower and upper corners.

    Attributes:
        base: of the base at every sample, shape (2, N, 3).
        footholds: of every footstep's foothold, shape (2, steps, 3).
        empty: the footstep or sample that is left with nothing, in words; None when all have something.
    """

    base: Array
    footholds: Array
    empty: str | None


def reachable(problem: Problem) -> tuple[Choice, Boxes]:
    """Return the polygons that each footstep may reach, and boxes that hold base and footholds.

    A foothold is held from the last swing sample on; base and feet in contact keep each other in the boxes of Eq. (16).
    """
    steps, choice = problem.footsteps, list(all_open(problem))
    size = problem.samples
    reach = np.einsum("iab,b->ia", np.abs(problem.rotations), np.array(problem.robot.foot_reach_m)) + SLACK_M
    low = np.array([one.vertices_m.min(axis=0) for one in problem.polygons]).reshape(-1, 3)
    high = np.array([one.vertices_m.max(axis=0) for one in problem.polygons]).reshape(-1, 3)
    held = [np.arange(step.touch - 1, step.leave) for step in steps]
    still = [np.arange(_first_lift(problem, foot)) for foot in range(4)]
    base = np.array([np.full((size, 3), -np.inf), np.full((size, 3), np.inf)])
    for sample, position in ((0, problem.start_m), (size - 2, problem.goal_m), (size - 1, problem.goal_m)):
        base[:, sample] = position
    for foot, samples in enumerate(still):
        point = problem.feet_m[foot] - problem.levers_m[samples, foot]
        base[0, samples] = np.maximum(base[0, samples], point - reach[samples])
        base[1, samples] = np.minimum(base[1, samples], point + reach[samples])
    feet = np.array([[low.min(axis=0)] * len(steps), [high.max(axis=0)] * len(steps)]).reshape(2, len(steps), 3)
    if (base[0] > base[1]).any():
        return tuple(choice), Boxes(base, feet, "the base at the start or the goal is out of reach of the start feet")
    for _ in range(_ROUNDS):
        before = feet.copy()
        for number, step in enumerate(steps):
            samples = held[number]
            lever = problem.levers_m[samples, step.foot]
            lower = np.maximum(feet[0, number], (base[0, samples] + lever - reach[samples]).max(axis=0))
            upper = np.minimum(feet[1, number], (base[1, samples] + lever + reach[samples]).min(axis=0))
            left = _meeting(problem, choice[number], lower, upper, low, high)
            if not left:
                return tuple(choice), Boxes(base, feet, f"footstep {number} reaches no polygon")
            choice[number] = left
            chosen = list(left)
            feet[0, number] = np.maximum(lower, low[chosen].min(axis=0) - SLACK_M)
            feet[1, number] = np.minimum(upper, high[chosen].max(axis=0) + SLACK_M)
            base[0, samples] = np.maximum(base[0, samples], feet[0, number] - lever - reach[samples])
            base[1, samples] = np.minimum(base[1, samples], feet[1, number] - lever + reach[samples])
            if (base[0, samples] > base[1, samples]).any():
                return tuple(choice), Boxes(base, feet, f"no base position is within reach during footstep {number}")
        if np.abs(feet - before).max(initial=0.0) < SLACK_M:
            break
    return tuple(choice), Boxes(base, feet, None)


def _first_lift(problem: Problem, foot: int) -> int:
    swings = np.flatnonzero(~problem.contacts[:, foot])
    return int(swings[0]) if len(swings) else problem.samples


def _meeting(
    problem: Problem, ids: tuple[int, ...], lower: Array, upper: Array, low: Array, high: Array
) -> tuple[int, ...]:
    """Return the polygons that meet a box, by the separating axes of box and sides."""
    if (lower > upper).any():
        return ()
    chosen = np.array(ids)
    overlap = ((low[chosen] <= upper + SLACK_M) & (high[chosen] >= lower - SLACK_M)).all(axis=1)
    return tuple(int(r) for r in chosen[overlap] if _not_apart(problem.polygons[r], lower, upper))


def _not_apart(one: object, lower: Array, upper: Array) -> bool:
    sides, bounds = one.sides, one.bounds  # type: ignore[attr-defined]
    least = np.minimum(sides * lower, sides * upper).sum(axis=1)
    return bool((least <= bounds + SLACK_M).all())

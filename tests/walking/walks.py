"""Walks at random, and the robot that walks them."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass

from surefoot.frames import Foot
from surefoot.robots.biped import biped
from surefoot.walking import (
    StepCommand,
    StepKind,
    Unsafe,
    WalkingParameters,
    WalkingState,
    WalkingStep,
    plan_step,
    standing_state,
    walking_parameters,
)

DIGIT = biped("digit")
CELL_M = 2.70351
DEFAULTS = walking_parameters(CELL_M)


@dataclass(frozen=True)
class Place:
    """Where a robot is in the modes of rules.md 5: stand, walk, or a pending turn (type, steps done, side)."""

    node: str | tuple[str, int, int]
    state: WalkingState


def first_place(parameters: WalkingParameters, yaw_rad: float = 0.0, floor_m: float = 0.0) -> Place:
    return Place("stand", standing_state((1.0, 2.0, floor_m), yaw_rad, Foot.LEFT, parameters, DIGIT))


def actions(place: Place, parameters: WalkingParameters) -> list[str]:
    """Return what rules.md 5 allows, whatever the position: straight steps by their length."""
    if place.node == "stand":
        return ["start"]
    if place.node == "walk":
        return [*map(str, parameters.straight_cells), "stop", "pre", "pre", "A", "A"]
    return ["turn"]


def command_of(
    place: Place, action: str, parameters: WalkingParameters, deviation: int = 0, height_m: float = 0.0
) -> tuple[StepCommand, str | tuple[str, int, int]]:
    """Return the command of an action and the node after it; the next heading changes are all that could follow."""
    p, side = parameters, place.state.stance.side
    cell, next_side = p.fine_cell_m, -place.state.stance.side
    free = (0.0, -next_side * p.turn_rad)
    if action == "start":
        return StepCommand(StepKind.START, p.stop_cells * cell, 0.0, 0.0, False, free, deviation), "walk"
    if action == "stop":
        return StepCommand(StepKind.STOP, p.stop_cells * cell), "stand"
    if action == "pre":
        changes = (next_side * p.turn_rad,)
        return StepCommand(StepKind.WALK, p.pre_step_cells * cell, 0.0, 0.0, False, changes, deviation), (
            "B",
            0,
            next_side,
        )
    if action not in ("A", "turn"):
        return StepCommand(StepKind.WALK, int(action) * cell, 0.0, height_m, False, free, deviation), "walk"
    turn_type, done, turn_side = ("A", 0, -side)
    if action == "turn":
        assert isinstance(place.node, tuple)
        turn_type, done, turn_side = place.node
    lengths = p.turn_a_cells if turn_type == "A" else p.turn_b_cells
    last = done + 1 == p.turn_steps
    change = turn_side * p.turn_rad
    command = StepCommand(StepKind.WALK, lengths[done] * cell, change, 0.0, last, free if last else (change,))
    return command, "walk" if last else (turn_type, done + 1, turn_side)


def walk(
    seed: int, steps: int, parameters: WalkingParameters, deviations: float = 0.0, straight: tuple[int, ...] = ()
) -> Iterator[tuple[str, WalkingStep | Unsafe]]:
    """Walk at random.

    Args:
        seed: of the random commands.
        steps: how many, unless one is unsafe before.
        parameters: of the walk.
        deviations: how often a straight step may be lengthened or shortened by a cell.
        straight: which straight lengths are commanded; all when empty.
    """
    chance = random.Random(seed)
    place = first_place(parameters, yaw_rad=chance.uniform(-3, 3))
    for _ in range(steps):
        allowed = actions(place, parameters)
        if straight:
            allowed = [a for a in allowed if not a.isdigit() or int(a) in straight]
        action = chance.choice(allowed)
        command, node = command_of(place, action, parameters, int(chance.random() < deviations))
        step = plan_step(place.state, command, parameters, DIGIT)
        label = f"{place.node[0]}{int(place.node[1]) + 1}" if isinstance(place.node, tuple) else action
        yield label, step
        if isinstance(step, Unsafe):
            return
        place = Place(node, step.next_state())

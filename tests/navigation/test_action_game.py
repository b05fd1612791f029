"""The action game: verdicts, displacements, and what its strategies do."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from art import CELL_M, STAIRS, TWO_ROOMS, UPPER_FLOOR, coarse_of

from surefoot.frames import Direction
from surefoot.navigation import (
    STOP_ORDER,
    Action,
    ActionRules,
    Context,
    FineState,
    Mode,
    action_rules,
    apply_action,
    build_action_game,
    solve_action,
    standing_start,
)
from surefoot.robots import biped
from surefoot.walking import step_library, walking_parameters

EAST = Context(0, int(Direction.EAST), 0)


def rules(*, stairs: bool = False, **walking: Any) -> ActionRules:
    coarse = coarse_of(TWO_ROOMS, floors=(UPPER_FLOOR,), stairs=(STAIRS,)) if stairs else coarse_of(TWO_ROOMS)
    return action_rules(coarse, step_library(walking_parameters(CELL_M, **walking), biped("digit")))


def test_default_library_is_realizable() -> None:
    verdict, strategy, start = solve_action(build_action_game(rules(), Direction.EAST, EAST), 13, 13)
    assert verdict
    assert strategy is not None
    assert start is not None
    assert start.moved_cells < 1


@pytest.mark.parametrize(
    ("walking", "realizable"),
    [
        ({"straight_cells": (4, 3)}, False),  # with deviations at start and stop too, short steps are needed
        ({"lateral_outcomes_cells": 4}, False),
        ({"side_band_cells": 10}, False),
    ],
)
def test_breaking_points(walking: dict[str, Any], realizable: bool) -> None:
    verdict, strategy, _ = solve_action(build_action_game(rules(**walking), Direction.EAST, EAST), 13, 13)
    assert bool(verdict) is realizable
    assert (strategy is not None) is realizable
    assert realizable or verdict.witness is not None


def test_stairs_give_contexts_and_stay_realizable() -> None:
    with_stairs = rules(stairs=True)
    kinds = {(context.here > 0, context.there > 0) for context in with_stairs.contexts}
    assert (False, True) in kinds
    assert (True, True) in kinds
    assert all(context.order != STOP_ORDER or context.here == 0 for context in with_stairs.contexts)
    verdict, _, _ = solve_action(build_action_game(with_stairs, Direction.EAST, EAST), 13, 13)
    assert verdict, verdict.witness


@pytest.mark.parametrize(
    ("heading", "order", "stance", "steps"),
    [
        # E turning left, type A (right stance), and E turning right, type A (left stance): biped facts, 1.3.
        (4, Direction.NORTH, 1, [(-1, 4), (-2, 2), (-4, 1), (-3, 0)]),
        (4, Direction.SOUTH, 0, [(1, 4), (2, 2), (4, 1), (3, 0)]),
        (0, Direction.EAST, 0, [(-4, 1), (-2, 2), (-1, 4), (0, 3)]),
    ],
)
def test_type_a_turn(heading: int, order: Direction, stance: int, steps: list[tuple[int, int]]) -> None:
    flat = rules()
    context = flat.contexts.index(Context(0, int(order), 0))
    state = FineState(8 if order == Direction.SOUTH else 16, 8, heading, stance, int(Mode.WALKING), context)
    for number, (rows, columns) in enumerate(steps):
        action = Action.TURN if number == 0 else Action.CONTINUE
        moved = apply_action(flat.tables, state, action, 0, 0)
        assert (moved.state.row - state.row, moved.state.column - state.column) == (rows, columns)
        assert moved.state.stance == 1 - state.stance
        state = moved.state
    assert state.heading == int(order) * 4
    assert state.mode == Mode.WALKING


def test_type_b_turn_after_its_pre_step() -> None:
    flat = rules()
    context = flat.contexts.index(Context(0, int(Direction.EAST), 0))
    state = FineState(20, 8, 0, 0, int(Mode.WALKING), context)
    ready = apply_action(flat.tables, state, Action.PRE_STEP, 0, 0).state
    assert ready == FineState(16, 8, 0, 1, int(Mode.READY), context)
    places = []
    state = ready
    for action in (Action.TURN, Action.CONTINUE, Action.CONTINUE, Action.CONTINUE):
        state = apply_action(flat.tables, state, action, 0, 0).state
        places.append((state.row - ready.row, state.column - ready.column))
    assert places == [(-2, 1), (-5, 4), (-6, 6), (-6, 10)]


def test_lateral_outcome_only_at_the_last_turn_step() -> None:
    flat = rules()
    context = flat.contexts.index(Context(0, int(Direction.NORTH), 0))
    state = FineState(16, 8, 4, 1, int(Mode.WALKING), context)
    with pytest.raises(ValueError, match="not among those"):
        apply_action(flat.tables, state, Action.TURN, 0, 1)
    for action in (Action.TURN, Action.CONTINUE, Action.CONTINUE):
        state = apply_action(flat.tables, state, action, 0, 0).state
    nominal = apply_action(flat.tables, state, Action.CONTINUE, 0, 0).state
    left = apply_action(flat.tables, state, Action.CONTINUE, 0, 2).state
    assert (left.row, left.column) == (nominal.row, nominal.column - 2)


def test_crossing_wraps_and_achieves() -> None:
    flat = rules()
    context = flat.contexts.index(EAST)
    moved = apply_action(flat.tables, FineState(13, 24, 4, 0, int(Mode.WALKING), context), Action.STRAIGHT, 0, 0)
    assert moved.achieved
    assert moved.state.column == 2


def test_strategy_achieves_every_order_within_a_few_steps() -> None:
    """Play the strategy with random deviations and random orders: never lost, never more than 12 steps an order."""
    flat = rules()
    _, strategy, start = solve_action(build_action_game(flat, Direction.EAST, EAST), 13, 13)
    assert strategy is not None
    assert start is not None
    chance = np.random.default_rng(1)
    state = standing_start(flat, start.row, start.column, Direction.EAST, flat.contexts.index(EAST))
    heading, pending = Direction.EAST, 0
    for _ in range(4000):
        action = strategy.decide(state)
        outcomes = admitted(flat, state, action)
        moved = apply_action(flat.tables, state, action, *outcomes[chance.integers(len(outcomes))])
        pending += 1
        state = moved.state
        if moved.achieved:
            order = flat.contexts[state.context].order
            heading = heading if order == STOP_ORDER else Direction(order)
            choices = [n for n, c in enumerate(flat.contexts) if c.order != heading.opposite]
            state = state._replace(context=int(chance.choice(choices)))
            pending = 0
        assert pending <= 12


def admitted(flat: ActionRules, state: FineState, action: int) -> list[tuple[int, int]]:
    """Return the outcomes that the game admits, found by trying."""
    found = []
    for sagittal in (-1, 0, 1):
        for lateral in (-2, -1, 0, 1, 2):
            try:
                apply_action(flat.tables, state, action, sagittal, lateral)
            except ValueError:
                continue
            found.append((sagittal, lateral))
    return found

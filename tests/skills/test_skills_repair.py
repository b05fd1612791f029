"""Symbolic repair and the manager against an oracle that only knows graphs."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from skills_oracle import (
    ALL,
    Recorded,
    can_win,
    edges_of,
    fewest_by_enumeration,
    grid,
    primitive_sets,
    results,
    terrain_states,
    winners,
)

from surefoot.errors import BackendFailed, InputError
from surefoot.skills.manager import (
    Knowledge,
    Outcome,
    SuggestionOrder,
    cost_aware,
    handle,
    paper_order,
    synthesize_library,
)
from surefoot.skills.repair import Kind, RandomOrder, repair
from surefoot.skills.shortest import fewest_new
from surefoot.skills.skill_game import every_move, pair_game, solve_game
from surefoot.skills.unrepairable import Cause
from surefoot.skills.values import Cell, Direction, Physics, Primitive, TerrainState

ORDERS = pytest.mark.parametrize("order", [cost_aware, paper_order()], ids=["cost-aware", "paper"])
FORWARD = Direction.FORWARD


Question = tuple[TerrainState, Cell, frozenset[tuple[Cell, Cell]]]


@st.composite
def questions(draw: st.DrawFn) -> Question:
    """Return a grid, a request and a few disallowed moves."""
    state = draw(terrain_states())
    request = draw(st.sampled_from(state.cells()))
    edges = sorted(edges_of(state))
    return state, request, draw(st.frozensets(st.sampled_from(edges), max_size=4)) if edges else frozenset()


def walk(state: TerrainState, strategy: dict[Cell, Direction | None]) -> list[Cell]:
    """Return the cells that a strategy visits until it stays."""
    cell, visited = state.centre, [state.centre]
    while (direction := strategy[cell]) is not None:
        cell = direction.of(cell)
        visited.append(cell)
        assert len(visited) <= state.rows * state.columns
    return visited


@settings(max_examples=60, deadline=None)
@given(questions(), primitive_sets())
def test_engine_agrees_with_reachability(question: Question, primitives: frozenset[Primitive]) -> None:
    state, request, disallowed = question
    solved = solve_game(pair_game(state, request, primitives, disallowed=disallowed))
    assert solved.winning == winners(state, request, primitives, disallowed)


@settings(max_examples=60, deadline=None)
@given(questions(), primitive_sets(), primitive_sets(), st.integers(0, 5))
@ORDERS
def test_every_pair_that_the_oracle_calls_repairable_is_handled(
    order: SuggestionOrder, question: Question, at_hand: frozenset[Primitive], more: frozenset[Primitive], seed: int
) -> None:
    state, request, disallowed = question
    if order is not cost_aware:
        order = paper_order(seed)
    physics = Recorded(at_hand | more)
    answer, knowledge = handle(state, request, Knowledge(results(at_hand)), physics, order=order, disallowed=disallowed)
    assert knowledge.skills <= physics.feasible
    assert len(set(physics.asked)) == len(physics.asked)
    repairable = can_win(state, request, {*ALL} - {*knowledge.refused}, disallowed)
    assert (answer.outcome in (Outcome.REALIZABLE, Outcome.REPAIRED)) == repairable
    assert repairable == can_win(state, request, physics.feasible, disallowed)
    if repairable:
        visited = walk(state, dict(answer.strategy))
        steps = list(pairwise(visited))
        assert visited[-1] == request
        assert not disallowed.intersection(steps)
        assert {edges_of(state)[step] for step in steps} <= knowledge.skills
        assert len(answer.new) >= answer.fewest
    else:
        assert answer.why is not None
        assert answer.why.cause in (Cause.OBSTACLE, Cause.DISALLOWED, Cause.PHYSICS)
        blocked = {*ALL} - {*answer.why.primitives}
        assert not can_win(state, request, blocked, disallowed)


@settings(max_examples=40, deadline=None)
@given(questions(), primitive_sets(), primitive_sets())
def test_suggestions_are_needed_and_never_blocked(
    question: Question, at_hand: frozenset[Primitive], refused: frozenset[Primitive]
) -> None:
    state, request, disallowed = question
    game = pair_game(state, request, at_hand, disallowed=disallowed)
    inventable = [move for move in every_move(state) if move.skill not in refused | at_hand]
    for order in (RandomOrder(3), cost_aware(Knowledge(), 0)):
        suggestion = repair(game, inventable, order)
        assert (suggestion is not None) == can_win(state, request, {*ALL} - (refused - at_hand), disallowed)
        if suggestion is not None:
            assert not refused.intersection(suggestion.primitives)
            assert not disallowed.intersection((move.source, move.targets[0]) for move in suggestion.moves)
            assert can_win(state, request, at_hand.union(suggestion.primitives), disallowed)


@settings(max_examples=40, deadline=None)
@given(terrain_states(sizes=(3,)), primitive_sets(), primitive_sets(), st.data())
def test_lower_bound_is_the_fewest_new_primitives(
    state: TerrainState, at_hand: frozenset[Primitive], refused: frozenset[Primitive], data: st.DataObject
) -> None:
    request = data.draw(st.sampled_from(state.cells()))
    found = fewest_new(state, request, at_hand - refused, refused)
    enumerated = fewest_by_enumeration(state, request, at_hand, refused, most=2)
    if enumerated is None:
        assert found is None or found > 2
    else:
        assert found == enumerated


def test_a_front_row_of_an_unseen_class_needs_one_primitive() -> None:
    """Case study: rows of gap, flat, dense; twelve skills know flat and dense; the request is straight ahead."""
    skills = [one for one in ALL if "gap" not in (one.here, one.next) and "sparse" not in (one.here, one.next)]
    physics = Recorded(ALL)
    answer, knowledge = handle(grid("ggg", "fff", "ddd"), (0, 1), Knowledge(results(skills[:12])), physics)
    assert physics.asked == [Primitive(FORWARD, "flat", "gap")]
    assert answer.outcome is Outcome.REPAIRED
    assert answer.new == (Primitive(FORWARD, "flat", "gap"),)
    assert answer.fewest == 1
    assert walk(answer.state, dict(answer.strategy)) == [(1, 1), (0, 1)]
    assert knowledge.count(Physics.INFEASIBLE) == 0


def test_one_other_class_in_front_needs_no_repair_when_it_is_known() -> None:
    """Case study: all sparse rebar, another class in the centre and in front."""
    skills = [Primitive(FORWARD, "sparse", "gap")]
    answer, _ = handle(grid("sgs", "sss", "sss"), (0, 1), Knowledge(results(skills)), Recorded(()))
    assert answer.outcome is Outcome.REALIZABLE


def test_a_disallowed_move_is_avoided_everywhere_but_only_here() -> None:
    """Case study: (1, 0) -> (1, 1) is forbidden; the primitive itself stays a skill."""
    state = grid("fff", "fff", "fff")
    edge = ((1, 1), (0, 1))
    knowledge = Knowledge(results(ALL))
    answer, after = handle(state, (0, 1), knowledge, Recorded(()), disallowed=[edge])
    visited = walk(state, dict(answer.strategy))
    assert visited[-1] == (0, 1)
    assert edge not in list(pairwise(visited))
    assert after == knowledge
    enclosed = [((1, 1), direction.of((1, 1))) for direction in Direction]
    answer, _ = handle(state, (0, 1), knowledge, Recorded(()), disallowed=enclosed)
    assert answer.outcome is Outcome.UNREPAIRABLE
    assert answer.why is not None
    assert answer.why.cause is Cause.DISALLOWED


@ORDERS
def test_infeasible_suggestions_are_remembered_and_another_way_is_found(order: SuggestionOrder) -> None:
    feasible = {Primitive(FORWARD, "flat", "flat"), Primitive(Direction.LEFT, "flat", "flat")}
    feasible |= {Primitive(Direction.RIGHT, "flat", "dense")}
    physics = Recorded(feasible)
    answer, knowledge = handle(grid("fdf", "fff", "fff"), (0, 1), Knowledge(), physics, order=order)
    assert answer.outcome is Outcome.REPAIRED
    assert walk(answer.state, dict(answer.strategy)) == [(1, 1), (1, 0), (0, 0), (0, 1)]
    assert Primitive(FORWARD, "flat", "dense") in knowledge.refused
    assert not feasible.intersection(knowledge.refused)


def test_an_undecided_check_is_unavailable_and_leaves_the_pair_undecided() -> None:
    wanted = Primitive(FORWARD, "flat", "gap")
    answer, knowledge = handle(grid("#g#", "#f#", "###"), (0, 1), Knowledge(), Recorded((), unknown=[wanted]))
    assert answer.outcome is Outcome.UNDECIDED
    assert answer.why is not None
    assert answer.why.primitives == (wanted,)
    assert knowledge.count(Physics.UNKNOWN) == 1


def test_obstacles_around_the_request_are_the_reason() -> None:
    answer, _ = handle(grid("f#f", "#ff", "fff"), (0, 0), Knowledge(), Recorded(ALL))
    assert answer.outcome is Outcome.UNREPAIRABLE
    assert answer.why is not None
    assert answer.why.cause is Cause.OBSTACLE
    assert answer.asked == ()


@pytest.mark.parametrize(("state", "request_cell"), [(grid("fff", "f#f", "fff"), (0, 0)), (grid("f"), (0, 1))])
def test_bad_questions_are_refused(state: TerrainState, request_cell: Cell) -> None:
    with pytest.raises(InputError, match=r"own cell|outside of the grid"):
        handle(state, request_cell, Knowledge(), Recorded(()))


def test_grids_without_a_centre_are_refused() -> None:
    with pytest.raises(InputError, match="odd number"):
        grid("ff", "ff", "ff")


def test_physics_that_does_not_answer_is_a_failure_not_a_loop() -> None:
    with pytest.raises(BackendFailed, match="no answer about forward flat->flat"):
        handle(grid("f", "f", "f"), (0, 0), Knowledge(), lambda _: [])


def test_paper_order_takes_turns_between_aiming_and_extending() -> None:
    state = grid("fffff", "ddddd", "fffff", "fffff", "fffff")
    at_hand = [Primitive(direction, "flat", "flat") for direction in Direction]
    inventable = [move for move in every_move(state) if move.skill not in at_hand]
    suggestion = repair(pair_game(state, (0, 2), at_hand), inventable, RandomOrder(1))
    assert suggestion is not None
    kinds = [edit.kind for edit in suggestion.edits]
    assert kinds[0] is Kind.EXTEND  # nobody stands on dense ground yet, so nothing can be re-aimed
    assert Kind.AIM in kinds
    assert set(suggestion.primitives) <= {move.skill for move in inventable}


@ORDERS
@pytest.mark.parametrize("at_once", [1, 3])
def test_a_whole_synthesis_answers_every_pair_and_repeats_itself(order: SuggestionOrder, at_once: int) -> None:
    states = [grid("gsd", "fff", "dfd"), grid("ggg", "fff", "sss"), grid("#g#", "dsd", "fff")]
    pairs = [(state, (0, column)) for state in states for column in range(3) if state.label((0, column)) != "obstacle"]
    feasible = {one for one in ALL if (one.here, one.next) != ("sparse", "gap")}
    start = [Primitive(direction, name, name) for direction in Direction for name in ("flat", "dense")]
    found = [synthesize_library(pairs, start, Recorded(feasible), order=order, at_once=at_once) for _ in range(2)]
    assert [pair.outcome for pair in found[0].pairs] == [pair.outcome for pair in found[1].pairs]
    assert found[0].knowledge == found[1].knowledge
    assert found[0].count(Outcome.REPAIRED) + found[0].count(Outcome.REALIZABLE) == len(pairs) - 1
    assert found[0].pairs[-1].outcome is Outcome.UNREPAIRABLE  # the last gap can only be entered from sparse stones


@settings(max_examples=25, deadline=None)
@given(st.lists(terrain_states(sizes=(3,)), min_size=1, max_size=6), primitive_sets(), st.integers(1, 5), st.data())
def test_asking_ahead_changes_no_answer(
    states: list[TerrainState], feasible: frozenset[Primitive], at_once: int, data: st.DataObject
) -> None:
    pairs = [(state, data.draw(st.sampled_from(state.cells()))) for state in states]
    physics = Recorded(feasible)
    found = synthesize_library(pairs, (), physics, at_once=at_once)
    assert len(set(physics.asked)) == len(physics.asked)
    assert found.knowledge.skills <= feasible
    for pair, (state, request) in zip(found.pairs, pairs, strict=True):
        handled = pair.outcome in (Outcome.REALIZABLE, Outcome.REPAIRED)
        assert handled == can_win(state, request, feasible) == can_win(state, request, found.knowledge.skills)
        assert len(pair.new) >= pair.fewest
        assert not handled or walk(state, dict(pair.strategy))[-1] == request

"""Every engine, against the formula on sets, and its strategies played to the end."""

from __future__ import annotations

import numpy as np
import pytest
from gr1_oracle import Update, arenas, faults_of, make_arena, naive_winning, random_arena, some_strategy_wins
from hypothesis import given, settings

from surefoot.compute import Deadline
from surefoot.errors import LimitExceeded
from surefoot.games import Arena, Engine, EnvDeadEnd, Solution, follow, solve, visit

many = settings(max_examples=2000, deadline=None)
DEAD_ENDS: tuple[EnvDeadEnd, ...] = ("wins", "loses")
UPDATES: tuple[Update, ...] = ("before the choice", "after the choice")


@pytest.fixture(params=[solve], ids=["explicit"], scope="module")
def engine(request: pytest.FixtureRequest) -> Engine:
    chosen: Engine = request.param
    return chosen


def winning_nodes(solution: Solution) -> set[int]:
    return set(np.flatnonzero(solution.winning).tolist())


def check_against_oracles(engine: Engine, arena: Arena, env_dead_end: EnvDeadEnd) -> None:
    solution = engine(arena, env_dead_end=env_dead_end)
    assert winning_nodes(solution) == naive_winning(arena, env_dead_end)
    for update in UPDATES:
        assert faults_of(arena, solution, env_dead_end, update) == []
    check_shape(arena, solution)
    check_ranks(arena, solution)


def check_shape(arena: Arena, solution: Solution) -> None:
    goals = max(len(arena.goals), 1)
    assert solution.rank.shape == solution.choice.shape == solution.waits_for.shape == (goals, arena.nodes)
    np.testing.assert_array_equal(solution.rank >= 0, np.tile(solution.winning, (goals, 1)))
    np.testing.assert_array_equal(solution.choice >= 0, np.tile(solution.winning & arena.system, (goals, 1)))
    for array in (solution.winning, solution.rank, solution.choice, solution.waits_for):
        assert not array.flags.writeable


def check_ranks(arena: Arena, solution: Solution) -> None:
    """Where a goal does not hold, its rank falls with every move, or stays while one justice does not hold."""
    for g, (rank, waits_for) in enumerate(zip(solution.rank, solution.waits_for, strict=True)):
        for v in np.flatnonzero(rank > 0).tolist():
            targets = [follow(arena, solution, g, v)] if arena.system[v] else arena.successors_of(v).tolist()
            for w in targets:
                stays = rank[w] == rank[v] and waits_for[w] == waits_for[v] >= 0
                assert 0 <= rank[w] < rank[v] or stays
            assert waits_for[v] < 0 or not arena.justices[waits_for[v], v]
        assert (waits_for[rank <= 0] == -1).all()


@many
@given(arena=arenas())
@pytest.mark.parametrize("env_dead_end", DEAD_ENDS)
def test_small_games(engine: Engine, env_dead_end: EnvDeadEnd, arena: Arena) -> None:
    check_against_oracles(engine, arena, env_dead_end)


@pytest.mark.parametrize("env_dead_end", DEAD_ENDS)
def test_games_of_many_layers(engine: Engine, env_dead_end: EnvDeadEnd) -> None:
    deep = 0
    for seed in range(120):
        arena = random_arena(seed)
        check_against_oracles(engine, arena, env_dead_end)
        solution = engine(arena, env_dead_end=env_dead_end)
        deep += bool(solution.rank.max() > 6 and solution.waits_for.max() >= 0)
    assert deep > 20  # the ensemble is not trivial


@settings(max_examples=300, deadline=None)
@given(arena=arenas(most_nodes=4, most_edges=2, most_sets=2))
@pytest.mark.parametrize("env_dead_end", DEAD_ENDS)
def test_where_the_engine_says_no_no_strategy_wins(engine: Engine, env_dead_end: EnvDeadEnd, arena: Arena) -> None:
    solution = engine(arena, env_dead_end=env_dead_end)
    for v in range(arena.nodes):
        assert solution.winning[v] == some_strategy_wins(arena, v, env_dead_end)


def test_a_solution_is_the_same_every_time(engine: Engine) -> None:
    arena = random_arena(3)
    one, two = engine(arena), engine(arena)
    for name in ("winning", "rank", "choice", "waits_for"):
        np.testing.assert_array_equal(getattr(one, name), getattr(two, name))


def test_the_nearest_way_is_taken_and_the_first_of_equals(engine: Engine) -> None:
    # 0 -> {1, 2, 3}; 1 -> 2; 2 -> 4; 3 -> 4; 4 is the goal and goes back
    arena = make_arena([True] * 5, [[1, 2, 3], [2], [4], [4], [0]], set(), [{4}], [])
    solution = engine(arena)
    assert solution.rank[0].tolist() == [2, 2, 1, 1, 0]
    assert solution.choice[0].tolist() == [1, 0, 0, 0, 0]


def test_at_a_goal_the_next_goal_is_nearest(engine: Engine) -> None:
    # from goal 0 at node 0 the play can go to goal 2 at node 2 or to goal 1 at node 1
    arena = make_arena([True] * 3, [[2, 1], [0], [0]], set(), [{0}, {1}, {2}], [])
    solution = engine(arena)
    assert follow(arena, solution, 0, 0) == follow(arena, solution, 1, 0) == 1
    assert follow(arena, solution, 2, 0) == 2


def test_it_moves_rather_than_waits(engine: Engine) -> None:
    # node 0 may wait for the environment (1) to open the gate (3), or walk round (2) without its help
    arena = make_arena([True, False, True, True], [[1, 2], [0, 3], [3], [0]], set(), [{3}], [{3}])
    solution = engine(arena)
    assert follow(arena, solution, 0, 0) == 2
    assert solution.waits_for[0, 0] == -1
    gate_only = make_arena([True, False, True, True], [[1], [0, 3], [3], [0]], set(), [{3}], [{3}])
    assert engine(gate_only).waits_for[0, 0] == 0


def test_no_goals_means_to_stay_safe(engine: Engine) -> None:
    # the system keeps away from 3, the environment at 2 does not
    arena = make_arena([True, True, False, True], [[1, 2], [0], [0, 3], [3]], {3}, [], [])
    solution = engine(arena)
    assert winning_nodes(solution) == {0, 1}
    assert follow(arena, solution, 0, 0) == 1


def test_a_promise_that_cannot_be_kept_is_used(engine: Engine) -> None:
    arena = make_arena([False], [[0]], set(), [set()], [set()])
    assert winning_nodes(engine(arena)) == {0}


@pytest.mark.parametrize(("env_dead_end", "wins"), [("wins", {0}), ("loses", set())])
def test_who_wins_when_the_environment_is_stuck(engine: Engine, env_dead_end: EnvDeadEnd, wins: set[int]) -> None:
    stuck = make_arena([False, True], [[], []], set(), [{1}], [])
    assert winning_nodes(engine(stuck, env_dead_end=env_dead_end)) == wins


def test_memory_advances_by_one_with_every_visit() -> None:
    arena = make_arena([True, True], [[1], [0]], set(), [{0}, {0}, {1}], [])
    assert [visit(arena, m, 0) for m in range(3)] == [1, 2, 2]
    assert [visit(arena, m, 1) for m in range(3)] == [0, 1, 0]
    assert visit(make_arena([True], [[0]], set(), [], []), 0, 0) == 0


def test_there_is_no_move_where_the_game_is_lost(engine: Engine) -> None:
    arena = make_arena([True], [[0]], {0}, [], [])
    with pytest.raises(ValueError, match="node 0 is not a winning node of the system"):
        follow(arena, engine(arena), 0, 0)


def test_an_empty_arena_has_no_winner(engine: Engine) -> None:
    assert winning_nodes(engine(make_arena([], [], set(), [], []))) == set()


def test_a_deadline_ends_the_work(engine: Engine) -> None:
    with pytest.raises(LimitExceeded, match="time limit"):
        engine(random_arena(0), deadline=Deadline.after(-1.0))


def test_a_wrong_option_is_named(engine: Engine) -> None:
    with pytest.raises(ValueError, match="env_dead_end is one of wins, loses"):
        engine(random_arena(0), env_dead_end="draws")  # type: ignore[arg-type]

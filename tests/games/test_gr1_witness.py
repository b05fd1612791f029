from __future__ import annotations

import numpy as np
from gr1_oracle import arenas, make_arena, naive_winning
from hypothesis import given, settings

from surefoot.games import (
    Arena,
    can_stay_safe,
    environment_cannot_keep_assumptions,
    failing_goals,
    solve,
    with_goals,
)


@settings(max_examples=300, deadline=None)
@given(arena=arenas(most_nodes=6))
def test_failing_goals_are_those_that_cannot_be_won_alone(arena: Arena) -> None:
    solution = solve(arena)
    for v in range(arena.nodes):
        alone = [g for g in range(len(arena.goals)) if v not in naive_winning(with_goals(arena, g), "wins")]
        assert failing_goals(arena, solution, v) == tuple(alone)
        assert can_stay_safe(arena, v) == (v in naive_winning(with_goals(arena, ()), "wins"))


def test_the_goal_behind_a_wall_fails() -> None:
    arena = make_arena([True] * 3, [[1], [0], [2]], set(), [{0}, {2}, {1}], [])
    assert failing_goals(arena, solve(arena), 0) == (1,)
    assert can_stay_safe(arena, 0)


def test_goals_that_exclude_each_other_do_not_fail_alone() -> None:
    arena = make_arena([True] * 3, [[1, 2], [1], [2]], set(), [{1}, {2}], [])
    solution = solve(arena)
    assert not solution.winning[0]
    assert failing_goals(arena, solution, 0) == ()


def keeps_its_word(arena: Arena) -> set[int]:
    """Return where the environment can visit every justice again and again or drive the system into a mistake.

    Written with the environment's own controllable predecessor: nu Z . AND_j mu Y . mistake or justice_j and pre(Z)
    or pre(Y), and for no justice nu Z . mistake or pre(Z).
    """
    everything = set(range(arena.nodes))
    mistake = {v for v in everything if arena.lost[v]}

    def pre(target: set[int]) -> set[int]:
        found = set(mistake)
        for v in everything - mistake:
            inside = [w in target for w in arena.successors_of(v).tolist()]
            if all(inside) if arena.system[v] else any(inside):
                found.add(v)
        return found

    justices = [set(np.flatnonzero(row).tolist()) for row in arena.justices] or [everything]
    z = everything
    while True:
        following = everything
        for justice in justices:
            y: set[int] = set()
            while (more := mistake | (justice & pre(z)) | pre(y)) != y:
                y = more
            following = following & y
        if following == z:
            return z
        z = following


@settings(max_examples=500, deadline=None)
@given(arena=arenas())
def test_where_the_environment_must_break_its_word(arena: Arena) -> None:
    keeps = keeps_its_word(arena)
    broken = environment_cannot_keep_assumptions(arena, np.arange(arena.nodes))
    assert set(broken.tolist()) == set(range(arena.nodes)) - keeps


def test_only_the_given_nodes_are_judged_in_their_order() -> None:
    # at node 0 the system can stay for ever where the justice (node 1) never holds; node 2 is the environment's own
    arena = make_arena([True, False, False], [[0, 1], [0], [1, 2]], set(), [], [{1}])
    assert environment_cannot_keep_assumptions(arena, [2, 1, 0]).tolist() == [2, 1, 0]
    free = make_arena([True, False, False], [[1], [0], [1, 2]], set(), [], [{1}])
    assert environment_cannot_keep_assumptions(free, [2, 1, 0]).tolist() == []
    assert environment_cannot_keep_assumptions(arena, [1]).tolist() == [1]


def test_a_mistake_of_the_system_counts_for_the_environment() -> None:
    into_lost = make_arena([True, False], [[1], [1]], {1}, [], [set()])
    stuck = make_arena([True], [[]], set(), [], [set()])
    env_stuck = make_arena([False], [[]], set(), [], [])
    assert environment_cannot_keep_assumptions(into_lost, [0, 1]).tolist() == []
    assert environment_cannot_keep_assumptions(stuck, [0]).tolist() == []
    assert environment_cannot_keep_assumptions(env_stuck, [0]).tolist() == [0]

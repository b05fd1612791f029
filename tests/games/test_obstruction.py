"""Plays that the environment wins: found exactly where the system loses, and really won."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surefoot.compute import Deadline
from surefoot.errors import LimitExceeded
from surefoot.games import Arena, solve
from surefoot.games.obstruction import obstruction


def random_arena(seed: int) -> Arena:
    source = np.random.default_rng(seed)
    nodes = int(source.integers(2, 14))
    degree = source.integers(0, 4, nodes)
    first = np.concatenate([[0], np.cumsum(degree)])
    return Arena(
        system=source.random(nodes) < 0.5,
        first=first,
        successors=source.integers(0, nodes, int(first[-1]), dtype=np.int32),
        lost=source.random(nodes) < 0.05,
        goals=source.random((int(source.integers(0, 3)), nodes)) < 0.4,
        justices=source.random((int(source.integers(0, 3)), nodes)) < 0.5,
    )


@settings(max_examples=400, deadline=None)
@given(st.integers(0, 2**32))
def test_the_environment_has_a_play_exactly_where_the_system_loses(seed: int) -> None:
    arena = random_arena(seed)
    wins = solve(arena).winning
    for node in range(arena.nodes):
        found = obstruction(arena, node)
        assert (found is None) == bool(wins[node])
        if found is None:
            continue
        assert found.nodes[0] == node
        assert all(after in arena.successors_of(before) for before, after in pairwise(found.nodes))
        last = found.nodes[-1]
        if found.repeats_from is None:
            assert arena.lost[last] or (arena.system[last] and not len(arena.successors_of(last)))
            continue
        loop = list(found.nodes[found.repeats_from :])
        assert loop[0] in arena.successors_of(last)
        assert arena.justices[:, loop].any(axis=1).all()
        assert found.goal is not None
        assert not arena.goals[found.goal, loop].any()


def test_the_system_heads_for_its_goal_as_long_as_it_can() -> None:
    """A corridor 0 - 1 - 2, the goal at 3 behind a door at 2 that the environment need not open."""
    arena = Arena(
        system=np.array([True, True, False, True]),
        first=np.array([0, 2, 3, 5, 6]),
        successors=np.array([0, 1, 2, 3, 1, 0]),
        lost=np.zeros(4, dtype=np.bool_),
        goals=np.array([[False, False, False, True]]),
        justices=np.zeros((0, 4), dtype=np.bool_),
    )
    found = obstruction(arena, 0)
    assert found is not None
    assert found.nodes == (0, 1, 2)
    assert found.repeats_from == 1
    assert found.goal == 0


def test_a_deadline_is_kept() -> None:
    arena = next(a for a in map(random_arena, range(100)) if len(a.goals) and not solve(a).winning[0])
    with pytest.raises(LimitExceeded):
        obstruction(arena, 0, deadline=Deadline.after(0.0))

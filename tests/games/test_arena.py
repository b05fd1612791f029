from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from gr1_oracle import arenas, make_arena
from hypothesis import given, settings
from hypothesis import strategies as st

from surefoot.games import Arena, reachable, restrict, solve, swap_players, with_goals

FIELDS: dict[str, Any] = {
    "system": np.array([True, False]),
    "first": np.array([0, 1, 2]),
    "successors": np.array([1, 0]),
    "lost": np.array([False, False]),
    "goals": np.zeros((1, 2), dtype=np.bool_),
    "justices": np.zeros((0, 2), dtype=np.bool_),
}


def edges_of(arena: Arena) -> list[list[int]]:
    return [arena.successors_of(v).tolist() for v in range(arena.nodes)]


def test_an_arena_keeps_read_only_copies() -> None:
    given_arrays = {name: array.copy() for name, array in FIELDS.items()}
    arena = Arena(**given_arrays)
    for name, array in given_arrays.items():
        array[...] = 1
        assert not getattr(arena, name).flags.writeable
    assert (arena.nodes, arena.edges, edges_of(arena)) == (2, 2, [[1], [0]])
    assert arena.degree.tolist() == [1, 1]


def test_what_is_read_only_already_is_not_copied() -> None:
    arena = Arena(**FIELDS)
    again = Arena(**{name: getattr(arena, name) for name in FIELDS})
    assert again.successors is arena.successors


@pytest.mark.parametrize(
    ("name", "wrong", "sentence"),
    [
        ("system", np.array([[True, False]]), "system is a boolean array of shape"),
        ("lost", np.array([0, 1]), "lost is a boolean array of shape"),
        ("lost", np.array([False]), "lost is a boolean array of shape"),
        ("goals", np.array([False, False]), "goals is a boolean array of shape"),
        ("justices", np.zeros((1, 3), dtype=np.bool_), "justices is a boolean array of shape"),
        ("successors", np.array([1, 2]), "successors are node numbers from 0 to 1"),
        ("successors", np.array([-1, 0]), "successors are node numbers from 0 to 1"),
        ("successors", np.array([1, 2**32]), "successors are node numbers from 0 to 1"),
        ("successors", np.array([1.0, 0.0]), "successors is a row of integers"),
        ("first", np.array([0, 2]), "first is a row of 3 integers"),
        ("first", np.array([0, 3, 2]), "first rises from 0"),
        ("first", np.array([1, 1, 2]), "first rises from 0"),
        ("first", np.array([0, 1, 1]), "first rises from 0"),
    ],
)
def test_what_does_not_fit_is_refused(name: str, wrong: object, sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        Arena(**{**FIELDS, name: wrong})


@settings(deadline=None)
@given(arena=arenas(), start=st.sets(st.integers(0, 7)))
def test_reachable_is_the_least_closed_set(arena: Arena, start: set[int]) -> None:
    start = {v for v in start if v < arena.nodes}
    seen = set(start)
    while fresh := {w for v in seen for w in arena.successors_of(v).tolist()} - seen:
        seen |= fresh
    assert set(np.flatnonzero(reachable(arena, sorted(start))).tolist()) == seen


@pytest.mark.parametrize("start", [2, -1, [0, 5]])
def test_reachable_refuses_nodes_that_do_not_exist(start: int | list[int]) -> None:
    with pytest.raises(ValueError, match="initial nodes are numbers from 0 to 1"):
        reachable(Arena(**FIELDS), start)


@settings(deadline=None)
@given(arena=arenas(), data=st.data())
def test_restrict_keeps_names_in_order(arena: Arena, data: st.DataObject) -> None:
    keep = np.array(data.draw(st.lists(st.booleans(), min_size=arena.nodes, max_size=arena.nodes)), dtype=np.bool_)
    old = np.flatnonzero(keep).tolist()
    part = restrict(arena, keep)
    expected = [[old.index(w) for w in arena.successors_of(v).tolist() if keep[w]] for v in old]
    assert edges_of(part) == expected
    for name in ("system", "lost", "goals", "justices"):
        np.testing.assert_array_equal(getattr(part, name), getattr(arena, name)[..., keep])


@settings(deadline=None)
@given(arena=arenas(), data=st.data())
def test_the_winner_is_the_same_in_the_reachable_part(arena: Arena, data: st.DataObject) -> None:
    seen = reachable(arena, data.draw(st.integers(0, arena.nodes - 1)))
    np.testing.assert_array_equal(solve(restrict(arena, seen)).winning, solve(arena).winning[seen])


@settings(deadline=None)
@given(arena=arenas())
def test_swapping_exchanges_owners_and_promises(arena: Arena) -> None:
    swapped = swap_players(arena)
    alive = ~arena.lost
    np.testing.assert_array_equal(swapped.system[alive], ~arena.system[alive])
    np.testing.assert_array_equal(swapped.goals, arena.justices)
    assert not swapped.lost.any()
    assert len(swapped.justices) == 0
    assert edges_of(swapped) == [[] if arena.lost[v] else row for v, row in enumerate(edges_of(arena))]
    assert not swapped.system[arena.lost].any()


@settings(deadline=None)
@given(arena=arenas(most_sets=0))
def test_staying_safe_is_determined(arena: Arena) -> None:
    """Either the system stays safe for ever or the environment forces it into a lost node or a dead end."""
    pressed = Arena(
        system=~arena.system & ~arena.lost,
        first=swap_players(arena).first,
        successors=swap_players(arena).successors,
        lost=np.zeros(arena.nodes, dtype=np.bool_),
        goals=np.zeros((1, arena.nodes), dtype=np.bool_),
        justices=np.zeros((0, arena.nodes), dtype=np.bool_),
    )
    forced = solve(pressed, env_dead_end="wins").winning
    np.testing.assert_array_equal(forced, ~solve(arena).winning)


def test_with_goals_picks_rows() -> None:
    arena = make_arena([True, True], [[1], [0]], set(), [{0}, {1}], [])
    assert with_goals(arena, 1).goals.tolist() == [[False, True]]
    assert with_goals(arena, ()).goals.shape == (0, 2)

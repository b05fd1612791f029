"""The encoding: verdicts as of the compact game and of reachability, no dead ends, and a file that says the same."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from skills_oracle import ALL, CLASSES, can_win, edges_of, grid, primitive_sets, terrain_states

from surefoot.errors import InputError
from surefoot.games import synthesize
from surefoot.games.region import winning_region
from surefoot.logic import parse_structuredslugs, read_specification, write_slugsin, write_structuredslugs
from surefoot.skills.encoding import Vocabulary, pair_specification, specification
from surefoot.skills.skill_game import arena_of, pair_game, solve_game
from surefoot.skills.values import Direction, Primitive, TerrainState


def verdict(state: TerrainState, request: tuple[int, int], primitives: frozenset[Primitive], **more: object) -> bool:
    spec = pair_specification(state, request, CLASSES, sorted(primitives), **more)  # type: ignore[arg-type]
    return bool(synthesize(spec, realizability_only=True).verdict)


@settings(max_examples=12, deadline=None)
@given(terrain_states(sizes=(3,)), primitive_sets(), st.data())
def test_every_cell_wins_in_the_encoding_as_in_the_compact_game(
    state: TerrainState, primitives: frozenset[Primitive], data: st.DataObject
) -> None:
    request = data.draw(st.sampled_from(state.cells()))
    edges = sorted(edges_of(state))
    disallowed = data.draw(st.frozensets(st.sampled_from(edges), max_size=3)) if edges else frozenset()
    spec = pair_specification(state, request, CLASSES, sorted(primitives), disallowed=disallowed)
    region = winning_region(spec, env_dead_end="loses")
    winning = solve_game(pair_game(state, request, primitives, disallowed=disallowed)).winning
    idle = dict.fromkeys((variable.name for variable in spec.outputs), 0)
    for row, column in state.cells():
        position = {f"x{k}": int(k == row) for k in range(3)} | {f"y{k}": int(k == column) for k in range(3)}
        found = region.contains(position | idle)
        assert found == ((row, column) in winning)


@settings(max_examples=8, deadline=None)
@given(terrain_states(sizes=(3,)), primitive_sets(), st.data())
def test_no_dead_end_is_reachable_so_both_readings_agree(
    state: TerrainState, primitives: frozenset[Primitive], data: st.DataObject
) -> None:
    request = data.draw(st.sampled_from(state.cells()))
    spec = pair_specification(state, request, CLASSES, sorted(primitives))
    wins = synthesize(spec, env_dead_end="wins", realizability_only=True)
    loses = synthesize(spec, env_dead_end="loses", realizability_only=True)
    assert bool(wins.verdict) == bool(loses.verdict) == can_win(state, request, primitives)
    if wins.verdict:
        assert synthesize(spec).warnings == ()
    arena = arena_of(pair_game(state, request, primitives))
    assert (arena.degree[~arena.system] > 0).all()


def test_files_say_the_same(tmp_path: Path) -> None:
    state, request = grid("ggg", "fff", "ddd"), (0, 1)
    skills = [one for one in ALL if "gap" not in (one.here, one.next)]
    for primitives, expected in ((skills, False), ([*skills, Primitive(Direction.FORWARD, "flat", "gap")], True)):
        spec = pair_specification(state, request, CLASSES, primitives, forbidden=[ALL[0]])
        for name, text in (("a.structuredslugs", write_structuredslugs(spec)), ("a.slugsin", write_slugsin(spec))):
            (tmp_path / name).write_text(text)
            assert bool(synthesize(read_specification(tmp_path / name)).verdict) is expected


def test_partial_evaluation_leaves_positions_and_usable_skills() -> None:
    spec = pair_specification(grid("fff", "fff", "fgf"), (0, 0), CLASSES, ALL)
    assert [variable.name for variable in spec.inputs] == ["x0", "x1", "x2", "y0", "y1", "y2"]
    named = {variable.name for variable in spec.outputs}
    assert {"forward_flat_to_flat", "left_gap_to_flat", "backward_flat_to_gap"} <= named
    assert not any("dense" in name or "sparse" in name for name in named)
    assert "forward_flat_to_gap" not in named


def test_the_whole_specification_keeps_terrain_and_request_open_and_is_readable() -> None:
    words = Vocabulary(3, 3, CLASSES, ALL[:6])
    read = parse_structuredslugs(write_structuredslugs(specification(words)))
    assert sum(len(variable.bits) for variable in read.inputs) == 6 + 6 + 9 * 3  # five values: three bits a cell
    assert len(read.outputs) == 6


def test_a_disallowed_move_is_a_guarantee_not_an_assumption() -> None:
    state, primitives = grid("f", "f", "f"), frozenset(ALL)
    assert verdict(state, (0, 0), primitives)
    assert not verdict(state, (0, 0), primitives, disallowed=[((1, 0), (0, 0))])
    assert verdict(state, (0, 0), primitives, disallowed=[((0, 0), (1, 0))])


def test_classes_that_would_be_spelled_alike_are_numbered() -> None:
    words = Vocabulary(3, 1, ("high gap", "high-gap"), (Primitive(Direction.LEFT, "high gap", "high-gap"),))
    assert words.skill_name(words.primitives[0]) == "left_class0_to_class1"


def test_unknown_classes_are_refused() -> None:
    with pytest.raises(InputError, match=r"'gap' is no terrain class; there are: flat, obstacle"):
        pair_specification(grid("g", "f", "f"), (0, 0), ("flat",), ())

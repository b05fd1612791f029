"""Skills with headings: compact game, specification and repair against shortest paths on (cell, heading)."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from skills_heading_oracle import (
    ALL,
    CLASSES,
    FORWARD_ONLY,
    direction_sets,
    distances,
    edges_of,
    grid,
    primitive_sets,
    terrain_states,
    turning,
)
from skills_oracle import Recorded, results

from surefoot.errors import InputError
from surefoot.games import synthesize
from surefoot.games.region import winning_region
from surefoot.logic import parse_structuredslugs, read_specification, write_slugsin, write_structuredslugs
from surefoot.skills.encoding import Vocabulary
from surefoot.skills.heading_encoding import heading_pair_specification, heading_specification
from surefoot.skills.headings import Pose, Turning, read_turning, turning_object
from surefoot.skills.manager import Knowledge, Outcome, PairAnswer, handle, paper_order
from surefoot.skills.next_skill import next_skill, steps
from surefoot.skills.shortest import fewest_new
from surefoot.skills.skill_game import framed_game, solve_game
from surefoot.skills.values import Direction, Primitive, TerrainState, Turn

CORNER = grid("#ff", "#f#", "#f#")
"""Ahead, and then to the right."""

FLAT = [
    Primitive(Direction.FORWARD, "flat", "flat"),
    Primitive(Turn.LEFT, "flat", "flat"),
    Primitive(Turn.RIGHT, "flat", "flat"),
]


def values_of(pose: Pose) -> dict[str, int]:
    (row, column), heading = pose
    named = {f"x{k}": int(k == row) for k in range(3)} | {f"y{k}": int(k == column) for k in range(3)}
    return named | {f"h{k}": int(k == heading) for k in range(4)}


@settings(max_examples=60, deadline=None)
@given(terrain_states(), primitive_sets(), direction_sets(), st.sets(st.integers(0, 3), min_size=1), st.data())
def test_the_compact_game_is_won_from_where_a_path_leads(
    state: TerrainState,
    primitives: frozenset[Primitive],
    directions: tuple[Direction, ...],
    facing: set[int],
    data: st.DataObject,
) -> None:
    request = data.draw(st.sampled_from(state.cells()))
    disallowed = data.draw(st.frozensets(st.sampled_from(sorted(edges_of(state, directions))), max_size=4))
    frame = turning(directions, facing)
    solved = solve_game(framed_game(frame, state, request, primitives, disallowed=disallowed))
    expected = distances(state, request, primitives, directions, disallowed, facing)
    assert solved.winning == expected.keys()
    for pose, move in solved.strategy.items():
        after = 0 if move is None else expected[move.targets[0]]
        assert expected[pose] == (0 if move is None else after + 1)


@settings(max_examples=6, deadline=None)
@given(terrain_states(), primitive_sets(), direction_sets(), st.data())
def test_every_pose_wins_in_the_specification_as_in_the_compact_game(
    state: TerrainState, primitives: frozenset[Primitive], directions: tuple[Direction, ...], data: st.DataObject
) -> None:
    request = data.draw(st.sampled_from(state.cells()))
    disallowed = data.draw(st.frozensets(st.sampled_from(sorted(edges_of(state, directions))), max_size=3))
    frame = turning(directions)
    spec = heading_pair_specification(state, request, frame, sorted(primitives), disallowed=disallowed)
    region = winning_region(spec, env_dead_end="loses")
    expected = distances(state, request, primitives, directions, disallowed)
    idle = dict.fromkeys((variable.name for variable in spec.outputs), 0)
    for pose in frame.states(state):
        assert region.contains(values_of(pose) | idle) == (pose in expected)


@settings(max_examples=4, deadline=None)
@given(terrain_states(), primitive_sets(), st.data())
def test_no_dead_end_is_reachable_so_both_readings_agree(
    state: TerrainState, primitives: frozenset[Primitive], data: st.DataObject
) -> None:
    request = data.draw(st.sampled_from(state.cells()))
    spec = heading_pair_specification(state, request, turning(), sorted(primitives))
    wins = synthesize(spec, env_dead_end="wins", realizability_only=True)
    loses = synthesize(spec, env_dead_end="loses", realizability_only=True)
    expected = (state.centre, 0) in distances(state, request, primitives, tuple(Direction))
    assert bool(wins.verdict) == bool(loses.verdict) == expected


@pytest.mark.parametrize(("skills", "expected"), [(FLAT, True), (FLAT[:2], True), (FLAT[:1], False)])
def test_files_say_the_same(tmp_path: Path, skills: list[Primitive], expected: bool) -> None:
    spec = heading_pair_specification(CORNER, (0, 2), turning(FORWARD_ONLY), skills, forbidden=[ALL[0]])
    for name, text in (("a.structuredslugs", write_structuredslugs(spec)), ("a.slugsin", write_slugsin(spec))):
        (tmp_path / name).write_text(text)
        assert bool(synthesize(read_specification(tmp_path / name)).verdict) is expected


@pytest.mark.parametrize(
    ("sign", "request_cell", "skills"),
    [("x0 <->", (0, 2), FLAT), ("h0 <->", (0, 1), FLAT[:1])],
    ids=["a turn could carry the robot away", "a move could turn it"],
)
def test_without_a_frame_condition_nothing_is_sure(
    sign: str, request_cell: tuple[int, int], skills: list[Primitive]
) -> None:
    facing = turning(FORWARD_ONLY, facing=[0] if len(skills) == 1 else range(4))
    spec = heading_pair_specification(CORNER, request_cell, facing, skills)
    framing = [line for line in spec.env_trans_hard if sign in line.text and "->" in line.text]
    assert framing
    loose = replace(spec, env_trans_hard=tuple(line for line in spec.env_trans_hard if line not in framing))
    assert synthesize(spec, realizability_only=True).verdict
    assert not synthesize(loose, realizability_only=True).verdict


def test_the_whole_specification_leaves_terrain_request_and_pose_open() -> None:
    words = Vocabulary(3, 3, CLASSES, (*ALL[:4], *ALL[-2:]))
    read = parse_structuredslugs(write_structuredslugs(heading_specification(words, turning())))
    named = {variable.name for variable in read.inputs}
    assert {"h0", "h3", "rh0", "rh3", "n_1_1"} <= named
    assert "turn_right_bars_to_rods" in {variable.name for variable in read.outputs}
    assert sum(len(variable.bits) for variable in read.inputs) == 6 + 4 + 6 + 4 + 9 * 2


def test_partial_evaluation_leaves_poses_and_usable_skills() -> None:
    spec = heading_pair_specification(CORNER, (0, 2), turning(FORWARD_ONLY), ALL)
    assert [variable.name for variable in spec.inputs] == ["x0", "x1", "x2", "y0", "y1", "y2", "h0", "h1", "h2", "h3"]
    expected = {"forward_flat_to_flat", "turn_left_flat_to_flat", "turn_right_flat_to_flat"}
    assert {variable.name for variable in spec.outputs} == expected


def test_headings_wrap_around_and_labels_turn_with_them() -> None:
    state, frame = grid("fff", "fbf", "fff"), turning()
    pose: Pose = ((1, 1), 0)
    for heading in (1, 2, 3, 0):
        pose = frame.after(pose, Turn.LEFT)
        assert pose == ((1, 1), heading)
    assert frame.after(((1, 1), 0), Turn.RIGHT) == ((1, 1), 3)
    assert frame.primitive(state, ((1, 1), 0), Direction.FORWARD) == Primitive(Direction.FORWARD, "bars", "flat")
    assert frame.primitive(state, ((1, 1), 1), Direction.FORWARD) == Primitive(Direction.FORWARD, "rods", "flat")
    assert frame.after(((1, 1), 1), Direction.FORWARD) == ((1, 0), 1)
    assert frame.primitive(state, ((1, 1), 3), Turn.LEFT) == Primitive(Turn.LEFT, "rods", "bars")


@settings(max_examples=25, deadline=None)
@given(terrain_states(), primitive_sets(), primitive_sets(), direction_sets(), st.booleans(), st.data())
def test_repair_finds_a_way_whenever_there_is_one(
    state: TerrainState,
    at_hand: frozenset[Primitive],
    refused: frozenset[Primitive],
    directions: tuple[Direction, ...],
    papers: bool,
    data: st.DataObject,
) -> None:
    request, frame = data.draw(st.sampled_from(state.cells())), turning(directions)
    physics = Recorded(set(ALL) - refused | at_hand)
    knowledge = Knowledge(results(at_hand))
    order = {"order": paper_order()} if papers else {}
    answer, after = handle(state, request, knowledge, physics, frame=frame, **order)  # type: ignore[arg-type]
    possible = distances(state, request, physics.feasible, directions)
    before = distances(state, request, at_hand, directions)
    start = frame.start(state)
    assert (answer.outcome is Outcome.UNREPAIRABLE) is (start not in possible)
    assert (answer.outcome is Outcome.REALIZABLE) is (start in before)
    assert after.skills <= physics.feasible
    assert answer.strategy == {}
    if answer.outcome is Outcome.REPAIRED:
        assert 0 < answer.fewest <= len(answer.new)
        assert answer.fewest == fewest_new(state, request, at_hand, after.refused, frame=frame)
    if start in possible:
        walk = steps(frame, answer)
        assert all(step.primitive in after.skills for step in walk)
        assert len(walk) == distances(state, request, after.skills, directions)[start]


def test_the_next_skill_keeps_the_heading_or_the_cell() -> None:
    frame = turning(FORWARD_ONLY)
    answer, _ = handle(CORNER, (0, 2), Knowledge(), Recorded(ALL), frame=frame)
    pose: Pose = ((1, 1), 0)
    ways = []
    for step in steps(frame, answer):
        assert next_skill(frame, answer, *pose) == step
        turns = isinstance(step.primitive.direction, Turn)
        assert (step.cell == pose[0]) is turns
        assert (step.heading == pose[1]) is not turns
        pose = step.cell, step.heading
        ways.append(step.primitive.direction)
    assert ways == [Direction.FORWARD, Turn.RIGHT, Direction.FORWARD]
    assert next_skill(frame, answer, (0, 2), 3) is next_skill(frame, answer, (0, 2), -1) is None
    with pytest.raises(InputError, match=r"no way to \(0, 2\) from \(0, 0\) facing ahead"):
        next_skill(frame, answer, (0, 0), 0)


def test_a_request_may_ask_for_a_heading() -> None:
    frame = turning(FORWARD_ONLY, facing=[0])
    answer, knowledge = handle(CORNER, (0, 2), Knowledge(), Recorded(ALL), frame=frame)
    assert steps(frame, answer)[-1].heading == 0
    assert steps(frame, answer)[-1].primitive.direction is Turn.LEFT
    spec = heading_pair_specification(CORNER, (0, 2), frame, sorted(knowledge.skills))
    assert bool(synthesize(spec, realizability_only=True).verdict)


def test_a_failed_turn_is_disallowed_here_and_its_skill_stays() -> None:
    frame, failed = turning(FORWARD_ONLY), (((0, 1), 0), ((0, 1), 3))
    answer, knowledge = handle(CORNER, (0, 2), Knowledge(), Recorded(ALL), frame=frame, disallowed=[failed])
    assert failed not in walked(frame, answer)
    assert Primitive(Turn.RIGHT, "flat", "flat") not in knowledge.refused
    closed = [failed, (((0, 1), 2), ((0, 1), 3)), (((1, 1), 0), ((1, 1), 3)), (((1, 1), 2), ((1, 1), 3))]
    closed += [(((2, 1), 0), ((2, 1), 3)), (((2, 1), 2), ((2, 1), 3))]
    lost, _ = handle(CORNER, (0, 2), knowledge, Recorded(ALL), frame=frame, disallowed=closed)
    assert lost.outcome is Outcome.UNREPAIRABLE
    assert lost.why is not None
    assert "failed here" in lost.why.text


def walked(frame: Turning, answer: PairAnswer) -> list[tuple[Pose, Pose]]:
    """Return the poses before and after every skill of a strategy."""
    after: list[Pose] = [(step.cell, step.heading) for step in steps(frame, answer)]
    return list(pairwise([frame.start(answer.state), *after]))


def test_what_is_no_turning_is_refused() -> None:
    with pytest.raises(InputError, match="its own name after two"):
        Turning((("bars", "rods"), ("rods", "rods")))
    with pytest.raises(InputError, match="headings 0 to 3"):
        turning(facing=[4])
    assert read_turning(turning_object(turning(FORWARD_ONLY)), CLASSES) == turning(FORWARD_ONLY)
    with pytest.raises(InputError, match="exactly flat, bars, rods, gap"):
        read_turning(turning_object(turning()), (*CLASSES, "gap"))

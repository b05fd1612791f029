"""Partial evaluation, unrealizable cores and vacuity."""

from __future__ import annotations

import random
from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gr1_specs import random_specification
from naive_gr1 import solve_naively
from surefoot.errors import InputError
from surefoot.games import partial_evaluation, synthesize, unrealizable_core
from surefoot.games.cores import Memory, keeping, minimal
from surefoot.games.vacuity import vacuities
from surefoot.logic import Conjunct, Evaluator, infix, parse_structuredslugs
from surefoot.logic.syntax import Constant

TERRAIN = """[INPUT]
wet
cell:0...3
[OUTPUT]
jump
[ENV_TRANS]
jump & !wet -> cell' = cell + 1
cell@0.0.3 -> wet'
[SYS_TRANS]
wet -> !jump
[SYS_LIVENESS]
cell' = 3
"""


def test_known_variables_vanish_and_constants_are_folded() -> None:
    left = partial_evaluation(parse_structuredslugs(TERRAIN), {"wet": False})
    assert [v.name for v in left.variables] == ["cell", "jump"]
    lines = {c.line: infix(c.expression) for c in left.conjuncts}
    assert lines == {7: "!jump | cell' = cell + 1", 8: "!cell@0.0.3", 12: "cell' = 3"}
    wet = partial_evaluation(parse_structuredslugs(TERRAIN), {"wet": True, "cell": 1})
    assert {c.line: infix(c.expression) for c in wet.conjuncts} == {10: "!jump", 12: "FALSE"}


@pytest.mark.parametrize(
    ("known", "complaint"),
    [({"ice": True}, "ice is not declared; declared are: wet, cell, jump"), ({"cell": 4}, "cell never is 4")],
)
def test_unknown_names_and_values_are_bad_input(known: dict[str, int], complaint: str) -> None:
    with pytest.raises(InputError, match=complaint):
        partial_evaluation(parse_structuredslugs(TERRAIN), known)


@settings(max_examples=80, deadline=None)
@given(st.integers(0, 2**32))
def test_partial_evaluation_means_the_same_where_the_values_are_known(seed: int) -> None:
    source = random.Random(seed)
    spec = random_specification(source)
    known = {v.name: source.choice(v.values) for v in spec.variables if source.random() < 0.5}
    left = partial_evaluation(spec, known)
    before, after = Evaluator(spec), Evaluator(left)
    names = [v.name for v in spec.variables]
    states = [dict(zip(names, row, strict=True)) | known for row in product(*(v.values for v in spec.variables))]
    lines = {(c.section, c.line): c for c in left.conjuncts}
    for conjunct in spec.conjuncts:
        kept = lines.get((conjunct.section, conjunct.line))
        assert kept is None or not (isinstance(kept.expression, Constant) and kept.expression.value)
        for now, following in zip(states, reversed(states), strict=True):
            expected = bool(before(conjunct.expression, now, following))
            assert (kept is None or bool(after(kept.expression, now, following))) == expected


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32), st.sampled_from(["slugs", "robotics"]))
def test_cores_are_unrealizable_and_minimal(seed: int, semantics: str) -> None:
    spec = random_specification(random.Random(seed))
    if solve_naively(spec, semantics=semantics).realizable:
        with pytest.raises(ValueError, match="is realizable"):
            unrealizable_core(spec, semantics=semantics)
        return
    found = unrealizable_core(spec, semantics=semantics)
    core = found.lines
    assert found.minimal
    candidates = spec.system_safety + spec.sys_liveness + (spec.sys_init if semantics == "slugs" else ())
    assert not solve_naively(keeping(spec, core, candidates), semantics=semantics).realizable
    for line in core:
        others = tuple(other for other in core if other is not line)
        assert solve_naively(keeping(spec, others, candidates), semantics=semantics).realizable


def test_a_search_that_is_cut_short_returns_what_it_has(monkeypatch: pytest.MonkeyPatch) -> None:
    from surefoot.compute import Deadline
    from surefoot.errors import LimitExceeded
    from surefoot.games.subsets import Subsets

    text = "[INPUT]\na\n[OUTPUT]\nc\nd\n[SYS_TRANS]\nc' <-> d'\nd' <-> a'\nc'\nd' | c'\n[SYS_LIVENESS]\nc\n"
    spec = parse_structuredslugs(text)
    honest, asked = Subsets.realizable, []

    def tired(self: Subsets, kept: tuple[Conjunct, ...], deadline: Deadline) -> bool:
        asked.append(kept)
        if len(asked) > 3:
            raise LimitExceeded("enough")
        return honest(self, kept, deadline)

    monkeypatch.setattr(Subsets, "realizable", tired)
    core = unrealizable_core(spec)
    assert not core.minimal
    assert core.limit == "enough"
    assert len(core.lines) > 2
    assert not synthesize(keeping(spec, core.lines, spec.sys_trans + spec.sys_liveness)).verdict
    monkeypatch.undo()
    full = unrealizable_core(spec)
    assert full.minimal
    assert len(full.lines) == 3


def test_remembered_sets_spare_questions() -> None:
    lines = tuple(Conjunct("SYS_TRANS", Constant(True), str(k), k) for k in range(64))
    needed = {lines[3], lines[40]}
    memory = Memory(lambda kept: needed <= set(kept))
    assert memory.holds(lines)
    assert set(minimal(lines, memory.holds)) == needed
    assert memory.asked < 40
    assert minimal(lines, lambda kept: True) == ()


def kinds(text: str) -> list[tuple[str, list[int]]]:
    spec = parse_structuredslugs(text)
    strategy = synthesize(spec).strategy
    assert strategy is not None
    return [(kind, [line.line for line in lines]) for kind, _, lines in vacuities(spec, strategy)]


def test_a_fair_specification_gives_no_warning() -> None:
    assert kinds("[INPUT]\na\n[OUTPUT]\nc\n[ENV_LIVENESS]\na\n!a\n[SYS_LIVENESS]\nc & a\n") == []


def test_an_overflow_in_the_environment_is_a_dead_end_with_its_line() -> None:
    text = "[INPUT]\nx:0...4\nb\n[OUTPUT]\nc\n[ENV_INIT]\nx = 0\n[ENV_TRANS]\nb' | c\nx' = x + 1\n"
    assert kinds(text) == [("env_dead_end", [10])]


def test_contradicting_initial_conditions_are_named() -> None:
    text = "[INPUT]\nx:0...4\nb\n[OUTPUT]\nc\n[ENV_INIT]\nb\nx > 2\nx < 2\n"
    assert kinds(text) == [("false_initial", [8, 9])]


def test_a_system_that_keeps_the_environment_from_its_justice() -> None:
    text = "[INPUT]\nseen\n[OUTPUT]\nhide\n[ENV_TRANS]\nhide -> !seen'\n"
    text += "[ENV_LIVENESS]\n!seen\nseen\n[SYS_LIVENESS]\nFALSE\n"
    assert kinds(text) == [("falsified_assumption", [9])]


def test_a_question_that_gives_up_leaves_the_core_minimal() -> None:
    """Large pieces are glanced at, and hard ones kept for now; single lines are always decided."""
    needed, items = {3, 11, 12}, tuple(range(16))
    asked: list[int] = []

    def glance(kept: tuple[int, ...]) -> bool:
        asked.append(len(kept))
        return len(kept) < 9 and needed <= set(kept)

    found = minimal(items, lambda kept: needed <= set(kept), glance)
    assert set(found) == needed
    assert asked


def test_memories_share_what_they_know_and_keep_no_guesses() -> None:
    lines = tuple(Conjunct("SYS_TRANS", Constant(True), str(k), k) for k in range(4))
    memory = Memory(lambda kept: len(kept) > 2)
    hurried = Memory(lambda kept: None, memory.yes, memory.no)
    assert not hurried.holds(lines[:3])
    assert memory.holds(lines[:3])
    assert hurried.holds(lines[:3])
    assert (memory.asked, hurried.asked) == (1, 1)

"""What the readers of specifications understand."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from surefoot.errors import InputError
from surefoot.logic import Conjunct, Evaluator, infix, parse_slugsin, parse_structuredslugs, read_specification
from surefoot.logic.syntax import And, Atom, Implies, Variable, postorder

SPECS = Path(__file__).parents[3] / "shared" / "data" / "specs"
DECLARED = "[INPUT]\na\nb\nx:0...5\n[OUTPUT]\nc\ny:2...9\n"


def line(text: str, section: str = "SYS_TRANS") -> Conjunct:
    """Return the conjunct of one line over a, b, x (inputs) and c, y (outputs)."""
    (found,) = parse_structuredslugs(f"{DECLARED}[{section}]\n{text}\n").conjuncts
    return found


def holds(text: str, now: dict[str, int], after: dict[str, int] | None = None) -> bool:
    specification = parse_structuredslugs(f"{DECLARED}[SYS_TRANS]\n{text}\n")
    return bool(Evaluator(specification)(specification.sys_trans[0].expression, now, after))


@pytest.mark.skipif(not SPECS.is_dir(), reason="../shared/data/specs is absent")
def test_every_stored_specification_is_read() -> None:
    paths = sorted(SPECS.rglob("*.*slugs*"))
    assert len(paths) == 27
    for path in paths:
        found = read_specification(path)
        assert found.outputs
        assert found.conjuncts
        lines = path.read_text().splitlines()
        for conjunct in found.conjuncts:
            begin = conjunct.column - 1
            assert lines[conjunct.line - 1][begin : begin + len(conjunct.text)] == conjunct.text


def test_sections_may_come_in_any_order_and_again() -> None:
    found = parse_slugsin("[SYS_TRANS]\nc\n[OUTPUT]\nc\n[INPUT]\na\n[SYS_TRANS] # more\n! a # why\n\n[ENV_LIVENESS]\n")
    assert [(c.section, c.text, c.line, c.column) for c in found.sys_trans] == [
        ("SYS_TRANS", "c", 2, 1),
        ("SYS_TRANS", "! a", 8, 1),
    ]
    assert found.env_liveness == ()


def test_hard_sections_are_safety_and_the_other_repair_sections_are_kept_apart() -> None:
    hard = "[ENV_TRANS]\na'\n[ENV_TRANS_HARD]\nb'\n[SYS_TRANS_HARD]\nc'\n"
    text = f"{DECLARED}{hard}[CHANGE_CONS]\nc -> c'\n[NOT_ALLOWED_REPAIR]\na\n"
    found = parse_structuredslugs(text)
    assert [c.text for c in found.environment_safety] == ["a'", "b'"]
    assert [c.text for c in found.system_safety] == ["c'"]
    assert [c.section for c in found.conjuncts][-2:] == ["CHANGE_CONS", "NOT_ALLOWED_REPAIR"]


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("a | b & c", "a | b & c"),
        ("(a | b) & c", "(a | b) & c"),
        ("a ^ b | c", "a ^ b | c"),
        ("a -> b -> c", "a -> b -> c"),
        ("a <-> b -> c", "a <-> b -> c"),
        ("! x = 3", "!(x = 3)"),
        ("!a & b", "!a & b"),
        (r"a /\ b \/ c && a || b", "a & b | c & a | b"),
        ("~ a --> b <--> c", "!a -> b <-> c"),
        ("[a | b] & (TRUE)", "(a | b) & TRUE"),
        ("next(a | x = 3) & X c & ()b", "(a' | x' = 3) & c' & b'"),
        ("x+1+y >= -2+x'", "x + 1 + y >= -2 + x'"),
        ("x == 3", "x = 3"),
        ("| ! a & b c'", "!a | b & c'"),
        ("x@1 & a", "x@1 & a"),
    ],
)
def test_infix_notation(text: str, meaning: str) -> None:
    assert infix(line(text).expression) == meaning


def test_implication_associates_to_the_left_as_in_slugs() -> None:
    expression = line("a -> b -> c").expression
    assert isinstance(expression, Implies)
    assert isinstance(expression.left, Implies)


def test_long_chains_become_one_node() -> None:
    expression = line(" & ".join(["a"] * 5000)).expression
    assert isinstance(expression, And)
    assert len(expression.operands) == 5000


def test_operators_that_are_declared_are_variables() -> None:
    found = parse_structuredslugs("[OUTPUT]\nX\nG\nnext\n[SYS_TRANS]\nX & G' & next\n")
    assert {n.name for n in postorder([found.sys_trans[0].expression]) if isinstance(n, Atom)} == {"X", "G", "next"}


@pytest.mark.parametrize("value", range(6))
def test_sums_are_exact_and_nothing_overflows(value: int) -> None:
    assert holds("x' = x + 1", {"x": value}, {"x": value + 1})
    assert not any(holds("x' = x + 1", {"x": 5}, {"x": after}) for after in range(6))
    assert holds("x + x + y >= 4 + x + y", {"x": value, "y": 3}) == (value >= 4)


def test_bits_are_those_of_the_value_minus_its_lower_limit() -> None:
    assert Variable("y", 2, 9).bits == ("y@0.2.9", "y@1", "y@2")
    assert Variable("flag").bits == ("flag",)
    assert Variable("one", 4, 4).bits == ()
    assert [holds("y@1", {"y": value}) for value in (2, 3, 4, 5, 6)] == [False, False, True, True, False]


def test_buffers_are_shared_objects() -> None:
    found = parse_slugsin("[INPUT]\na\nb\n[OUTPUT]\nc\n[SYS_TRANS]\n$ 3 ^ a b & ? 0 c | ? 1 ? 0\n")
    expression = found.sys_trans[0].expression
    assert infix(expression) == "(a ^ b) & c | (a ^ b)"
    assert len(postorder([expression])) == 6
    evaluate = Evaluator(found)
    values = [(a, b, c) for a in (0, 1) for b in (0, 1) for c in (0, 1)]
    assert [bool(evaluate(expression, {"a": a, "b": b, "c": c})) for a, b, c in values] == [
        a != b for a, b, c in values
    ]


def test_an_inner_buffer_hides_the_outer_one() -> None:
    found = parse_slugsin("[INPUT]\na\nb\n[OUTPUT]\nc\n[SYS_TRANS]\n$ 2 a & ? 0 $ 2 b ! ? 0\n")
    assert infix(found.sys_trans[0].expression) == "a & !b"


def test_prefix_operators_need_no_blanks() -> None:
    found = parse_slugsin("[INPUT]\na\n[OUTPUT]\nc\n[SYS_TRANS]\n|!a &c' a'\n")
    assert infix(found.sys_trans[0].expression) == "!a | c' & a'"


def test_the_format_is_told_by_suffix_or_content(tmp_path: Path) -> None:
    infix_file, prefix_file = tmp_path / "one.txt", tmp_path / "two.txt"
    infix_file.write_text("[INPUT]\r\na # not = this\r\n[OUTPUT]\r\nc\r\n[SYS_TRANS]\r\na -> c'\r\n", newline="")
    prefix_file.write_text("[INPUT]\na\n[OUTPUT]\nc # ->\n[SYS_TRANS]\n| ! a c'\n")
    assert isinstance(read_specification(infix_file).sys_trans[0].expression, Implies)
    assert infix(read_specification(prefix_file).sys_trans[0].expression) == "!a | c'"
    assert len(read_specification(prefix_file).sha256) == 64


@pytest.mark.parametrize("size", [50_000])
@pytest.mark.parametrize("shape", ["!", "& a", "$ 1", "(", "next (", "a ->", "^ a"])
def test_deep_nesting_is_read_or_refused_in_bounded_time(shape: str, size: int) -> None:
    begun = time.process_time()
    declared = "[INPUT]\na\n[OUTPUT]\nc\n[SYS_TRANS]\n"
    if shape in ("(", "next ("):
        text = shape * size + "a" + ")" * size
        reader = parse_structuredslugs
    elif shape == "a ->":
        text, reader = " ".join([shape] * size) + " a", parse_structuredslugs
    else:
        text, reader = " ".join([shape] * size) + " a", parse_slugsin
    try:
        found = reader(declared + text)
    except InputError as problem:
        assert ":6: column " in str(problem)  # noqa: PT017
    else:
        expression = found.sys_trans[0].expression
        assert infix(expression)
        assert Evaluator(found)(expression, {"a": 1}).shape == ()
    assert time.process_time() - begun < 60

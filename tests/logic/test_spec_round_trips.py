"""What is written is read back with its structure (infix) and its meaning (prefix); lowering keeps the meaning."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import pytest
from hypothesis import given, settings

from gr1_specs import same, specifications
from surefoot.errors import InputError
from surefoot.logic import (
    Evaluator,
    Lowering,
    Specification,
    parse_slugsin,
    parse_structuredslugs,
    range_conjuncts,
    read_specification,
    write_slugsin,
    write_structuredslugs,
)
from surefoot.logic.syntax import And, Atom, Constant, Not, Or, Xor, postorder

SPECS = Path(__file__).parents[3] / "shared" / "data" / "specs"


def bits_of(spec: Specification, values: dict[str, int]) -> dict[str, int]:
    """Return the value of every bit."""
    return {bit: (values[v.name] - v.values[0]) >> k & 1 for v in spec.variables for k, bit in enumerate(v.bits)}


def steps(spec: Specification) -> list[tuple[dict[str, int], dict[str, int]]]:
    """Return some pairs of valuations."""
    names = [v.name for v in spec.variables]
    states = [dict(zip(names, row, strict=True)) for row in product(*(v.values for v in spec.variables))]
    return [(states[(7 * k) % len(states)], states[(11 * k + 3) % len(states)]) for k in range(12)]


@settings(max_examples=100, deadline=None)
@given(specifications())
def test_infix_round_trip(spec: Specification) -> None:
    text = write_structuredslugs(spec)
    read = parse_structuredslugs(text)
    assert (read.inputs, read.outputs) == (spec.inputs, spec.outputs)
    assert [c.section for c in read.conjuncts] == [c.section for c in spec.conjuncts]
    for one, other in zip(spec.conjuncts, read.conjuncts, strict=True):
        assert same(one.expression, other.expression)
    assert write_structuredslugs(read) == text


@settings(max_examples=100, deadline=None)
@given(specifications())
def test_prefix_round_trip_keeps_the_meaning(spec: Specification) -> None:
    read = parse_slugsin(write_slugsin(spec))
    assert [v.name for v in read.inputs] == [bit for v in spec.inputs for bit in v.bits]
    written = {name: [c for c in read.conjuncts if c.section == name] for name in {c.section for c in read.conjuncts}}
    mean, meant = Evaluator(read), Evaluator(spec)
    limits = range_conjuncts(spec)
    for section in ("ENV_INIT", "SYS_INIT", "ENV_TRANS", "SYS_TRANS", "ENV_LIVENESS", "SYS_LIVENESS"):
        original = [*getattr(spec, section.lower()), *(c for c in limits if c.section == section)]
        assert len(original) == len(written.get(section, []))
        for one, other in zip(original, written.get(section, []), strict=True):
            for now, after in steps(spec):
                expected = bool(meant(one.expression, now, after))
                assert bool(mean(other.expression, bits_of(spec, now), bits_of(spec, after))) == expected


@settings(max_examples=100, deadline=None)
@given(specifications())
def test_lowering_agrees_with_the_evaluator_of_integers(spec: Specification) -> None:
    lowering, evaluate = Lowering(spec), Evaluator(spec)
    for conjunct in (*spec.conjuncts, *range_conjuncts(spec)):
        lowered = lowering.boolean(conjunct.expression)
        assert all(isinstance(n, Constant | Atom | Not | And | Or | Xor) for n in postorder([lowered]))
        assert lowering.boolean(conjunct.expression) is lowered
        for now, after in steps(spec):
            assert bool(evaluate(lowered, now, after)) == bool(evaluate(conjunct.expression, now, after))


@pytest.mark.skipif(not SPECS.is_dir(), reason="../shared/data/specs is absent")
def test_stored_specifications_survive_both_formats() -> None:
    for path in sorted(SPECS.rglob("*.*slugs*")):
        spec = read_specification(path)
        assert len(parse_slugsin(write_slugsin(spec)).conjuncts) == len(spec.conjuncts) + len(range_conjuncts(spec))
        if path.parent.name != "gr1experiments":
            text = write_structuredslugs(spec)
            assert write_structuredslugs(parse_structuredslugs(text)) == text


def test_a_buffer_chain_is_written_with_buffers_and_refused_in_infix() -> None:
    chain = " ".join(["a", *(f"| & ? {k} a ! ? {k}" for k in range(60))])
    spec = parse_slugsin(f"[INPUT]\na\n[OUTPUT]\nc\n[SYS_TRANS]\n$ 61 {chain}\n")
    assert len(write_slugsin(spec)) < 3000
    with pytest.raises(InputError, match="too large without buffers; write it as slugsin"):
        write_structuredslugs(spec)

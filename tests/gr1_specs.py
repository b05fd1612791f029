"""Random GR(1) specifications for Hypothesis, and structural comparison of expressions."""

from __future__ import annotations

from dataclasses import dataclass

from hypothesis import strategies as st

from surefoot.logic import Conjunct, Specification, Variable
from surefoot.logic.syntax import (
    COMPARISONS,
    And,
    Atom,
    Comparison,
    Constant,
    Expression,
    Iff,
    Implies,
    Integer,
    Node,
    Not,
    Number,
    Or,
    Sum,
    Term,
    Xor,
    children,
)


@dataclass(frozen=True)
class Mentions:
    """What an expression may mention: (variable, primed)."""

    leaves: tuple[tuple[Variable, bool], ...]


def expressions(mentions: Mentions, *, integers: bool = True) -> st.SearchStrategy[Expression]:
    """Return expressions in the normal form of the readers: no conjunction directly inside a conjunction."""
    booleans = [(v, p) for v, p in mentions.leaves if v.is_boolean]
    numbers = [(v, p) for v, p in mentions.leaves if not v.is_boolean] if integers else []
    leaves: list[st.SearchStrategy[Expression]] = [st.builds(Constant, st.booleans())]
    if booleans:
        leaves.append(st.sampled_from(booleans).map(lambda leaf: Atom(leaf[0].name, leaf[1])))
    if numbers:
        leaves.append(comparisons(numbers))
    return st.recursive(st.one_of(leaves), _above, max_leaves=8)


def comparisons(numbers: list[tuple[Variable, bool]]) -> st.SearchStrategy[Expression]:
    """Return comparisons of sums; those of a variable with a constant stay within its values."""
    single = st.sampled_from(numbers).map(lambda leaf: Integer(leaf[0].name, leaf[1]))
    constant = st.integers(-3, 9).map(Number)
    sums = st.lists(st.one_of(single, constant), min_size=2, max_size=3).map(lambda parts: Sum(tuple(parts)))
    terms: st.SearchStrategy[Term] = st.one_of(single, sums)
    general = st.builds(Comparison, st.sampled_from(COMPARISONS), terms, terms)
    return st.one_of(general, st.sampled_from(numbers).flatmap(_with_constant))


def _with_constant(leaf: tuple[Variable, bool]) -> st.SearchStrategy[Expression]:
    variable, primed = leaf
    value = st.sampled_from(list(variable.values)).map(Number)
    return st.builds(Comparison, st.sampled_from(COMPARISONS), st.just(Integer(variable.name, primed)), value)


def _above(inner: st.SearchStrategy[Expression]) -> st.SearchStrategy[Expression]:
    return st.one_of(
        inner.map(Not),
        *(_chain(kind, inner) for kind in (And, Or, Xor)),
        st.builds(Implies, inner, inner),
        st.builds(Iff, inner, inner),
    )


def _chain(kind: type[And | Or | Xor], inner: st.SearchStrategy[Expression]) -> st.SearchStrategy[Expression]:
    operands = st.lists(inner.filter(lambda e: not isinstance(e, kind)), min_size=2, max_size=3)
    return operands.map(lambda parts: kind(tuple(parts)))


VARIABLES = (Variable("a"), Variable("n", 0, 2), Variable("b_1"), Variable("m", -1, 3))


@st.composite
def specifications(draw: st.DrawFn, *, integers: bool = True, most_lines: int = 2) -> Specification:
    """Return a specification of one or two inputs and outputs each, every section filled at random."""
    pool = [v for v in VARIABLES if integers or v.is_boolean] + [Variable("c"), Variable("d")]
    names = draw(st.permutations(pool))
    inputs = tuple(names[: draw(st.integers(0, 2))])
    outputs = tuple(names[len(inputs) : len(inputs) + draw(st.integers(1, 2))])
    now = tuple((v, False) for v in inputs + outputs)
    after_inputs = tuple((v, True) for v in inputs)
    after = tuple((v, True) for v in inputs + outputs)
    allowed = {
        "ENV_INIT": tuple((v, False) for v in inputs),
        "SYS_INIT": now,
        "ENV_TRANS": now + after_inputs,
        "SYS_TRANS": now + after,
        "ENV_LIVENESS": now + after,
        "SYS_LIVENESS": now + after,
    }
    sections = {}
    for name, leaves in allowed.items():
        drawn = draw(st.lists(expressions(Mentions(leaves), integers=integers), max_size=most_lines))
        sections[name.lower()] = tuple(Conjunct(name, expression, "", k + 1) for k, expression in enumerate(drawn))
    return Specification(inputs, outputs, **sections)


def same(left: Node, right: Node) -> bool:
    """Return whether two expressions have the same structure."""
    if type(left) is not type(right):
        return False
    for name in ("name", "primed", "value", "operator"):
        if getattr(left, name, None) != getattr(right, name, None):
            return False
    below, other = children(left), children(right)
    return len(below) == len(other) and all(same(a, b) for a, b in zip(below, other, strict=True))

"""Random GR(1) specifications, and structural comparison of expressions."""

from __future__ import annotations

import random
from typing import Any

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

Leaf = tuple[Variable, bool]
VARIABLES = (Variable("a"), Variable("n", 0, 2), Variable("b_1"), Variable("m", -1, 3), Variable("c"), Variable("d"))


def random_specification(
    source: random.Random, *, integers: bool = True, most_lines: int = 2, depth: int = 3, most_outputs: int = 2
) -> Specification:
    """Return a specification of at most two inputs and one or more outputs, every section filled at random."""
    pool = [v for v in VARIABLES if integers or v.is_boolean]
    source.shuffle(pool)
    inputs = tuple(pool[: source.randint(0, 2)])
    outputs = tuple(pool[len(inputs) : len(inputs) + source.randint(1, most_outputs)])
    now = [(v, False) for v in inputs + outputs]
    after_inputs = [(v, True) for v in inputs]
    after = [(v, True) for v in inputs + outputs]
    allowed = {
        "ENV_INIT": [(v, False) for v in inputs],
        "SYS_INIT": now,
        "ENV_TRANS": now + after_inputs,
        "SYS_TRANS": now + after,
        "ENV_LIVENESS": now + after,
        "SYS_LIVENESS": now + after,
    }
    sections: dict[str, Any] = {}
    for name, leaves in allowed.items():
        count = source.randint(0, most_lines)
        lines = [random_expression(source, leaves, depth) for _ in range(count)]
        sections[name.lower()] = tuple(Conjunct(name, line, "", k + 1) for k, line in enumerate(lines))
    return Specification(inputs, outputs, **sections)


def random_expression(source: random.Random, leaves: list[Leaf], depth: int) -> Expression:
    """Return an expression in the normal form of the readers: no conjunction directly inside a conjunction."""
    if depth == 0 or source.random() < 0.25:
        return _leaf(source, leaves)
    kind = source.choice((Not, And, Or, Xor, Implies, Iff))
    if kind is Not:
        return Not(random_expression(source, leaves, depth - 1))
    if kind in (Implies, Iff):
        left, right = (random_expression(source, leaves, depth - 1) for _ in range(2))
        return Implies(left, right) if kind is Implies else Iff(left, right)
    operands = [random_expression(source, leaves, depth - 1) for _ in range(source.randint(2, 3))]
    return kind(tuple(Not(e) if isinstance(e, kind) else e for e in operands))  # type: ignore[call-arg, arg-type]


def _leaf(source: random.Random, leaves: list[Leaf]) -> Expression:
    if not leaves or source.random() < 0.05:
        return Constant(source.random() < 0.5)
    variable, primed = source.choice(leaves)
    if variable.is_boolean:
        return Atom(variable.name, primed)
    left: Term = Integer(variable.name, primed)
    operator = source.choice(COMPARISONS)
    if source.random() < 0.5:
        return Comparison(operator, left, Number(source.choice(variable.values)))
    numbers = [Integer(v.name, p) for v, p in leaves if not v.is_boolean]
    terms: list[Term] = [*numbers, Number(source.randint(-3, 9))]
    if source.random() < 0.7:
        left = Sum((left, source.choice(terms)))
    return Comparison(operator, left, Sum((source.choice(terms), source.choice(terms), source.choice(numbers))))


def specifications(*, integers: bool = True, most_lines: int = 2) -> st.SearchStrategy[Specification]:
    """Return random specifications for Hypothesis."""
    seeds = st.integers(0, 2**32)
    return seeds.map(lambda seed: random_specification(random.Random(seed), integers=integers, most_lines=most_lines))


def same(left: Node, right: Node) -> bool:
    """Return whether two expressions have the same structure."""
    if type(left) is not type(right):
        return False
    for name in ("name", "primed", "value", "operator"):
        if getattr(left, name, None) != getattr(right, name, None):
            return False
    below, other = children(left), children(right)
    return len(below) == len(other) and all(same(a, b) for a, b in zip(below, other, strict=True))

"""Partial evaluation: what is left of a specification once some variables are known for good.

Source: Zhou et al., 2025, Definition 1: known propositions are replaced by their truth values, everywhere.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from surefoot.errors import InputError
from surefoot.logic.building import FALSE, TRUE, conjunction, disjunction
from surefoot.logic.syntax import (
    SECTIONS,
    And,
    Atom,
    Comparison,
    Conjunct,
    Constant,
    Expression,
    Iff,
    Implies,
    Integer,
    Node,
    Not,
    Number,
    Or,
    Specification,
    Sum,
    bit_owners,
    children,
    postorder,
)

_COMPARED = {
    "=": int.__eq__,
    "!=": int.__ne__,
    "<": int.__lt__,
    "<=": int.__le__,
    ">": int.__gt__,
    ">=": int.__ge__,
}


def partial_evaluation(specification: Specification, known: Mapping[str, int | bool]) -> Specification:
    """Return the specification with known variables replaced by their values, primed and unprimed.

    The known variables are no longer declared; lines that became true are left out, the others keep their text and
    place. The source stays, without a hash: the result is no longer what the file says.

    Args:
        specification: any.
        known: values by name.

    Raises:
        InputError: a name is not declared, or a value is none of the variable's.
    """
    for name, value in known.items():
        variable = specification.variable(name)
        if variable is None:
            declared = ", ".join(v.name for v in specification.variables[:8])
            raise InputError(f"{name} is not declared; declared are: {declared}")
        if int(value) not in variable.values:
            raise InputError(
                f"{name} never is {value}; its values go from {variable.values[0]} to {variable.values[-1]}"
            )
    values = {name: int(value) for name, value in known.items()}
    for bit, (variable, position) in bit_owners(specification).items():
        if variable.name in known:
            values[bit] = (int(known[variable.name]) - variable.values[0]) >> position & 1
    sections: dict[str, Any] = {
        name.lower(): _evaluated(getattr(specification, name.lower()), values) for name in SECTIONS
    }
    inputs, outputs = (
        tuple(variable for variable in side if variable.name not in known)
        for side in (specification.inputs, specification.outputs)
    )
    return replace(specification, inputs=inputs, outputs=outputs, sha256="", **sections)


def _evaluated(conjuncts: tuple[Conjunct, ...], values: Mapping[str, int]) -> tuple[Conjunct, ...]:
    kept: list[Conjunct] = []
    for conjunct in conjuncts:
        expression = substituted(conjunct.expression, values)
        if not (isinstance(expression, Constant) and expression.value):
            kept.append(replace(conjunct, expression=expression))
    return tuple(kept)


def substituted(
    expression: Expression,
    values: Mapping[str, int],
    following: Mapping[str, int] | None = None,
    *,
    unprime: bool = False,
) -> Expression:
    """Return an expression with variables replaced by values, and constants folded.

    Args:
        expression: any.
        values: of variables and bits by name, for unprimed ones.
        following: the same for primed ones; None: as for unprimed ones.
        unprime: whether the primed variables that are left lose their prime.
    """
    after = values if following is None else following
    made: dict[int, Node] = {}
    for node in postorder([expression]):
        made[id(node)] = _folded(node, [made[id(child)] for child in children(node)], values, after, unprime)
    return made[id(expression)]  # type: ignore[return-value]


def _folded(node: Node, below: list[Any], now: Mapping[str, int], after: Mapping[str, int], unprime: bool) -> Node:
    """Return a node over new operands, simplified."""
    if isinstance(node, Atom | Integer):
        value = (after if node.primed else now).get(node.name)
        if value is None:
            return type(node)(node.name, node.primed and not unprime)
        return Number(value) if isinstance(node, Integer) else _constant(bool(value))
    if isinstance(node, Constant | Number):
        return node
    if isinstance(node, Not):
        return _negated(below[0])
    if isinstance(node, And | Or):
        unit, zero = (TRUE, FALSE) if isinstance(node, And) else (FALSE, TRUE)
        if any(isinstance(part, Constant) and part.value == zero.value for part in below):
            return zero
        left = [part for part in below if not isinstance(part, Constant)]
        return (conjunction(left) if isinstance(node, And) else disjunction(left)) if left else unit
    if isinstance(node, Implies):
        return _folded(Or((node.left, node.right)), [_negated(below[0]), below[1]], now, after, unprime)
    if isinstance(node, Comparison):
        return _compared(node.operator, below[0], below[1])
    if isinstance(node, Sum):
        constant = sum(part.value for part in below if isinstance(part, Number))
        others = [part for part in below if not isinstance(part, Number)]
        terms = [*others, Number(constant)] if constant or not others else others
        return terms[0] if len(terms) == 1 else Sum(tuple(terms))
    if isinstance(node, Iff):
        return _negated(_parity(below))
    return _parity(below)


def _parity(below: list[Expression]) -> Expression:
    from surefoot.logic.syntax import Xor

    odd = sum(part.value for part in below if isinstance(part, Constant)) % 2 == 1
    left = [part for part in below if not isinstance(part, Constant)]
    if not left:
        return _constant(odd)
    whole = left[0] if len(left) == 1 else Xor(tuple(left))
    return _negated(whole) if odd else whole


def _compared(operator: str, left: Any, right: Any) -> Expression:
    if isinstance(left, Number) and isinstance(right, Number):
        return _constant(_COMPARED[operator](left.value, right.value))
    return Comparison(operator, left, right)


def _negated(operand: Expression) -> Expression:
    if isinstance(operand, Constant):
        return _constant(not operand.value)
    return operand.operand if isinstance(operand, Not) else Not(operand)


def _constant(value: bool) -> Constant:
    return TRUE if value else FALSE

"""The meaning of expressions, on integers: one valuation or millions at a time.

This evaluator knows nothing of bits, buffers or decision diagrams, which makes it the yardstick for all that does.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.logic.syntax import (
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
    Specification,
    Xor,
    bit_owners,
    children,
    postorder,
)

Values = Mapping[str, NDArray[Any] | int | bool]
_COMPARE: dict[str, Callable[[Any, Any], Any]] = {
    "=": np.equal,
    "!=": np.not_equal,
    "<": np.less,
    "<=": np.less_equal,
    ">": np.greater,
    ">=": np.greater_equal,
}


class Evaluator:
    """Evaluates expressions of one specification."""

    def __init__(self, specification: Specification) -> None:
        """Take the variables from the specification."""
        self._bits = bit_owners(specification)
        self._plans: dict[int, _Plan] = {}

    def __call__(self, expression: Expression, current: Values, following: Values | None = None) -> NDArray[np.bool_]:
        """Return where the expression holds.

        Args:
            expression: what to evaluate.
            current: value of every unprimed variable that occurs; arrays that broadcast against each other, or scalars.
            following: the same for primed ones.

        Returns:
            truth values in the broadcast shape of what the expression mentions.
        """
        plan = self._plan(expression)
        values: dict[int, Any] = {}
        for node, forget in plan.steps:
            values[id(node)] = self._value(node, values, current, following or {})
            for child in forget:
                del values[child]
        return np.asarray(values[id(expression)], dtype=np.bool_)

    def mentions(self, expression: Expression) -> frozenset[tuple[str, bool]]:
        """Return (variable, primed) of all variables that occur; a bit counts as its integer."""
        return self._plan(expression).mentions

    def _plan(self, expression: Expression) -> _Plan:
        plan = self._plans.get(id(expression))
        if plan is None:
            plan = self._plans[id(expression)] = self._planned(expression)
        return plan

    def _planned(self, expression: Expression) -> _Plan:
        order = postorder([expression])
        last: dict[int, int] = {}
        for place, node in enumerate(order):
            last.update((id(child), place) for child in children(node))
        forget: list[list[int]] = [[] for _ in order]
        for child, place in last.items():
            forget[place].append(child)
        found = {(self._owner(node.name), node.primed) for node in order if isinstance(node, Atom | Integer)}
        return _Plan(expression, tuple(zip(order, forget, strict=True)), frozenset(found))

    def _owner(self, name: str) -> str:
        return self._bits[name][0].name if name in self._bits else name

    def _value(self, node: Node, values: dict[int, Any], current: Values, following: Values) -> Any:
        if isinstance(node, Constant | Number):
            return np.asarray(node.value)
        if isinstance(node, Atom | Integer):
            return self._leaf(node, following if node.primed else current)
        below = [values[id(child)] for child in children(node)]
        if isinstance(node, Not):
            return ~below[0]
        if isinstance(node, And):
            return reduce(np.logical_and, below)
        if isinstance(node, Or):
            return reduce(np.logical_or, below)
        if isinstance(node, Xor):
            return reduce(np.logical_xor, below)
        if isinstance(node, Implies):
            return ~below[0] | below[1]
        if isinstance(node, Iff):
            return below[0] == below[1]
        if isinstance(node, Comparison):
            return _COMPARE[node.operator](*below)
        return reduce(np.add, below)

    def _leaf(self, node: Atom | Integer, values: Values) -> Any:
        if node.name in self._bits:
            variable, position = self._bits[node.name]
            stored = np.asarray(values[variable.name], dtype=np.int64) - variable.values[0]
            return (stored >> position & 1).astype(np.bool_)
        value = np.asarray(values[node.name])
        return value.astype(np.int64 if isinstance(node, Integer) else np.bool_)


@dataclass(frozen=True, slots=True, eq=False)
class _Plan:
    """An expression in the order of evaluation; after each step some operands are used for the last time."""

    expression: Expression
    steps: tuple[tuple[Node, list[int]], ...]
    mentions: frozenset[tuple[str, bool]]

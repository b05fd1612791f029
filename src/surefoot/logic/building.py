"""Building expressions bottom up: chains of one associative operator become one node, in linear time."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from surefoot.logic.syntax import And, Atom, Constant, Expression, Integer, Node, Number, Or, Sum, Xor

TRUE = Constant(True)
FALSE = Constant(False)


@dataclass(slots=True)
class Chain:
    """Operands of one associative operator (``&``, ``|``, ``^`` or ``+``) while they are collected."""

    kind: str
    operands: deque[Node]


Draft = Node | Chain


def join(kind: str, left: Draft, right: Draft) -> Draft:
    """Return two operands under an associative operator; a chain that is given away must not be used again."""
    if isinstance(left, Chain) and left.kind == kind:
        if isinstance(right, Chain) and right.kind == kind:
            if len(right.operands) > len(left.operands):
                right.operands.extendleft(reversed(left.operands))
                return right
            left.operands.extend(right.operands)
        else:
            left.operands.append(finished(right))
        return left
    if isinstance(right, Chain) and right.kind == kind:
        right.operands.appendleft(finished(left))
        return right
    return Chain(kind, deque((finished(left), finished(right))))


def finished(draft: Draft) -> Node:
    """Return the node of a chain; a node is finished already."""
    if not isinstance(draft, Chain):
        return draft
    kinds: dict[str, Callable[[Any], Node]] = {"&": And, "|": Or, "^": Xor, "+": Sum}
    return kinds[draft.kind](tuple(draft.operands))


def conjunction(operands: list[Expression] | tuple[Expression, ...]) -> Expression:
    """Return the conjunction of any number of expressions."""
    return TRUE if not operands else operands[0] if len(operands) == 1 else And(tuple(operands))


def disjunction(operands: list[Expression] | tuple[Expression, ...]) -> Expression:
    """Return the disjunction of any number of expressions."""
    return FALSE if not operands else operands[0] if len(operands) == 1 else Or(tuple(operands))


@dataclass(slots=True)
class Leaves:
    """One object per variable, bit and number, so that large files stay small in memory."""

    known: dict[tuple[str, bool], Atom | Integer] = field(default_factory=dict)
    numbers: dict[int, Number] = field(default_factory=dict)

    def atom(self, name: str, primed: bool) -> Atom:
        """Return the Boolean variable or bit."""
        found = self.known.get((name, primed))
        if not isinstance(found, Atom):
            found = self.known[(name, primed)] = Atom(name, primed)
        return found

    def integer(self, name: str, primed: bool) -> Integer:
        """Return the integer variable."""
        found = self.known.get((name, primed))
        if not isinstance(found, Integer):
            found = self.known[(name, primed)] = Integer(name, primed)
        return found

    def number(self, value: int) -> Number:
        """Return the constant."""
        return self.numbers.setdefault(value, Number(value))

"""From integers to bits: comparisons and sums become adders and comparators over the bits of the variables.

An integer is stored as ``value - lower``, least significant bit first. Sums are exact: a sum has as many bits as it
needs, so nothing wraps around, and ``x' = x + 1`` has no solution where x has its greatest value. Equal subterms of one
``Lowering`` become one object, so that a compiler to decision diagrams meets each of them once.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from surefoot.logic.building import FALSE, TRUE
from surefoot.logic.ranges import range_conjuncts
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
    Sum,
    Xor,
    children,
    postorder,
)

__all__ = ["Lowering", "boolean", "range_conjuncts"]


@dataclass(frozen=True, slots=True)
class _Bits:
    """A number: ``offset`` plus the bits, the least significant first."""

    offset: int
    bits: tuple[Expression, ...]


def boolean(expression: Expression, specification: Specification) -> Expression:
    """Return an expression made of Constant, Atom, Not, And, Or and Xor over bits.

    Args:
        expression: any expression of the specification.
        specification: declares the variables.
    """
    return Lowering(specification).boolean(expression)


class Lowering:
    """Lowers expressions of one specification; equal results are one object across calls."""

    def __init__(self, specification: Specification) -> None:
        """Start with an empty table."""
        self._specification = specification
        self._table: dict[tuple[object, ...], Expression] = {}
        self._atoms: dict[tuple[str, bool], Expression] = {}

    def boolean(self, expression: Expression) -> Expression:
        """Return an expression made of Constant, Atom, Not, And, Or and Xor over bits."""
        made: dict[int, Expression] = {}
        numbers: dict[int, _Bits] = {}
        for node in postorder([expression]):
            if isinstance(node, Number | Integer | Sum):
                numbers[id(node)] = self._number(node, numbers)
            elif isinstance(node, Comparison):
                made[id(node)] = self._comparison(node.operator, numbers[id(node.left)], numbers[id(node.right)])
            else:
                made[id(node)] = self._logical(node, [made[id(child)] for child in children(node)])
        return made[id(expression)]

    def _logical(self, node: Node, below: list[Expression]) -> Expression:
        if isinstance(node, Constant):
            return TRUE if node.value else FALSE
        if isinstance(node, Atom):
            return self._atom(node.name, node.primed)
        if isinstance(node, Not):
            return self.negation(below[0])
        if isinstance(node, And):
            return self.conjunction(below)
        if isinstance(node, Or):
            return self.disjunction(below)
        if isinstance(node, Implies):
            return self.disjunction([self.negation(below[0]), below[1]])
        if isinstance(node, Iff):
            return self.negation(self.parity(below))
        return self.parity(below)

    def negation(self, operand: Expression) -> Expression:
        """Return the negation."""
        if isinstance(operand, Constant):
            return FALSE if operand.value else TRUE
        if isinstance(operand, Not):
            return operand.operand
        return self._shared(("!", id(operand)), Not(operand))

    def conjunction(self, operands: Iterable[Expression]) -> Expression:
        """Return the conjunction, without constants and repetitions."""
        return self._junction(operands, TRUE, FALSE, "&")

    def disjunction(self, operands: Iterable[Expression]) -> Expression:
        """Return the disjunction, without constants and repetitions."""
        return self._junction(operands, FALSE, TRUE, "|")

    def parity(self, operands: Iterable[Expression]) -> Expression:
        """Return whether an odd number of the operands holds."""
        odd = False
        kept: dict[int, Expression] = {}
        for operand in operands:
            inner = operand
            if isinstance(inner, Not):
                inner, odd = inner.operand, not odd
            if isinstance(inner, Constant):
                odd ^= inner.value
            elif kept.pop(id(inner), None) is None:
                kept[id(inner)] = inner
        parts = tuple(kept.values())
        if not parts:
            return TRUE if odd else FALSE
        whole = parts[0] if len(parts) == 1 else self._shared(("^", *sorted(kept)), Xor(parts))
        return self.negation(whole) if odd else whole

    def _junction(self, operands: Iterable[Expression], unit: Constant, zero: Constant, symbol: str) -> Expression:
        parts: dict[int, Expression] = {}
        for operand in operands:
            if operand is zero:
                return zero
            if operand is not unit:
                parts[id(operand)] = operand
        for part in parts.values():
            if isinstance(part, Not) and id(part.operand) in parts:
                return zero
        if len(parts) < 2:
            return next(iter(parts.values()), unit)
        kind = And if symbol == "&" else Or
        return self._shared((symbol, *sorted(parts)), kind(tuple(parts.values())))

    def _shared(self, key: tuple[object, ...], made: Expression) -> Expression:
        """Return the object of that key; keys name operands by id, and the table keeps all operands alive."""
        return self._table.setdefault(key, made)

    def _atom(self, name: str, primed: bool) -> Expression:
        return self._atoms.setdefault((name, primed), Atom(name, primed))

    def _number(self, node: Number | Integer | Sum, numbers: dict[int, _Bits]) -> _Bits:
        if isinstance(node, Number):
            return _Bits(node.value, ())
        if isinstance(node, Integer):
            variable = self._specification.variable(node.name)
            if variable is None or variable.lower is None:
                raise ValueError(f"{node.name} is no integer of the specification")
            return _Bits(variable.lower, tuple(self._atom(bit, node.primed) for bit in variable.bits))
        total = _Bits(0, ())
        for operand in node.operands:
            part = numbers[id(operand)]
            total = _Bits(total.offset + part.offset, self._add(total.bits, part.bits))
        return total

    def _add(self, left: tuple[Expression, ...], right: tuple[Expression, ...]) -> tuple[Expression, ...]:
        """Return the bits of an exact sum: a ripple-carry adder with one bit more than its longer operand."""
        if not left or not right:
            return left or right
        bits: list[Expression] = []
        carry: Expression = FALSE
        for k in range(max(len(left), len(right))):
            a, b = _bit(left, k), _bit(right, k)
            bits.append(self.parity([a, b, carry]))
            both = self.conjunction([a, b])
            carry = self.disjunction([both, self.conjunction([carry, self.disjunction([a, b])])])
        return (*bits, carry)

    def _comparison(self, operator: str, left: _Bits, right: _Bits) -> Expression:
        if operator in ("=", "!="):
            equal = self._equal(*self._aligned(left, right))
            return equal if operator == "=" else self.negation(equal)
        if operator in ("<", ">="):
            less = self._less(*self._aligned(left, right))
            return less if operator == "<" else self.negation(less)
        more = self._less(*self._aligned(right, left))
        return more if operator == ">" else self.negation(more)

    def _aligned(self, left: _Bits, right: _Bits) -> tuple[tuple[Expression, ...], tuple[Expression, ...]]:
        """Return both numbers minus the lesser offset, as bits."""
        least = min(left.offset, right.offset)
        return self._raised(left, left.offset - least), self._raised(right, right.offset - least)

    def _raised(self, number: _Bits, by: int) -> tuple[Expression, ...]:
        constant = tuple(TRUE if by >> k & 1 else FALSE for k in range(by.bit_length()))
        return self._add(number.bits, constant)

    def _equal(self, left: tuple[Expression, ...], right: tuple[Expression, ...]) -> Expression:
        width = max(len(left), len(right))
        return self.conjunction(self.negation(self.parity([_bit(left, k), _bit(right, k)])) for k in range(width))

    def _less(self, left: tuple[Expression, ...], right: tuple[Expression, ...]) -> Expression:
        """Return left < right, from the least significant bit up: a higher bit overrules the lower ones."""
        less: Expression = FALSE
        for k in range(max(len(left), len(right))):
            a, b = _bit(left, k), _bit(right, k)
            here = self.conjunction([self.negation(a), b])
            same = self.negation(self.parity([a, b]))
            less = self.disjunction([here, self.conjunction([same, less])])
        return less


def _bit(bits: tuple[Expression, ...], k: int) -> Expression:
    return bits[k] if k < len(bits) else FALSE

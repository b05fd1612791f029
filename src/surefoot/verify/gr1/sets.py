"""Sets of steps for the checker: decision diagrams of its own, and the meaning of a specification's lines in them.

Integers are translated by their values, not by circuits over their bits: an expression is the map from each value that
it can have to the set of steps in which it has it. Nothing here is shared with the engines.
"""

from __future__ import annotations

import operator
from bisect import bisect_left
from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import LimitExceeded
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
    Variable,
    Xor,
    bit_owners,
    children,
    postorder,
)
from surefoot.verify.gr1._kernels import FALSE, FULL, LEAF, TRUE, and_exists, loaded, made, rehash, shares

MOST_NODES = 48_000_000
MOST_PAIRS = 400_000
"""How many pairs of values are added where a sum is added to a sum."""
MOST_VALUES = 400_000
"""How many values a sum has."""
_FIRST_NODES = 1 << 18
_COMPARE: dict[str, Callable[[int, int], bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}


class Sets:
    """A manager of sets over some ordered variables; a set is a whole number, and equal sets are equal numbers."""

    def __init__(self, variables: int) -> None:
        """Take the number of variables; variable 0 is decided first."""
        self._variables = variables
        self._nodes = np.zeros((_FIRST_NODES, 3), dtype=np.int32)
        self._nodes[0] = LEAF, TRUE, TRUE
        self._count = np.ones(1, dtype=np.int64)
        self._table = np.zeros(4 * _FIRST_NODES, dtype=np.int32)
        self._cache = np.full((1 << 20, 4), -1, dtype=np.int32)
        self._none = np.zeros(variables, dtype=np.bool_)
        self._operations: dict[bytes, int] = {}

    def variable(self, index: int) -> int:
        """Return the set in which a variable is true."""
        return self._made(index, FALSE, TRUE)

    def conjoin(self, sets: Iterable[int]) -> int:
        """Return the conjunction."""
        result = TRUE
        for one in sets:
            result = self._applied(result, one, self._none, 0)
        return result

    def unite(self, sets: Iterable[int]) -> int:
        """Return the union."""
        return self.conjoin(one ^ 1 for one in sets) ^ 1

    def differ(self, left: int, right: int) -> int:
        """Return where exactly one of two sets holds."""
        return self.unite((self.conjoin((left, right ^ 1)), self.conjoin((left ^ 1, right))))

    def project(self, left: int, right: int, variables: NDArray[np.bool_]) -> int:
        """Return the conjunction of two sets with some variables projected away."""
        operation = self._operations.setdefault(variables.tobytes(), len(self._operations) + 1)
        return self._applied(left, right, variables, operation)

    def load(self, variable: NDArray[np.int32], low: NDArray[np.int32], high: NDArray[np.int32]) -> NDArray[np.int32]:
        """Return the sets of the rows of a table, whose rows 0 and 1 are false and true, children first."""
        found = np.full(len(variable), FALSE, dtype=np.int32)
        found[1] = TRUE
        row = 2
        while (row := loaded(self._nodes, self._table, self._count, variable, low, high, row, found)) < len(variable):
            self._grow()
        return found

    def mentioned(self, one: int) -> NDArray[np.bool_]:
        """Return which variables a set depends on."""
        found = np.zeros(self._variables, dtype=np.bool_)
        seen, pending = {0}, [one >> 1]
        while pending:
            node = pending.pop()
            if node not in seen:
                seen.add(node)
                found[self._nodes[node, 0]] = True
                pending.extend(int(edge) >> 1 for edge in self._nodes[node, 1:])
        return found

    def share(self, one: int) -> float:
        """Return the share of all valuations that a set contains."""
        share = float(shares(self._nodes, int(self._count[0]))[one >> 1])
        return 1.0 - share if one & 1 else share

    def some(self, one: int) -> dict[int, bool]:
        """Return a partial valuation inside a set that is not empty; the variables left out may be anything."""
        found: dict[int, bool] = {}
        while one > FALSE:
            variable, low, high = (int(value) for value in self._nodes[one >> 1])
            found[variable] = low ^ (one & 1) == FALSE
            one = (high if found[variable] else low) ^ (one & 1)
        return found

    @property
    def mark(self) -> int:
        """How many nodes there are; see ``release``."""
        return int(self._count[0])

    def release(self, mark: int) -> None:
        """Forget all sets that were made since a mark."""
        self._count[0] = mark
        self._table[:] = 0
        rehash(self._nodes, self._table, mark)
        self._cache[:] = -1

    def _made(self, variable: int, low: int, high: int) -> int:
        while (one := made(self._nodes, self._table, self._count, variable, low, high)) == FULL:
            self._grow()
        return int(one)

    def _applied(self, left: int, right: int, variables: NDArray[np.bool_], operation: int) -> int:
        while True:
            one = and_exists(
                self._nodes, self._table, self._count, self._cache, variables, operation, int(left), int(right)
            )
            if one != FULL:
                return int(one)
            self._grow()

    def _grow(self) -> None:
        if 2 * len(self._nodes) > MOST_NODES:
            raise LimitExceeded(f"verifying the strategy: more than {MOST_NODES // 2} nodes of decision diagrams")
        self._nodes = np.concatenate([self._nodes, np.zeros_like(self._nodes)])
        self._table = np.zeros(2 * len(self._table), dtype=np.int32)
        rehash(self._nodes, self._table, int(self._count[0]))
        if len(self._cache) < 1 << 22:
            self._cache = np.full((2 * len(self._cache), 4), -1, dtype=np.int32)


class Translator:
    """Translates the lines of a specification into sets of steps.

    Args:
        specification: the specification.
        sets: the manager.
        place: for every bit of the variables, in the order of the declarations, its place in the variable order; the
            present value of a bit is variable ``2 * place``, the next one ``2 * place + 1``.
    """

    def __init__(self, specification: Specification, sets: Sets, place: Sequence[int]) -> None:
        self._sets, self._owners = sets, bit_owners(specification)
        self._bits: dict[str, list[int]] = {}
        self._variables = {variable.name: variable for variable in specification.variables}
        self._known: dict[tuple[str, bool], dict[int, int]] = {}
        rest = iter(place)
        for variable in specification.variables:
            self._bits[variable.name] = [next(rest) for _ in variable.bits]

    def places(self, variables: Iterable[Variable]) -> list[int]:
        """Return the places of the bits of some variables."""
        return [place for variable in variables for place in self._bits[variable.name]]

    def in_range(self, variables: Iterable[Variable], *, primed: bool) -> int:
        """Return where every variable has one of its values."""
        whole = [v for v in variables if not v.is_boolean]
        return self._sets.conjoin(self._sets.unite(self._values(v.name, primed).values()) for v in whole)

    def translate(self, expression: Expression) -> int:
        """Return the set of steps in which an expression holds; its integers have values in their ranges."""
        truth: dict[int, int] = {}
        whole: dict[int, dict[int, int]] = {}
        for node in postorder([expression]):
            if isinstance(node, Number):
                whole[id(node)] = {node.value: TRUE}
            elif isinstance(node, Integer):
                whole[id(node)] = self._values(node.name, node.primed)
            elif isinstance(node, Comparison):
                truth[id(node)] = self._compared(node, whole)
            elif isinstance(node, Sum):
                whole[id(node)] = self._sum(children(node), whole)
            else:
                truth[id(node)] = self._combined(node, truth)
        return truth[id(expression)]

    def words(self, valuation: dict[int, bool], *, primed: bool) -> str:
        """Return a valuation as the values of all variables; what may be anything is false or the least value."""
        parts = []
        for name, variable in self._variables.items():
            bits = [valuation.get(2 * place + primed, False) for place in self._bits[name]]
            parts.append(variable.shown(self._decoded(variable, bits)))
        return ", ".join(parts)

    @staticmethod
    def _decoded(variable: Variable, bits: Sequence[bool]) -> int:
        return sum(bit << k for k, bit in enumerate(bits)) + (0 if variable.is_boolean else variable.values[0])

    def _bit(self, place: int, primed: bool) -> int:
        return self._sets.variable(2 * place + primed)

    def _values(self, name: str, primed: bool) -> dict[int, int]:
        """Return for every value of an integer where it has it."""
        if (name, primed) not in self._known:
            variable, bits = self._variables[name], [self._bit(place, primed) for place in self._bits[name]]
            self._known[name, primed] = {
                value: self._sets.conjoin(
                    bit if value - variable.values[0] >> k & 1 else bit ^ 1 for k, bit in enumerate(bits)
                )
                for value in variable.values
            }
        return self._known[name, primed]

    def _sum(self, terms: Sequence[Node], whole: dict[int, dict[int, int]]) -> dict[int, int]:
        """Return for every value of a sum where it has it; integers are added bit by bit, whatever their ranges."""
        total, ranges = {0: TRUE}, []
        for term in terms:
            if isinstance(term, Integer):
                ranges.append(self._sets.unite(whole[id(term)].values()))
                total = self._plus_bits(total, term)
            else:
                total = self._plus_values(total, whole[id(term)])
        allowed = self._sets.conjoin(ranges)
        found = {value: self._sets.conjoin((where, allowed)) for value, where in total.items()}
        return {value: where for value, where in found.items() if where != FALSE}

    def _plus_bits(self, total: dict[int, int], term: Integer) -> dict[int, int]:
        least = self._variables[term.name].values[0]
        total = {value + least: where for value, where in total.items()}
        for k, place in enumerate(self._bits[term.name]):
            bit = self._bit(place, term.primed)
            parts: dict[int, list[int]] = {}
            for value, where in total.items():
                parts.setdefault(value, []).append(self._sets.conjoin((where, bit ^ 1)))
                parts.setdefault(value + (1 << k), []).append(self._sets.conjoin((where, bit)))
            total = self._united(parts)
        return total

    def _plus_values(self, total: dict[int, int], term: dict[int, int]) -> dict[int, int]:
        if len(total) * len(term) > MOST_PAIRS:
            raise LimitExceeded(f"verifying the strategy: more than {MOST_PAIRS} pairs of values in one sum of sums")
        parts: dict[int, list[int]] = {}
        for a, where_a in total.items():
            for b, where_b in term.items():
                parts.setdefault(a + b, []).append(self._sets.conjoin((where_a, where_b)))
        return self._united(parts)

    def _united(self, parts: dict[int, list[int]]) -> dict[int, int]:
        if len(parts) > MOST_VALUES:
            raise LimitExceeded(f"verifying the strategy: more than {MOST_VALUES} values of one sum")
        return {value: self._sets.unite(where) for value, where in parts.items()}

    def _compared(self, node: Comparison, whole: dict[int, dict[int, int]]) -> int:
        """Return where two integers compare; values are taken in order, so that pairs of them are not."""
        left, right = (whole[id(child)] for child in children(node))
        if node.operator in ("=", "!="):
            same = [self._sets.conjoin((where, right[value])) for value, where in left.items() if value in right]
            both = self._sets.conjoin(self._sets.unite(values.values()) for values in (left, right))
            equal = self._sets.unite(same)
            return equal if node.operator == "=" else self._sets.conjoin((both, equal ^ 1))
        values = sorted(right)
        if node.operator in (">", ">="):
            values.reverse()
        beyond = [FALSE]
        for value in reversed(values):
            beyond.append(self._sets.unite((beyond[-1], right[value])))
        holds = _COMPARE[node.operator]
        rows = []
        for a, where_a in left.items():
            fitting = len(values) - bisect_left(values, True, key=lambda b, a=a: holds(a, b))  # type: ignore[misc]
            rows.append(self._sets.conjoin((where_a, beyond[fitting])))
        return self._sets.unite(rows)

    def _combined(self, node: Node, truth: dict[int, int]) -> int:
        if isinstance(node, Constant):
            return TRUE if node.value else FALSE
        if isinstance(node, Atom):
            return self._atom(node)
        below = [truth[id(child)] for child in children(node)]
        if isinstance(node, Not):
            return below[0] ^ 1
        if isinstance(node, And):
            return self._sets.conjoin(below)
        if isinstance(node, Or):
            return self._sets.unite(below)
        if isinstance(node, Implies):
            return self._sets.unite((below[0] ^ 1, below[1]))
        if isinstance(node, Iff):
            return self._sets.differ(*below) ^ 1
        assert isinstance(node, Xor)
        result = below[0]
        for one in below[1:]:
            result = self._sets.differ(result, one)
        return result

    def _atom(self, node: Atom) -> int:
        if node.name in self._owners:
            variable, position = self._owners[node.name]
            return self._bit(self._bits[variable.name][position], node.primed)
        return self._bit(self._bits[node.name][0], node.primed)

"""All values of some variables that satisfy a set of conjuncts, for many states at once.

Conjuncts that share no variable to choose are counted apart and multiplied, so that free variables cost nothing.
Within a group the variables are chosen one after the other; each conjunct filters as soon as all its variables are
chosen. Nothing but the evaluator of the integer level is used.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import LimitExceeded
from surefoot.logic.evaluate import Evaluator
from surefoot.logic.syntax import And, Expression, Variable

LARGEST_TABLE = 4_000_000
"""Rows of partial choices that are held at once."""

Columns = dict[str, NDArray[np.int64]]


@dataclass(frozen=True, slots=True, eq=False)
class Group:
    """Variables that are chosen together, in this order, and what has to hold once each of them is chosen.

    Attributes:
        variables: to choose.
        filters: (number of variables) conjuncts that can be judged after each choice.
    """

    variables: tuple[Variable, ...]
    filters: tuple[tuple[Expression, ...], ...]


class Choices:
    """The choices that conjuncts leave.

    Args:
        evaluator: of the specification.
        conjuncts: what has to hold.
        variables: to choose.
        primed: whether the next values are chosen; otherwise the current ones.
    """

    def __init__(
        self, evaluator: Evaluator, conjuncts: Sequence[Expression], variables: Sequence[Variable], *, primed: bool
    ) -> None:
        """Split the conjuncts into groups."""
        self._evaluator = evaluator
        self._primed = primed
        parts = [part for conjunct in conjuncts for part in _split(conjunct)]
        names = {variable.name for variable in variables}
        chosen = {
            id(part): frozenset(name for name, prime in evaluator.mentions(part) if prime is primed and name in names)
            for part in parts
        }
        self._guards = [part for part in parts if not chosen[id(part)]]
        self._groups = [_ordered(group, parts, chosen) for group in _connected(variables, chosen.values())]

    def count(self, current: Columns, following: Columns, rows: int) -> NDArray[np.int64]:
        """Return how many choices there are in each of some states.

        Args:
            current: (rows,) values of the unprimed variables that are not chosen.
            following: (rows,) values of the primed ones that are not chosen.
            rows: how many states.
        """
        total = self._guarded(current, following, rows).astype(np.int64)
        for group in self._groups:
            total *= self._count_group(group, current, following, rows)
        return total

    def listed(self, current: Columns, following: Columns) -> Iterator[dict[str, int]]:
        """Yield the choices in a single state, one after the other.

        Args:
            current: (1,) values of the unprimed variables that are not chosen.
            following: (1,) values of the primed ones that are not chosen.
        """
        if not self._guarded(current, following, 1)[0]:
            return
        tables = []
        for group in self._groups:
            _, table = self._tabled(group, current, following, np.zeros(1, dtype=np.int64))
            columns = [variable.name for variable in group.variables]
            tables.append([dict(zip(columns, row, strict=True)) for row in table.T.tolist()])
        for parts in product(*tables):
            yield {name: value for part in parts for name, value in part.items()}

    def _guarded(self, current: Columns, following: Columns, rows: int) -> NDArray[np.bool_]:
        """Return in which states the conjuncts without a variable to choose hold."""
        holds = np.ones(rows, dtype=np.bool_)
        for guard in self._guards:
            holds &= self._evaluator(guard, current, following)
        return holds

    def _count_group(self, group: Group, current: Columns, following: Columns, rows: int) -> NDArray[np.int64]:
        if not any(group.filters):
            size = np.prod([len(variable.values) for variable in group.variables], dtype=np.float64)
            if size > 2**60:
                raise LimitExceeded("verifying the strategy: a state has more than 2^60 choices")
            return np.full(rows, int(size))
        counts = np.zeros(rows, dtype=np.int64)
        step = max(1, 200_000 // max(len(variable.values) for variable in group.variables))
        for start in range(0, rows, step):
            part = np.arange(start, min(start + step, rows))
            origin, _ = self._tabled(group, current, following, part)
            np.add.at(counts, origin, 1)
        return counts

    def _tabled(
        self, group: Group, current: Columns, following: Columns, origin: NDArray[np.int64]
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the choices of a group: the state of each row, and (variables, rows) values."""
        table = np.zeros((0, len(origin)), dtype=np.int64)
        for place, variable in enumerate(group.variables):
            if max(1, table.shape[1]) * len(variable.values) > LARGEST_TABLE:
                raise LimitExceeded(f"verifying the strategy: more than {LARGEST_TABLE} choices at {variable.name}")
            values = np.asarray(variable.values, dtype=np.int64)
            allowed = self._allowed(group, place, table, origin, values, current, following)
            rows, picked = np.nonzero(allowed)
            table = np.vstack([table[:, rows], values[picked]])
            origin = origin[rows]
        return origin, table

    def _allowed(
        self,
        group: Group,
        place: int,
        table: NDArray[np.int64],
        origin: NDArray[np.int64],
        values: NDArray[np.int64],
        current: Columns,
        following: Columns,
    ) -> NDArray[np.bool_]:
        """Return (rows, values) which extensions of the partial choices pass the filters of this place."""
        allowed = np.ones((len(origin), len(values)), dtype=np.bool_)
        here = {name: column[origin][:, None] for name, column in current.items()}
        after = {name: column[origin][:, None] for name, column in following.items()}
        target = after if self._primed else here
        target.update({v.name: table[k][:, None] for k, v in enumerate(group.variables[:place])})
        target[group.variables[place].name] = values[None, :]
        for part in group.filters[place]:
            allowed &= self._evaluator(part, here, after)
        return allowed


def _split(expression: Expression) -> Iterator[Expression]:
    """Yield the conjuncts of an expression."""
    stack = [expression]
    while stack:
        item = stack.pop()
        if isinstance(item, And):
            stack.extend(reversed(item.operands))
        else:
            yield item


def _connected(variables: Sequence[Variable], sets: object) -> list[list[Variable]]:
    """Return the variables in groups: two that occur in one set are in one group."""
    leader = {variable.name: variable.name for variable in variables}

    def find(name: str) -> str:
        while leader[name] != name:
            leader[name] = leader[leader[name]]
            name = leader[name]
        return name

    for names in set(sets):  # type: ignore[call-overload]
        first, *others = sorted(names) or [""]
        for other in others:
            leader[find(other)] = find(first)
    groups: dict[str, list[Variable]] = {}
    for variable in variables:
        groups.setdefault(find(variable.name), []).append(variable)
    return list(groups.values())


def _ordered(group: list[Variable], parts: list[Expression], chosen: dict[int, frozenset[str]]) -> Group:
    """Return a group in an order that lets conjuncts filter early."""
    names = {variable.name for variable in group}
    relevant = [part for part in parts if chosen[id(part)] & names]
    left, done = list(group), frozenset[str]()
    order: list[Variable] = []
    filters: list[tuple[Expression, ...]] = []
    while left:

        def gain(variable: Variable, done: frozenset[str] = done) -> tuple[float, int]:
            ready = sum(1 for part in relevant if variable.name in chosen[id(part)] <= done | {variable.name})
            return (ready / len(variable.values), -len(variable.values))

        best = max(left, key=gain)
        left.remove(best)
        after = done | {best.name}
        order.append(best)
        filters.append(tuple(part for part in relevant if best.name in chosen[id(part)] <= after))
        done = after
    return Group(tuple(order), tuple(filters))

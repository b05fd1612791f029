"""Affine rows over a vector of unknowns: the plumbing below the model's equations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]

FAMILIES = (
    "boundary", "integration", "dynamics", "moment", "region", "contact", "friction", "torque", "base torque",
    "reach", "clearance", "collision", "support", "flight", "tilt", "leg",
)  # fmt: skip
"""What rows are about; the numbers in ``Rows.family`` count in this order."""


@dataclass(frozen=True, slots=True, eq=False)
class Quantity:
    """An array whose entries are unknowns or known numbers.

    Attributes:
        index: position in the vector of unknowns, or -1 for a known number.
        value: the known numbers; 0 where there is an unknown.
    """

    index: Index
    value: Array

    @classmethod
    def unknown(cls, index: Index) -> Quantity:
        """Return a quantity of unknowns."""
        return cls(index, np.zeros(index.shape))

    @classmethod
    def known(cls, value: Array) -> Quantity:
        """Return a quantity of known numbers."""
        return cls(np.full(value.shape, -1, dtype=np.int64), value)

    def __getitem__(self, key: Any) -> Quantity:
        """Return a part of it."""
        return Quantity(self.index[key], self.value[key])

    def at(self, unknowns: Array) -> Array:
        """Return its numbers for given unknowns."""
        return np.where(self.index >= 0, unknowns[self.index], self.value)


Term = tuple[Any, Quantity]
"""A coefficient (number or array that broadcasts) and a quantity."""


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """Rows ``lower <= matrix @ unknowns <= upper``.

    Attributes:
        matrix: sparse, shape (rows, unknowns).
        lower: shape (rows,).
        upper: shape (rows,).
        family: index into ``FAMILIES``, shape (rows,).
        where: four whole numbers that tell a row of its family from the others, shape (rows, 4).
    """

    matrix: sp.csr_matrix
    lower: Array
    upper: Array
    family: Index
    where: Index

    def pick(self, chosen: NDArray[np.bool_]) -> Rows:
        """Return some of the rows."""
        return Rows(
            self.matrix[chosen], self.lower[chosen], self.upper[chosen], self.family[chosen], self.where[chosen]
        )

    def excess(self, unknowns: Array) -> Array:
        """Return by how much every row is violated; at most 0 where it holds."""
        values = self.matrix @ unknowns
        excess: Array = np.maximum(values - self.upper, self.lower - values)
        return excess

    @property
    def equal(self) -> NDArray[np.bool_]:
        """Which rows are equations."""
        equal: NDArray[np.bool_] = self.lower == self.upper
        return equal


def stacked(parts: Sequence[Rows]) -> Rows:
    """Return several blocks of rows over the same unknowns as one."""
    counts = [np.diff(part.matrix.indptr) for part in parts]
    starts = np.concatenate([[0], np.cumsum(np.concatenate(counts))])
    matrix = sp.csr_matrix(
        (
            np.concatenate([part.matrix.data for part in parts]),
            np.concatenate([part.matrix.indices for part in parts]),
            starts,
        ),
        shape=(len(starts) - 1, parts[0].matrix.shape[1]),
    )
    return Rows(
        matrix,
        np.concatenate([part.lower for part in parts]),
        np.concatenate([part.upper for part in parts]),
        np.concatenate([part.family for part in parts]),
        np.concatenate([part.where for part in parts]),
    )


class RowBuilder:
    """Collects rows; the equations of the model are written with it.

    Args:
        size: how many unknowns there are.
    """

    def __init__(self, size: int) -> None:
        self.size = size
        self.count = 0
        self._rows: list[Index] = []
        self._columns: list[Index] = []
        self._values: list[Array] = []
        self._lower: list[Array] = []
        self._upper: list[Array] = []
        self._family: list[Index] = []
        self._where: list[Index] = []

    def add(self, family: str, lower: Any, upper: Any, terms: Sequence[Term], where: Sequence[Any] = ()) -> None:
        """Add one row for every entry of the terms' quantities.

        Args:
            family: one of ``FAMILIES``.
            lower: number or array that broadcasts against the quantities.
            upper: the same.
            terms: whose sum is bounded; their quantities broadcast against each other.
            where: up to four whole numbers or arrays that name the rows.
        """
        shape = np.broadcast_shapes(
            *(quantity.index.shape for _, quantity in terms), *(np.shape(coefficient) for coefficient, _ in terms)
        )
        size = int(np.prod(shape))
        numbers = np.arange(self.count, self.count + size)
        offset = np.zeros(size)
        for coefficient, quantity in terms:
            factors = np.broadcast_to(np.asarray(coefficient, dtype=float), shape).ravel()
            index = np.broadcast_to(quantity.index, shape).ravel()
            offset += factors * np.broadcast_to(quantity.value, shape).ravel()
            unknown = (index >= 0) & (factors != 0)
            self._rows.append(numbers[unknown])
            self._columns.append(index[unknown])
            self._values.append(factors[unknown])
        self._lower.append(np.broadcast_to(np.asarray(lower, dtype=float), shape).ravel() - offset)
        self._upper.append(np.broadcast_to(np.asarray(upper, dtype=float), shape).ravel() - offset)
        self._family.append(np.full(size, FAMILIES.index(family)))
        names = np.zeros((size, 4), dtype=np.int64)
        for column, name in enumerate(where):
            names[:, column] = np.broadcast_to(np.asarray(name), shape).ravel()
        self._where.append(names)
        self.count += size

    def splice(self, *, rows: Index, columns: Index, values: Array, slack: Index, upper: Array) -> None:
        """Add rows given by their entries, each of which one slack lets give: entries - slack <= upper."""
        size = len(upper)
        self._rows += [self.count + rows, np.arange(self.count, self.count + size)]
        self._columns += [columns, slack]
        self._values += [values, np.full(size, -1.0)]
        self._lower.append(np.full(size, -np.inf))
        self._upper.append(upper)
        self._family.append(np.zeros(size, dtype=np.int64))
        self._where.append(np.zeros((size, 4), dtype=np.int64))
        self.count += size

    def rows(self) -> Rows:
        """Return what was added."""
        if not self._lower:
            empty = np.zeros(0)
            none = np.zeros(0, dtype=np.int64)
            return Rows(sp.csr_matrix((0, self.size)), empty, empty, none, np.zeros((0, 4), dtype=np.int64))
        matrix = sp.csr_matrix(
            (np.concatenate(self._values), (np.concatenate(self._rows), np.concatenate(self._columns))),
            shape=(self.count, self.size),
        )
        return Rows(
            matrix,
            np.concatenate(self._lower),
            np.concatenate(self._upper),
            np.concatenate(self._family),
            np.concatenate(self._where),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Cost:
    """The objective ``unknowns' P unknowns / 2 + q' unknowns + constant``.

    Attributes:
        hessian: P, symmetric, sparse.
        linear: q.
        constant: what remains at 0.
        curvature: a diagonal that P exceeds (P minus it is positive semidefinite), shape (unknowns,).
    """

    hessian: sp.csc_matrix
    linear: Array
    constant: float
    curvature: Array

    def at(self, unknowns: Array) -> float:
        """Return the objective's value."""
        return float(unknowns @ (self.hessian @ unknowns) / 2 + self.linear @ unknowns + self.constant)


class CostBuilder:
    """Collects weighted squared deviations.

    Args:
        size: how many unknowns there are.
    """

    def __init__(self, size: int) -> None:
        self._rows = RowBuilder(size)
        self._weights: list[Array] = []

    def add(self, weight: Any, terms: Sequence[Term], target: Any) -> None:
        """Add weight * (sum of the terms - target) ** 2 for every entry of the quantities."""
        before = self._rows.count
        self._rows.add("boundary", target, target, terms)
        shape = np.broadcast_shapes(*(quantity.index.shape for _, quantity in terms))
        self._weights.append(np.broadcast_to(np.asarray(weight, dtype=float), shape).ravel())
        assert self._rows.count - before == self._weights[-1].size

    def cost(self) -> Cost:
        """Return the sum of what was added."""
        return squared(self._rows.rows(), np.concatenate(self._weights))


def squared(rows: Rows, weights: Array) -> Cost:
    """Return the sum of weight * (row - its lower limit) ** 2."""
    weighted = sp.diags_array(2.0 * weights) @ rows.matrix
    hessian = sp.csc_matrix(rows.matrix.T @ weighted)
    hessian.sort_indices()
    alone = np.diff(rows.matrix.indptr) == 1
    single = rows.matrix[alone]
    curvature = np.asarray(single.multiply(single).T @ (2.0 * weights[alone])).ravel()
    return Cost(hessian, -(weighted.T @ rows.lower), float(weights @ rows.lower**2), curvature)

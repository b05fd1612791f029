"""Binary decision diagrams: the small interface that the symbolic engine needs, whoever provides them.

A back end numbers its variables from 0, top of the order first. A set (a function) is a value of the back end's own
class; ``&``, ``|``, ``^``, ``~`` and ``==`` work on it. ``diagram_backends`` opens one by name.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Literal, Protocol, TypeAlias

Backend = Literal["oxidd", "cudd"]
Set: TypeAlias = Any  # a function of the back end; its operators are untyped in both libraries


class Diagrams(Protocol):
    """A manager of decision diagrams over a fixed number of ordered variables.

    Every method raises ``LimitExceeded`` when the node limit of the manager is reached.
    """

    true: Set
    false: Set

    def variable(self, index: int) -> Set:
        """Return the set in which a variable is true."""
        ...

    def cube(self, indices: Iterable[int]) -> Set:
        """Return the conjunction of variables; it stands for the set of them in a quantifier."""
        ...

    def conjoin(self, left: Set, right: Set) -> Set:
        """Return ``left & right``."""
        ...

    def unite(self, left: Set, right: Set) -> Set:
        """Return ``left | right``."""
        ...

    def differ(self, left: Set, right: Set) -> Set:
        """Return ``left ^ right``."""
        ...

    def exists(self, function: Set, cube: Set) -> Set:
        """Return the projection: some value of the cube's variables."""
        ...

    def and_exists(self, left: Set, right: Set, cube: Set) -> Set:
        """Return ``exists(left & right, cube)`` without building the conjunction."""
        ...

    def renaming(self, pairs: Sequence[tuple[int, int]]) -> Any:
        """Return a renaming (old variable, new variable) for ``rename``; use it again and again."""
        ...

    def rename(self, function: Set, renaming: Any) -> Set:
        """Return the function with its variables renamed, all at once."""
        ...

    def cofactors(self, function: Set) -> tuple[int, Set, Set] | None:
        """Return the top variable and what is left where it is false and where it is true; None for a constant."""
        ...

    def count(self, function: Set, variables: int) -> int:
        """Return how many valuations of so many variables, all that the function mentions, satisfy it."""
        ...

    def pick(self, function: Set) -> dict[int, bool] | None:
        """Return a partial valuation that satisfies it whatever the others are; None if there is none."""
        ...

    def size(self, function: Set) -> int:
        """Return the number of nodes of a function."""
        ...

    def nodes(self) -> int:
        """Return the number of nodes that are alive, or thereabouts."""
        ...

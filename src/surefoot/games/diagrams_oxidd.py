"""Decision diagrams by OxiDD: complement edges, one worker, a hard limit of nodes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from oxidd.bcdd import BCDDFunction, BCDDManager
from oxidd.util import BooleanOperator, DDMemoryError

from surefoot.errors import LimitExceeded
from surefoot.games.diagrams import Set

DEFAULT_NODES = 64 << 20
_MOST_NODES = (1 << 31) - 16


class OxiddDiagrams:
    """A manager of OxiDD; see ``Diagrams``. Nodes are allotted lazily, so a high limit costs nothing by itself."""

    def __init__(self, variables: int, node_limit: int | None = None) -> None:
        self._limit = min(node_limit or DEFAULT_NODES, _MOST_NODES)
        cache = 1 << 16 if variables < 24 else 1 << 19 if variables < 64 else 1 << 21
        self._manager = BCDDManager(max(self._limit, 1 << 10), cache, 1)
        self._manager.add_vars(variables)
        self.true = self._manager.true()
        self.false = self._manager.false()

    def variable(self, index: int) -> Set:
        """Return the set in which a variable is true."""
        return self._manager.var(index)

    def cube(self, indices: Iterable[int]) -> Set:
        """Return the conjunction of variables."""
        result = self.true
        for index in sorted(indices, reverse=True):
            result = result & self._manager.var(index)
        return result

    def conjoin(self, left: Set, right: Set) -> Set:
        """Return ``left & right``."""
        return self._limited(lambda: left & right)

    def unite(self, left: Set, right: Set) -> Set:
        """Return ``left | right``."""
        return self._limited(lambda: left | right)

    def differ(self, left: Set, right: Set) -> Set:
        """Return ``left ^ right``."""
        return self._limited(lambda: left ^ right)

    def exists(self, function: Set, cube: Set) -> Set:
        """Return the projection: some value of the cube's variables."""
        return self._limited(lambda: function.exists(cube))

    def and_exists(self, left: Set, right: Set, cube: Set) -> Set:
        """Return ``exists(left & right, cube)`` without building the conjunction."""
        return self._limited(lambda: left.apply_exists(BooleanOperator.AND, right, cube))

    def renaming(self, pairs: Sequence[tuple[int, int]]) -> Any:
        """Return a renaming (old variable, new variable)."""
        return BCDDFunction.make_substitution([(old, self._manager.var(new)) for old, new in pairs])

    def rename(self, function: Set, renaming: Any) -> Set:
        """Return the function with its variables renamed, all at once."""
        return self._limited(lambda: function.substitute(renaming))

    def cofactors(self, function: Set) -> tuple[int, Set, Set] | None:
        """Return the top variable and what is left where it is false and where it is true; None for a constant."""
        parts = function.cofactors()
        if parts is None:
            return None
        return function.node_var(), parts[1], parts[0]

    def count(self, function: Set, variables: int) -> int:
        """Return how many valuations of so many variables satisfy it."""
        return int(function.sat_count(variables))

    def pick(self, function: Set) -> dict[int, bool] | None:
        """Return a partial valuation that satisfies it whatever the others are; None if there is none."""
        cube = function.pick_cube()
        return None if cube is None else {index: value for index, value in enumerate(cube) if value is not None}

    def size(self, function: Set) -> int:
        """Return the number of nodes of a function."""
        return int(function.node_count())

    def nodes(self) -> int:
        """Return the number of nodes that are alive, or thereabouts."""
        return int(self._manager.approx_num_inner_nodes())

    def _limited(self, operation: Callable[[], Set]) -> Set:
        try:
            return operation()
        except DDMemoryError as problem:
            raise LimitExceeded(f"the limit of {self._limit} decision diagram nodes was reached") from problem

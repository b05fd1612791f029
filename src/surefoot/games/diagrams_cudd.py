"""Decision diagrams by CUDD through the optional package dd."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from surefoot.errors import BackendMissing, LimitExceeded
from surefoot.games.diagrams import Set

_BYTES_PER_NODE = 40


class CuddDiagrams:
    """A manager of CUDD; see ``Diagrams``. The declared order stays: automatic reordering is off."""

    def __init__(self, variables: int, node_limit: int | None = None) -> None:
        try:
            from dd import cudd  # type: ignore[import-not-found,unused-ignore]
        except ImportError as problem:
            raise BackendMissing("dd", "pip install 'surefoot[cudd]'") from problem
        self._limit = node_limit
        memory = {} if node_limit is None else {"memory_estimate": max(node_limit * _BYTES_PER_NODE, 1 << 24)}
        self._cudd = cudd
        self._manager = cudd.BDD(**memory)
        self._manager.configure(reordering=False)
        self._names = [f"v{index}" for index in range(variables)]
        self._manager.declare(*self._names)
        self._numbers = {name: index for index, name in enumerate(self._names)}
        self.true = self._manager.true
        self.false = self._manager.false

    def variable(self, index: int) -> Set:
        """Return the set in which a variable is true."""
        return self._manager.var(self._names[index])

    def cube(self, indices: Iterable[int]) -> Set:
        """Return the conjunction of variables."""
        return self._manager.cube([self._names[index] for index in indices])

    def conjoin(self, left: Set, right: Set) -> Set:
        """Return ``left & right``."""
        return self._limited(lambda: left & right)

    def unite(self, left: Set, right: Set) -> Set:
        """Return ``left | right``."""
        return self._limited(lambda: left | right)

    def differ(self, left: Set, right: Set) -> Set:
        """Return ``left ^ right``."""
        return self._limited(lambda: self._manager.apply("xor", left, right))

    def exists(self, function: Set, cube: Set) -> Set:
        """Return the projection: some value of the cube's variables."""
        return self._limited(lambda: self._manager.exist(list(cube.support), function))

    def and_exists(self, left: Set, right: Set, cube: Set) -> Set:
        """Return ``exists(left & right, cube)`` without building the conjunction."""
        return self._limited(lambda: self._cudd.and_exists(left, right, list(cube.support)))

    def renaming(self, pairs: Sequence[tuple[int, int]]) -> Any:
        """Return a renaming (old variable, new variable)."""
        return {self._names[old]: self.variable(new) for old, new in pairs}

    def rename(self, function: Set, renaming: Any) -> Set:
        """Return the function with its variables renamed, all at once."""
        return self._limited(lambda: self._manager.let(renaming, function))

    def cofactors(self, function: Set) -> tuple[int, Set, Set] | None:
        """Return the top variable and what is left where it is false and where it is true; None for a constant."""
        if function.var is None:
            return None
        low, high = (~function.low, ~function.high) if function.negated else (function.low, function.high)
        return self._numbers[function.var], low, high

    def count(self, function: Set, variables: int) -> int:
        """Return how many valuations of so many variables satisfy it."""
        return int(function.count(nvars=variables))

    def pick(self, function: Set) -> dict[int, bool] | None:
        """Return a partial valuation that satisfies it whatever the others are; None if there is none."""
        chosen = self._manager.pick(function)
        return None if chosen is None else {self._numbers[name]: value for name, value in chosen.items()}

    def size(self, function: Set) -> int:
        """Return the number of nodes of a function."""
        return int(function.dag_size)

    def nodes(self) -> int:
        """Return the number of nodes that are alive, or thereabouts."""
        return len(self._manager)

    def _limited(self, operation: Callable[[], Set]) -> Set:
        if self._limit is not None and len(self._manager) > self._limit:
            raise LimitExceeded(f"the limit of {self._limit} decision diagram nodes was reached")
        return operation()

"""Contact tables that wait to be tried, each with what all prices so far prove about its cost."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from surefoot.footholds.cells import Cells
from surefoot.footholds.dual import Pricing
from surefoot.footholds.sharing import Prices

GUESSED, FIRST, LATER, LAST = range(4)
"""Order of trial: what even prices like, a coarse selection, what better prices suggest, other templates."""


class Pool:
    """Contact tables that may be tried.

    Args:
        guide: evaluates prices.
    """

    def __init__(self, guide: Pricing) -> None:
        self.guide = guide
        self.tables: dict[bytes, tuple[Cells, str]] = {}
        self.ranks: dict[bytes, int] = {}
        self.bounds: dict[bytes, float] = {}
        self.priced: dict[bytes, int] = {}
        self.guesses: list[Callable[[Cells], float]] = []
        self.gone: set[bytes] = set()

    def add(self, named: Iterable[tuple[str, Cells]], rank: int) -> None:
        """Take in contact tables; those that are there already move up in rank."""
        for name, cells in named:
            key = cells.tobytes()
            if key in self.tables:
                self.ranks[key] = min(self.ranks[key], rank)
            elif key not in self.gone:
                self.tables[key], self.ranks[key] = (cells, name), rank
                self.bounds[key], self.priced[key] = -np.inf, 0

    def has(self, rank: int) -> bool:
        """Return whether any of a rank, or of one before it, is left."""
        return any(own <= rank for own in self.ranks.values())

    def price(self, prices: Prices) -> None:
        """Learn from prices; what they prove about a table is looked up when its rank's turn has come."""
        self.guesses.append(self.guide.guesses(prices))

    def pop(self, worth: float) -> tuple[Cells, str] | None:
        """Return the table that promises most within the first rank, or None when none can cost less than that."""
        while self.tables:
            rank = min(self.ranks.values())
            keys = [key for key, own in self.ranks.items() if own == rank]
            for key in keys:
                self._look_up(key)
                if self.bounds[key] >= worth:
                    self._drop(key)
            left = [key for key in keys if key in self.tables]
            if left:
                best = min(left, key=lambda one: (self.bounds[one], one))
                found = self.tables[best]
                self._drop(best)
                return found
        return None

    def _look_up(self, key: bytes) -> None:
        for guess in self.guesses[self.priced[key] :]:
            self.bounds[key] = max(self.bounds[key], guess(self.tables[key][0]))
        self.priced[key] = len(self.guesses)

    def _drop(self, key: bytes) -> None:
        self.gone.add(key)
        del self.tables[key], self.ranks[key], self.bounds[key], self.priced[key]

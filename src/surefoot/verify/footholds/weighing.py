"""Adds up weighted rows, and how large what was added is: no proof may rest on what rounding makes of it."""

from __future__ import annotations

from typing import Any

import numpy as np

from surefoot.verify.footholds.file import Array

_ROUNDING = 1e-12


class Tally:
    """Coefficients of unknowns.

    Args:
        shape: of the unknowns.
    """

    def __init__(self, shape: int | tuple[int, ...]) -> None:
        self.sum: Array = np.zeros(shape)
        self.size: Array = np.zeros(shape)

    def add(self, place: Any, amount: Any) -> None:
        """Add to some coefficients, each as often as it is named."""
        np.add.at(self.sum, place, amount)
        np.add.at(self.size, place, np.abs(amount))


def rounded(size: float) -> float:
    """Return how much rounding may be worth in a sum of terms that are so large together."""
    return _ROUNDING * float(size)


def place_in(given: Any, *counts: int) -> tuple[int, ...]:
    """Return places that a file names, each a whole number from 0 to below its count.

    Raises:
        ValueError: one is not.
    """
    for one, count in zip(given, counts, strict=True):
        if isinstance(one, bool) or one != int(one) or not 0 <= one < count:
            raise ValueError(f"place {one}")
    return tuple(int(one) for one in given)

"""One line of the table of benchmarks: a measured number beside its target and the paper's."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

Say = Callable[[str], None]
Bound = Literal["at most", "at least"]


@dataclass(frozen=True, slots=True)
class Figure:
    """One measured number.

    Attributes:
        what: what was measured.
        measured: the number.
        unit: its unit, empty for counts.
        target: what it should be at most or at least; None when there is no target.
        bound: which of the two.
        paper: what the papers (or the tools they use) need for the same.
    """

    what: str
    measured: float
    unit: str
    target: float | None
    bound: Bound
    paper: str

    @property
    def met(self) -> bool | None:
        """Whether the target is met; None when there is none."""
        if self.target is None:
            return None
        return self.measured <= self.target if self.bound == "at most" else self.measured >= self.target

    @property
    def measured_text(self) -> str:
        """The number with its unit."""
        return f"{_short(self.measured)} {self.unit}".rstrip()

    @property
    def target_text(self) -> str:
        """The target with its unit, or nothing."""
        return "" if self.target is None else f"{self.bound} {_short(self.target)} {self.unit}".rstrip()


def _short(value: float) -> str:
    return f"{value:.3g}" if abs(value) < 1000 and value != int(value) else f"{value:.0f}"

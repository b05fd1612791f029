"""How far the engines come: growing families, member after member, until one takes too long."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from surefoot.compute import Deadline
from surefoot.games.families import FAMILIES
from surefoot.games.synthesis import synthesize
from surefoot.logic import parse_slugsin

STEP = 5
LIMIT_S = 60.0


@dataclass(frozen=True, slots=True)
class Member:
    """One member of a family.

    Attributes:
        family: its name.
        size: its parameter.
        solve_s: processor seconds to decide it; None when the limit was reached.
    """

    family: str
    size: int
    solve_s: float | None


def growth(say: Callable[[str], None], *, limit_s: float = LIMIT_S, step: int = STEP) -> Iterator[Member]:
    """Decide the members of every family in rising order; the first that takes too long is the last."""
    for family, text_of in FAMILIES.items():
        size = step
        while True:
            say(f"deciding {family} {size}")
            spec = parse_slugsin(text_of(size), Path(f"{family}_{size}.slugsin"))
            answer = synthesize(spec, realizability_only=True, deadline=Deadline.after(limit_s))
            yield Member(family, size, answer.solve_s if answer.verdict.limit is None else None)
            if answer.verdict.limit is not None:
                break
            size += step

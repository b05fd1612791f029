"""How far the engines come: growing families of specifications, member after member, until one takes a minute."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from surefoot.cli.benchmarks.deciding import LIMIT_S, decide
from surefoot.cli.output import Say, answer

if TYPE_CHECKING:
    from surefoot.missions.bench.figures import Figure

LARGEST = 2000


@dataclass(frozen=True, slots=True)
class Member:
    """One member of a family.

    Attributes:
        family: its name.
        size: its parameter.
        solve_s: processor seconds to decide it; infinite when the limit was reached.
        states: how many of them are reachable, if they were counted.
    """

    family: str
    size: int
    solve_s: float
    states: int | None


def growth(say: Say, limit_s: int = LIMIT_S) -> Iterator[Member]:
    """Decide the members of every family in rising order, each in a process of its own; stop after the first failure.

    Args:
        say: is told what is decided.
        limit_s: how long one may take.
    """
    from surefoot.games.families import FAMILIES

    with TemporaryDirectory(prefix="surefoot-") as folder:
        for family, text_of in FAMILIES.items():
            for size in sizes(family):
                say(f"deciding {family} {size}")
                suffix = "slugsin" if family == "genbuf" else "structuredslugs"
                path = Path(folder) / f"{family}_{size}.{suffix}"
                path.write_text(text_of(size))
                run = decide(path, limit_s)
                decided = run["verdict"] == "realizable"
                yield Member(family, size, run["solve_s"] if decided else float("inf"), run["states"])
                if not decided:
                    break


def sizes(family: str) -> Iterator[int]:
    """Yield the members that are tried: jcss12 one by one, it grows fastest; of the others some in every octave."""
    if family == "jcss12":
        yield from range(2, LARGEST)
    for octave in count(1):
        for size in (2**octave, 3 * 2 ** (octave - 1)):
            if size > LARGEST:
                return
            yield size


def growth_figures(say: Say) -> Iterator[Figure]:
    """Return the largest member of every family that is decided within the limit."""
    from surefoot.missions.bench.figures import Figure

    best: dict[str, Member] = {}
    for member in growth(say):
        if member.solve_s < float("inf"):
            best[member.family] = member
    for family, member in best.items():
        what = f"growth of {family}: member {member.size}, the largest within {LIMIT_S} s, CPU"
        yield Figure(what, member.solve_s, "s", None, "at most", "")


def answer_growth(say: Say, picture: Path | None, *, as_json: bool) -> None:
    """Measure the growth, draw it if a picture is asked for, and end the command."""
    members = tuple(growth(say))
    if picture is not None:
        from surefoot.viewer.studies.growth import draw_growth

        rows = [(member.family, member.size, member.solve_s) for member in members]
        draw_growth(picture, rows, LIMIT_S)
    lines = [f"{'family':<8}  {'size':>5}  {'CPU [s]':>8}  reachable states"]
    for member in members:
        seconds = f"{member.solve_s:8.2f}" if member.solve_s < float("inf") else "       -"
        states = "not counted" if member.states is None else f"{member.states:,}"
        lines.append(f"{member.family:<8}  {member.size:>5}  {seconds}  {states}")
    answer({"members": members, "limit_s": LIMIT_S}, lines, yes=True, as_json=as_json)

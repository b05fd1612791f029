"""The lines of the search for gaits in the table of benchmarks."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from surefoot.cli.output import Say

if TYPE_CHECKING:
    from surefoot.missions.bench.figures import Figure


def gait_figures(say: Say) -> Iterator[Figure]:
    """Measure all families and compare with the paper (Gurobi 9, i9-13900K) and the targets."""
    from surefoot.footholds.free_benchmarks import FIRST_S, GAP, REFUTED_S, measure
    from surefoot.missions.bench.figures import Figure

    for one in measure(say=say):
        what = f"gaits {one.family} ({one.feasible}+{one.infeasible} of {one.instances}):"
        refuted = one.infeasible > one.feasible
        target, paper = (REFUTED_S, "0.5-1 s") if refuted else (FIRST_S, "27 s mean, 146 s worst")
        done = "refuted" if refuted else "first plan"
        yield Figure(f"{what} {done}, median CPU", one.decided_s[0], "s", None, "at most", paper)
        yield Figure(f"{what} {done}, p95 CPU", one.decided_s[1], "s", target, "at most", paper)
        yield Figure(f"{what} unknown", one.unknown, "", 0, "at most", "")
        if one.gaps:
            yield Figure(f"{what} gap of the total in 15 s of CPU, median", one.gaps[0], "", None, "at most", "")
            yield Figure(f"{what} gap of the total in 15 s of CPU, worst", one.gaps[1], "", GAP, "at most", "")

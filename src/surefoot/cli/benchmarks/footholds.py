"""The foothold programs' lines in the table of benchmarks."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from surefoot.cli.output import Say

if TYPE_CHECKING:
    from surefoot.missions.bench.figures import Figure


def foothold_figures(say: Say) -> Iterator[Figure]:
    """Measure all families and compare with the paper (Gurobi 9, i9-13900K) and the targets."""
    from surefoot.footholds.benchmarks import COLLISION_MS, DECIDED_MS, GAP_MS, PAPER, measure
    from surefoot.missions.bench.figures import Figure

    families = measure(say=say)
    for one in families:
        what = f"footholds {one.family} ({one.feasible}+{one.infeasible} of {one.instances}):"
        paper, target = PAPER.get(one.family, "0.37 s"), COLLISION_MS if one.collision else GAP_MS
        yield Figure(
            f"{what} decided, p95 CPU", one.decided_ms[1], "ms", None if one.collision else DECIDED_MS, "at most", ""
        )
        yield Figure(f"{what} to 1e-4, median CPU", one.gap_ms[0], "ms", None, "at most", paper)
        yield Figure(f"{what} to 1e-4, p95 CPU", one.gap_ms[1], "ms", target, "at most", paper)
        yield Figure(f"{what} net gap, worst", one.net_gap, "", None, "at most", "")
        yield Figure(f"{what} unknown", one.unknown, "", 0, "at most", "")
    worst = max(families, key=lambda one: one.gap_ms[1])
    yield Figure(
        f"footholds, worst family: {worst.family}, to 1e-4, p95 CPU", worst.gap_ms[1], "ms", None, "at most", ""
    )
    residual = max(one.residual for one in families)
    yield Figure("footholds, worst residual", residual, "", 1e-6, "at most", "")

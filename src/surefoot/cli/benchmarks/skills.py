"""The lines of skills and repair in the table of benchmarks."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from surefoot.cli.output import Say

if TYPE_CHECKING:
    from surefoot.missions.bench.figures import Figure

STRATEGY_MS = 2.0
REPAIR_MS = 20.0
RESYNTHESIS_MS = 5.0
WHOLE_S = 60.0
_PAPER = {3: ("20-60 ms", "50-250 ms"), 5: ("40-300 ms", "100-600 ms")}


def skill_figures(say: Say) -> Iterator[Figure]:
    """Measure synthesis and repair of single pairs, and one whole offline synthesis with physics."""
    from surefoot.missions.bench.figures import Figure
    from surefoot.skills.benchmarks import measure, percentile, whole_synthesis

    for size in (3, 5):
        times = measure((size, size), say)
        what = f"skills {size}x{size}:"
        strategy, repair = _PAPER[size]
        for percent in (50, 95):
            name = "median" if percent == 50 else "p95"
            yield Figure(
                f"{what} strategy of a pair, no repair, {name} CPU",
                percentile(times.strategy_ms, percent), "ms", STRATEGY_MS, "at most", strategy,
            )  # fmt: skip
            yield Figure(
                f"{what} symbolic repair of a pair ({len(times.repair_ms)}), {name} CPU",
                percentile(times.repair_ms, percent), "ms", REPAIR_MS, "at most", repair,
            )  # fmt: skip
        yield Figure(f"{what} symbolic repair, worst CPU", max(times.repair_ms), "ms", None, "at most", "")
        resynthesis = percentile(times.resynthesis_ms, 95)
        yield Figure(f"{what} resynthesis, p95 CPU", resynthesis, "ms", RESYNTHESIS_MS, "at most", "50 ms")
        yield Figure(f"{what} repairable pairs of {times.pairs} missed", times.missed, "", 0, "at most", "some")
        yield Figure(f"{what} new skills over the fewest", times.new / times.fewest, "", None, "at most", "")
    found = whole_synthesis("unstructured-8", 0, say)
    what = "skills unstructured-8, 3x3, seed 0:"
    yield Figure(f"{what} whole offline synthesis", found["time_s"], "s", WHOLE_S, "at most", "397 s")
    for name in ("pairs", "start_skills", "realizable", "repaired", "unrepairable", "undecided", "suggested"):
        yield Figure(f"{what} {name.replace('_', ' ')}", found[name], "", None, "at most", "")
    yield Figure(f"{what} repaired of those in need", found["repaired_of_those_in_need"], "", None, "at least", "0.526")

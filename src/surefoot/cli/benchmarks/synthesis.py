"""The synthesis lines in the table of benchmarks: realizability of stored specifications, beside slugs."""

from __future__ import annotations

import os
import statistics
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from surefoot.cli.benchmarks.deciding import decide
from surefoot.cli.benchmarks.growth import growth_figures
from surefoot.cli.output import Say

if TYPE_CHECKING:
    from surefoot.missions.bench.figures import Figure

REPEATS = 3
TARGETS: dict[str, tuple[float | None, str]] = {
    "navigation/coarse_one_obstacle.structuredslugs": (10.0, "slugs: none in 300 s"),
    "navigation/fine_action_game.structuredslugs": (20.0, "slugs: none in 251 s"),
    "gr1experiments/genbuf_10.slugsin": (0.87, "slugs: 0.87 s"),
    "gr1experiments/bunny_many_goals_8.slugsin": (4.8, "slugs: 4.8 s"),
    "gr1experiments/jcss12_4.slugsin": (55.0, "slugs: 55 s"),
    "gr1experiments/synt15_4.slugsin": (None, "slugs, synt15 2: 0.25 s"),
    "slugs/EvasionOnGrid_basicEvasion.structuredslugs": (10.0, "slugs: none in 20 s"),
}
"""Processor seconds to decide, without a strategy."""


def folder_of_specifications() -> Path:
    """Return where the specifications are: SUREFOOT_SPECS, or else beside the repository."""
    return Path(os.environ.get("SUREFOOT_SPECS", "../shared/data/specs"))


def synthesis_figures(say: Say) -> Iterator[Figure]:
    """Measure every stored specification with a target, each run in a process of its own; medians."""
    from surefoot.missions.bench.figures import Figure

    folder = folder_of_specifications()
    for name, (target_s, slugs) in TARGETS.items():
        path = folder / name
        if not path.is_file():
            say(f"{path} is absent; SUREFOOT_SPECS names the folder of specifications")
            continue
        say(f"deciding {name}")
        runs = [decide(path) for _ in range(REPEATS)]
        decided = all(run["verdict"] == "realizable" for run in runs)
        solve_s = statistics.median(run["solve_s"] for run in runs) if decided else float("inf")
        memory_mb = max(run["peak_mb"] for run in runs)
        what = f"synthesis {path.stem} ({runs[0]['engine']}):"
        yield Figure(f"{what} decided, CPU", solve_s, "s", target_s, "at most", slugs)
        yield Figure(f"{what} peak memory", memory_mb, "MB", None, "at most", "")
    yield from growth_figures(say)

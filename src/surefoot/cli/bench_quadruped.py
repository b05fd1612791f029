"""The lines of quadruped missions in the table of benchmarks."""

from __future__ import annotations

import statistics
from collections.abc import Iterator
from typing import TYPE_CHECKING

from surefoot.cli.output import Say

if TYPE_CHECKING:
    from surefoot.missions.figures import Figure
    from surefoot.missions.quadruped_bench import SceneResult

SEEDS = tuple(range(25))
RESYNTHESIS_MS = 5.0
_TARGETS_MS = {"unstructured-4": 100.0, "unstructured-8": 200.0, "rebar-7": 200.0, "rebar-14": 200.0}
_PAPER = {
    "unstructured-4": "370 ms",
    "unstructured-8": "490 ms; 2650 ms with collision",
    "rebar-7": "1110 ms",
    "rebar-14": "1090 ms",
}


def quadruped_figures(say: Say) -> Iterator[Figure]:
    """Walk the four scenes with every seed."""
    from surefoot.missions.quadruped_bench import SCENES, measure_scene

    for scene in SCENES:
        yield from _scene(measure_scene(scene, SEEDS, say))


def _scene(found: SceneResult) -> Iterator[Figure]:
    from surefoot.missions.figures import Figure

    answers = [one.answer for one in found.missions]
    ways = sum(one.way for one in found.missions)
    what = f"quadruped {found.scene}:"
    yield Figure(f"{what} seeds with a way", ways, f"of {len(answers)}", None, "at least", "")
    missed = ", ".join(f"seed {one.seed}: {one.answer.why_not}" for one in found.missed)
    yield Figure(f"{what} goals missed although there is a way", len(found.missed), missed, 0, "at most", "one run")
    yield Figure(f"{what} runs not verified", sum(not one.verified for one in answers), "", 0, "at most", "")
    mean = statistics.fmean(found.solve_ms)
    yield Figure(f"{what} online program, mean CPU", mean, "ms", _TARGETS_MS[found.scene], "at most",
                 _PAPER[found.scene])  # fmt: skip
    p95 = statistics.quantiles(found.solve_ms, n=20)[-1]
    yield Figure(f"{what} online program, p95 CPU", p95, "ms", None, "at most", "")
    yield Figure(f"{what} re-targeting, mean CPU", statistics.fmean(found.retarget_ms), "ms", None, "at most", "")
    walked = [one for one in answers if one.transitions]
    sizes = {"polygons": "polygons_mean", "continuous variables": "continuous_mean", "binaries": "binaries_mean"}
    for name, key in sizes.items():
        value = statistics.fmean(getattr(one, key) for one in walked)
        yield Figure(f"{what} {name} of a program, mean", value, "", None, "at most", "")
    programs = len(found.solve_ms)
    contradictions = sum(one.contradictions for one in answers)
    settled = sum(one.settled for one in answers)
    yield Figure(f"{what} programs against their certificates", contradictions, f"of {programs}", None, "at most",
                 "not reported")  # fmt: skip
    yield Figure(f"{what} settled first", settled, f"of {programs}", None, "at most", "")
    yield Figure(f"{what} stopped by a limit", sum(one.limits for one in answers), "", 0, "at most", "")
    slowest = max(one.resynthesis_ms for one in answers)
    yield Figure(f"{what} strategy made at run time, worst CPU", slowest, "ms", RESYNTHESIS_MS, "at most", "50 ms")
    idle = sum(one.idle_s - one.idle_for_checks_s for one in answers)
    yield Figure(f"{what} idle time from planning", idle, "s", 0, "at most", "not reported")
    checks = sum(one.idle_for_checks_s for one in answers)
    yield Figure(f"{what} idle time while physics is asked", checks, "s", None, "at most", "not reported")
    yield from _collision(found, what)


def _collision(found: SceneResult, what: str) -> Iterator[Figure]:
    """Compare the same programs with and without free regions."""
    from surefoot.missions.figures import Figure

    both = [list(zip(one.with_collision_ms, one.without_ms, strict=True)) for one in found.missions]
    pairs = [pair for mission in both for pair in mission]
    if pairs:
        on, off = (statistics.fmean(column) for column in zip(*pairs, strict=True))
        yield Figure(f"{what} programs at steps ({len(pairs)}), with collision, mean CPU", on, "ms", 200.0, "at most",
                     "2650 ms")  # fmt: skip
        yield Figure(f"{what} the same without collision, mean CPU", off, "ms", None, "at most", "490 ms")

"""``surefoot bench quadruped``: missions of a quadruped, and what the paper compares on them."""

from __future__ import annotations

import statistics
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from surefoot.cli.benchmarks.table import figure_table, plain_table
from surefoot.cli.output import Say, answer
from surefoot.errors import InputError

if TYPE_CHECKING:
    from surefoot.missions.bench.campaign import Campaign
    from surefoot.missions.bench.detours import Detour
    from surefoot.missions.bench.figures import Figure
    from surefoot.missions.bench.quadruped import Measured
    from surefoot.missions.bench.quadruped_missions import Ended, Mission, Program
    from surefoot.missions.bench.tables import Miss, NearestRow, TurnedRow

SEEDS, FULL_SEEDS = 3, 25
RESYNTHESIS_MS = 5.0
_TARGETS_MS = {"unstructured-4": 100.0, "unstructured-8": 200.0, "rebar-7": 200.0, "rebar-14": 200.0}
_PAPER = {
    "unstructured-4": "370 ms",
    "unstructured-8": "490 ms",
    "rebar-7": "1110 ms",
    "rebar-14": "1090 ms",
}


@dataclass(frozen=True, slots=True)
class Asked:
    """What is to be measured.

    Attributes:
        scenes: names of scenes; none for all four.
        seeds: how many maps of each; None for a few.
        full: as many as the documentation's tables have.
        keep: a folder for every result, with which a campaign goes on; None for one that is removed.
        pictures: a folder for pictures; None for none.
    """

    scenes: Sequence[str] = ()
    seeds: int | None = None
    full: bool = False
    keep: Path | None = None
    pictures: Path | None = None

    @property
    def given(self) -> bool:
        """Whether anything but pictures was asked for."""
        return bool(self.scenes) or self.seeds is not None or self.full or self.keep is not None


def answer_quadruped_bench(asked: Asked, say: Say, *, as_json: bool) -> None:
    """Measure, print the tables, and end the command."""
    from surefoot.missions.bench.quadruped import measure
    from surefoot.missions.bench.tables import misses, nearest_rows, turned_rows

    with _campaign(asked, say) as campaign:
        found = measure(campaign)
        pictures = _pictures(campaign, found, asked.pictures)
    figures = tuple(quadruped_figures(found))
    nearest, turned, missed = nearest_rows(found.straight), turned_rows(found.turned), tuple(misses(found))
    met = all(figure.met is not False for figure in figures)
    lines = [*figure_table(figures), *_nearest_lines(nearest), *_turned_lines(turned), *_missed_lines(missed)]
    value = {"figures": figures, "nearest": nearest, "turned": turned, "missed": missed, "pictures": pictures}
    answer({**value, "met": met}, [*lines, *map(str, pictures)], yes=met, as_json=as_json)


@contextmanager
def _campaign(asked: Asked, say: Say) -> Iterator[Campaign]:
    from surefoot.missions.bench.campaign import SCENES, Campaign

    for scene in asked.scenes:
        if scene not in SCENES:
            raise InputError(f"there is no scene {scene!r}; there are: {', '.join(SCENES)}", key="--scene")
    if asked.full and asked.seeds is not None:
        raise InputError(f"is {FULL_SEEDS} seeds already; give --seeds or --full", key="--full")
    seeds = range(FULL_SEEDS if asked.full else asked.seeds or SEEDS)
    scenes = tuple(one for one in SCENES if not asked.scenes or one in asked.scenes)
    if asked.keep is not None:
        yield Campaign(asked.keep, scenes, seeds, say)
        return
    with tempfile.TemporaryDirectory(prefix="surefoot-") as name:
        yield Campaign(Path(name), scenes, seeds, say)


def _pictures(campaign: Campaign, found: Measured, folder: Path | None) -> list[Path]:
    if folder is None:
        return []
    from surefoot.viewer.studies.quadruped import draw_ways

    return draw_ways(campaign, found, folder)


def quadruped_figures(found: Measured) -> Iterator[Figure]:
    """Return the numbers that have a target or stand in the paper, scene by scene."""
    for scene in dict.fromkeys(one.scene for one in found.missions):
        yield from _scene(scene, [one for one in found.missions if one.scene == scene])
        yield from _detours(scene, [one for one in found.detours if one.scene == scene])


def _scene(scene: str, missions: Sequence[Mission]) -> Iterator[Figure]:
    from surefoot.missions.bench.figures import Figure

    what, ended = f"{scene}:", [one.ended for one in missions if one.ended is not None]
    ways = [one for one in missions if one.way]
    missed = sum(one.ended is not None and not one.ended.reached for one in ways)
    yield Figure(f"{what} maps with a way", len(ways), f"of {len(missions)}", None, "at least", "")
    yield Figure(f"{what} goals missed although there is a way", missed, "", 0, "at most", "one run")
    yield Figure(f"{what} starts that are no place to stand", len(missions) - len(ended), "", None, "at most", "")
    programs = [program for one in missions for program in one.programs]
    if programs:
        yield from _programs(scene, what, programs)
    yield from _counts(what, ended, len(programs))


def _programs(scene: str, what: str, programs: Sequence[Program]) -> Iterator[Figure]:
    from surefoot.missions.bench.figures import Figure

    times = [one.solve_ms for one in programs]
    yield Figure(f"{what} online program, mean CPU", statistics.fmean(times), "ms", _TARGETS_MS[scene], "at most",
                 _PAPER[scene])  # fmt: skip
    yield Figure(f"{what} online program, p95 CPU", _p95(times), "ms", None, "at most", "")
    retargets = statistics.fmean(one.retarget_ms for one in programs)
    yield Figure(f"{what} re-targeting, mean CPU", retargets, "ms", None, "at most", "")
    for name, key in {"polygons": "polygons", "continuous variables": "continuous", "binaries": "binaries"}.items():
        value = statistics.fmean(getattr(one, key) for one in programs)
        yield Figure(f"{what} {name} of a program, mean", value, "", None, "at most", "")
    steps = [one for one in programs if one.clear_ms is not None and one.plain_ms is not None]
    yield Figure(f"{what} programs at steps", len(steps), f"of {len(programs)}", None, "at most", "")
    if steps:
        clear, plain = [one.clear_ms or 0.0 for one in steps], [one.plain_ms or 0.0 for one in steps]
        yield Figure(f"{what} these with collision, mean CPU", statistics.fmean(clear), "ms", 200.0, "at most",
                     "2650 ms")  # fmt: skip
        yield Figure(f"{what} these with collision, p95 CPU", _p95(clear), "ms", None, "at most", "")
        yield Figure(f"{what} the same without, mean CPU", statistics.fmean(plain), "ms", None, "at most", "490 ms")
        yield Figure(f"{what} the same without, p95 CPU", _p95(plain), "ms", None, "at most", "")
        binaries = (
            statistics.fmean(one.binaries for one in steps),
            statistics.fmean(one.plain_binaries for one in steps),
        )
        yield Figure(f"{what} binaries of these with collision", binaries[0], "", None, "at most", "256")
        yield Figure(f"{what} binaries of the same without", binaries[1], "", None, "at most", "69")


def _p95(times: Sequence[float]) -> float:
    return statistics.quantiles(times, n=20, method="inclusive")[-1] if len(times) > 1 else times[0]


def _counts(what: str, ended: Sequence[Ended], programs: int) -> Iterator[Figure]:
    from surefoot.missions.bench.figures import Figure

    yield Figure(f"{what} runs not verified", sum(not one.verified for one in ended), "", 0, "at most", "")
    contradictions, of = sum(one.contradictions for one in ended), f"of {programs}"
    yield Figure(f"{what} programs against their certificates", contradictions, of, None, "at most", "not reported")
    other = sum(one.other_gaits for one in ended)
    yield Figure(f"{what} of these done in another gait", other, f"of {contradictions}", None, "at least", "")
    yield Figure(f"{what} settled first", sum(one.settled for one in ended), of, None, "at most", "")
    yield Figure(f"{what} stopped by a limit", sum(one.limits for one in ended), "", 0, "at most", "")
    slowest = max((one.resynthesis_ms for one in ended), default=0.0)
    yield Figure(f"{what} strategy made at run time, worst CPU", slowest, "ms", RESYNTHESIS_MS, "at most", "50 ms")
    idle = sum(one.idle_s - one.idle_for_checks_s for one in ended)
    yield Figure(f"{what} idle time from planning", idle, "s", 0, "at most", "not reported")
    checks = sum(one.idle_for_checks_s for one in ended)
    yield Figure(f"{what} idle time while physics is asked", checks, "s", None, "at most", "not reported")


def _detours(scene: str, detours: Sequence[Detour]) -> Iterator[Figure]:
    """Return what an obstacle that appears brings about (Fig. 14)."""
    from surefoot.missions.bench.figures import Figure

    what, ways = f"{scene}, obstacle appears:", [one for one in detours if one.way]
    if not detours:
        return
    yield Figure(f"{what} maps on which a way is left", len(ways), f"of {len(detours)}", None, "at least", "")
    missed = sum(not one.ended.reached for one in ways)
    yield Figure(f"{what} of these, goals missed", missed, "", 0, "at most", "one run")
    yield Figure(f"{what} runs not verified", sum(not one.ended.verified for one in detours), "", 0, "at most", "")
    for asked, name, target in ((False, "skills at hand", RESYNTHESIS_MS), (True, "new skills", None)):
        times = [one.first_ms for one in detours if one.first_ms is not None and (one.asked > 0) is asked]
        if times:
            head, median = f"{what} other strategy, {name} ({len(times)}), CPU", statistics.median(times)
            yield Figure(f"{head}, median", median, "ms", target, "at most", "50 ms")
            yield Figure(f"{head}, worst", max(times), "ms", target, "at most", "50 ms")
    longer = [one.ended.transitions - one.segments_before for one in ways if one.ended.reached]
    if longer:
        yield Figure(f"{what} additional segments, median", statistics.median(longer), "", None, "at most", "")


def _nearest_lines(rows: Sequence[NearestRow]) -> list[str]:
    if not rows:
        return []
    head = ("scene", "planner", "whole ways", "footholds", "out of reach", "worst", "beside", "worst")
    cells = [
        (
            one.scene + (", thinned" if one.thinned else ""),
            one.planner,
            f"{one.whole} of {one.ways}",
            str(one.footholds),
            f"{one.out_of_reach:.1%}",
            f"{100 * one.worst_out_m:.0f} cm",
            f"{one.off_polygon:.1%}",
            f"{100 * one.worst_off_m:.0f} cm",
        )
        for one in rows
    ]
    return plain_table("Straight ahead, against the nearest foothold (Zhou et al. 2025, Fig. 15)", head, cells)


def _turned_lines(rows: Sequence[TurnedRow]) -> list[str]:
    if not rows:
        return []
    head = ("scene", "turned by", "polygons", "variables", "binaries", "programs", "min", "mean", "max", "no motion")
    cells = [
        (
            one.scene,
            f"{one.angle_deg} deg",
            f"{one.polygons:.1f}",
            f"{one.continuous:.0f}",
            f"{one.binaries:.0f}",
            str(one.programs),
            *("-" if time is None else f"{time:.0f} ms" for time in (one.least_ms, one.mean_ms, one.most_ms)),
            str(one.refuted + one.no_stance + one.limits),
        )
        for one in rows
    ]
    title = "The same transitions on turned ground, CPU (Zhou et al. 2025, Table IV: 0.16 to 19 s)"
    return plain_table(title, head, cells)


def _missed_lines(missed: Sequence[Miss]) -> list[str]:
    found = []
    for one in missed:
        found += [f"Missed: {one.what}: {one.why}", *(f"  {move}" for move in one.refuted)]
    return found

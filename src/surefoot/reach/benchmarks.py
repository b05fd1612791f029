"""Measures the room: synthesis, screening, look-ups, library, Table I, the certificate; beside paper and target."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from surefoot.reach.barriers import barrier_region, screen_arrays
from surefoot.reach.certified import certified_region
from surefoot.reach.controller import Controller
from surefoot.reach.ensembles import TABLE_READING, Law, TableCell, table_1
from surefoot.reach.library import action_follows, action_steps, composed_library, region_library
from surefoot.reach.parameters import Disturbance, GridSpec, Reading, Settings, Transition
from surefoot.reach.synthesis import synthesize
from surefoot.reach.warming import warm_up

GOLDEN = Transition(0.416, (0.4, 0.6))
SETTINGS = Settings(Disturbance(Reading.RATE))
FINE = Settings(Disturbance(Reading.RATE), grid=GridSpec(0.0005, 0.001))
PAPER_MEAN_PERCENT = 91.98
EXACT_AREA = {"shws": 0.0667, "fhws": 0.1464}
SCREENED = 100_000

Say = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class Measured:
    """A number with its target (None: no target; ``at_most`` tells its sense) and what the papers have."""

    what: str
    value: float
    unit: str
    target: float | None
    at_most: bool
    paper: str = ""


def measure(say: Say) -> Iterator[Measured]:
    """Measure everything; times are the median CPU time of one core."""
    warm_up()
    rocs = "3.6 s (paper), 8.0 s (ROCS)"
    for settings, name, targets in ((SETTINGS, "2 mm, 4 mm/s", (10, 20)), (FINE, "0.5 mm, 1 mm/s", (100, 300))):
        say(f"synthesising at {name}")
        for all_masks, what, target in ((False, "first winning omega", targets[0]), (True, "all masks", targets[1])):
            seconds = median_cpu_s(partial(synthesize, GOLDEN, settings, all_masks=all_masks))
            paper = rocs if settings is SETTINGS else ""
            yield Measured(f"one transition, {name}, {what}", 1e3 * seconds, "ms", target, True, paper)
    yield _screening(say)
    region = synthesize(GOLDEN, SETTINGS)
    look = Controller(region).omega
    seconds = median_cpu_s(lambda: [look(0.1, 0.6) for _ in range(10_000)])
    yield Measured("look-up of omega", 1e2 * seconds, "us", None, True)
    yield from _library(say)
    yield from _table(say)
    yield from _certificate(say)


def table(say: Say, runs: int = 1000, seed: int = 0) -> dict[str, object]:
    """Return Table I for both laws, with its reading and with pushes at random instants."""
    found: dict[str, object] = {"reading": TABLE_READING, "runs": runs, "seed": seed}
    for law in Law:
        say(f"walking Table I, law: {law.value}")
        cells = table_1(runs, seed, law)
        found[law.value] = cells
        found[f"{law.value}_mean_percent"] = mean_percent(cells)
    say("walking Table I with pushes at random instants")
    found["random_instant"] = table_1(runs, seed, random_time=True)
    found["paper_mean_percent"] = PAPER_MEAN_PERCENT
    return found


def mean_percent(cells: tuple[TableCell, ...]) -> float:
    """Return the mean success rate of the cells of a table [%]."""
    return statistics.fmean(cell.percent for cell in cells)


def median_cpu_s(work: Callable[[], object], repeats: int = 9) -> float:
    """Return the median CPU time of some repetitions [s]."""
    times = []
    for _ in range(repeats):
        begin = time.process_time()
        work()
        times.append(time.process_time() - begin)
    return statistics.median(times)


def _screening(say: Say) -> Measured:
    say(f"screening {SCREENED} transitions in closed form")
    rng = np.random.default_rng(0)
    lengths, feet = rng.uniform(0.2, 0.55, SCREENED), rng.uniform(-0.05, 0.05, SCREENED)
    windows = np.sort(rng.uniform(0.2, 0.7, (SCREENED, 2)), axis=1)
    screen_arrays(lengths[:2], windows[:2], feet[:2], SETTINGS)
    seconds = median_cpu_s(lambda: screen_arrays(lengths, windows, feet, SETTINGS), 3)
    return Measured("screening in closed form", SCREENED / seconds, "/s", 100_000, False)


def _library(say: Say) -> Iterator[Measured]:
    from surefoot.robots import biped
    from surefoot.walking import step_library, walking_parameters

    say("building the library of the action game's transitions")
    digit = biped("digit")
    steps = action_steps(step_library(walking_parameters(2.70351), digit))
    seconds = median_cpu_s(lambda: region_library(steps, SETTINGS), 1)
    yield Measured(f"library of {len(steps)} transitions, not cached", seconds, "s", 60, True)
    say("composing it at 1 mm, 2 mm/s")
    finer = Settings(Disturbance(Reading.RATE), grid=GridSpec(0.001, 0.002))
    seconds = median_cpu_s(partial(composed_library, steps, finer, follows=action_follows), 1)
    yield Measured("the same at 1 mm, 2 mm/s, targets cut until every sequence composes", seconds, "s", 60, True)


def _table(say: Say) -> Iterator[Measured]:
    paper = f"{PAPER_MEAN_PERCENT} %"
    for law in Law:
        say(f"walking Table I, law: {law.value}")
        mean = mean_percent(table_1(law=law))
        if law is Law.TABLE:
            off = abs(mean - PAPER_MEAN_PERCENT)
            yield Measured(f"Table I, mean of six cells, {mean:.1f} %: off the paper", off, "points", 2, True, paper)
        else:
            yield Measured("Table I, mean of six cells, barrier-aware law", mean, "%", 97, False, paper)


def _certificate(say: Say) -> Iterator[Measured]:
    say("certifying in closed form")
    begin = -SETTINGS.grid.behind_m
    certified = certified_region(GOLDEN, SETTINGS).area(begin)
    ours = barrier_region(GOLDEN, SETTINGS, at_apex=True).area(begin)
    for name in ("shws", "fhws"):
        share = 100 * certified[name] / EXACT_AREA[name]
        what = f"certified closed form, {name}: share of the exact {EXACT_AREA[name]} (here {ours[name]:.4f})"
        yield Measured(what, share, "%", 95, False)

"""What the skills room measures about itself: times of synthesis and repair, and pairs that the oracle would handle."""

from __future__ import annotations

import hashlib
import os
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from surefoot.compute import process_pool
from surefoot.skills.grid import terrain_set
from surefoot.skills.making import make_library
from surefoot.skills.manager import Knowledge, Outcome, Pair, PairAnswer, handle
from surefoot.skills.physics import start_primitives
from surefoot.skills.shortest import fewest_new
from surefoot.skills.skill_game import pair_game, solve_game
from surefoot.skills.terrain_checks import terrain_checks
from surefoot.skills.terrains import generated
from surefoot.skills.values import CheckResult, Direction, Physics, PhysicsCheck, Primitive, TerrainState

SCENES = ("unstructured-4", "unstructured-8", "rebar-7", "rebar-14")
SEEDS = (0, 1)
HARD = (0.0, 0.3, 0.6)
"""Shares of infeasible primitives that a repair is measured with."""


@dataclass(frozen=True, slots=True)
class Times:
    """Processor times of many pairs on one size of grid.

    Attributes:
        strategy_ms: of a strategy where no repair is needed.
        repair_ms: of everything symbolic where one is, until the pair is decided.
        resynthesis_ms: of another strategy after a move was disallowed.
        missed: pairs that the oracle calls repairable under the recorded physics, and that were not handled.
        pairs: how many were looked at.
        new: new primitives of all repaired pairs.
        fewest: the least that they could have been.
    """

    strategy_ms: tuple[float, ...]
    repair_ms: tuple[float, ...]
    resynthesis_ms: tuple[float, ...]
    missed: int
    pairs: int
    new: int
    fewest: int


def tabled(hard: float) -> PhysicsCheck:
    """Return physics by a table that is drawn from the names: a share of all primitives is infeasible.

    Left and right are mirror images, so they are infeasible together.
    """

    def one(primitive: Primitive) -> CheckResult:
        sideways = primitive.direction in (Direction.LEFT, Direction.RIGHT)
        name = f"{'sideways' if sideways else primitive.direction} {primitive.here}->{primitive.next}"
        drawn = int.from_bytes(hashlib.sha256(name.encode()).digest()[:4]) / 2**32
        verdict = Physics.INFEASIBLE if drawn < hard else Physics.FEASIBLE
        return CheckResult(primitive, verdict, "table", "" if verdict is Physics.FEASIBLE else "drawn so", 0.0)

    return lambda primitives: map(one, primitives)


def measure(grid: tuple[int, int], say: Callable[[str], None] = lambda _: None) -> Times:
    """Measure every pair of every scene, each on its own: nothing is at hand but the first skills."""
    strategy_ms: list[float] = []
    resynthesis_ms: list[float] = []
    repairs: list[tuple[float, PairAnswer, Knowledge]] = []
    solve_game(pair_game(TerrainState((("flat",),)), (0, 0), ()))  # compiles
    for scene in SCENES:
        for seed in SEEDS:
            say(f"{scene}, seed {seed}, {grid[0]} x {grid[1]}")
            states = terrain_set(generated(scene, seed, grid=grid))
            for hard in HARD:
                physics = tabled(hard)
                first = Knowledge().extended(physics(start_primitives(states.classes)))
                repairs += _repairs(states.pairs(), first, physics)
            for state, request in states.pairs():
                every = [one for cell in state.cells() for way in Direction if (one := state.primitive(cell, way))]
                strategy_ms.append(_ms(lambda: solve_game(pair_game(state, request, every))))  # noqa: B023
                edge = (state.centre, Direction.FORWARD.of(state.centre))
                resynthesis_ms.append(
                    _ms(lambda: solve_game(pair_game(state, request, every, disallowed=[edge])))  # noqa: B023
                )
    handled = (Outcome.REALIZABLE, Outcome.REPAIRED)
    missed = sum(_repairable(pair, known) and pair.outcome not in handled for _, pair, known in repairs)
    repaired = [pair for _, pair, _ in repairs if pair.outcome is Outcome.REPAIRED]
    return Times(
        tuple(strategy_ms),
        tuple(taken for taken, pair, _ in repairs if pair.outcome is not Outcome.REALIZABLE),
        tuple(resynthesis_ms),
        missed,
        len(repairs),
        sum(len(pair.new) for pair in repaired),
        sum(pair.fewest for pair in repaired),
    )


def _repairs(
    pairs: Sequence[Pair], known: Knowledge, physics: PhysicsCheck
) -> Iterator[tuple[float, PairAnswer, Knowledge]]:
    for state, request in pairs:
        begin_s = time.process_time()
        answer, after = handle(state, request, known, physics)
        yield 1e3 * (time.process_time() - begin_s), answer, after


def _repairable(pair: PairAnswer, known: Knowledge) -> bool:
    return fewest_new(pair.state, pair.request, known.skills, known.refused) is not None


def _ms(work: Callable[[], object]) -> float:
    begin_s = time.process_time()
    work()
    return 1e3 * (time.process_time() - begin_s)


def percentile(values: Sequence[float], percent: int) -> float:
    """Return a percentile; 50 is the median."""
    return statistics.quantiles(values, n=100)[percent - 1]


def whole_synthesis(scene: str, seed: int, say: Callable[[str], None]) -> dict[str, Any]:
    """Make a library with real physics on all cores, and return its numbers."""
    terrain = generated(scene, seed)
    workers = len(os.sched_getaffinity(0))
    with tempfile.TemporaryDirectory(prefix="surefoot-") as folder, process_pool(workers) as executor:
        checks = terrain_checks(terrain, executor)
        return make_library(terrain_set(terrain), Path(folder), checks, at_once=3 * workers, say=say)

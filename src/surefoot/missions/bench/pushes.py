"""An ensemble of pushed walks: what share of random pushes is recovered, by what, and at which size."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from surefoot.compute import Deadline, each_answer, process_pool
from surefoot.missions.biped.mission import RunAnswer, run_mission
from surefoot.missions.plans.planning import plan_mission
from surefoot.missions.pushes.source import RandomPushes
from surefoot.missions.scenario.shipped import scene_path

SCENE = "two_rooms"
SIZES_MPS = ((0.05, 0.0), (0.1, 0.0), (0.2, 0.0), (0.4, 0.0), (0.1, 0.025), (0.2, 0.05))
"""Largest jumps ahead and sideways."""
SEEDS = range(20)
STEPS = 60


@dataclass(frozen=True, slots=True)
class PushRow:
    """What became of the pushes of one size.

    Attributes:
        size_mps: the largest jump ahead.
        side_size_mps: the largest jump sideways.
        pushes: how many there were.
        in_region: recovered by the law of the controllable region.
        by_step: recovered by the placement of a foot.
        falls: not recovered, or no step was safe later on.
        steps: walking steps.
        walks: walks.
        whole: walks without a fall.
        refused: logs that the checker refuses for anything but a fall.
    """

    size_mps: float
    side_size_mps: float
    pushes: int
    in_region: int
    by_step: int
    falls: int
    steps: int
    walks: int
    whole: int
    refused: int

    def share(self, count: int) -> str:
        """Return a count as a share of the pushes."""
        return f"{100 * count / max(1, self.pushes):.1f} %"


@dataclass(frozen=True, slots=True)
class _Walk:
    """One walk of the ensemble: its pushes, and the plan that it follows."""

    size_mps: float
    side_size_mps: float
    seed: int
    steps: int
    plan: Path


def push_ensemble(
    sizes_mps: Iterable[tuple[float, float]] = SIZES_MPS,
    seeds: Iterable[int] = SEEDS,
    steps: int = STEPS,
    plan_dir: Path | None = None,
    progress: Callable[[str], None] = lambda _: None,
    workers: int | None = None,
) -> tuple[PushRow, ...]:
    """Walk the two-room scene for every seed and size of push, in parallel.

    Args:
        sizes_mps: largest jumps ahead and sideways.
        seeds: of the walks.
        steps: of a walk that nobody fells.
        plan_dir: a plan of the scene; it is planned when none is given.
        progress: is told what happens.
        workers: processes; None means one per core.
    """
    sizes, seeds = tuple(sizes_mps), tuple(seeds)
    with tempfile.TemporaryDirectory(prefix="surefoot-pushes-") as name:
        plan = plan_dir or Path(name) / "plan"
        if plan_dir is None:
            plan_mission(scene_path(SCENE), plan, progress)
        walks = [_Walk(*size, seed, steps, plan) for size in sizes for seed in seeds]
        found: list[RunAnswer | None] = [None] * len(walks)
        with process_pool(workers, preload=("surefoot.missions.bench.pushes",)) as executor:
            for done, (place, run) in enumerate(each_answer(executor, _walked, walks, Deadline()), 1):
                found[place] = run
                progress(f"{done} of {len(walks)} walks")
    runs = [run for run in found if run is not None]
    return tuple(_row(size, runs[i * len(seeds) : (i + 1) * len(seeds)]) for i, size in enumerate(sizes))


def _walked(walk: _Walk) -> RunAnswer:
    """Return what one walk did."""
    with tempfile.TemporaryDirectory(prefix="surefoot-pushes-") as name:
        return run_mission(
            scene_path(SCENE),
            walk.plan,
            steps=walk.steps,
            seed=walk.seed,
            obstacle="random",
            out=Path(name) / "run",
            pushes=RandomPushes(walk.seed, walk.size_mps, walk.side_size_mps),
        )


def _row(size_mps: tuple[float, float], runs: list[RunAnswer]) -> PushRow:
    return PushRow(
        *size_mps,
        pushes=sum(run.pushes for run in runs),
        in_region=sum(run.recovered_in_region for run in runs),
        by_step=sum(run.recovered_by_step for run in runs),
        falls=sum(run.falls for run in runs),
        steps=sum(run.steps for run in runs),
        walks=len(runs),
        whole=sum(run.falls == 0 for run in runs),
        refused=sum(not run.verified for run in runs),
    )

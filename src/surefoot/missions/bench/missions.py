"""Ensembles of missions: the paper's Table II beside ours, and obstacles that hunt in pairs."""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path

from surefoot.missions.bench.figures import Figure, Say
from surefoot.missions.biped.run_log import Step, read_run
from surefoot.missions.scenario.shipped import scene_path

SEEDS = range(100)
TABLE_II = ((200, 9, 4), (260, 17, 12), (500, 29, 22))
"""Steps, turns and waypoint corrections of three missions: Shamsah et al., T-RO 2023, Table II."""
PAPER_LATERAL_SHARE = 12 / 260
CAMPAIGN = (("two_rooms_two_obstacles", "adversarial"),)


@dataclass(frozen=True, slots=True)
class Walked:
    """What is kept of a run.

    Attributes:
        turns: quarter turns completed, by step.
        corrections: waypoint corrections, by step.
        goals_reached: how often each goal was reached.
        collisions: turns with a shared cell or a swap.
        unsafe_steps: steps without a safe candidate.
        belief_violations: turns at which a hidden obstacle was outside its belief.
        verified: whether the log was accepted.
    """

    turns: tuple[int, ...]
    corrections: tuple[int, ...]
    goals_reached: tuple[int, ...]
    collisions: int
    unsafe_steps: int
    belief_violations: int
    verified: bool


def mission_figures(folder: Path, say: Say) -> Iterator[Figure]:
    """Walk missions of 500 steps and compare every beginning of 200, 260 and 500 steps with Table II."""
    runs = tuple(ensemble(folder, "two_rooms", "random", 500, say))
    for steps, turns, corrections in TABLE_II:
        yield from _table_row(runs, steps, turns, corrections)
    total = sum(run.corrections[-1] for run in runs)
    share = total / sum(len(run.corrections) for run in runs)
    paper = f"{100 * PAPER_LATERAL_SHARE:.1f} % (12 of 260)"
    yield Figure("steps handled by a lateral transition", 100 * share, "%", None, "at most", paper)
    yield from safety_figures("two_rooms, random", runs)
    for scene, policy in CAMPAIGN:
        yield from safety_figures(f"{scene}, {policy}", tuple(ensemble(folder, scene, policy, 500, say)))


def ensemble(folder: Path, scene: str, policy: str, steps: int, say: Say, seeds: range = SEEDS) -> Iterator[Walked]:
    """Plan a scene once and walk it with many seeds."""
    from surefoot.missions.biped.mission import run_mission
    from surefoot.missions.plans.planning import plan_mission

    plan = folder / f"plan-{scene}"
    if not plan.exists():
        plan_mission(scene_path(scene), plan, say)
    for seed in seeds:
        say(f"{scene}: walking {steps} steps, {policy}, seed {seed}")
        run = run_mission(scene_path(scene), plan, steps=steps, seed=seed, obstacle=policy, out=folder / "run")
        turns, corrections = _by_step(folder / "run" / "run.jsonl")
        yield Walked(
            turns,
            corrections,
            run.goals_reached,
            run.collisions,
            run.unsafe_steps,
            run.belief_violations,
            run.verified,
        )


def safety_figures(what: str, runs: tuple[Walked, ...]) -> Iterator[Figure]:
    """Return what must never happen, and that goals are reached."""
    name = f"{len(runs)} x {len(runs[0].turns)} steps, {what}:"
    yield Figure(f"{name} collisions", sum(run.collisions for run in runs), "", 0, "at most", "")
    yield Figure(f"{name} unsafe steps", sum(run.unsafe_steps for run in runs), "", 0, "at most", "")
    yield Figure(f"{name} belief violations", sum(run.belief_violations for run in runs), "", 0, "at most", "")
    fewest = min(count for run in runs for count in run.goals_reached)
    yield Figure(f"{name} least visits of a goal", fewest, "", 1, "at least", "")
    yield Figure(f"{name} logs verified", sum(run.verified for run in runs), "", len(runs), "at least", "")


def _table_row(runs: tuple[Walked, ...], steps: int, turns: int, corrections: int) -> Iterator[Figure]:
    """Return the mean turns and corrections of the first so many steps, and how much they vary."""
    for what, paper, counts in (
        ("turns", turns, [run.turns[steps - 1] for run in runs]),
        ("waypoint corrections", corrections, [run.corrections[steps - 1] for run in runs]),
    ):
        spread = f"{what} in {steps} steps, mean of {len(runs)} ({min(counts)} to {max(counts)})"
        yield Figure(spread, statistics.fmean(counts), "", None, "at most", str(paper))


def _by_step(log: Path) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return how many quarter turns and corrections there were until each step, from a log."""
    steps = read_run(log).steps
    turns = accumulate(int(_ends_turn(step)) for step in steps)
    corrections = accumulate(int(step.outcome.lateral != 0) for step in steps)
    return tuple(turns), tuple(corrections)


def _ends_turn(step: Step) -> bool:
    """Return whether a step turns into a direction of the grid; headings are counted clockwise, changes to the left."""
    if not step.heading_change_rad:
        return False
    turn_steps = round(math.pi / 2 / abs(step.heading_change_rad))
    return (step.fine.heading - round(math.copysign(1, step.heading_change_rad))) % turn_steps == 0

"""Benchmarks: what `surefoot bench` measures, beside the paper's numbers and our targets."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from surefoot.errors import InputError
from surefoot.missions.bench.figures import Figure, Say
from surefoot.missions.scenario.shipped import scene_path

SCENE = "two_rooms"
REPEATS = 5
STEPS = 500
SEEDS = range(10)
POLICIES = ("random", "adversarial")


def benchmarks(which: str, say: Say = lambda _: None) -> tuple[Figure, ...]:
    """Measure one part or all; ``missions``, which takes a quarter of an hour, only when it is asked for.

    Args:
        which: ``all`` or one of ``walking``, ``navigation``, ``action``, ``mission``, ``missions``.
        say: is told what is measured.
    """
    parts = {
        "walking": _walking,
        "navigation": _navigation,
        "action": _action,
        "mission": _mission,
        "missions": _missions,
    }
    if which != "all" and which not in parts:
        raise InputError(f"no benchmark {which!r}; there are all, {', '.join(parts)}")
    with tempfile.TemporaryDirectory(prefix="surefoot-bench-") as name:
        chosen = [part for title, part in parts.items() if which == title or (which == "all" and title != "missions")]
        return tuple(figure for part in chosen for figure in part(Path(name), say))


def _walking(folder: Path, say: Say) -> Iterator[Figure]:
    say(f"walking {STEPS} steps")
    walked = _run(folder, _plan(folder, say), seed=0, policy="random")
    paper = "0.5 ms"
    yield Figure("a walking step, decisions included, mean", walked.plan_ms_mean, "ms", 0.1, "at most", paper)
    yield Figure("a walking step, 95 % below", walked.plan_ms_p95, "ms", None, "at most", "")


def _navigation(folder: Path, say: Say) -> Iterator[Figure]:
    from surefoot.compute import Deadline
    from surefoot.games import warm_up
    from surefoot.missions.scenario.scene import read_biped_scene
    from surefoot.navigation import build_navigation_game, solve_navigation

    scene = read_biped_scene(scene_path(SCENE))
    warm_up()
    say("building and solving the navigation game")
    seconds = _median(lambda: solve_navigation(build_navigation_game(scene.problem, Deadline()), Deadline()))
    paper = "slugs 67-190 s CPU without the collision guarantee, none in 543 s with it"
    yield Figure("two-room game: build, solve, strategy", seconds, "s", 0.3, "at most", paper)
    say("planning in a process of its own")
    elapsed_s, peak_mb = whole_process(["plan", str(scene_path(SCENE)), "-o", str(folder / "process"), "--json"])
    yield Figure("surefoot plan, whole process", elapsed_s, "s", 3.0, "at most", "")
    yield Figure("surefoot plan, peak memory", peak_mb, "MB", 300.0, "at most", "")


def _action(_folder: Path, say: Say) -> Iterator[Figure]:
    from surefoot.games import warm_up
    from surefoot.missions.scenario.scene import read_biped_scene
    from surefoot.navigation import Order, action_rules, build_action_game, order_context, solve_action

    scene = read_biped_scene(scene_path(SCENE))
    warm_up()
    say("building and solving the action game")
    half = scene.walking.fine_cells / 2
    first = order_context(scene.coarse, scene.problem.start, Order(scene.problem.heading, waits=False))

    def solve() -> None:
        rules = action_rules(scene.coarse, scene.library)
        solve_action(build_action_game(rules, scene.problem.heading, first), half, half)

    yield Figure("action game: build, solve, strategy", _median(solve), "s", 0.5, "at most", "slugs none in 251 s CPU")


def _mission(folder: Path, say: Say) -> Iterator[Figure]:
    plan = _plan(folder, say)
    for policy in POLICIES:
        runs = []
        for seed in SEEDS:
            say(f"walking {STEPS} steps, {policy} obstacle, seed {seed}")
            runs.append(_run(folder, plan, seed=seed, policy=policy))
        what = f"{len(SEEDS)} x {STEPS} steps, {policy}:"
        yield Figure(f"{what} collisions", sum(run.collisions for run in runs), "", 0, "at most", "")
        yield Figure(f"{what} unsafe steps", sum(run.unsafe_steps for run in runs), "", 0, "at most", "")
        fewest = min(count for run in runs for count in run.goals_reached)
        yield Figure(f"{what} least visits of a goal", fewest, "", 2, "at least", "")
        yield Figure(f"{what} logs verified", sum(run.verified for run in runs), "", len(SEEDS), "at least", "")
        yield Figure(f"{what} turns", sum(run.turns for run in runs), "", None, "at least", "29 in 500 steps")
        corrections = sum(run.waypoint_corrections for run in runs)
        yield Figure(f"{what} waypoint corrections", corrections, "", None, "at most", "22 in 500 steps")


def _missions(folder: Path, say: Say) -> Iterator[Figure]:
    from surefoot.missions.bench.missions import mission_figures

    return mission_figures(folder, say)


def _plan(folder: Path, say: Say) -> Path:
    """Plan the scene once and return the plan's folder."""
    from surefoot.missions.plans.planning import plan_mission

    out = folder / "plan"
    if not out.exists():
        plan_mission(scene_path(SCENE), out, say)
    return out


def _run(folder: Path, plan: Path, *, seed: int, policy: str) -> Any:
    from surefoot.missions.biped.mission import run_mission

    return run_mission(
        scene_path(SCENE), plan, steps=STEPS, seed=seed, obstacle=policy, script=None, out=folder / "run"
    )


def _median(work: Callable[[], object]) -> float:
    """Return the median time of some repetitions [s]."""
    times = []
    for _ in range(REPEATS):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return statistics.median(times)


def whole_process(arguments: list[str]) -> tuple[float, float]:
    """Run the command line in a new process and return its time [s] and its largest resident size [MB]."""
    command = [sys.executable, "-c", "import sys; from surefoot.cli import main; sys.exit(main())", *arguments]
    begin = time.perf_counter()
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # noqa: S603 - our own command
    _, status, used = os.wait4(child.pid, 0)
    elapsed_s = time.perf_counter() - begin
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode != 0:
        raise InputError(f"surefoot {' '.join(arguments)} ended with exit code {child.returncode}; run it to see why")
    return elapsed_s, used.ru_maxrss * 1024 / 1e6

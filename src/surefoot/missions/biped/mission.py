"""Online: a biped walks its plan against moving obstacles (design: observation, order, action, step, and back)."""

from __future__ import annotations

import platform
import statistics
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numba
import numpy as np

from surefoot import __version__
from surefoot.compute import sha256_of
from surefoot.errors import InputError
from surefoot.frames import Foot
from surefoot.missions.biped.navigator import Navigator
from surefoot.missions.biped.replanning import replanned
from surefoot.missions.biped.walk import BipedWalk
from surefoot.missions.obstacles.bodies import bodies_of
from surefoot.missions.obstacles.policies import Adversary, Crowd, random_policies
from surefoot.missions.obstacles.scripts import read_script
from surefoot.missions.plans.reader import BipedPlan, read_plan
from surefoot.missions.pushes.source import Pusher, PushSource
from surefoot.missions.references import reference
from surefoot.missions.run_writer import RunWriter
from surefoot.missions.scenario.scene import BipedScene, read_biped_scene
from surefoot.navigation import Action, apply_action, deviations, standing_start
from surefoot.verify import Report, verify_path
from surefoot.walking import (
    StepCommand,
    StepKind,
    WalkingStep,
    plan_step,
    standing_state,
)

POLICIES = ("random", "adversarial", "scripted")


@dataclass(frozen=True, slots=True)
class RunAnswer:
    """What a run did.

    Attributes:
        steps: walking steps.
        goals_reached: how often each goal was reached.
        decisions: orders of the navigation strategy.
        collisions: decisions with a shared cell or a swap, as the checker counts them.
        unsafe_steps: steps for which no candidate satisfied the theorems.
        turns: quarter turns of the robot that were completed.
        waypoint_corrections: steps that shifted their waypoint sideways.
        belief_violations: turns at which an obstacle that the robot did not see was outside its belief.
        assumption_violations: assumptions of the obstacles that the robot saw broken.
        replans: how often the mission was planned again.
        replan_ms_max: the longest time that planning again took [ms].
        reactions: how many legs between goals were walked straight (``direct``), around to see (``loop``), or with
            stops to wait (``wait``).
        pushes: jumps of the CoM's velocity.
        recovered_in_region: pushes that the law of the controllable region recovered within the step.
        recovered_by_step: pushes that the placement of a foot recovered.
        falls: pushes that nothing recovered, or soon after which no step was safe.
        sign_alternation_share: share of the steps that satisfy Prop. V.1 (ii).
        plan_ms_mean: time to decide one step [ms], action and keyframe decision included.
        plan_ms_p95: its 95th percentile.
        verified: whether the independent checker accepted the log.
        findings: what it refused.
        failures: why the mission was not reached, a sentence each; empty when it was.
        notes: what the user should know.
        out: the run folder.
    """

    steps: int
    decisions: int
    goals_reached: tuple[int, ...]
    collisions: int
    unsafe_steps: int
    turns: int
    waypoint_corrections: int
    belief_violations: int
    assumption_violations: int
    replans: int
    replan_ms_max: float
    reactions: dict[str, int]
    pushes: int
    recovered_in_region: int
    recovered_by_step: int
    falls: int
    sign_alternation_share: float
    plan_ms_mean: float
    plan_ms_p95: float
    verified: bool
    findings: tuple[str, ...]
    failures: tuple[str, ...]
    notes: tuple[str, ...]
    out: Path

    @property
    def succeeded(self) -> bool:
        """Return whether every goal was reached safely and the log was verified."""
        return not self.failures


def run_mission(
    scenario_path: Path | str,
    plan_dir: Path | str,
    *,
    steps: int,
    seed: int,
    obstacle: str,
    out: Path | str,
    script: Path | str | None = None,
    pushes: PushSource | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> RunAnswer:
    """Walk a plan for a number of steps and have the log verified.

    Args:
        scenario_path: the scenario that the plan was made for.
        plan_dir: the plan folder.
        steps: walking steps.
        seed: of the obstacles' choices.
        obstacle: how obstacles move: "random", "adversarial" or "scripted".
        script: the script of scripted obstacles.
        out: the run folder.
        pushes: on the robot; None for none.
        progress: is told what happens.

    Raises:
        InputError: if an input cannot be used, for instance a plan made for another scenario.
    """
    scenario_path, plan_dir, out = Path(scenario_path), Path(plan_dir), Path(out)
    scene = read_biped_scene(scenario_path)
    plan = read_plan(plan_dir, scene)
    crowd = _crowd(obstacle, scene, seed, None if script is None else Path(script))
    progress("preparing the keyframe decision maker (the first run ever compiles it)")
    _warm_up(scene, plan)
    if crowd.lawless:
        problem = scene.problem
        replanned(problem, 0, problem.start, problem.heading, 0, problem.start, plan.navigation.states[0].visible)
    with RunWriter(out) as writer:
        writer.write(
            "header",
            kind="biped-run",
            format=1,
            surefoot=__version__,
            versions={"python": platform.python_version(), "numpy": np.__version__, "numba": numba.__version__},
            scenario=reference(scenario_path, out),
            map=reference(scene.occupancy.path, out),
            plan={"path": reference(plan_dir / "plan.json", out)["path"], "sha256": sha256_of(plan_dir / "plan.json")},
            seed=seed,
            policy=obstacle,
            steps=steps,
            kinds=[kind.obstacles for kind in scene.problem.obstacle_kinds],
            breaks_assumptions=crowd.lawless,
            pushes=None if pushes is None else pushes.described(out),
        )
        navigator = Navigator(scene, plan.navigation, crowd, writer, progress)
        pusher = Pusher(pushes)
        walk = BipedWalk(scene, plan, navigator, writer, steps, progress, pusher)
        walk.run()
    progress("verifying the log")
    report = verify_path(out)
    times = walk.decision_ms or [0.0]
    return RunAnswer(
        steps=walk.steps,
        decisions=navigator.turn + 1,
        goals_reached=tuple(navigator.goals_reached),
        collisions=_count(report, "collisions"),
        unsafe_steps=walk.unsafe_steps,
        turns=walk.turns_completed,
        waypoint_corrections=walk.corrections,
        belief_violations=navigator.counts.belief_violations,
        assumption_violations=navigator.counts.assumption_violations,
        replans=navigator.counts.replans,
        replan_ms_max=navigator.counts.replan_ms_max,
        reactions=navigator.counts.reactions,
        pushes=pusher.pushes,
        recovered_in_region=pusher.recovered["region"],
        recovered_by_step=pusher.recovered["step"],
        falls=pusher.falls,
        sign_alternation_share=walk.alternating / max(1, walk.steps),
        plan_ms_mean=statistics.fmean(times),
        plan_ms_p95=float(np.percentile(times, 95)),
        verified=report.accepted,
        findings=tuple(map(str, report.findings)),
        failures=failures_of(walk, report),
        notes=(*walk.notes, *_push_notes(pushes, walk.steps + bool(pusher.falls))),
        out=out,
    )


def failures_of(walk: BipedWalk, report: Report) -> tuple[str, ...]:
    """Return why a mission was not reached: what the robot did, which goals were left, what is wrong with the log."""
    collisions = _count(report, "collisions")
    visits = walk.navigator.goals_reached
    missed = [str(goal) for goal, times in enumerate(visits) if not times]
    return (
        *((walk.stopped,) if walk.stopped else ()),
        *((f"robot and obstacle met in {collisions} decisions",) if collisions else ()),
        *((f"not visited within {walk.steps} steps: goal {' and goal '.join(missed)}",) if missed else ()),
        *(() if report.accepted else ("the log was refused by the independent checker, a bug in Surefoot",)),
    )


def _push_notes(pushes: PushSource | None, steps: int) -> tuple[str, ...]:
    """Return that pushes of a script did not come, if so."""
    late = () if pushes is None else pushes.after(steps)
    if not late:
        return ()
    named = ", ".join(map(str, late[:5])) + (", ..." if len(late) > 5 else "")
    return (f"{len(late)} of the pushes did not come: the walk ended before step {named}",)


def _warm_up(scene: BipedScene, plan: BipedPlan) -> None:
    """Plan two steps on the spot, so that compilation and tables do not count as time to decide a step."""
    walking, robot = scene.walking, scene.robot
    length_m = walking.stop_cells * walking.fine_cell_m
    standing = standing_state((0.0, 0.0, 0.0), 0.0, Foot.LEFT, walking, robot)
    start = plan_step(standing, StepCommand(StepKind.START, length_m), walking, robot)
    rules = plan.rules
    first = standing_start(rules, *plan.fine_start, scene.problem.heading, 0)
    deviations(rules.tables, first, Action.START)
    apply_action(rules.tables, first, Action.STAY, 0, 0)
    if isinstance(start, WalkingStep):
        plan_step(start.next_state(), StepCommand(StepKind.WALK, 2 * length_m), walking, robot)


def _count(report: Report, name: str) -> int:
    count = report.counts.get(name, 0)
    return count if isinstance(count, int) else 0


def _crowd(name: str, scene: BipedScene, seed: int, script: Path | None) -> Crowd:
    """Return the obstacles and how they move."""
    if name not in POLICIES:
        raise InputError(f"no obstacle policy {name!r}; there are {', '.join(POLICIES)}", key="obstacle")
    if (name == "scripted") != (script is not None):
        raise InputError("scripted obstacles need a script, and only scripted ones have it", key="script")
    bodies = bodies_of(scene.problem)
    if script is not None:
        if not bodies:
            raise InputError("the scenario has no obstacle to follow a script", key="script")
        tours = read_script(script, scene.grid, bodies)
        return Crowd(bodies, tours.policies(), lawless=tours.breaks_assumptions)
    if name == "random":
        return Crowd(bodies, random_policies(seed, len(bodies)))
    return Crowd(bodies, tuple(Adversary(scene.coarse, body, seed + number) for number, body in enumerate(bodies)))

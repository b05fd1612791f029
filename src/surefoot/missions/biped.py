"""Online: a biped walks its plan against moving obstacles (design: observation, order, action, step, and back)."""

from __future__ import annotations

import platform
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numba
import numpy as np

from surefoot import __version__
from surefoot.compute import sha256_of
from surefoot.errors import AssumptionViolated, CertificateRejected, InputError
from surefoot.frames import Foot
from surefoot.missions.biped_scene import BipedScene, read_biped_scene
from surefoot.missions.fine_steps import FineSteps
from surefoot.missions.obstacle_policies import (
    Adversary,
    Policy,
    Situation,
    legal_cells,
    random_policy,
    scripted_policy,
)
from surefoot.missions.plan_reader import BipedPlan, read_plan
from surefoot.missions.planning import reference
from surefoot.missions.run_writer import RunWriter
from surefoot.navigation import (
    Action,
    ObstacleState,
    Order,
    Rules,
    apply_action,
    order_context,
    standing_start,
)
from surefoot.verify import Report, verify_path
from surefoot.walking import (
    StepCommand,
    StepKind,
    Unsafe,
    WalkingState,
    WalkingStep,
    plan_step,
    standing_state,
)

POLICIES = ("random", "adversarial", "scripted")
STANDING_TURN_S = 1.0
"""How long a turn lasts in which the robot stays standing."""


@dataclass(frozen=True, slots=True)
class RunAnswer:
    """What a run did.

    Attributes:
        steps: walking steps.
        goals_reached: how often each goal was reached.
        collisions: turns with a shared cell or a swap, as the checker counts them.
        unsafe_steps: steps for which no candidate satisfied the theorems.
        turns: quarter turns that were completed.
        waypoint_corrections: steps that shifted their waypoint sideways.
        sign_alternation_share: share of the steps that satisfy Prop. V.1 (ii).
        plan_ms_mean: time to decide one step [ms], action and keyframe decision included.
        plan_ms_p95: its 95th percentile.
        verified: whether the independent checker accepted the log.
        findings: what it refused.
        notes: what the user should know.
        out: the run folder.
    """

    steps: int
    goals_reached: tuple[int, ...]
    collisions: int
    unsafe_steps: int
    turns: int
    waypoint_corrections: int
    sign_alternation_share: float
    plan_ms_mean: float
    plan_ms_p95: float
    verified: bool
    findings: tuple[str, ...]
    notes: tuple[str, ...]
    out: Path

    @property
    def succeeded(self) -> bool:
        """Return whether every goal was reached safely and the log was verified."""
        return self.verified and min(self.goals_reached) > 0 and not self.collisions and not self.unsafe_steps


def run_mission(
    scenario_path: Path | str,
    plan_dir: Path | str,
    *,
    steps: int,
    seed: int,
    obstacle: str,
    out: Path | str,
    script: Path | str | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> RunAnswer:
    """Walk a plan for a number of steps and have the log verified.

    Args:
        scenario_path: the scenario that the plan was made for.
        plan_dir: the plan folder.
        steps: walking steps.
        seed: of the obstacle's choices.
        obstacle: "random", "adversarial" or "scripted".
        script: the script of a scripted obstacle.
        out: the run folder.
        progress: is told what happens.

    Raises:
        InputError: if an input cannot be used, for instance a plan made for another scenario.
    """
    scenario_path, plan_dir, out = Path(scenario_path), Path(plan_dir), Path(out)
    scene = read_biped_scene(scenario_path)
    plan = read_plan(plan_dir, scene)
    policy = _policy(obstacle, scene, seed, None if script is None else Path(script))
    progress("preparing the keyframe decision maker (the first run ever compiles it)")
    _warm_up(scene)
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
        )
        walk = _Walk(scene, plan, policy, writer, steps, progress)
        walk.run()
    progress("verifying the log")
    report = verify_path(out)
    times = walk.decision_ms or [0.0]
    return RunAnswer(
        steps=walk.steps,
        goals_reached=tuple(walk.goals_reached),
        collisions=_count(report, "collisions"),
        unsafe_steps=walk.unsafe_steps,
        turns=walk.turns_completed,
        waypoint_corrections=walk.corrections,
        sign_alternation_share=walk.alternating / max(1, walk.steps),
        plan_ms_mean=statistics.fmean(times),
        plan_ms_p95=float(np.percentile(times, 95)),
        verified=report.accepted,
        findings=tuple(f"{finding.rule}: {finding.message} ({finding.where})" for finding in report.findings),
        notes=tuple(walk.notes),
        out=out,
    )


def _warm_up(scene: BipedScene) -> None:
    """Plan two steps on the spot, so that compilation and tables do not count as time to decide a step."""
    walking, robot = scene.walking, scene.robot
    length_m = walking.stop_cells * walking.fine_cell_m
    standing = standing_state((0.0, 0.0, 0.0), 0.0, Foot.LEFT, walking, robot)
    start = plan_step(standing, StepCommand(StepKind.START, length_m), walking, robot)
    if isinstance(start, WalkingStep):
        plan_step(start.next_state(), StepCommand(StepKind.WALK, 2 * length_m), walking, robot)


def _count(report: Report, name: str) -> int:
    count = report.counts.get(name, 0)
    return count if isinstance(count, int) else 0


def _policy(name: str, scene: BipedScene, seed: int, script: Path | None) -> Policy:
    if name not in POLICIES:
        raise InputError(f"no obstacle policy {name!r}; there are {', '.join(POLICIES)}", key="obstacle")
    if (name == "scripted") != (script is not None):
        raise InputError("a scripted obstacle needs a script, and only a scripted one has it", key="script")
    if script is not None:
        return scripted_policy(script, scene.grid)
    if name == "random":
        return random_policy(seed)
    return Adversary(scene.coarse, scene.problem.domain, seed)


class _Walk:
    """One run: turns of the navigation game, each walked step by step."""

    def __init__(
        self,
        scene: BipedScene,
        plan: BipedPlan,
        policy: Policy,
        writer: RunWriter,
        steps: int,
        progress: Callable[[str], None],
    ) -> None:
        self.scene, self.plan, self.policy, self.writer = scene, plan, policy, writer
        self.limit, self.progress = steps, progress
        self.fine_steps = FineSteps(scene, plan.rules)
        self.game_rules = Rules(scene.problem, scene.problem.domain)
        self.cell, self.heading = scene.problem.start, scene.problem.heading
        self.truth = list(scene.problem.obstacle_starts)
        self.knowledge = self.game_rules.start()
        self.goal = 0
        self.goals_reached = [0] * len(scene.problem.goals)
        self.fine = standing_start(plan.rules, *plan.fine_start, self.heading, 0)
        place = self.fine_steps.waypoint_m(self.cell, self.fine)
        yaw = self.fine_steps.yaw_rad(self.fine)
        self.walking: WalkingState = standing_state(place, yaw, Foot.LEFT, scene.walking, scene.robot)
        self.time_s, self.turn, self.steps = 0.0, -1, 0
        self.unsafe_steps = self.turns_completed = self.corrections = self.alternating = 0
        self.decision_ms: list[float] = []
        self.notes: list[str] = []
        self.halted = False

    def run(self) -> None:
        """Walk until the steps are used up, or no safe step is left."""
        self._arrive()
        idle = 0
        while self.steps < self.limit and not self.halted:
            before = self.steps
            self.turn += 1
            order = self._decide()
            if not self._carry_out(order):
                break
            self._obstacles_move(order)
            idle = 0 if self.steps > before else idle + 1
            if idle > 1000:
                self.notes.append("the robot waited for 1000 turns on end; the obstacle does not make way")
                break
        self.writer.write(
            "end",
            steps=self.steps,
            turns_coarse=self.turn + 1,
            goals_reached=self.goals_reached,
            time_s=self.time_s,
        )

    def _arrive(self) -> None:
        """Book a goal that the robot has come to."""
        if self.cell == self.scene.problem.goals[self.goal]:
            self.goals_reached[self.goal] += 1
            self.progress(f"step {self.steps}: goal {self.goal} reached ({self.goals_reached[self.goal]})")
        self.goal = self.plan.navigation.advance(self.goal, self.cell)

    def _decide(self) -> Order:
        """Ask the navigation strategy for an order, and log the turn."""
        try:
            order = self.plan.navigation.decide(self.cell, self.heading, self.knowledge, self.goal)
        except KeyError as problem:
            raise CertificateRejected("the navigation strategy has no order for where the robot is") from problem
        grid, domain = self.scene.grid, self.game_rules.domain
        self.writer.write(
            "turn",
            turn=self.turn,
            time_s=self.time_s,
            cell=list(grid.cell(self.cell)),
            heading=self.heading.name.lower(),
            goal=self.goal,
            obstacles=[list(grid.cell(cell)) for cell in self.truth],
            visible=[list(grid.cell(cell)) for cell in self.knowledge.visible],
            hidden=[list(grid.cell(cell)) for cell in domain.members(self.knowledge.hidden)],
            order=str(order),
        )
        return order

    def _carry_out(self, order: Order) -> bool:
        """Walk until the order is achieved; return False when the steps ran out or none was safe."""
        coarse = self.scene.coarse
        target = self.cell if order.waits else int(coarse.target[self.cell, order.direction])
        context = order_context(coarse, self.cell, order)
        self.fine = self.fine._replace(context=self.plan.rules.contexts.index(context))
        achieved = False
        while not achieved:
            if self.steps >= self.limit:
                return False
            begin = time.perf_counter()
            action = self.plan.action.decide(self.fine)
            if action == Action.STAY:
                self.time_s += STANDING_TURN_S
                return True
            step = plan_step(
                self.walking, self.fine_steps.command(self.fine, action), self.scene.walking, self.scene.robot
            )
            self.decision_ms.append(1e3 * (time.perf_counter() - begin))
            if isinstance(step, Unsafe):
                self._halt(step)
                return False
            achieved = self._book(step, action, target)
        if not order.waits:
            self.cell, self.heading = target, order.direction
            self._arrive()
        return True

    def _halt(self, unsafe: Unsafe) -> None:
        """Log that no step is safe; the robot stops."""
        self.unsafe_steps += 1
        self.halted = True
        self.notes.append(f"step {self.steps}: {unsafe.reason}")
        self.writer.write("unsafe", step=self.steps, time_s=self.time_s, reason=unsafe.reason)

    def _book(self, step: WalkingStep, action: int, target: int) -> bool:
        """Log a step and give its outcome to the action game as the environment's move."""
        before = self.fine
        moved = apply_action(self.plan.rules.tables, before, action, step.sagittal_cells, step.lateral_cells)
        self.writer.write(
            "step",
            step=self.steps,
            turn=self.turn,
            time_s=self.time_s + (step.rise_s or 0.0),
            fine=before._asdict(),
            action=action,
            outcome={"sagittal": step.sagittal_cells, "lateral": step.lateral_cells},
            **step.record(),
        )
        crossed = moved.achieved and action != Action.STOP
        if not self.fine_steps.contains(target if crossed else self.cell, moved.state, step.next_waypoint_m):
            raise CertificateRejected(f"step {self.steps} left the fine cell that the action game booked")
        self.fine, self.walking = moved.state, step.next_state()
        self.steps += 1
        self.time_s += step.duration_s
        self.turns_completed += (
            bool(step.heading_change_rad) and moved.state.heading % self.plan.rules.tables.turn_steps == 0
        )
        self.corrections += step.lateral_cells != 0
        self.alternating += step.sign_alternates
        return moved.achieved

    def _obstacles_move(self, order: Order) -> None:
        """Let every obstacle move within its rules, and observe."""
        cell_before = self._cell_before(order)
        for number, truth in enumerate(self.truth):
            legal = legal_cells(self.game_rules.domain, truth, cell_before, order)
            situation = Situation(self.turn, cell_before, self.heading, order, truth, legal)
            self.truth[number] = self.policy(situation)
        outcomes = self.game_rules.outcomes(cell_before, self.cell, order, self.knowledge)
        self.knowledge = self._observed(outcomes, cell_before)

    def _cell_before(self, order: Order) -> int:
        """Return the robot's cell at the beginning of a turn that has been carried out."""
        if order.waits:
            return self.cell
        return self.scene.grid.index(self.scene.grid.cell(self.cell).neighbour(order.direction.opposite))

    def _observed(self, outcomes: tuple[ObstacleState, ...], cell_before: int) -> ObstacleState:
        """Return the outcome that matches what the robot sees of the true obstacles."""
        domain = self.game_rules.domain
        view = self.cell if self.scene.problem.view == "post" else cell_before
        in_view = domain.seen_from[view]
        visible = tuple(sorted(cell for cell in self.truth if in_view >> domain.bit[cell] & 1))
        hidden = domain.mask(self.truth) & ~in_view
        for state in outcomes:
            if state.visible == visible and not hidden & ~state.hidden:
                return state
        raise AssumptionViolated("the obstacles moved in a way that the belief does not contain")

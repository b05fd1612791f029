"""One walk of a biped: turns of the navigation game, each carried out step by step and logged."""

from __future__ import annotations

import time
from collections.abc import Callable

from surefoot.errors import AssumptionViolated, CertificateRejected
from surefoot.frames import Foot
from surefoot.missions.biped_scene import BipedScene
from surefoot.missions.fine_steps import FineSteps
from surefoot.missions.obstacle_policies import Policy, Situation, legal_cells
from surefoot.missions.plan_reader import BipedPlan
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
from surefoot.walking import Unsafe, WalkingState, WalkingStep, plan_step, standing_state

STANDING_TURN_S = 1.0
"""How long a turn lasts in which the robot stays standing."""
MOST_IDLE_TURNS = 1000
"""After so many turns of waiting on end the walk is given up; obstacles that keep assumption (c) make way before."""


class BipedWalk:
    """A walk in progress.

    Args:
        scene: the scenario on its map.
        plan: its strategies.
        policy: how the obstacles move.
        writer: of the log.
        steps: how many walking steps.
        progress: is told what happens.
    """

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
            if idle > MOST_IDLE_TURNS:
                self.notes.append(f"the robot waited for {MOST_IDLE_TURNS} turns; the obstacle does not make way")
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
            situation = Situation(self.turn, cell_before, order, truth, legal)
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

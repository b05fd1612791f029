"""One walk of a biped: every order of the navigation game carried out step by step, and logged."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from surefoot.errors import CertificateRejected
from surefoot.frames import Foot
from surefoot.missions.biped.navigator import Navigator
from surefoot.missions.plans.reader import BipedPlan
from surefoot.missions.pushes.outlook import Displaced, Outlook
from surefoot.missions.pushes.recovery import Fallen, PushRecovery
from surefoot.missions.pushes.source import Pusher
from surefoot.missions.pushes.step import transition
from surefoot.missions.run_writer import RunWriter
from surefoot.missions.scenario.fine_steps import FineSteps
from surefoot.missions.scenario.scene import BipedScene
from surefoot.navigation import (
    Action,
    Mode,
    Order,
    order_context,
    standing_start,
)
from surefoot.walking import Unsafe, WalkingState, plan_step, standing_state

STANDING_TURN_S = 1.0
"""How long a turn lasts in which the robot stays standing."""
MOST_IDLE_TURNS = 1000
"""After so many turns of waiting on end the walk is given up; obstacles that keep assumption (c) make way before."""


class BipedWalk:
    """A walk in progress.

    Args:
        scene: the scenario on its map.
        plan: its strategies.
        navigator: gives the orders, and watches the obstacles.
        writer: of the log.
        steps: how many walking steps.
        progress: is told what happens.
        pusher: pushes the robot, and counts what becomes of it.
    """

    def __init__(
        self,
        scene: BipedScene,
        plan: BipedPlan,
        navigator: Navigator,
        writer: RunWriter,
        steps: int,
        progress: Callable[[str], None],
        pusher: Pusher | None = None,
    ) -> None:
        self.scene, self.plan, self.navigator, self.writer = scene, plan, navigator, writer
        self.limit, self.progress = steps, progress
        self.fine_steps = FineSteps(scene, plan.rules)
        self.pusher = pusher or Pusher()
        self.outlook = Outlook(scene, self.fine_steps, plan.action)
        self.fine = standing_start(plan.rules, *plan.fine_start, scene.problem.heading, 0)
        place = self.fine_steps.waypoint_m(scene.problem.start, self.fine)
        yaw = self.fine_steps.yaw_rad(self.fine)
        self.walking: WalkingState = standing_state(place, yaw, Foot.LEFT, scene.walking, scene.robot)
        self.time_s, self.steps = 0.0, 0
        self.unsafe_steps = self.turns_completed = self.corrections = self.alternating = 0
        self.decision_ms: list[float] = []
        self.notes: list[str] = []
        self.stopped = ""

    def run(self) -> None:
        """Walk until the steps are used up, or no safe step is left."""
        navigator = self.navigator
        idle = 0
        while self.steps < self.limit and not self.stopped:
            before = self.steps
            order = navigator.decide(self.time_s, standing=self.fine.mode == Mode.STANDING)
            if not self._carry_out(order):
                break
            navigator.finish_turn(order)
            idle = 0 if self.steps > before else idle + 1
            if idle > MOST_IDLE_TURNS:
                self.notes.append(f"the robot waited for {MOST_IDLE_TURNS} turns; the obstacles do not make way")
                break
        self.writer.write(
            "end",
            steps=self.steps,
            turns_coarse=navigator.turn + 1,
            goals_reached=navigator.goals_reached,
            time_s=self.time_s,
        )

    def _carry_out(self, order: Order) -> bool:
        """Walk until the order is achieved; return False when the steps ran out or none was safe."""
        coarse, cell = self.scene.coarse, self.navigator.cell
        target = cell if order.waits else int(coarse.target[cell, order.direction])
        context = order_context(coarse, cell, order)
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
            planned = self._planned(action)
            self.decision_ms.append(1e3 * (time.perf_counter() - begin))
            if isinstance(planned, Unsafe):
                self._halt(planned)
                return False
            push = self.pusher.at(self.steps)
            if push is not None:
                recovery = PushRecovery(self.outlook, planned, self.fine, (cell, target))
                found = self.pusher.counted(recovery.recover(push))
                if isinstance(found, Fallen):
                    self._fall(found)
                    return False
                achieved = self._book(found.walked, target, found.push)
            else:
                achieved = self._book(planned, target)
        if not order.waits:
            self.navigator.arrive(target, order.direction, self.steps)
        return True

    def _planned(self, action: int) -> Displaced | Unsafe:
        """Return the next step, and what it leads to; after a push its waypoint may be moved for what follows."""
        if self.pusher.pushes:
            return self.outlook.onward(self.walking, self.fine, action)
        command = self.fine_steps.command(self.fine, action)
        step = plan_step(self.walking, command, self.scene.walking, self.scene.robot)
        return step if isinstance(step, Unsafe) else self.outlook.booked(step, self.fine, action)

    def _fall(self, fallen: Fallen) -> None:
        """Log that nothing recovers a push."""
        text = f"{fallen.reason}; the push was {-fallen.margin_mps:.3f} m/s too large"
        self.stopped = f"the robot fell in step {self.steps}, {text}"
        lost = {"reason": fallen.reason, "margin_mps": fallen.margin_mps, "push": fallen.push}
        self.writer.write("fall", step=self.steps, time_s=self.time_s, **lost)

    def _halt(self, unsafe: Unsafe) -> None:
        """Log that no step is safe; the robot stops. Soon after a push that counts as a fall."""
        self.unsafe_steps += 1
        blame = self.pusher.blamed()
        after = "" if blame is None else f", after the push of step {blame}"
        self.stopped = f"the robot stopped before step {self.steps}: {unsafe.reason}{after}"
        self.writer.write("unsafe", step=self.steps, time_s=self.time_s, reason=unsafe.reason, after_push=blame)

    def _book(self, walked: Displaced, target: int, push: dict[str, Any] | None = None) -> bool:
        """Log a step and give its outcome to the action game as the environment's move."""
        before, step, moved, action = self.fine, walked.step, walked.moved, walked.action
        flag = transition(walked.outcome, walked.cells, step.yaw_rad - self.scene.grid.rotation_rad)
        self.writer.write(
            "step",
            step=self.steps,
            turn=self.navigator.turn,
            time_s=self.time_s + (step.rise_s or 0.0),
            fine=before._asdict(),
            action=action,
            outcome={"sagittal": walked.outcome[0], "lateral": walked.outcome[1]},
            transition=flag,
            **step.record(),
            **({} if walked.cells == (0, 0) else {"moved_cells": walked.cells}),
            **({} if push is None else {"push": push}),
        )
        crossed = moved.achieved and action != Action.STOP
        if not self.fine_steps.contains(target if crossed else self.navigator.cell, moved.state, step.next_waypoint_m):
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

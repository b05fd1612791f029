"""Recovery of a pushed step: the region's law, else the capture rule, and the fine cell in which the walk goes on.

A way out counts only when the walk goes on from it: the new fine state keeps the rules of the action game and is one
that the action strategy has an answer for, and the next steps that it commands satisfy the theorems. Of several the
first is taken whose apexes are as little at risk as those of undisturbed walking, else the one with the least risk.
Source: Shamsah et al., T-RO 2023, Section VII and Fig. 12; docs/reach.md, section 7.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from itertools import product
from typing import Any

from surefoot.missions.pushes.motion import (
    OMEGAS_RADPS,
    Motion,
    Planned,
    capture_motion,
    held_motion,
    meeting_motion,
    region_motion,
)
from surefoot.missions.pushes.outlook import FARTHEST_CELLS, Displaced, Outlook
from surefoot.missions.pushes.source import StepPush
from surefoot.missions.pushes.step import Way, Window, walked
from surefoot.missions.scenario.fine_steps import FineSteps
from surefoot.navigation import Action, FineState, Moved, displace_action
from surefoot.walking import WalkingState, WalkingStep
from surefoot.walking.library import STOP_SPEED_MPS

WINDOWS_MPS = ((0.2, 0.45), (0.45, 0.7))
"""Apex speeds that a law aims at: those of the paper's Table I."""
USUAL_RISK = 0.2
"""Risks of undisturbed walking stay below."""
LAW_RISK = 0.3
"""The law of the region is preferred to a displaced foot up to this risk."""
MARGIN_TRIALS = 8
FAR_WAYS = 30
"""Of so many ways out at most the outlook is judged with displaced next steps, which takes long."""
FASTEST_MPS = 1.0
_SPEED_STEP_MPS = 0.05
_NOT_OVER = "the CoM does not get over its foot"
Judge = Callable[[WalkingState, Moved], float | str]


class Recovery(StrEnum):
    """What a push was recovered by."""

    REGION = "region"
    STEP = "step"


@dataclass(frozen=True, slots=True)
class Recovered:
    """A pushed step as it is really walked.

    Attributes:
        walked: the step, and what it leads to in the action game.
        by: what recovered the push.
        push: fields of the step's record (docs/formats.md, section 3).
    """

    walked: Displaced
    by: Recovery
    push: dict[str, Any]


@dataclass(frozen=True, slots=True)
class Fallen:
    """A push that nothing recovered.

    Attributes:
        reason: what the last way out failed by.
        margin_mps: by how much the push was too large, negative.
        push: when it came, and its jump.
        by: what recovered it: nothing.
    """

    reason: str
    margin_mps: float
    push: dict[str, Any]
    by: None = None


@dataclass(frozen=True, slots=True)
class PushRecovery:
    """Finds a way out for one planned step.

    Attributes:
        outlook: judges how the walk goes on.
        plan: the step as planned.
        state: of the action game, before the step.
        cells: the coarse cell of the robot, and the one that its order leads to.
    """

    outlook: Outlook
    plan: Displaced
    state: FineState
    cells: tuple[int, int]

    @property
    def step(self) -> WalkingStep:
        """Return the planned step."""
        return self.plan.step

    @property
    def action(self) -> int:
        """Return the action that the step carries out."""
        return self.plan.action

    @property
    def fine_steps(self) -> FineSteps:
        """Return the commands and places of fine cells."""
        return self.outlook.fine_steps

    def recover(self, push: StepPush) -> Recovered | Fallen:
        """Return how the step goes on after a push.

        The margin of a fall is found by bisection: how much smaller the jump would have had to be.
        """
        found = self._way_out(push.instant, push.jump_mps)
        if isinstance(found, Recovered):
            return found
        low, high = 0.0, 1.0
        for _ in range(MARGIN_TRIALS):
            middle = 0.5 * (low + high)
            scaled = (middle * push.sagittal_mps, middle * push.lateral_mps)
            saved = isinstance(self._way_out(push.instant, scaled), Recovered)
            low, high = (middle, high) if saved else (low, middle)
        time_s = push.instant * (self.step.first_half_s + self.step.second_half_s)
        record = {"time_s": time_s, "jump_mps": push.jump_mps}
        return Fallen(found, -(1 - high) * math.hypot(*push.jump_mps), record)

    def _way_out(self, instant: float, jump_mps: tuple[float, float]) -> Recovered | str:
        """Return the way out of a push, or why the last one fails."""
        time_s = instant * (self.step.first_half_s + self.step.second_half_s)
        planned = Planned.of(self.step, time_s, jump_mps)
        found = self._best(planned, self.outlook.risk, math.inf)
        if isinstance(found, str) and found != _NOT_OVER:
            found = self._best(planned, self.outlook.far_risk, FAR_WAYS)
        return found

    def _best(self, planned: Planned, judged: Judge, most: float) -> Recovered | str:
        """Return the best of the first ways out as their outlook is judged, or why the last one fails."""
        reason, best, least = _NOT_OVER, None, math.inf
        for motion, window in self._motions(planned):
            if window is None and least <= LAW_RISK and best is not None and best.push["window_mps"] is not None:
                return best
            if isinstance(motion, float):
                continue
            for way in self._ways(planned, motion, window):
                step = self._step(way)
                if isinstance(step, str):
                    reason = step
                    continue
                risk, most = judged(step.next_state(), way.moved), most - 1
                if isinstance(risk, str):
                    reason = risk
                elif risk < least:
                    best, least = self._recovered(way, step), risk
                if best is not None and (least <= USUAL_RISK or most <= 0):
                    return best
                if most <= 0:
                    return reason
        return best or reason

    def _motions(self, planned: Planned) -> Iterator[tuple[Motion | float, Window | None]]:
        """Yield ways to the next apex, the best first, each with the window of speeds that a law aims at."""
        speed, omega = self.step.next_apex_speed_mps, self.step.omega_radps
        if self.action != Action.STOP:
            window = next((w for w in WINDOWS_MPS if speed <= w[1] + 1e-9), WINDOWS_MPS[-1])
            aims = (
                window[0] + _SPEED_STEP_MPS * k for k in range(round((window[1] - window[0]) / _SPEED_STEP_MPS) + 1)
            )
            for aim in (None, speed, *aims):
                motion = region_motion(planned, window, aim)
                if motion is None:
                    break
                yield motion, window
        if planned.switched:
            low, high = OMEGAS_RADPS
            yield held_motion(planned, omega, omega), None
            for first, then in product((low, omega, high), repeat=2):
                yield held_motion(planned, first, then), None
            return
        yield capture_motion(planned, speed, self.outlook.scene.walking.fine_cell_m), None
        yield from ((motion, None) for motion in self._placed_motions(planned))

    def _placed_motions(self, planned: Planned) -> Iterator[Motion | float]:
        """Yield motions of a foot in the air: other switches with the foot on a waypoint, then other capture speeds.

        A foot on its waypoint needs no more level floor than a planned one, which matters on stairs.
        """
        speed, cell = self.step.next_apex_speed_mps, self.outlook.scene.walking.fine_cell_m
        count = round((FASTEST_MPS - STOP_SPEED_MPS) / _SPEED_STEP_MPS)
        speeds = sorted((STOP_SPEED_MPS + _SPEED_STEP_MPS * k for k in range(count + 1)), key=lambda v: abs(v - speed))
        for cells in sorted(range(-FARTHEST_CELLS, FARTHEST_CELLS + 1), key=abs):
            for wished in (speed, *speeds):
                yield meeting_motion(planned, planned.next_foot.ahead_m + cell * cells, wished)
        for wished in speeds:
            yield capture_motion(planned, wished, cell)

    def _ways(self, planned: Planned, motion: Motion, window: Window | None) -> Iterator[Way]:
        """Yield what a motion may mean for the action game."""
        tables = self.fine_steps.rules.tables
        for put_off in (False, True) if self.action == Action.STOP else (False,):
            for shift in self._shifts(planned, motion):
                base = self.plan.cells[0] + shift[0], self.plan.cells[1] + shift[1]
                outcome, displaced = self.outlook.labelled(self.state, self.action, self.plan.outcome, base)
                moved = displace_action(tables, self.state, self.action, outcome, displaced, put_off=put_off)
                if moved is not None:
                    yield Way(planned, motion, window, shift, outcome, displaced, moved, put_off)

    def _shifts(self, planned: Planned, motion: Motion) -> list[tuple[int, int]]:
        """Return by how many rows and columns the waypoint may move for its foot, the least first.

        The foot stays within half a fine cell of the waypoint along the heading (within the cell's half diagonal in
        the middle of a turn), and within the safety distance sideways.
        """
        scene = self.outlook.scene
        cell, heading = scene.walking.fine_cell_m, self.step.yaw_rad - scene.grid.rotation_rad
        cos, sin = math.cos(heading), math.sin(heading)
        waypoint = planned.frame.into(self.step.next_waypoint_m)
        gap = motion.foot.ahead_m - waypoint[0], motion.foot.left_m - waypoint[1]
        reach, found = 0.5 * cell * (abs(cos) + abs(sin)) + 1e-9, []
        span = range(-FARTHEST_CELLS, FARTHEST_CELLS + 1)
        for rows, columns in product(span, span):
            ahead = gap[0] - cell * (cos * columns - sin * rows)
            left = gap[1] + cell * (cos * rows + sin * columns)
            if abs(ahead) <= reach and abs(left) <= scene.walking.safety_distance_m - 1e-9:
                found.append((abs(rows) + abs(columns), abs(left), (rows, columns)))
        return [shift for _, _, shift in sorted(found)]

    def _step(self, way: Way) -> WalkingStep | str:
        """Return the step of a way out, or what is wrong with where its foot and its waypoint are."""
        motion, moved = way.motion, way.moved
        ashore = -self.step.stance.side * (motion.foot.left_m - motion.end.left_m)
        if not way.planned.switched and ashore <= 1e-9:
            return "the next foot would not be on its own side of the centre of mass"
        changes = self.fine_steps.next_changes(moved.state, achieved=moved.achieved)
        step = walked(way, changes, self.outlook.scene)
        if isinstance(step, str):
            return step
        crossed = moved.achieved and self.action != Action.STOP
        if not self.fine_steps.contains(self.cells[int(crossed)], moved.state, step.next_waypoint_m):
            return "the waypoint leaves its fine cell"
        if not self.fine_steps.stands(step.next_foot_m, step.next_waypoint_m, step.yaw_rad):
            return "the foot would stand too near to a riser"
        return step

    def _recovered(self, way: Way, step: WalkingStep) -> Recovered:
        cell = self.outlook.scene.walking.fine_cell_m
        by = Recovery.REGION if way.in_region(cell) else Recovery.STEP
        return Recovered(Displaced(step, way.moved, self.action, way.outcome, way.displaced), by, way.record(cell))

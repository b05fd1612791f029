"""How well a walk goes on from a state that a push has left."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

from surefoot.frames import Direction
from surefoot.missions.biped_scene import BipedScene
from surefoot.missions.fine_steps import FineSteps
from surefoot.navigation import (
    STOP_ORDER,
    Action,
    ActionStrategy,
    FineState,
    Mode,
    Moved,
    apply_action,
    deviations,
    displace_action,
)
from surefoot.walking import Unsafe, WalkingState, WalkingStep, apex_risk, plan_step
from surefoot.walking.risk import turn_node

LOOK_AHEAD = 6
FARTHEST_CELLS = 3
"""How far a waypoint may be displaced after a push, in rows and in columns."""


@dataclass(frozen=True, slots=True)
class Displaced:
    """A step with what it leads to in the action game.

    Attributes:
        step: the step.
        moved: in the action game.
        outcome: sagittal and lateral deviation, as the action game labels them.
        cells: rows and columns by which the waypoint moves beyond that outcome.
    """

    step: WalkingStep
    moved: Moved
    outcome: tuple[int, int]
    cells: tuple[int, int] = (0, 0)


@dataclass(frozen=True, slots=True)
class Outlook:
    """Looks ahead along the action strategy.

    Attributes:
        scene: the scenario on its map.
        fine_steps: commands and places of fine cells.
        strategy: of the action game.
    """

    scene: BipedScene
    fine_steps: FineSteps
    strategy: ActionStrategy

    def risk(self, walking: WalkingState, moved: Moved) -> float | str:
        """Return the largest risk of the apexes to come, or why a step that may be commanded cannot be walked.

        Steps are planned until the order is achieved, LOOK_AHEAD of them at most, then the first step of every order
        that may follow.
        """
        state, achieved = moved.state, moved.achieved
        worst = self._risk(walking, state)
        for _ in range(LOOK_AHEAD):
            if achieved:
                break
            found = self._next_step(walking, state)
            if isinstance(found, str):
                return found
            if found is None:
                return worst
            walking, state, achieved = found.step.next_state(), found.moved.state, found.moved.achieved
            worst = max(worst, self._risk(walking, state))
        for context in self._following(state) if achieved else ():
            found = self._next_step(walking, state._replace(context=context))
            if isinstance(found, str):
                return found
            if found is not None:
                worst = max(worst, self._risk(found.step.next_state(), found.moved.state))
        return worst

    def _risk(self, walking: WalkingState, state: FineState) -> float:
        """Return the risk of a state; after a push with lateral speed only the next ones tell."""
        if walking.side_speed_mps:
            return 0.0
        node = int(state.mode)
        if state.mode >= Mode.LEFT_A:
            kind = "A" if state.mode in (Mode.LEFT_A, Mode.RIGHT_A) else "B"
            node = turn_node(kind, walking.turn_step, self.fine_steps.rules.tables.turn_steps)
        return apex_risk(walking, node, self.scene.walking, self.scene.robot)

    def _following(self, state: FineState) -> list[int]:
        """Return the contexts that may follow an achieved order."""
        rules = self.fine_steps.rules
        context, tables = rules.contexts[state.context], rules.tables
        if context.order == STOP_ORDER:
            key = 4 * context.here + state.heading // tables.turn_steps
        else:
            key = 4 * context.there + int(Direction(context.order))
        return [int(c) for c in tables.next_context[tables.next_first[key] : tables.next_first[key + 1]]]

    def _next_step(self, walking: WalkingState, state: FineState) -> Displaced | str | None:
        """Return the next step, or why there is none, or nothing when the robot stays."""
        action = self.strategy.actions.get(state)
        if action is None:
            return "the action strategy has no answer where the foot lands"
        if action == Action.STAY:
            return None
        step = plan_step(walking, self.fine_steps.command(state, action), self.scene.walking, self.scene.robot)
        if isinstance(step, Unsafe):
            return self.corrected(walking, state, action) or f"no safe step follows: {step.reason}"
        outcome = step.sagittal_cells, step.lateral_cells
        return Displaced(step, apply_action(self.fine_steps.rules.tables, state, action, *outcome), outcome)

    def corrected(self, walking: WalkingState, state: FineState, action: int) -> Displaced | None:
        """Return a step whose waypoint lies elsewhere than the action game lets it deviate; None when none is safe.

        The displacement is the least one after which the action strategy has an answer. The theorems hold as for any
        step. Heading that is not cardinal after the step leaves no displacement by whole cells.
        """
        tables, command = self.fine_steps.rules.tables, self.fine_steps.command(state, action)
        heading = apply_action(tables, state, action, 0, 0).state.heading
        if heading % tables.turn_steps:
            return None
        ahead, cell_m = Direction(heading // tables.turn_steps), self.scene.walking.fine_cell_m
        span = range(-FARTHEST_CELLS, FARTHEST_CELLS + 1)
        for along, aside in sorted(product(span, span), key=lambda pair: (abs(pair[0]) + abs(pair[1]), pair)):
            shift = tuple(along * a + aside * b for a, b in zip(ahead.offset, ahead.left.offset, strict=True))
            outcome, cells = self.labelled(state, action, (0, 0), (shift[0], shift[1]))
            moved = displace_action(tables, state, action, outcome, cells, put_off=False)
            if moved is None or not self._answered(moved):
                continue
            wider = replace(
                command,
                length_m=command.length_m + along * cell_m,
                height_change_m=moved.height_change_m,
                next_heading_changes_rad=self.fine_steps.next_changes(moved.state, achieved=moved.achieved),
                sagittal_outcomes_cells=0,
                shift_cells=aside,
            )
            step = plan_step(walking, wider, self.scene.walking, self.scene.robot)
            if isinstance(step, WalkingStep):
                length_m = command.length_m + outcome[0] * cell_m
                booked = replace(step, length_m=length_m, sagittal_cells=outcome[0], lateral_cells=outcome[1])
                return Displaced(booked, moved, outcome, cells)
        return None

    def _answered(self, moved: Moved) -> bool:
        """Return whether the action strategy has an answer in a state, whatever order follows."""
        contexts = self._following(moved.state) if moved.achieved else [moved.state.context]
        return all(moved.state._replace(context=context) in self.strategy.actions for context in contexts)

    def labelled(
        self, state: FineState, action: int, planned: tuple[int, int], shift: tuple[int, int]
    ) -> tuple[tuple[int, int], tuple[int, int]]:
        """Return the outcome of a displacement, and the rows and columns that no outcome of the game covers.

        Args:
            state: before the step.
            action: that it carries out.
            planned: outcome without the displacement.
            shift: rows and columns of the displacement.
        """
        tables = self.fine_steps.rules.tables
        heading = apply_action(tables, state, action, *planned).state.heading
        if heading % tables.turn_steps:
            return planned, shift
        ahead = Direction(heading // tables.turn_steps)
        along, aside = (sum(a * b for a, b in zip(shift, way.offset, strict=True)) for way in (ahead, ahead.left))
        total, most = (planned[0] + along, planned[1] + aside), deviations(tables, state, action)
        if abs(total[0]) <= most.sagittal and abs(total[1]) <= most.lateral:
            return total, (0, 0)
        return planned, shift

"""How well a walk goes on from a state that a push has left."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

from surefoot.frames import Direction
from surefoot.missions.scenario.fine_steps import FineSteps
from surefoot.missions.scenario.scene import BipedScene
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
RISKY = 0.3
"""An outlook that is worse is a reason to displace the next waypoint."""
STRAIGHT = int(Action.STRAIGHT)
FARTHEST_CELLS = 3
"""How far a waypoint may be displaced after a push, in rows and in columns."""


@dataclass(frozen=True, slots=True)
class Displaced:
    """A step with what it leads to in the action game.

    Attributes:
        step: the step.
        moved: in the action game.
        action: of the action game that it carries out.
        outcome: sagittal and lateral deviation, as the action game labels them.
        cells: rows and columns by which the waypoint moves beyond that outcome.
    """

    step: WalkingStep
    moved: Moved
    action: int
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

    def onward(self, walking: WalkingState, state: FineState, action: int) -> Displaced | Unsafe:
        """Return the next step of a walk that was pushed.

        It is the planned one where the walk goes on well after it; else the one among those with a displaced waypoint
        after which the walk is least at risk.
        """
        step = plan_step(walking, self.fine_steps.command(state, action), self.scene.walking, self.scene.robot)
        planned = step if isinstance(step, Unsafe) else self.booked(step, state, action)
        if isinstance(planned, Displaced):
            risk = self.risk(planned.step.next_state(), planned.moved)
            if not isinstance(risk, str) and risk <= RISKY:
                return planned
        found, least = planned, math.inf
        if isinstance(planned, Displaced) and not isinstance(risk, str):
            least = risk
        for other in self.displaced(walking, state, action):
            risk = self.risk(other.step.next_state(), other.moved)
            if isinstance(risk, str):
                found = other if isinstance(found, Unsafe) else found
            elif risk < least:
                found, least = other, risk
            if least <= RISKY:
                break
        return found

    def far_risk(self, walking: WalkingState, moved: Moved) -> float | str:
        """Return the risk where the next step of the walk may be displaced for the sake of the following ones."""
        action = None if moved.achieved else self.strategy.actions.get(moved.state)
        if action is None or action == Action.STAY:
            return self.risk(walking, moved)
        found = self.onward(walking, moved.state, action)
        if isinstance(found, Unsafe):
            return f"no safe step follows: {found.reason}"
        return self.risk(found.step.next_state(), found.moved)

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
            return next(self.displaced(walking, state, action), f"no safe step follows: {step.reason}")
        return self.booked(step, state, action)

    def booked(self, step: WalkingStep, state: FineState, action: int) -> Displaced:
        """Return what a planned step leads to."""
        outcome = step.sagittal_cells, step.lateral_cells
        return Displaced(step, apply_action(self.fine_steps.rules.tables, state, action, *outcome), action, outcome)

    def displaced(self, walking: WalkingState, state: FineState, action: int) -> Iterator[Displaced]:
        """Yield safe steps whose waypoint lies elsewhere than the action game lets it deviate, the least far first.

        After them come such steps straight on, where a turn was to begin or to be prepared. After each of them the
        action strategy has an answer; the theorems hold as for any step.
        """
        yield from self._displaced(walking, state, action)
        if action in (Action.TURN, Action.PRE_STEP) and state.mode == Mode.WALKING:
            yield from self._displaced(walking, state, STRAIGHT)

    def _displaced(self, walking: WalkingState, state: FineState, action: int) -> Iterator[Displaced]:
        """Yield safe steps of one action; a heading that is not cardinal after it leaves no whole cells."""
        tables = self.fine_steps.rules.tables
        heading = apply_action(tables, state, action, 0, 0).state.heading
        if heading % tables.turn_steps:
            return
        ahead, span = Direction(heading // tables.turn_steps), range(-FARTHEST_CELLS, FARTHEST_CELLS + 1)
        for along, aside in sorted(product(span, span), key=lambda pair: (abs(pair[0]) + abs(pair[1]), pair)):
            shift = tuple(along * a + aside * b for a, b in zip(ahead.offset, ahead.left.offset, strict=True))
            outcome, cells = self.labelled(state, action, (0, 0), (shift[0], shift[1]))
            moved = displace_action(tables, state, action, outcome, cells, put_off=False)
            if moved is None or not self._answered(moved):
                continue
            step = self._wider(walking, state, action, moved, (along, aside))
            if isinstance(step, WalkingStep):
                yield Displaced(self._labelled_as(step, state, action, outcome), moved, action, outcome, cells)

    def _wider(
        self, walking: WalkingState, state: FineState, action: int, moved: Moved, cells: tuple[int, int]
    ) -> WalkingStep | Unsafe:
        """Return the step of an action whose waypoint lies some cells farther ahead and to the left."""
        command = self.fine_steps.command(state, action)
        command = replace(
            command,
            length_m=command.length_m + cells[0] * self.scene.walking.fine_cell_m,
            height_change_m=moved.height_change_m,
            next_heading_changes_rad=self.fine_steps.next_changes(moved.state, achieved=moved.achieved),
            sagittal_outcomes_cells=0,
            shift_cells=cells[1],
        )
        return plan_step(walking, command, self.scene.walking, self.scene.robot)

    def _labelled_as(self, step: WalkingStep, state: FineState, action: int, outcome: tuple[int, int]) -> WalkingStep:
        """Return a step as the action game labels it; ``length_m`` counts no cells beyond the outcome."""
        length_m = self.fine_steps.command(state, action).length_m + outcome[0] * self.scene.walking.fine_cell_m
        return replace(step, length_m=length_m, sagittal_cells=outcome[0], lateral_cells=outcome[1])

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

"""Replays the discrete side of a run log: decisions, fine states, actions and outcomes."""

from __future__ import annotations

from dataclasses import dataclass, field

from surefoot.frames import Direction
from surefoot.verify.findings import Ledger
from surefoot.verify.navigation.claims import ORDERS, Claims
from surefoot.verify.navigation.decisions import WAIT, Table
from surefoot.verify.plan.action import ActionTable, Core, start_core
from surefoot.verify.plan.moves import (
    FINE,
    NOWHERE,
    PRE_STEP,
    STANDING,
    STAY,
    STOPPING,
    STRAIGHT,
    TURN,
    WALKING,
    allowed,
    landed,
    moved,
    outcome_limits,
)
from surefoot.verify.plan.next_turns import check_listed, contexts_after, heading_changes_rad
from surefoot.verify.runs.decisions import BrokenLogError, Decider
from surefoot.verify.runs.file import Replan, RunFile, Step, Turn, Violation
from surefoot.verify.scene.derived import STOP, Cell, Scene


@dataclass(frozen=True, slots=True)
class Walked:
    """A step of the log with its place in the game: cells, the state after it, heading changes that may come next."""

    step: Step
    cell: Cell
    after_cell: Cell
    after: Core
    may_turn_rad: tuple[float, ...]


@dataclass(slots=True)
class Replayed:
    """How far a log could be followed.

    Attributes:
        walked: the steps that follow the game.
        goals_reached: how often each goal was reached.
        turns: decisions.
        quarter_turns: heading changes by 90 degrees that were completed.
        whole: whether every record could be followed.
    """

    goals_reached: list[int]
    walked: list[Walked] = field(default_factory=list)
    turns: int = 0
    quarter_turns: int = 0
    whole: bool = True


@dataclass(slots=True)
class _Replayer:
    scene: Scene
    claims: Claims
    decider: Decider
    actions: ActionTable
    ledger: Ledger
    done: Replayed
    core: Core
    cell: Cell
    order: int = 0
    context: int = 0
    achieved: bool = True
    pushed: bool = False

    def refuse(self, rule: str, message: str, line: int) -> BrokenLogError:
        self.ledger.refuse(rule, message, f"run.jsonl line {line}")
        return BrokenLogError()

    def turn(self, record: Turn) -> None:
        """Follow a decision: the obstacles' moves, the belief, the order."""
        self._stay(record.line)
        if not self.achieved:
            raise self.refuse("rules.md 5, orders", "a decision comes before the last order is achieved", record.line)
        if record.turn != self.done.turns:
            raise self.refuse("formats.md 3, turn", f"has to be turn {self.done.turns}", record.line)
        self.order = self.decider.turn(record, self.core)
        if record.cell != self.cell:
            raise self.refuse("rules.md 5, composition (2)", f"the robot has walked to {self.cell}", record.line)
        self.achieved = False
        self.done.turns += 1
        self.context = self._context(record.line)

    def _stay(self, line: int) -> None:
        """Count an order to wait as achieved when the robot stands: nothing moves, so nothing is logged."""
        if self.achieved or self.order < WAIT or self.core[4] != STANDING:
            return
        row = self.actions.row(self.core, self.context)
        if row < 0 or self.actions.actions[row] != STAY:
            raise self.refuse("rules.md 5, actions", "the standing robot has no action stay", line)
        self.achieved = True

    def _context(self, line: int) -> int:
        order = STOP if self.order >= WAIT else self.order
        there = self.cell if order == STOP else self.scene.target(self.cell, Direction(order))
        context = (self.claims.kinds[self.cell], order, self.claims.kinds.get(there, -1))
        if context not in self.claims.contexts:
            raise self.refuse("rules.md 5, contexts", f"order {ORDERS[order]} is no context here", line)
        return self.claims.contexts.index(context)

    def step(self, record: Step) -> None:
        """Follow a walking step: the state, the action, the outcome."""
        if self.decider.decision is None or self.achieved:
            raise self.refuse("formats.md 3, step", "a step without a pending order", record.line)
        if (record.step, record.turn) != (len(self.done.walked), self.done.turns - 1):
            raise self.refuse("formats.md 3, step", f"has to be step {len(self.done.walked)}", record.line)
        if (record.core, record.context) != (self.core, self.context) or record.stance != self.core[3]:
            raise self.refuse("rules.md 5, state", f"the game is in {self.core}, context {self.context}", record.line)
        row, rules = self.actions.row(self.core, self.context), self.actions.rules
        if row < 0 or record.action == STAY or not self._answers(int(self.actions.actions[row]), record):
            raise self.refuse("formats.md 3, action", "is not the action of the action strategy", record.line)
        far, wide = outcome_limits(rules, self.core, rules.here[self.context], record.action)
        if abs(record.sagittal) > far or abs(record.lateral) > wide:
            raise self.refuse("rules.md 5, outcomes", "the outcome is none of the action's", record.line)
        order = int(rules.order[self.context])
        after = self._displaced(record, moved(rules, self.core, order, record.action, record.sagittal, record.lateral))
        status, achieved, crossed = landed(rules, self.core, self.context, record.action, after)
        if status != FINE:
            raise self.refuse("rules.md 5, lost", "the outcome is lost", record.line)
        self._arrive(record, after, bool(achieved), int(crossed))

    def _answers(self, action: int, record: Step) -> bool:
        """Return whether a step carries out the strategy's action, or after a push goes straight on before a turn."""
        order = int(self.actions.rules.order[self.context])
        onward = self.pushed and action in (PRE_STEP, TURN) and record.action >= STRAIGHT
        core = self.core
        return record.action == action or (
            onward and bool(allowed(self.actions.rules, core[2], core[3], core[4], order, record.action))
        )

    def _displaced(self, record: Step, after: Core) -> Core:
        """Return the state after a step whose push displaced its waypoint, or put off its stop."""
        put_off = record.push is not None and record.push.put_off
        if put_off and record.action != STOPPING:
            raise self.refuse("formats.md 3, pushes", "only a stop can be put off", record.line)
        self.pushed = self.pushed or record.push is not None
        if record.moved != (0, 0) and not self.pushed:
            raise self.refuse("formats.md 3, pushes", "a waypoint moves before the first push", record.line)
        row, column, heading, stance, mode = (int(value) for value in after)
        return row + record.moved[0], column + record.moved[1], heading, stance, WALKING if put_off else mode

    def _arrive(self, record: Step, after: Core, achieved: bool, crossed: int) -> None:
        n, cell = int(self.actions.rules.sizes[0]), self.cell
        if crossed != NOWHERE:
            self.cell = self.scene.target(self.cell, Direction(crossed))
        self.done.quarter_turns += self.core[2] != after[2] and after[2] % self.claims.turn_steps == 0
        row, column, heading, stance, mode = (int(value) for value in after)
        self.core, self.achieved = (row % n, column % n, heading, stance, mode), achieved
        last = crossed if crossed != NOWHERE else heading // self.claims.turn_steps
        turns = self._may_turn(last)
        check_listed(record.next_heading_changes_rad, turns, self.claims.turn_steps, record.line, self.ledger)
        self.done.walked.append(Walked(record, cell, self.cell, self.core, turns))

    def _may_turn(self, last: int) -> tuple[float, ...]:
        """Return the heading changes that the action game allows in the present state, whatever order comes next."""
        achieved = self.achieved
        contexts = contexts_after(self.scene, self.claims, self.cell, last) if achieved else [self.context]
        return heading_changes_rad(self.actions.rules, self.core, contexts)


def replay(run: RunFile, scene: Scene, claims: Claims, table: Table, actions: ActionTable, ledger: Ledger) -> Replayed:
    """Follow a log through both games until it leaves them or ends."""
    done = Replayed([0] * len(claims.goals))
    decider = Decider(scene, claims, table, actions, run.breaks_assumptions, ledger, done.goals_reached)
    player = _Replayer(scene, claims, decider, actions, ledger, done, start_core(claims), claims.start)
    try:
        for record in run.records:
            if isinstance(record, Turn):
                player.turn(record)
            elif isinstance(record, Step):
                player.step(record)
            elif isinstance(record, Violation | Replan):
                decider.note(record)
        if player.achieved:
            decider.finish()
        if run.end is not None and (decider.violations or decider.replan):
            raise decider.refuse("formats.md 3, violation", "no decision follows it", run.end.line)
    except BrokenLogError:
        done.whole = False
    ledger.counts["replans"], ledger.counts["belief_violations"] = decider.strategies, decider.belief_violations
    return done

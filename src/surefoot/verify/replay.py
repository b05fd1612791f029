"""Replays the discrete side of a run log: obstacle, belief, orders, fine states, actions and outcomes."""

from __future__ import annotations

from dataclasses import dataclass, field

from surefoot.frames import Direction
from surefoot.verify.action import ActionTable, Core, start_core
from surefoot.verify.action_moves import (
    FINE,
    NOWHERE,
    STANDING,
    STAY,
    landed,
    moved,
    outcome_limits,
)
from surefoot.verify.belief import Known, Obstacle
from surefoot.verify.claims import ORDERS, Claims
from surefoot.verify.findings import Ledger
from surefoot.verify.navigation import WAIT, Decision, Table, start_decision, successors
from surefoot.verify.next_turns import check_listed, contexts_after, heading_changes_rad
from surefoot.verify.run_file import Step, Turn, Unsafe
from surefoot.verify.scene import STOP, Cell, Scene


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


class _BrokenLogError(Exception):
    """The log leaves the game; what follows cannot be judged."""


@dataclass(slots=True)
class _Replayer:
    scene: Scene
    claims: Claims
    obstacle: Obstacle
    table: Table
    actions: ActionTable
    ledger: Ledger
    done: Replayed
    core: Core
    cell: Cell
    decision: Decision | None = None
    truth: Cell | None = None
    order: int = 0
    context: int = 0
    achieved: bool = True

    def refuse(self, rule: str, message: str, line: int) -> _BrokenLogError:
        self.ledger.refuse(rule, message, f"run.jsonl line {line}")
        return _BrokenLogError()

    def turn(self, record: Turn) -> None:
        """Follow a decision: the obstacle's move, the belief, the order."""
        self._stay(record.line)
        if not self.achieved:
            raise self.refuse("rules.md 5, orders", "a decision comes before the last order is achieved", record.line)
        if record.turn != self.done.turns:
            raise self.refuse("formats.md 3, turn", f"has to be turn {self.done.turns}", record.line)
        expected = self._expected(record)
        self._compare(record, expected)
        order = self.table.order(expected)
        if order is None or order != record.order:
            raise self.refuse("formats.md 3, order", "is not the order of the navigation strategy", record.line)
        self.decision, self.order, self.achieved = expected, order, False
        self.truth = record.obstacles[0] if record.obstacles else None
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

    def _expected(self, record: Turn) -> Decision:
        """Return the decision that the obstacle's true cell brings about."""
        if len(record.obstacles) != len(self.scene.scenario.obstacles):
            raise self.refuse("formats.md 3, turn", "lists another number of obstacles", record.line)
        truth = record.obstacles[0] if record.obstacles else None
        bit = -1 if truth is None else self._place(truth, record.line)
        if self.decision is None:
            if truth != self.claims.obstacle:
                raise self.refuse("rules.md 4, start", "the obstacle is not at its start", record.line)
            found = start_decision(self.scene, self.claims, self.obstacle)
            if self.claims.goals[0] == self.cell:
                self.done.goals_reached[0] += 1
            return found
        if self.truth is not None:
            self._check_obstacle(bit, record.line)
        _, options = successors(self.scene, self.claims, self.obstacle, self.decision, self.order)
        for decision, reached in sorted(options, key=lambda option: -option[0].known.visible):
            if truth is None or decision.known.visible in (bit, -1):
                if reached:
                    self.done.goals_reached[self.decision.goal] += 1
                return decision
        raise self.refuse("rules.md 4, belief", "the obstacle is where the belief says it cannot be", record.line)

    def _place(self, truth: Cell, line: int) -> int:
        rows, columns = self.scene.frame.rows, self.scene.frame.columns
        index = self.scene.index(truth) if 0 <= truth[0] < rows and 0 <= truth[1] < columns else -1
        if index not in self.obstacle.place:
            raise self.refuse("rules.md 4, obstacle domain", f"the obstacle is outside it, in {truth}", line)
        return self.obstacle.place[index]

    def _check_obstacle(self, bit: int, line: int) -> None:
        """Check that the obstacle moved by at most one cell, and not into a robot that stands."""
        if self.truth is None or self.decision is None:
            return
        before = self.obstacle.place[self.scene.index(self.truth)]
        if not self.obstacle.next_of[before] >> bit & 1:
            raise self.refuse("rules.md 4, obstacle", f"jumps from {self.truth}", line)
        if self.order >= WAIT and self.obstacle.domain[bit] == self.decision.cell:
            raise self.refuse("rules.md 4, assumption (a)", "the obstacle walks into a robot that stands", line)

    def _compare(self, record: Turn, expected: Decision) -> None:
        """Compare a decision record with the decision that the rules give."""
        if self.scene.index(self.cell) != expected.cell:
            raise self.refuse("rules.md 5, composition (2)", f"the robot has walked to {self.cell}", record.line)
        known: Known = expected.known
        visible = [self.obstacle.domain[known.visible]] if known.visible >= 0 else []
        own = {
            "cell": (record.cell, self.scene.cell(expected.cell)),
            "heading": (int(record.heading), expected.heading),
            "goal": (record.goal, expected.goal),
            "visible": (list(record.visible), [self.scene.cell(cell) for cell in visible]),
            "hidden": (set(record.hidden), {self.scene.cell(cell) for cell in self.obstacle.cells(known.hidden)}),
        }
        for name, (found, derived) in own.items():
            if found != derived:
                rule = "rules.md 4, belief" if name in ("visible", "hidden") else f"rules.md 4, {name}"
                raise self.refuse(rule, f"{name} is not what the rules give", record.line)

    def _context(self, line: int) -> int:
        order = STOP if self.order >= WAIT else self.order
        there = self.cell if order == STOP else self.scene.target(self.cell, Direction(order))
        context = (self.claims.kinds[self.cell], order, self.claims.kinds.get(there, -1))
        if context not in self.claims.contexts:
            raise self.refuse("rules.md 5, contexts", f"order {ORDERS[order]} is no context here", line)
        return self.claims.contexts.index(context)

    def step(self, record: Step) -> None:
        """Follow a walking step: the state, the action, the outcome."""
        if self.decision is None or self.achieved:
            raise self.refuse("formats.md 3, step", "a step without a pending order", record.line)
        if (record.step, record.turn) != (len(self.done.walked), self.done.turns - 1):
            raise self.refuse("formats.md 3, step", f"has to be step {len(self.done.walked)}", record.line)
        if (record.core, record.context) != (self.core, self.context) or record.stance != self.core[3]:
            raise self.refuse("rules.md 5, state", f"the game is in {self.core}, context {self.context}", record.line)
        row, rules = self.actions.row(self.core, self.context), self.actions.rules
        if row < 0 or self.actions.actions[row] != record.action or record.action == STAY:
            raise self.refuse("formats.md 3, action", "is not the action of the action strategy", record.line)
        far, wide = outcome_limits(rules, self.core, rules.here[self.context], record.action)
        if abs(record.sagittal) > far or abs(record.lateral) > wide:
            raise self.refuse("rules.md 5, outcomes", "the outcome is none of the action's", record.line)
        order = int(rules.order[self.context])
        after = moved(rules, self.core, order, record.action, record.sagittal, record.lateral)
        status, achieved, crossed = landed(rules, self.core, self.context, record.action, after)
        if status != FINE:
            raise self.refuse("rules.md 5, lost", "the outcome is lost", record.line)
        self._arrive(record, after, bool(achieved), int(crossed))

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


def replay(
    scene: Scene,
    claims: Claims,
    obstacle: Obstacle,
    table: Table,
    actions: ActionTable,
    records: tuple[Turn | Step | Unsafe, ...],
    ledger: Ledger,
) -> Replayed:
    """Follow a log through both games until it leaves them or ends."""
    done = Replayed([0] * len(claims.goals))
    player = _Replayer(scene, claims, obstacle, table, actions, ledger, done, start_core(claims), claims.start)
    try:
        for record in records:
            if isinstance(record, Turn):
                player.turn(record)
            elif isinstance(record, Step):
                player.step(record)
    except _BrokenLogError:
        done.whole = False
    return done

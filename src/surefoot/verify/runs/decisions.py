"""Follows the decisions of a run log: where the obstacles go, what the robot knows, which strategy decides."""

from __future__ import annotations

from dataclasses import dataclass, field

from surefoot.verify.artefacts import NAVIGATION_ARRAYS, read_arrays
from surefoot.verify.findings import Ledger
from surefoot.verify.navigation.belief import KindKnown, Known, Obstacles
from surefoot.verify.navigation.claims import Claims
from surefoot.verify.navigation.decisions import WAIT, Decision, Table, read_table
from surefoot.verify.navigation.liveness import check_liveness
from surefoot.verify.navigation.play import arrival, explore, start_decision
from surefoot.verify.plan.action import ActionTable, Core
from surefoot.verify.plan.composition import check_composition
from surefoot.verify.plan.moves import STANDING
from surefoot.verify.runs.file import Replan, Turn, Violation
from surefoot.verify.runs.knowledge import (
    Seen,
    breach,
    enlarged,
    learnt,
    order_without_strategy,
    reset,
    seen_obstacles,
    unexplained,
)
from surefoot.verify.scene.derived import Cell, Scene


class BrokenLogError(Exception):
    """The log leaves the game; what follows cannot be judged."""


@dataclass(slots=True)
class Decider:
    """Follows the decisions of one log.

    Attributes:
        table: of the strategy that decides; None while none does.
        actions: the action strategy of the plan, which carries out the orders of every strategy.
        breaks: whether the obstacles may break their assumptions.
        decision: the last one; None before the first.
        order: its order.
        truths: the obstacles' true cells in it.
        violations: those noted since the last decision.
        replan: the one noted since the last decision.
    """

    scene: Scene
    claims: Claims
    table: Table | None
    actions: ActionTable
    breaks: bool
    ledger: Ledger
    goals_reached: list[int]
    decision: Decision | None = None
    order: int = 0
    truths: tuple[int, ...] = ()
    strategies: int = 0
    belief_violations: int = 0
    violations: list[Violation] = field(default_factory=list)
    replan: Replan | None = None

    def refuse(self, rule: str, message: str, line: int) -> BrokenLogError:
        """Note a broken rule; the error is for the caller to raise."""
        self.ledger.refuse(rule, message, f"run.jsonl line {line}")
        return BrokenLogError()

    def note(self, record: Violation | Replan) -> None:
        """Keep a record that belongs to the decision after it."""
        if isinstance(record, Violation):
            self.violations.append(record)
        elif self.replan is None:
            self.replan = record
        else:
            raise self.refuse("formats.md 3, replan", "follows another one without a decision between", record.line)

    def turn(self, record: Turn, core: Core) -> int:
        """Follow one decision; return its order.

        Args:
            record: of the log.
            core: the robot's state in the action game.
        """
        truths = self._truths(record)
        before = self.decision
        expected = self._first(record, truths) if before is None else self._next(record, before, truths, core)
        self._compare(record, expected)
        self._check_truths(record, expected.known, truths)
        order = self._order(expected)
        if order is None or order != record.order:
            raise self.refuse("formats.md 3, order", "is not the order that has to be given", record.line)
        self.decision, self.order, self.truths = expected, order, truths
        return order

    def finish(self) -> None:
        """Count the goal that the last order led to, when the log ends as soon as it is achieved."""
        if self.decision is not None:
            _, _, _, reached = arrival(self.scene, self.claims, self.decision, self.order)
            self.goals_reached[self.decision.goal] += reached

    def _truths(self, record: Turn) -> tuple[int, ...]:
        """Return the obstacles' true cells: free ones, and, of obstacles that keep the rules, those of the domain."""
        if len(record.obstacles) != self.scene.obstacles:
            raise self.refuse("formats.md 3, turn", "lists another number of obstacles", record.line)
        for kind in self.scene.obstacle_kinds:
            for member in kind.members:
                cell = record.obstacles[member]
                inside = cell in self.scene.kinds and (self.breaks or self.scene.index(cell) in kind.domain)
                if not inside:
                    raise self.refuse("rules.md 4, obstacle domain", f"obstacle {member} is in {cell}", record.line)
        return tuple(self.scene.index(cell) for cell in record.obstacles)

    def _first(self, record: Turn, truths: tuple[int, ...]) -> Decision:
        if truths != tuple(self.scene.index(start) for start in self.claims.obstacles):
            raise self.refuse("rules.md 4, start", "an obstacle is not at its start", record.line)
        if self.table is None or self.violations or self.replan:
            raise self.refuse("formats.md 3, turn", "the first decision is the plan's", record.line)
        if self.claims.goals[0] == self.claims.start:
            self.goals_reached[0] += 1
        return start_decision(self.scene, self.claims, self.table.obstacles)

    def _next(self, record: Turn, before: Decision, truths: tuple[int, ...], core: Core) -> Decision:
        """Return the decision that the last order and the obstacles' true moves bring about."""
        cell, heading, goal, reached = arrival(self.scene, self.claims, before, self.order)
        self.goals_reached[before.goal] += reached
        viewer = cell if self.scene.scenario.view_post else before.cell
        seen = seen_obstacles(self.scene, truths, viewer)
        replan, self.replan = self.replan, None
        if self.table is None:
            self._expect_violations(record, [])
            found = Decision(cell, heading, reset(self.scene, viewer, seen), goal)
            return found if replan is None else self._replanned(replan, found, viewer, seen, core)
        if replan is not None:
            raise self.refuse("formats.md 3, replan", "a strategy decides already", replan.line)
        obstacles = self.table.obstacles
        if not self.breaks:
            self._check_moves(record, obstacles, before, truths)
        known = self._explained(record, obstacles, before, cell, seen)
        if known is None:
            self.table, known = None, reset(self.scene, viewer, seen)
        return Decision(cell, heading, known, goal)

    def _check_moves(self, record: Turn, obstacles: Obstacles, before: Decision, truths: tuple[int, ...]) -> None:
        """Check that every obstacle moved within its speed and domain, and not into or through a robot that stands."""
        for number, kind in enumerate(obstacles.kinds):
            for member in kind.members:
                old, new = self.truths[member], truths[member]
                if new not in obstacles.next_of(number, old):
                    raise self.refuse("rules.md 4, obstacle", f"jumps from {self.scene.cell(old)}", record.line)
                if self.order >= WAIT and new not in obstacles.next_of(number, old, before.cell):
                    text = "an obstacle walks into or through a robot that stands"
                    raise self.refuse("rules.md 4, assumption (a)", text, record.line)

    def _explained(self, record: Turn, obstacles: Obstacles, before: Decision, cell: int, seen: Seen) -> Known | None:
        """Return what is known after a turn that a strategy decided; None when an assumption was broken."""
        waits = self.order >= WAIT
        known = learnt(obstacles, before, cell, seen, waits=waits)
        self._expect_violations(
            record,
            [
                (kind, *breach(obstacles, kind, before, seen[kind], waits=waits))
                for kind, part in enumerate(known)
                if part is None
            ],
        )
        whole = tuple(part for part in known if part is not None)
        return whole if len(whole) == len(known) else None

    def _expect_violations(self, record: Turn, expected: list[tuple[int, str, int | None]]) -> None:
        """Compare the violations noted before a decision with those that the robot has to see."""
        own = [(kind, name, None if cell is None else self.scene.cell(cell)) for kind, name, cell in expected]
        if [(one.kind, one.name, one.cell) for one in self.violations] != own or any(
            one.turn != record.turn for one in self.violations
        ):
            text = f"the violations seen are {own}" if own else "no violation is seen"
            raise self.refuse("formats.md 3, violation", text, record.line)
        if own and not self.breaks:
            raise self.refuse("formats.md 3, violation", "of obstacles that keep their assumptions", record.line)
        self.violations = []

    def _replanned(self, replan: Replan, found: Decision, viewer: int, seen: Seen, core: Core) -> Decision:
        """Check a strategy that was planned anew, and let it decide; return its first decision."""
        if core[4] != STANDING:
            raise self.refuse("formats.md 3, replan", "the robot does not stand", replan.line)
        if any(found.cell in cells for cells in seen) or unexplained(self.scene, found.known):
            raise self.refuse("formats.md 3, replan", "an obstacle is where no game can begin", replan.line)
        obstacles = Obstacles(self.scene, self.claims.belief, enlarged(self.scene, seen))
        known = tuple(
            KindKnown(part.visible, obstacles.believed(kind, part.hidden, viewer))
            for kind, part in enumerate(found.known)
        )
        start = found._replace(known=known)
        self.strategies += 1
        domains = tuple(self._cells(kind.domain) for kind in obstacles.kinds)
        own = {
            "strategy": (replan.strategy, self.strategies),
            "cell": (replan.cell, self.scene.cell(start.cell)),
            "heading": (int(replan.heading), start.heading),
            "goal": (replan.goal, start.goal),
            "visible": (replan.visible, tuple(self._cells(part.visible) for part in known)),
            "hidden": (replan.hidden, tuple(self._cells(part.hidden) for part in known)),
            "domains": (tuple(tuple(sorted(cells)) for cells in replan.domains), domains),
        }
        for name, (logged, derived) in own.items():
            if logged != derived:
                raise self.refuse("formats.md 3, replan", f"{name} is not what the rules give", replan.line)
        self._check_strategy(replan, obstacles, start, core)
        return start

    def _check_strategy(self, replan: Replan, obstacles: Obstacles, start: Decision, core: Core) -> None:
        """Check a strategy that was planned anew like a plan's, from where the robot is now."""
        before = self.ledger.total
        arrays = read_arrays(replan.path, NAVIGATION_ARRAYS, {"domain"})
        self.table = read_table(arrays, replan.path, obstacles, len(self.claims.goals), self.ledger)
        if self.table is not None:
            play = explore(self.scene, self.claims, start, self.table, self.ledger)
            if play.closed:
                check_liveness(play, self.ledger)
                check_composition(self.scene, self.claims, play, self.actions, core, self.ledger)
        if self.ledger.total > before:
            raise BrokenLogError

    def _order(self, decision: Decision) -> int | None:
        if self.table is None:
            return order_without_strategy(self.scene, self.claims, decision.cell, decision.heading)
        return self.table.order(decision)

    def _compare(self, record: Turn, expected: Decision) -> None:
        """Compare a decision record with the decision that the rules give."""
        own = {
            "cell": (record.cell, self.scene.cell(expected.cell)),
            "heading": (int(record.heading), expected.heading),
            "goal": (record.goal, expected.goal),
            "visible": (record.visible, tuple(self._cells(part.visible) for part in expected.known)),
            "hidden": (record.hidden, tuple(self._cells(part.hidden) for part in expected.known)),
            "strategy": (record.strategy, -1 if self.table is None else self.strategies),
        }
        rules = {"visible": "rules.md 4, belief", "hidden": "rules.md 4, belief", "strategy": "formats.md 3, strategy"}
        for name, (found, derived) in own.items():
            if found != derived:
                rule = rules.get(name, f"rules.md 4, {name}")
                raise self.refuse(rule, f"{name} is not what the rules give", record.line)

    def _check_truths(self, record: Turn, known: Known, truths: tuple[int, ...]) -> None:
        """Check that every obstacle out of sight is where its kind's belief says it may be."""
        for kind, part in zip(self.scene.obstacle_kinds, known, strict=True):
            unexplained = list(part.visible)
            for cell in (truths[member] for member in kind.members):
                if cell in unexplained:
                    unexplained.remove(cell)
                elif cell not in part.hidden:
                    self.belief_violations += 1
                    if not self.breaks:
                        text = f"an obstacle is truly in {self.scene.cell(cell)}, where the belief says it cannot be"
                        raise self.refuse("rules.md 4, belief", text, record.line)

    def _cells(self, indices: tuple[int, ...]) -> tuple[Cell, ...]:
        return tuple(self.scene.cell(index) for index in indices)

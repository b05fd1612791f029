"""Checks a saved navigation strategy against rules.md 4: safety, dead ends, liveness, check (1)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.frames import Direction
from surefoot.verify.artefacts import Arrays, PlanFile
from surefoot.verify.belief import Known, Obstacle
from surefoot.verify.claims import Claims
from surefoot.verify.findings import Ledger
from surefoot.verify.graphs import can_reach, components, cyclic
from surefoot.verify.scene import Scene

WAIT = 4


class Decision(NamedTuple):
    """The key of a row: where the robot is, what it knows and which goal is next."""

    cell: int
    heading: int
    known: Known
    goal: int


@dataclass(frozen=True, slots=True)
class Table:
    """The rows of ``navigation.npz``."""

    row_of: dict[Decision, int]
    orders: tuple[int, ...]

    def order(self, decision: Decision) -> int | None:
        """Return the order of a decision; None where there is no row."""
        row = self.row_of.get(decision)
        return None if row is None else self.orders[row]


@dataclass(frozen=True, slots=True)
class Play:
    """Every play that the strategy allows, as a graph of decisions.

    Attributes:
        decisions: the reached ones; node v is ``decisions[v]``.
        orders: of each.
        first: (N + 1,) offsets into the edges.
        successors: (E,) nodes.
        advances: (E,) whether the goal memory advances on the way.
        closed: whether every reached decision has an allowed order and all its successors rows.
    """

    decisions: tuple[Decision, ...]
    orders: NDArray[np.int64]
    first: NDArray[np.int64]
    successors: NDArray[np.int64]
    advances: NDArray[np.bool_]
    closed: bool


def read_table(plan: PlanFile, scene: Scene, ledger: Ledger) -> Table:
    """Read the rows of a navigation strategy; duplicate and malformed ones are refused."""
    arrays, obstacles = plan.navigation, len(scene.scenario.obstacles)
    source = plan.path.parent / "navigation.npz"
    if obstacles and not np.array_equal(arrays["domain"], np.array(scene.domain, np.int64)):
        ledger.refuse("rules.md 4, obstacle domain", "is not the scenario's", "navigation.npz domain")
        return Table({}, ())
    if arrays["visible"].shape[1] != obstacles or arrays["hidden"].shape[1] != (len(arrays["domain"]) + 7) // 8:
        raise InputError("has columns for another number of obstacles or cells", source=source, key="visible")
    row_of: dict[Decision, int] = {}
    place = {cell: bit for bit, cell in enumerate(scene.domain)}
    for row, decision in enumerate(_decisions(arrays, place, obstacles)):
        if decision is None:
            ledger.refuse("formats.md 2, navigation.npz", "the obstacle is neither visible nor hidden", f"row {row}")
        elif decision in row_of:
            ledger.refuse("formats.md 2, navigation.npz", "a decision has two rows", f"rows {row_of[decision]}, {row}")
        else:
            row_of[decision] = row
    return Table(row_of, tuple(int(order) for order in arrays["order"]))


def _decisions(arrays: Arrays, place: dict[int, int], obstacles: int) -> list[Decision | None]:
    """Return the key of every row; None where visible and hidden contradict each other."""
    found: list[Decision | None] = []
    masks: dict[bytes, int] = {}
    for row, packed in enumerate(arrays["hidden"]):
        data = packed.tobytes()
        hidden = masks.setdefault(data, int.from_bytes(data, "little"))
        cell = int(arrays["visible"][row, 0]) if obstacles else -1
        visible = place.get(cell, -2) if cell != -1 else -1
        if visible == -2 or (obstacles and (visible >= 0) == bool(hidden)):
            found.append(None)
            continue
        heading, goal = int(arrays["heading"][row]), int(arrays["goal"][row])
        found.append(Decision(int(arrays["cell"][row]), heading, Known(visible, hidden), goal))
    return found


def start_decision(scene: Scene, claims: Claims, obstacle: Obstacle) -> Decision:
    """Return the first decision of every play."""
    cell = scene.index(claims.start)
    known = Known(-1, 0)
    if claims.obstacle is not None:
        known = obstacle.at_start(scene.index(claims.obstacle), cell)
    return Decision(cell, int(claims.heading), known, advanced(scene, claims, 0, cell)[0])


def advanced(scene: Scene, claims: Claims, goal: int, cell: int) -> tuple[int, bool]:
    """Return the goal memory after arriving in a cell, and whether it advanced."""
    if scene.index(claims.goals[goal]) != cell:
        return goal, False
    return (goal + 1) % len(claims.goals), True


def order_allowed(scene: Scene, claims: Claims, decision: Decision, order: int) -> bool:
    """Return whether rules.md 4 allows an order (0-3 move, 4-7 wait) in a decision."""
    if not 0 <= order < 8:
        return False
    cell, move = scene.cell(decision.cell), Direction(order % WAIT)
    if move == Direction(decision.heading).opposite or not scene.terrain.passable(cell, move):
        return False
    return claims.kinds[cell] == 0 or order == decision.heading


def successors(
    scene: Scene, claims: Claims, obstacle: Obstacle, decision: Decision, order: int
) -> tuple[bool, list[tuple[Decision, bool]]]:
    """Return whether the turn is lost, and the decisions that may follow, with whether a goal is reached."""
    move = Direction(order % WAIT)
    target = scene.index(scene.target(scene.cell(decision.cell), move))
    moves = order < WAIT
    lost, known = obstacle.outcomes(decision.known, decision.cell, target, moves)
    cell, heading = (target, int(move)) if moves else (decision.cell, decision.heading)
    goal, reached = advanced(scene, claims, decision.goal, cell) if moves else (decision.goal, False)
    return lost, [(Decision(cell, heading, after, goal), reached) for after in known]


def explore(scene: Scene, claims: Claims, obstacle: Obstacle, table: Table, ledger: Ledger) -> Play:
    """Follow the strategy from the start into every decision that the environment can bring about."""
    start = start_decision(scene, claims, obstacle)
    before = ledger.total
    number, decisions, orders = {start: 0}, [start], []
    first, targets, advances = [0], [], []
    for decision in decisions:
        order = table.order(decision)
        orders.append(-1 if order is None else order)
        for after, reached in _checked(scene, claims, obstacle, table, decision, ledger):
            if after not in number:
                number[after] = len(decisions)
                decisions.append(after)
            targets.append(number[after])
            advances.append(reached)
        first.append(len(targets))
    closed = ledger.total == before
    spare = len(table.row_of.keys() - number.keys())
    if closed and spare:
        ledger.refuse("formats.md 2, navigation.npz", f"{spare} rows are reached by no play", times=spare)
    return Play(
        tuple(decisions),
        np.array(orders, np.int64),
        np.array(first, np.int64),
        np.array(targets, np.int64),
        np.array(advances, np.bool_),
        closed,
    )


def _checked(
    scene: Scene, claims: Claims, obstacle: Obstacle, table: Table, decision: Decision, ledger: Ledger
) -> list[tuple[Decision, bool]]:
    """Return the successors of a decision, none where a rule is broken."""
    order = table.order(decision)
    if order is None:
        _refuse_missing(scene, table, obstacle, decision, ledger)
        return []
    where = describe(scene, decision)
    if not order_allowed(scene, claims, decision, order):
        ledger.refuse("rules.md 4, orders", f"order {order} is not allowed", where)
        return []
    lost, found = successors(scene, claims, obstacle, decision, order)
    if lost:
        ledger.refuse("rules.md 4, collision", "the obstacle may be in the robot's old or new cell", where)
        return []
    if not found:
        ledger.refuse("rules.md 4, dead end", "the obstacle has nowhere to go", where)
    return found


def _refuse_missing(scene: Scene, table: Table, obstacle: Obstacle, decision: Decision, ledger: Ledger) -> None:
    """Refuse a reached decision without a row; say when only the belief differs."""
    where = describe(scene, decision)
    if decision.known.visible < 0:
        others = [
            row.known.hidden
            for row in table.row_of
            if (row.cell, row.heading, row.goal, row.known.visible)
            == (decision.cell, decision.heading, decision.goal, -1)
        ]
        if others:
            believed = [scene.cell(cell) for cell in obstacle.cells(decision.known.hidden)]
            text = "narrower" if any(other & ~decision.known.hidden == 0 for other in others) else "different"
            ledger.refuse("rules.md 4, belief", f"the belief is {believed}; the strategy knows only {text} ones", where)
            return
    ledger.refuse("rules.md 4, dead end", "a reached decision has no row", where)


def describe(scene: Scene, decision: Decision) -> str:
    """Return a decision as text."""
    seen = "hidden"
    if decision.known.visible >= 0:
        seen = f"visible in {scene.cell(scene.domain[decision.known.visible])}"
    heading = Direction(decision.heading).name.lower()
    return f"cell {scene.cell(decision.cell)}, heading {heading}, goal {decision.goal}, obstacle {seen}"


def check_liveness(scene: Scene, obstacle: Obstacle, play: Play, ledger: Ledger) -> None:
    """Refuse cycles that starve a goal while assumption (c) holds, and decisions in which (c) cannot be kept."""
    fair = _fair(scene, obstacle, play)
    component = components(play.first, play.successors, ~play.advances)
    starving = cyclic(play.first, play.successors, ~play.advances, component) & _all_fair(component, fair)
    for number in np.flatnonzero(starving):
        node = int(np.flatnonzero(component == number)[0])
        text = "the obstacle can keep the robot from its next goal for ever without breaking assumption (c)"
        ledger.refuse("rules.md 4, goals", text, describe(scene, play.decisions[node]))
    every = np.ones(len(play.successors), np.bool_)
    component = components(play.first, play.successors, every)
    kept = cyclic(play.first, play.successors, every, component) & _all_fair(component, fair)
    forced = ~can_reach(play.first, play.successors, kept[component])
    if forced.any():
        node = int(np.flatnonzero(forced)[0])
        text = "the environment is forced to break assumption (c)"
        where = describe(scene, play.decisions[node])
        ledger.refuse("rules.md 4, check (1)", text, where, times=int(forced.sum()))


def _fair(scene: Scene, obstacle: Obstacle, play: Play) -> NDArray[np.bool_]:
    """Return (4, N) whether a decision satisfies the justice of each direction."""
    fair = np.ones((4, len(play.decisions)), np.bool_)
    for node, decision in enumerate(play.decisions):
        order = int(play.orders[node])
        if order >= WAIT:
            target = scene.index(scene.target(scene.cell(decision.cell), Direction(order - WAIT)))
            fair[order - WAIT, node] = not obstacle.blocked(decision.known, decision.cell, target)
    return fair


def _all_fair(component: NDArray[np.int64], fair: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return which components hold, for every direction, a decision that satisfies its justice."""
    met = np.ones(int(component.max()) + 1, np.bool_)
    for row in fair:
        some = np.zeros_like(met)
        some[component[row]] = True
        met &= some
    return met

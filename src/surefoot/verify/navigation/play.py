"""Checks a saved navigation strategy against rules.md 4: every order is legal, and every answer has a row."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numba import njit

from surefoot.errors import LimitExceeded
from surefoot.frames import Direction
from surefoot.verify.findings import KEPT, Ledger
from surefoot.verify.graphs import reached_from
from surefoot.verify.navigation.belief import Obstacles
from surefoot.verify.navigation.belief_turn import Ints
from surefoot.verify.navigation.claims import Claims
from surefoot.verify.navigation.decisions import WAIT, Decision, Table, describe
from surefoot.verify.navigation.turns import Turns, turns_of
from surefoot.verify.row_index import row_of
from surefoot.verify.scene.derived import Scene

MOST_EDGES = 100_000_000


@dataclass(frozen=True, slots=True)
class Play:
    """Every play that a strategy allows, as a graph of its rows.

    Attributes:
        table: the rows; node v is row v.
        start: the row of the first decision, -1 without one.
        first: (N + 1,) offsets into the edges.
        successors: (E,) nodes.
        turns: what happens in the turn of every row; None when an order is not allowed.
        closed: whether every row has an allowed order, all its successors have rows, and all rows are reached.
    """

    table: Table
    start: int
    first: Ints
    successors: Ints
    turns: Turns | None
    closed: bool


def start_decision(scene: Scene, claims: Claims, obstacles: Obstacles) -> Decision:
    """Return the first decision of every play."""
    cell = scene.index(claims.start)
    known = obstacles.at_start([scene.index(start) for start in claims.obstacles], cell)
    return Decision(cell, int(claims.heading), known, advanced(scene, claims, 0, cell)[0])


def advanced(scene: Scene, claims: Claims, goal: int, cell: int) -> tuple[int, bool]:
    """Return the goal memory after arriving in a cell, and whether it advanced."""
    if scene.index(claims.goals[goal]) != cell:
        return goal, False
    return (goal + 1) % len(claims.goals), True


def order_allowed(scene: Scene, claims: Claims, cell: int, heading: int, order: int) -> bool:
    """Return whether rules.md 4 allows an order (0-3 move, 4-7 wait) in a cell with a heading."""
    where, move = scene.cell(cell), Direction(order % WAIT)
    if move == Direction(heading).opposite or not scene.terrain.passable(where, move):
        return False
    return claims.kinds[where] == 0 or order == heading


def arrival(scene: Scene, claims: Claims, decision: Decision, order: int) -> tuple[int, int, int, bool]:
    """Return cell, heading and goal memory after an order, and whether a goal is reached."""
    if order >= WAIT:
        return decision.cell, decision.heading, decision.goal, False
    cell = scene.index(scene.target(scene.cell(decision.cell), Direction(order)))
    goal, reached = advanced(scene, claims, decision.goal, cell)
    return cell, order, goal, reached


def explore(scene: Scene, claims: Claims, start: Decision, table: Table, ledger: Ledger) -> Play:
    """Check every row of a strategy: its order, its turn, and that every answer of the obstacles has a row.

    Raises:
        LimitExceeded: there are more answers than can be checked.
    """
    before, size = ledger.total, len(table.orders)
    row = table.row(start)
    if row < 0:
        _refuse_missing(scene, table, start, ledger)
    nothing = np.zeros(size + 1, np.int64)
    empty = Play(table, row, nothing, nothing[:0], None, closed=False)
    if not _orders_allowed(scene, claims, table, ledger):
        return empty
    turns = turns_of(table, [scene.index(goal) for goal in claims.goals])
    _refuse_lost(scene, table, turns, ledger)
    answers = np.diff(turns.first)[turns.numbers].prod(axis=1, initial=1.0).sum()
    if answers > MOST_EDGES:
        raise LimitExceeded(f"the strategy has {answers:.3g} answers to its orders; at most {MOST_EDGES} are checked")
    counts = np.diff(turns.first)[turns.numbers].prod(axis=1, initial=1)
    first = np.concatenate([[0], np.cumsum(counts)])
    successors, missing = _successors(
        table.slots, table.keys, turns.poses, turns.numbers, turns.first, turns.states, first
    )
    for number in missing[:KEPT]:
        _refuse_answers(scene, claims, table, table.decision(int(number)), int(table.orders[number]), ledger)
    if ledger.total > before:
        return empty
    spare = int((~reached_from(first, successors, row)).sum())
    if spare:
        ledger.refuse("formats.md 2, navigation.npz", f"{spare} rows are reached by no play", times=spare)
    return Play(table, row, first, successors, turns, closed=not spare)


def _orders_allowed(scene: Scene, claims: Claims, table: Table, ledger: Ledger) -> bool:
    """Return whether every row's order is allowed; refuse the others."""
    legal = np.zeros((len(scene.sees), 4, 2 * WAIT), np.bool_)
    for cell in map(scene.index, scene.kinds):
        for heading in range(4):
            legal[cell, heading] = [order_allowed(scene, claims, cell, heading, order) for order in range(2 * WAIT)]
    known = (table.orders >= 0) & (table.orders < 2 * WAIT)
    wrong = ~known | ~legal[table.cells, table.headings, np.where(known, table.orders, 0)]
    if wrong.any():
        row = int(np.flatnonzero(wrong)[0])
        where, text = describe(scene, table.decision(row)), f"order {table.orders[row]} is not allowed"
        ledger.refuse("rules.md 4, orders", text, where, int(wrong.sum()))
    return not wrong.any()


def _refuse_lost(scene: Scene, table: Table, turns: Turns, ledger: Ledger) -> None:
    """Refuse rows whose move may end or begin where an obstacle may be, and rows without an answer."""
    lost = turns.lost[turns.numbers].any(axis=1)
    stuck = (np.diff(turns.first)[turns.numbers] == 0).any(axis=1)
    for wrong, rule, text in (
        (lost, "rules.md 4, collision", "an obstacle may be in the robot's old or new cell"),
        (stuck, "rules.md 4, dead end", "the obstacles have nowhere to go"),
    ):
        if wrong.any():
            where = describe(scene, table.decision(int(np.flatnonzero(wrong)[0])))
            ledger.refuse(rule, text, where, int(wrong.sum()))


@njit(cache=True)
def _successors(
    slots: Ints, keys: Ints, poses: Ints, numbers: Ints, turn_first: Ints, states: Ints, first: Ints
) -> tuple[Ints, Ints]:
    """Return the row after every combination of what the kinds do (-1: none), and the rows that lack some."""
    found, kinds = np.empty(first[-1], np.int32), numbers.shape[1]
    lacking, lacks = np.zeros(len(poses), np.bool_), np.empty(kinds, np.int64)
    key = np.empty(kinds + 1, np.int64)
    for row in range(len(poses)):
        key[0] = poses[row]
        lacks[:] = turn_first[numbers[row]]
        for edge in range(first[row], first[row + 1]):
            whole = True
            for kind in range(kinds):
                key[kind + 1] = states[lacks[kind]]
                whole &= key[kind + 1] >= 0
            found[edge] = row_of(slots, keys, key) if whole else -1
            lacking[row] |= found[edge] < 0
            for kind in range(kinds - 1, -1, -1):
                lacks[kind] += 1
                if lacks[kind] < turn_first[numbers[row, kind] + 1]:
                    break
                lacks[kind] = turn_first[numbers[row, kind]]
    return found, np.flatnonzero(lacking)


def _refuse_answers(scene: Scene, claims: Claims, table: Table, decision: Decision, order: int, ledger: Ledger) -> None:
    """Refuse the first answer to a decision that has no row."""
    cell, heading, goal, _ = arrival(scene, claims, decision, order)
    turned = table.obstacles.turn(decision.known, decision.cell, cell, waits=order >= WAIT)
    for known in product(*turned.kinds):
        after = Decision(cell, heading, known, goal)
        if table.row(after) < 0:
            _refuse_missing(scene, table, after, ledger)
            return


def _refuse_missing(scene: Scene, table: Table, decision: Decision, ledger: Ledger) -> None:
    """Refuse a reached decision without a row; say when only the belief differs."""
    where = describe(scene, decision)
    same = (table.cells == decision.cell) & (table.headings == decision.heading) & (table.goals == decision.goal)
    for row in np.flatnonzero(same):
        other = table.decision(int(row)).known
        if all(one.visible == two.visible for one, two in zip(other, decision.known, strict=True)):
            narrower = all(set(one.hidden) <= set(two.hidden) for one, two in zip(other, decision.known, strict=True))
            believed = [[scene.cell(cell) for cell in part.hidden] for part in decision.known]
            text = f"the belief is {believed}; the strategy knows {'a narrower' if narrower else 'another'} one"
            ledger.refuse("rules.md 4, belief", text, where)
            return
    ledger.refuse("rules.md 4, dead end", "a reached decision has no row", where)

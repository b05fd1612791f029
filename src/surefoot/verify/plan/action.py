"""Checks a saved action strategy against rules.md 5: every state, every outcome, every next context."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from surefoot.frames import Direction
from surefoot.verify.artefacts import PlanFile
from surefoot.verify.findings import Ledger
from surefoot.verify.graphs import components, cyclic
from surefoot.verify.navigation.claims import ORDERS, Claims
from surefoot.verify.plan.moves import (
    FINE,
    FOREIGN_BORDER,
    LOST_CROSSING,
    NO_ROW,
    NOT_ALLOWED,
    NOWHERE,
    SIDE_BAND,
    STAIRS_FOOT,
    STAIRS_HEADING,
    STEP_HEIGHT,
    Rules,
    allowed,
    foreign_kept,
    landed,
    moved,
    outcome_limits,
    rules_of,
)
from surefoot.verify.scene.derived import STOP

Array = NDArray[Any]
Core = tuple[int, int, int, int, int]
_KEPT = 16
BORDERS, UNKNOWN = 6, 5
_BROKEN = {
    LOST_CROSSING: ("crossing", "a border other than the ordered one may be crossed"),
    SIDE_BAND: ("side band", "the position may come into the side band at a cardinal heading"),
    STAIRS_HEADING: ("stairs", "a move may start or end on stairs without a heading along them"),
    STAIRS_FOOT: ("stairs", "a foot may stand too close to a riser"),
    STEP_HEIGHT: ("stairs", "the height change of a move may be too large"),
    NO_ROW: ("dead end", "a reached state has no row"),
    NOT_ALLOWED: ("actions", "the action is not allowed"),
    FOREIGN_BORDER: ("foreign borders", "a pending turn may come too close to a foreign border"),
}


@dataclass(frozen=True, slots=True)
class ActionTable:
    """The rows of ``action.npz``, sorted by context, then by state.

    Attributes:
        rules: the numbers of the game.
        keys: (M,) ascending codes of state and context.
        cores: (M, 5) row, column, heading, stance and mode.
        contexts: (M,).
        actions: (M,).
    """

    rules: Rules
    keys: Array
    cores: Array
    contexts: Array
    actions: Array

    def row(self, core: Core, context: int) -> int:
        """Return the row of a state, -1 where there is none."""
        return int(find(self.rules, self.keys, core, context))


def read_action_table(plan: PlanFile, claims: Claims, ledger: Ledger) -> ActionTable | None:
    """Read the rows of an action strategy; None when some are malformed."""
    rules, arrays = rules_of(claims), plan.action
    names = ("row", "column", "heading", "stance", "mode")
    cores = np.stack([arrays[name] for name in names], axis=1).astype(np.int64)
    contexts, n, steps = arrays["context"].astype(np.int64), rules.sizes[0], rules.sizes[2]
    limits = np.array([n, n, 4 * steps, 2, 7])
    wrong = (cores < 0).any(axis=1) | (cores >= limits).any(axis=1) | (contexts < 0) | (contexts >= len(rules.order))
    wrong |= (cores[:, 4] <= 2) != (cores[:, 2] % steps == 0)
    if wrong.any():
        row = int(np.flatnonzero(wrong)[0])
        ledger.refuse("rules.md 5, state", "holds values that no state has", f"action.npz row {row}", int(wrong.sum()))
        return None
    keys = _codes(rules, cores, contexts)
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    if (keys[1:] == keys[:-1]).any():
        ledger.refuse("formats.md 2, action.npz", "a state has two rows", "action.npz")
        return None
    return ActionTable(rules, keys, cores[order], contexts[order], arrays["action"].astype(np.int64)[order])


def _codes(rules: Rules, cores: Array, contexts: Array) -> Array:
    """Return one number per state and context."""
    n, steps = rules.sizes[0], rules.sizes[2]
    codes = contexts
    for column, size in enumerate((n, n, 4 * steps, 2, 7)):
        codes = codes * size + cores[:, column]
    return codes


def start_core(claims: Claims) -> Core:
    """Return the first state of every walk: standing, stance left."""
    return (claims.fine[0], claims.fine[1], int(claims.heading) * claims.turn_steps, 0, 0)


def check_action(claims: Claims, table: ActionTable, contexts: list[int], ledger: Ledger) -> None:
    """Follow the strategy from the start, and from every other row, through every outcome and every next context.

    Args:
        claims: the plan's numbers.
        table: its action strategy.
        contexts: the first ones that are possible.
        ledger: takes findings and counts.
    """
    core = start_core(claims)
    _check_start(table.rules, core, claims, ledger)
    rows = np.array([table.row(core, context) for context in contexts], np.int64)
    for context, row in zip(contexts, rows, strict=True):
        if row < 0:
            ledger.refuse("rules.md 5, dead end", "a first context has no row", describe(claims, core, context))
    states, first, successors, broken, samples, achieved = _explore(
        table.rules, table.keys, table.cores, table.contexts, table.actions, rows[rows >= 0]
    )
    from_start = len(np.unique(states[states % BORDERS != UNKNOWN] // BORDERS))
    ledger.counts["action_states"], ledger.counts["action_rows"] = from_start, len(table.keys)
    ledger.counts["orders_achieved"] = int(achieved)
    for code, (name, text) in _BROKEN.items():
        for row, sagittal, lateral, context in [tuple(int(v) for v in s[1:]) for s in samples if s[0] == code][:3]:
            where = describe(claims, _core(table, row), int(table.contexts[row]))
            where += f", action {int(table.actions[row])}, outcome ({sagittal}, {lateral})"
            where += f", then {_context_name(claims, context)}" if context >= 0 else ""
            ledger.refuse(f"rules.md 5, {name}", text, where)
        ledger.total += max(0, int(broken[code]) - min(3, int((samples[:, 0] == code).sum())))
    if not broken.any():
        _check_liveness(claims, table, states, first, successors, ledger)


def _check_start(rules: Rules, core: Core, claims: Claims, ledger: Ledger) -> None:
    """Refuse a start in the side band."""
    n, band = int(rules.sizes[0]), int(rules.sizes[1])
    aside = core[1] if int(claims.heading) % 2 == 0 else core[0]
    if not band <= aside < n - band:
        ledger.refuse("rules.md 5, side band", "the start lies in the side band", f"fine cell {core[:2]}")


def _check_liveness(
    claims: Claims, table: ActionTable, states: Array, first: Array, successors: Array, ledger: Ledger
) -> None:
    """Refuse cycles without an achieved order; count the longest way to an achieved order."""
    use = np.ones(len(successors), np.bool_)
    component = components(first, successors, use)
    for number in np.flatnonzero(cyclic(first, successors, use, component))[:3]:
        row = int(states[int(np.flatnonzero(component == number)[0])]) // BORDERS
        where = describe(claims, _core(table, row), int(table.contexts[row]))
        ledger.refuse("rules.md 5, goal", "the robot may walk for ever without achieving its order", where)
    ledger.counts["most_steps_an_order"] = int(_longest(first, successors, np.argsort(component, kind="stable")))


def _core(table: ActionTable, row: int) -> Core:
    row_, column, heading, stance, mode = (int(value) for value in table.cores[row])
    return row_, column, heading, stance, mode


def _context_name(claims: Claims, context: int) -> str:
    here, order, there = claims.contexts[context]
    return f"order {ORDERS[order]} from profile {here} to {there}"


def describe(claims: Claims, core: Core, context: int) -> str:
    """Return a state as text."""
    row, column, heading, stance, mode = core
    degrees = heading * 90 / claims.turn_steps
    name = Direction(round(degrees // 90)).name.lower()
    return (
        f"fine cell ({row}, {column}), heading {heading} ({name} + {degrees % 90:g} degrees), "
        f"stance {('left', 'right')[stance]}, mode {mode}, {_context_name(claims, context)}"
    )


@njit(cache=True)
def find(rules: Rules, keys: Array, core: Core, context: int) -> int:
    """Return the row of a state and context, -1 where there is none."""
    n, steps = rules.sizes[0], rules.sizes[2]
    key = (context * n + core[0]) * n + core[1]
    key = ((key * 4 * steps + core[2]) * 2 + core[3]) * 7 + core[4]
    place = np.searchsorted(keys, key)
    return place if place < len(keys) and keys[place] == key else -1


@njit(cache=True)
def follows(rules: Rules, context: int, kind: int, last: int) -> bool:
    """Return whether a context may follow in a cell of a kind, after moving in a direction."""
    order = rules.order[context]
    return bool(rules.here[context] == kind and (order == STOP or order != (last + 2) % 4))


@njit(cache=True)
def _explore(
    rules: Rules, keys: Array, cores: Array, contexts: Array, actions: Array, starts: Array
) -> tuple[Array, Array, Array, Array, Array, int]:
    """Return the reached states, edges without an achieved order, what is broken and where, and the orders achieved.

    A state is row * BORDERS + the border last crossed. Rows that the start does not lead to are followed too; which
    border they crossed last is unknown.
    """
    number = np.full(len(keys) * BORDERS, -1, np.int32)
    states = np.empty(len(keys) * BORDERS, np.int64)
    offsets = np.zeros(len(keys) * BORDERS + 1, np.int64)
    edges = np.empty(max(16, len(keys) * 4), np.int64)
    broken = np.zeros(16, np.int64)
    samples = np.zeros((_KEPT * 16, 5), np.int64)
    count, used, done, achieved_count, spare = 0, 0, 0, 0, 0
    visited = np.zeros(len(keys), np.bool_)
    for row in starts:
        if not visited[row]:
            visited[row] = True
            number[row * BORDERS + NOWHERE] = count
            states[count] = row * BORDERS + NOWHERE
            count += 1
    while True:
        if done == count:
            while spare < len(keys) and visited[spare]:
                spare += 1
            if spare == len(keys):
                break
            visited[spare] = True
            number[spare * BORDERS + UNKNOWN] = count
            states[count] = spare * BORDERS + UNKNOWN
            count += 1
        row, last = states[done] // BORDERS, states[done] % BORDERS
        core = (cores[row, 0], cores[row, 1], cores[row, 2], cores[row, 3], cores[row, 4])
        context, action = contexts[row], actions[row]
        order = rules.order[context]
        if allowed(rules, core[2], core[3], core[4], order, action):
            far, wide = outcome_limits(rules, core, rules.here[context], action)
        else:
            far, wide = -1, -1
            _note(broken, samples, NOT_ALLOWED, row, 0, 0, -1)
        for choice in range(-far, far + 1):
            for aside in range(-wide, wide + 1):
                after = moved(rules, core, order, action, choice, aside)
                status, achieved, crossed = landed(rules, core, context, action, after)
                if status != FINE:
                    _note(broken, samples, status, row, choice, aside, -1)
                    continue
                n, border = rules.sizes[0], last if crossed == NOWHERE else (crossed + 2) % 4
                core_after = (after[0] % n, after[1] % n, after[2], after[3], after[4])
                kind = rules.there[context] if crossed != NOWHERE else rules.here[context]
                moved_to = crossed if crossed != NOWHERE else after[2] // rules.sizes[2]
                for following in range(len(rules.order)):
                    if achieved and not follows(rules, following, kind, moved_to):
                        continue
                    if not achieved and following != context:
                        continue
                    if border != UNKNOWN and not foreign_kept(rules, core_after, rules.order[following], border):
                        _note(broken, samples, FOREIGN_BORDER, row, choice, aside, following)
                        continue
                    target = find(rules, keys, core_after, following)
                    if target < 0:
                        _note(broken, samples, NO_ROW, row, choice, aside, following)
                        continue
                    code = target * BORDERS + border
                    visited[target] = True
                    if number[code] < 0:
                        number[code] = count
                        states[count] = code
                        count += 1
                    if achieved:
                        achieved_count += 1
                        continue
                    if used == len(edges):
                        edges = np.append(edges, np.empty(used, np.int64))
                    edges[used] = number[code]
                    used += 1
        done += 1
        offsets[done] = used
    return states[:count], offsets[: count + 1], edges[:used], broken, samples, achieved_count


@njit(cache=True)
def _note(broken: Array, samples: Array, code: int, row: int, sagittal: int, lateral: int, context: int) -> None:
    """Count a broken rule and keep the first few places."""
    if broken[code] < _KEPT:
        place = code * _KEPT + broken[code]
        samples[place, 0], samples[place, 1], samples[place, 2] = code, row, sagittal
        samples[place, 3], samples[place, 4] = lateral, context
    broken[code] += 1


@njit(cache=True)
def _longest(first: Array, successors: Array, order: Array) -> int:
    """Return the most edges, plus one, of a path in an acyclic graph whose nodes come after their successors."""
    steps = np.ones(len(order), np.int64)
    for node in order:
        for edge in range(first[node], first[node + 1]):
            if successors[edge] != node:
                steps[node] = max(steps[node], 1 + steps[successors[edge]])
    return steps.max() if len(steps) else 0

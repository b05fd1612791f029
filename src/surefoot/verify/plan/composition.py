"""Checks that the two strategies fit together (rules.md 5, composition), on the product of both."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from surefoot.frames import Direction
from surefoot.verify.findings import Ledger
from surefoot.verify.navigation.claims import ORDERS, Claims
from surefoot.verify.navigation.decisions import WAIT
from surefoot.verify.navigation.play import Play
from surefoot.verify.plan.action import ActionTable, Core, describe
from surefoot.verify.plan.moves import FINE, NOWHERE, OFFSETS, Rules, allowed, landed, moved, outcome_limits
from surefoot.verify.row_index import numbered
from surefoot.verify.scene.derived import STOP, Scene

MOST_STATES = 30_000_000
Array = NDArray[Any]
Stage = tuple[int, int, int]


def check_composition(scene: Scene, claims: Claims, play: Play, table: ActionTable, core: Core, ledger: Ledger) -> None:
    """Walk the product of navigation and action strategy.

    Navigation decisions that give the same order in the same cell with the same heading are taken together, which only
    adds plays. Every fine step of every order is walked in coordinates of the whole grid, so that a finished order is
    seen to have moved the robot by exactly one cell (or none, for stop), and every pair of consecutive orders is looked
    up among the contexts. ``core`` is the state in which the play begins.
    """
    stages, first, successors = _stages(play)
    contexts = np.array([context_of(scene, claims, stage[0], stage[2]) for stage in stages], np.int64)
    for stage, context in zip(stages, contexts, strict=True):
        if context < 0:
            text = (
                f"order {ORDERS[_fine_order(stage[2])]} in cell {scene.cell(stage[0])} is no context of the action game"
            )
            ledger.refuse("rules.md 5, composition (1)", text)
    _check_pairs(scene, stages, first, successors, ledger)
    ledger.counts["order_pairs"] = len(successors)
    if (contexts < 0).any():
        return
    blocks = np.searchsorted(table.contexts, np.arange(len(claims.contexts) + 1))
    cells = np.array([scene.cell(stage[0]) for stage in stages], np.int64)
    start = table.row(core, int(contexts[0]))
    if start < 0:
        ledger.refuse("rules.md 5, composition", "the first order has no row in the action strategy")
        return
    size = int((blocks[contexts + 1] - blocks[contexts]).sum())
    ledger.counts["product_is_whole"] = size <= MOST_STATES
    visited, failed, at_stage, row = _walk(
        table.rules, table.keys, table.cores, table.contexts, table.actions, blocks, contexts, cells, first, successors,
        start, min(size, MOST_STATES),
    )  # fmt: skip
    ledger.counts["product_states"] = int(visited)
    if failed:
        row_, column, heading, stance, mode = (int(value) for value in table.cores[row])
        where = describe(claims, (row_, column, heading, stance, mode), int(table.contexts[row]))
        text = {
            1: "an order ends in another cell than the navigation strategy expects",
            2: "a state of the product has no row in the action strategy",
            3: "a move of the product is lost",
        }[int(failed)]
        ledger.refuse("rules.md 5, composition (2)", text, f"cell {scene.cell(stages[int(at_stage)][0])}, {where}")


def _stages(play: Play) -> tuple[list[Stage], Array, Array]:
    """Return the distinct (cell, heading, order) of a play, the start first, and which follow which."""
    table = play.table
    keys = np.stack([table.cells, table.headings, table.orders], axis=1)
    from_start = np.concatenate([[play.start], np.arange(len(keys))])
    numbers, firsts = numbered(keys[from_start])
    of_node, size = numbers[1:], len(firsts)
    pairs = np.zeros(size * size, np.bool_)
    pairs[np.repeat(of_node, np.diff(play.first)) * size + of_node[play.successors]] = True
    after, follows = np.nonzero(pairs.reshape(size, size))
    first = np.concatenate([[0], np.cumsum(np.bincount(after, minlength=size))])
    stages = [(int(cell), int(heading), int(order)) for cell, heading, order in keys[from_start][firsts]]
    return stages, first.astype(np.int64), follows.astype(np.int64)


def _fine_order(order: int) -> int:
    """Return the order of the action game that carries out an order of the navigation game."""
    return STOP if order >= WAIT else order


def context_of(scene: Scene, claims: Claims, cell_index: int, navigation_order: int) -> int:
    """Return the context of an order of the navigation game, -1 where the action game admits none."""
    cell, order = scene.cell(cell_index), _fine_order(navigation_order)
    there = cell if order == STOP else scene.target(cell, Direction(order))
    context = (claims.kinds[cell], order, claims.kinds.get(there, -1))
    return claims.contexts.index(context) if context in claims.contexts else -1


def _check_pairs(scene: Scene, stages: list[Stage], first: Array, successors: Array, ledger: Ledger) -> None:
    """Refuse an order that goes back where the last one came from."""
    for number, (cell, heading, order) in enumerate(stages):
        last = heading if order >= WAIT else order
        for edge in range(first[number], first[number + 1]):
            after = stages[successors[edge]]
            if after[1] != last or (after[2] < WAIT and after[2] == (last + 2) % 4):
                text = f"after going {ORDERS[last]} in cell {scene.cell(cell)} comes order {after[2]}"
                ledger.refuse("rules.md 5, composition (1)", text)


@njit(cache=True)
def _walk(
    rules: Rules,
    keys: Array,
    cores: Array,
    row_contexts: Array,
    actions: Array,
    blocks: Array,
    contexts: Array,
    cells: Array,
    first: Array,
    successors: Array,
    start: int,
    most: int,
) -> tuple[int, int, int, int]:
    """Return how many product states were walked, what failed or 0, and where: stage and row."""
    bases = np.zeros(len(contexts) + 1, np.int64)
    for stage in range(len(contexts)):
        bases[stage + 1] = bases[stage] + blocks[contexts[stage] + 1] - blocks[contexts[stage]]
    seen = np.zeros(bases[-1], np.bool_)
    stages, rows = np.empty(most + 1, np.int32), np.empty(most + 1, np.int32)
    stages[0], rows[0], count, done = 0, start, 1, 0
    seen[bases[0] + start - blocks[contexts[0]]] = True
    while done < count:
        stage, row = stages[done], rows[done]
        done += 1
        core = (cores[row, 0], cores[row, 1], cores[row, 2], cores[row, 3], cores[row, 4])
        context, action = row_contexts[row], actions[row]
        if not allowed(rules, core[2], core[3], core[4], rules.order[context], action):
            return done, 3, stage, row
        far, wide = outcome_limits(rules, core, rules.here[context], action)
        for choice in range(-far, far + 1):
            for aside in range(-wide, wide + 1):
                after = moved(rules, core, rules.order[context], action, choice, aside)
                status, achieved, _ = landed(rules, core, context, action, after)
                if status != FINE:
                    return done, 3, stage, row
                row_after = cells[stage, 0] + after[0] // rules.sizes[0]
                column_after = cells[stage, 1] + after[1] // rules.sizes[0]
                if not achieved:
                    failed, count = _enter(
                        rules, keys, blocks, contexts, bases, seen, stages, rows, count, most, stage, after
                    )  # fmt: skip
                    if failed or not _is_cell(cells[stage], row_after, column_after):
                        return done, 2 if failed else 1, stage, row
                    continue
                for edge in range(first[stage], first[stage + 1]):
                    following = successors[edge]
                    if not _is_cell(cells[following], row_after, column_after) or not _is_ordered(
                        rules.order[context], cells[stage], row_after, column_after
                    ):
                        return done, 1, stage, row
                    failed, count = _enter(
                        rules, keys, blocks, contexts, bases, seen, stages, rows, count, most, following, after
                    )  # fmt: skip
                    if failed:
                        return done, 2, stage, row
    return done, 0, 0, 0


@njit(cache=True)
def _is_cell(cell: Array, row: int, column: int) -> bool:
    """Return whether a coarse cell is the one at a row and column."""
    return bool(cell[0] == row and cell[1] == column)


@njit(cache=True)
def _is_ordered(order: int, cell: Array, row: int, column: int) -> bool:
    """Return whether a row and column are where an order that is given in a cell has to end."""
    if order == NOWHERE:
        return _is_cell(cell, row, column)
    return _is_cell(cell, row - OFFSETS[order, 0], column - OFFSETS[order, 1])


@njit(cache=True)
def _enter(
    rules: Rules,
    keys: Array,
    blocks: Array,
    contexts: Array,
    bases: Array,
    seen: Array,
    stages: Array,
    rows: Array,
    count: int,
    most: int,
    stage: int,
    core: tuple[int, int, int, int, int],
) -> tuple[bool, int]:
    """Note a product state; return whether it lacks a row, and how many are noted."""
    n, steps, context = rules.sizes[0], rules.sizes[2], contexts[stage]
    key = (context * n + core[0] % n) * n + core[1] % n
    key = ((key * 4 * steps + core[2]) * 2 + core[3]) * 7 + core[4]
    row = np.searchsorted(keys, key)
    if row == len(keys) or keys[row] != key:
        return True, count
    place = bases[stage] + row - blocks[context]
    if not seen[place] and count <= most:
        seen[place] = True
        stages[count], rows[count] = stage, row
        count += 1
    return False, count

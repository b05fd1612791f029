"""Compiled exploration of the navigation game's graph.

A node is a pair: 16 * (4 * cell + heading) + order + 1, and a number of an obstacle state. Orders are -1 for a decision
of the robot, 0-3 moves, 4-7 declared waits, and 8 for what all waits in one place have in common: the obstacles'
answer. A move's node has the heading of the move, whatever the heading before it was.

An obstacle state is a chain: the number of (state of the kinds before, what is known of the last kind), from -1.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from surefoot.navigation._interning import FULL, Masks, Pairs, find, put
from surefoot.navigation._observation_kernel import DONE, Scratch, observe_kind, unpack
from surefoot.navigation._world_arrays import World, has

STATES_FULL, SEEN_FULL, NODES_FULL, EDGES_FULL, FRONT_FULL, PAUSED = 5, 6, 7, 8, 9, 10
DECISION, ANSWER = -1, 8
NODES_A_CALL = 50_000


class Tables(NamedTuple):
    """Everything that grows.

    ``seen`` are the observations that were worked out: (2 * known + robot stands, view), with their ``begin`` and
    ``end`` in ``outcomes``. ``blocked`` is the direction of a wait in vain, else -1.
    """

    masks: Masks
    known: Pairs
    states: Pairs
    seen: Pairs
    begin: NDArray[np.int64]
    end: NDArray[np.int64]
    outcomes: NDArray[np.int32]
    scratch: Scratch
    nodes: Pairs
    blocked: NDArray[np.int8]
    first: NDArray[np.int64]
    edges: NDArray[np.int32]
    front: NDArray[np.int64]


@njit(cache=True)
def explore(world: World, tables: Tables, progress: NDArray[np.int64]) -> int:
    """Give nodes their successors, in the order of their numbers.

    A node for which there is no room is begun again in the next call; what it left in the tables is found then.

    Args:
        world: the problem.
        tables: what was found so far; the first node is there.
        progress: numbers of finished nodes, of their edges and of observed outcomes; updated.

    Returns:
        DONE, PAUSED after so many nodes, or which table is full.
    """
    last = progress[0] + NODES_A_CALL
    while progress[0] < tables.nodes.used[0]:
        if progress[0] == last:
            return PAUSED
        node = progress[0]
        if node + 1 >= tables.first.size or node >= tables.blocked.size:
            return NODES_FULL
        code, state = tables.nodes.left[node], tables.nodes.right[node]
        order = code % 16 - 1
        if order == DECISION:
            status, used = _decide(world, tables, progress[1], code // 64, code // 16 % 4, state)
        elif 4 <= order < ANSWER:
            status, used = _wait(tables, progress[1], code, state)
            blocks = _is_blocked(world, tables, code // 64, order - 4, state)
            tables.blocked[node] = order - 4 if blocks else -1
        else:
            status, used = _answer(world, tables, progress, code // 64, code // 16 % 4, order, state)
        if status != DONE:
            return status
        progress[0], progress[1] = node + 1, used
        tables.first[node + 1] = used
    return DONE


@njit(cache=True)
def _decide(world: World, tables: Tables, used: int, cell: int, heading: int, state: int) -> tuple[int, int]:
    """Append the robot's orders: moves that cannot collide, and waits; on stairs only straight on."""
    for order in range(8):
        move = order % 4
        goal = world.target[cell, move]
        if goal < 0 or move == (heading + 2) % 4 or (world.stairs[cell] and order != heading):
            continue
        if order < 4 and _is_threatened(world, tables, cell, move, state):
            continue
        place = cell * 4 + (move if order < 4 else heading)
        status, used = _append(tables, used, 16 * place + order + 1, state)
        if status != DONE:
            return status, used
    return DONE, used


@njit(cache=True)
def _wait(tables: Tables, used: int, code: int, state: int) -> tuple[int, int]:
    """Append the obstacles' answer, common to all waits in one place."""
    return _append(tables, used, code // 16 * 16 + ANSWER + 1, state)


@njit(cache=True)
def _append(tables: Tables, used: int, code: int, state: int) -> tuple[int, int]:
    node = put(tables.nodes, code, state)
    if node == FULL:
        return NODES_FULL, used
    if used == tables.edges.size:
        return EDGES_FULL, used
    tables.edges[used] = node
    return DONE, used + 1


@njit(cache=True)
def _is_threatened(world: World, tables: Tables, cell: int, move: int, state: int) -> bool:
    """Return whether some obstacle may be where it threatens a move: the collision guarantee forbids the move."""
    visible = np.empty(world.obstacles.max() if world.obstacles.size else 0, np.int64)
    for kind in range(world.obstacles.size - 1, -1, -1):
        now = tables.states.right[state]
        state = tables.states.left[state]
        danger = world.threats[kind, cell, move]
        for obstacle in range(unpack(tables.known.left[now], world.part_of.size + 1, visible)):
            if has(danger, visible[obstacle]):
                return True
        hidden = tables.masks.words[tables.known.right[now] // world.obstacles.size]
        for word in range(hidden.size):
            if hidden[word] & danger[word]:
                return True
    return False


@njit(cache=True)
def _is_blocked(world: World, tables: Tables, cell: int, move: int, state: int) -> bool:
    """Return whether obstacles block the awaited move although they could make way (rules.md 4, assumption (c)).

    Without the escape clause every threat counts, visible or believed.
    """
    if not world.escape_clause:
        return _is_threatened(world, tables, cell, move, state)
    visible = np.empty(world.obstacles.max() if world.obstacles.size else 0, np.int64)
    for kind in range(world.obstacles.size - 1, -1, -1):
        now = tables.states.right[state]
        state = tables.states.left[state]
        danger = world.threats[kind, cell, move]
        clears, shows = world.can_clear[kind, cell, move], world.can_show[kind, cell, move]
        for obstacle in range(unpack(tables.known.left[now], world.part_of.size + 1, visible)):
            if has(danger, visible[obstacle]) and has(clears, visible[obstacle]):
                return True
        hidden = tables.masks.words[tables.known.right[now] // world.obstacles.size]
        threatens, all_show = False, True
        for word in range(hidden.size):
            threatens |= hidden[word] & danger[word] != 0
            all_show &= hidden[word] & ~shows[word] == 0
        if threatens and all_show:
            return True
    return False


@njit(cache=True)
def _answer(
    world: World, tables: Tables, progress: NDArray[np.int64], cell: int, heading: int, order: int, state: int
) -> tuple[int, int]:
    """Append the decisions that follow when the obstacles answer a move or a wait."""
    used = progress[1]
    waits = order == ANSWER
    arrival = cell if waits else world.target[cell, order]
    view = arrival if world.post else cell
    kinds = world.obstacles.size
    now = np.empty(kinds, np.int64)
    for kind in range(kinds - 1, -1, -1):
        now[kind] = tables.states.right[state]
        state = tables.states.left[state]
    # The states of the kinds so far stand in the front, those with one kind more behind them.
    begin, end = 0, 1
    tables.front[0] = -1
    for kind in range(kinds):
        status, entry = _observed(world, tables, progress, kind, now[kind], view, world.bit_of[cell] if waits else -1)
        if status != DONE:
            return status, used
        filled = end
        for before in range(begin, end):
            for place in range(tables.begin[entry], tables.end[entry]):
                if filled == tables.front.size:
                    return FRONT_FULL, used
                after = put(tables.states, tables.front[before], np.int64(tables.outcomes[place]))
                if after == FULL:
                    return STATES_FULL, used
                tables.front[filled] = after
                filled += 1
        begin, end = end, filled
    code = 16 * (4 * arrival + heading)
    for place in range(begin, end):
        status, used = _append(tables, used, code, tables.front[place])
        if status != DONE:
            return status, used
    return DONE, used


@njit(cache=True)
def _observed(
    world: World, tables: Tables, progress: NDArray[np.int64], kind: int, now: int, view: int, barred: int
) -> tuple[int, int]:
    """Return the entry of ``seen`` for one kind's observations, working them out the first time."""
    left = 2 * now + (1 if barred >= 0 else 0)
    entry = find(tables.seen, left, view)
    if entry >= 0:
        return DONE, entry
    if tables.seen.used[0] >= tables.begin.size:
        return SEEN_FULL, -1
    status, filled = observe_kind(
        world, tables.masks, tables.known, tables.scratch, tables.outcomes, progress[2], kind, now, view, barred
    )
    if status != DONE:
        return status, -1
    entry = put(tables.seen, left, view)
    tables.begin[entry], tables.end[entry] = progress[2], filled
    progress[2] = filled
    return DONE, entry

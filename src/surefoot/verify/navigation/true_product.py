"""Check (2) of rules.md 4: strategy, belief and the true obstacles together; the goals always stay within reach."""

from __future__ import annotations

from math import comb
from typing import NamedTuple

import numpy as np
from numba import njit

from surefoot.verify.findings import Ledger
from surefoot.verify.graphs import can_reach
from surefoot.verify.navigation.belief import Obstacles
from surefoot.verify.navigation.belief_turn import Ints, has, inserted, listed
from surefoot.verify.navigation.decisions import WAIT, Table, describe
from surefoot.verify.navigation.play import Play
from surefoot.verify.navigation.turns import Turns
from surefoot.verify.row_index import place_of, row_of, slots_of

MOST_EDGES = 20_000_000


class Steps(NamedTuple):
    """What the true obstacles can do and what is seen of them, as arrays; kinds stand one after the other.

    Attributes:
        kind: (obstacles,) kind of each.
        after: (bars, kinds, places, most) where an obstacle may be after a turn; bar 0: the robot moves.
        ends: (bars, kinds, places) how many there are.
        bars: (N,) of every row.
        seen: (views, words).
        views: (N,) of every row.
        codes: visible cells of every piece of knowledge.
        sets: where hidden obstacles may be, for every piece of knowledge.
        offsets: (kinds,) first piece of knowledge of each kind.
        digit_bits: of a code.
    """

    kind: Ints
    after: Ints
    ends: Ints
    bars: Ints
    seen: Ints
    views: Ints
    codes: Ints
    sets: Ints
    offsets: Ints
    digit_bits: int


def check_true_obstacles(play: Play, starts: list[int], ledger: Ledger) -> None:
    """Walk the product of a closed play with the true obstacles.

    A product that is too large is left out, and the counts say so: check (2) then rests on the argument of rules.md 4,
    by which it follows from the goals being reached under assumption (c).

    Args:
        play: every play of the strategy.
        starts: the obstacles' start cells.
        ledger: takes the findings.
    """
    table = play.table
    obstacles = table.obstacles
    whole = _most_edges(table) <= MOST_EDGES
    ledger.counts["true_product_is_whole"] = whole
    if not whole or play.turns is None:
        return
    members = [member for kind in obstacles.kinds for member in kind.members]
    truths = np.array([obstacles.place[starts[member]] for member in members], np.int64)
    states, first, successors, stray = _walk(
        _steps(table, play.turns), play.start, truths, table.keys, table.slots, play.turns.poses,
        play.turns.numbers, play.turns.first, play.turns.states,
    )  # fmt: skip
    ledger.counts["true_product_states"] = len(states)
    if len(stray):
        where = _describe(table, stray)
        ledger.refuse("rules.md 4, belief", "an obstacle goes where the belief says it cannot be", where)
        return
    # A goal is reached by a move: whether the memory advances depends on the robot's move, not on the obstacles.
    stuck = ~can_reach(first, successors, play.turns.advances[states[:, 0]])
    if stuck.any():
        where = _describe(table, states[int(np.flatnonzero(stuck)[0])])
        ledger.refuse("rules.md 4, check (2)", "no goal can be reached any more", where, times=int(stuck.sum()))


def _most_edges(table: Table) -> int:
    """Return a bound on the edges of the product: where hidden obstacles may be, and where each may go."""
    configurations, ways = np.ones(len(table.orders)), 1.0
    for kind, (states, field) in enumerate(zip(table.kinds, table.obstacles.fields, strict=True)):
        sizes = np.bitwise_count(states.sets.astype(np.uint64)).sum(axis=1)[states.keys[:, 1]]
        hidden = (states.visible < 0).sum(axis=1)
        own = [
            comb(int(size) + int(count) - 1, int(count)) if count else 1
            for size, count in zip(sizes, hidden, strict=True)
        ]
        configurations *= np.array(own, float)[table.keys[:, kind + 1]]
        ways *= float(2 * field.speed * (field.speed + 1) + 1) ** field.members
    return int(min(configurations.sum() * ways, 2**62))


def _steps(table: Table, turns: Turns) -> Steps:
    """Return what the true obstacles can do in every row."""
    obstacles = table.obstacles
    waits = table.orders >= WAIT
    standing, numbers = np.unique(table.cells[waits], return_inverse=True)
    bars = np.zeros(len(waits), np.int64)
    bars[waits] = 1 + numbers
    options = [_options(obstacles, barred) for barred in (None, *(int(cell) for cell in standing))]
    after, ends = (np.stack(parts) for parts in zip(*options, strict=True))
    viewers, views = np.unique(turns.viewers, return_inverse=True)
    lengths = [len(states.keys) for states in table.kinds]
    return Steps(
        kind=np.repeat(np.arange(len(obstacles.kinds)), [len(kind.members) for kind in obstacles.kinds]),
        after=after,
        ends=ends,
        bars=bars,
        seen=np.stack([obstacles.seen_from(int(cell)) for cell in viewers]),
        views=views.ravel(),
        codes=np.concatenate([states.keys[:, 0] for states in table.kinds]),
        sets=np.concatenate([states.sets[states.keys[:, 1]] for states in table.kinds]),
        offsets=np.cumsum([0, *lengths[:-1]]),
        digit_bits=obstacles.fields[0].digit_bits,
    )


def _options(obstacles: Obstacles, barred: int | None) -> tuple[Ints, Ints]:
    """Return where an obstacle of each kind may be after a turn from each place, and how many places there are."""
    size, fastest = len(obstacles.domain), max(kind.speed_cells for kind in obstacles.kinds)
    most = 2 * fastest * (fastest + 1) + 1
    after = np.zeros((len(obstacles.kinds), size, most), np.int64)
    ends = np.zeros((len(obstacles.kinds), size), np.int64)
    for number, kind in enumerate(obstacles.kinds):
        for cell in kind.domain:
            near = [obstacles.place[other] for other in obstacles.next_of(number, cell, barred)]
            after[number, obstacles.place[cell], : len(near)] = near
            ends[number, obstacles.place[cell]] = len(near)
    return after, ends


@njit(cache=True)
def _walk(
    steps: Steps,
    start: int,
    truths: Ints,
    keys: Ints,
    slots: Ints,
    poses: Ints,
    numbers: Ints,
    turn_first: Ints,
    turn_states: Ints,
) -> tuple[Ints, Ints, Ints, Ints]:
    """Return the reached states (row, code of the true cells per kind), their edges, and a state no belief covers.

    The places of ``truths`` stand kind by kind. The last result is empty when every belief covers the truth.
    """
    obstacles, kinds = len(truths), numbers.shape[1]
    states, index = np.empty((1024, 1 + kinds), np.int64), np.full(4096, -1, np.int64)
    offsets, edges, used = np.zeros(1025, np.int64), np.empty(4096, np.int32), 0
    states[0, 0] = start
    _encode(steps, truths, states[0])
    shown, shown_slots = _shown(steps, numbers, turn_first, turn_states)
    index[place_of(index, states, states[0])], count, done = 0, 1, 0
    choice, after, key = np.zeros(obstacles, np.int64), np.empty(obstacles, np.int64), np.empty(1 + kinds, np.int64)
    target, sight = np.empty(1 + kinds, np.int64), np.empty(2, np.int64)
    while done < count:
        row, bar = states[done, 0], steps.bars[states[done, 0]]
        places = _places(steps, states[done], obstacles)
        if not _covered(steps, keys[row], places):
            return states[:0], offsets[:1], edges[:0], states[done].copy()
        choice[:] = 0
        while True:
            for number in range(obstacles):
                after[number] = steps.after[bar, steps.kind[number], places[number], choice[number]]
            _encode(steps, after, target)
            key[0] = poses[row]
            found = True
            for kind in range(kinds):
                sight[0], sight[1] = numbers[row, kind], _visible(steps, kind, after, steps.views[row])
                option = row_of(shown_slots, shown, sight)
                key[1 + kind] = turn_states[option] if option >= 0 else -1
                found &= option >= 0
            target[0] = row_of(slots, keys, key) if found else -1
            if target[0] < 0:
                return states[:0], offsets[:1], edges[:0], states[done].copy()
            place = place_of(index, states, target)
            if index[place] < 0:
                if count == len(states):
                    states = np.append(states, np.empty_like(states), axis=0)
                    offsets = np.append(offsets, np.empty(count, np.int64))
                    index = slots_of(states[:count], 4 * len(states))[0]
                    place = place_of(index, states, target)
                states[count] = target
                index[place] = count
                count += 1
            if used == len(edges):
                edges = np.append(edges, np.empty(used, np.int32))
            edges[used] = index[place]
            used += 1
            if not _turned(steps, choice, bar, places):
                break
        done += 1
        offsets[done] = used
    return states[:count], offsets[: count + 1], edges[:used], states[0, :0]


@njit(cache=True)
def _turned(steps: Steps, choice: Ints, bar: int, places: Ints) -> bool:
    """Go on to the next combination of what the obstacles do; return False after the last."""
    for number in range(len(choice)):
        choice[number] += 1
        if choice[number] < steps.ends[bar, steps.kind[number], places[number]]:
            return True
        choice[number] = 0
    return False


@njit(cache=True)
def _encode(steps: Steps, places: Ints, state: Ints) -> None:
    """Write one code per kind for the true places of its obstacles behind the first number of a state."""
    state[1:] = 0
    for number in range(len(places)):
        kind = steps.kind[number]
        state[1 + kind] = inserted(state[1 + kind], places[number], steps.digit_bits)


@njit(cache=True)
def _places(steps: Steps, state: Ints, obstacles: int) -> Ints:
    """Return the true places of a state, kind by kind."""
    places, count = np.empty(obstacles, np.int64), 0
    for code in state[1:]:
        for place in listed(code, steps.digit_bits):
            places[count] = place
            count += 1
    return places


@njit(cache=True)
def _visible(steps: Steps, kind: int, places: Ints, view: int) -> int:
    """Return the code of those places of a kind's obstacles that are seen."""
    code = 0
    for number in range(len(places)):
        if steps.kind[number] == kind and has(steps.seen[view], places[number]):
            code = inserted(code, places[number], steps.digit_bits)
    return code


@njit(cache=True)
def _shown(steps: Steps, numbers: Ints, turn_first: Ints, turn_states: Ints) -> tuple[Ints, Ints]:
    """Return (turn, code of the visible cells) of every outcome of every turn, and the index of these rows."""
    found = np.zeros((len(turn_states), 2), np.int64)
    for row in range(len(numbers)):
        for kind in range(numbers.shape[1]):
            turn = numbers[row, kind]
            for option in range(turn_first[turn], turn_first[turn + 1]):
                found[option, 0] = turn
                found[option, 1] = steps.codes[steps.offsets[kind] + turn_states[option]]
    return found, slots_of(found)[0]


@njit(cache=True)
def _covered(steps: Steps, key: Ints, places: Ints) -> bool:
    """Return whether every obstacle is in a visible cell of its kind or in its kind's hidden set."""
    for kind in range(len(key) - 1):
        known = steps.offsets[kind] + key[1 + kind]
        shown, left = listed(steps.codes[known], steps.digit_bits), 0
        for number in range(len(places)):
            if steps.kind[number] != kind:
                continue
            if left < len(shown) and shown[left] == places[number]:
                left += 1
            elif not has(steps.sets[known], places[number]):
                return False
        if left < len(shown):
            return False
    return True


def _describe(table: Table, state: Ints) -> str:
    """Return a state of the product as text."""
    scene, obstacles = table.obstacles.scene, table.obstacles
    truths = [[scene.cell(cell) for cell in obstacles.listed(int(code))] for code in state[1:]]
    return f"{describe(scene, table.decision(int(state[0])))}; truly in {truths}"

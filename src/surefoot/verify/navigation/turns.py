"""The turns of a strategy: where each row's order leads, and what may be known of the obstacles after it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from surefoot.errors import LimitExceeded
from surefoot.frames import Direction
from surefoot.verify.navigation.belief_turn import Field, Ints, has, turn_of_kind
from surefoot.verify.navigation.decisions import WAIT, Table, pose_codes
from surefoot.verify.row_index import row_of

MOST_OUTCOMES = 50_000_000


class Turns(NamedTuple):
    """What happens after every row; obstacles are taken kind by kind, each combination with the robot's part once.

    Attributes:
        poses: (N,) code of cell, heading and goal after the turn.
        advances: (N,) whether a goal is reached on the way.
        viewers: (N,) the view cell.
        numbers: (N, kinds) which turn of each kind.
        first: (T + 1,) offsets; the turns of all kinds stand one after the other.
        states: (O,) the pieces of knowledge after it, -1 where no row has one.
        lost: (T,) whether an obstacle may be in the robot's old or new cell while it moves.
    """

    poses: Ints
    advances: NDArray[np.bool_]
    viewers: Ints
    numbers: Ints
    first: Ints
    states: Ints
    lost: NDArray[np.bool_]


def turns_of(table: Table, goals: list[int]) -> Turns:
    """Return the turns of all rows, whose orders have to be allowed."""
    scene, moves = table.obstacles.scene, table.orders < WAIT
    offsets = np.array([move.offset[0] * scene.frame.columns + move.offset[1] for move in Direction], np.int64)
    cells = np.where(moves, table.cells + offsets[table.orders % WAIT], table.cells)
    advances = moves & (cells == np.array(goals, np.int64)[table.goals])
    poses = pose_codes(
        cells,
        np.where(moves, table.orders, table.headings),
        np.where(advances, (table.goals + 1) % len(goals), table.goals),
    )
    viewers = cells if scene.scenario.view_post else table.cells
    return Turns(poses, advances, viewers, *_by_kind(table, cells))


def _by_kind(table: Table, after: Ints) -> tuple[Ints, Ints, Ints, NDArray[np.bool_]]:
    """Return the last four fields of ``Turns``, given the robot's cell after every row."""
    obstacles = table.obstacles
    meets, meeting = np.unique(np.stack([table.cells, after], axis=1), axis=0, return_inverse=True)
    place = np.full(len(obstacles.scene.sees), -1, np.int64)
    place[list(obstacles.domain)] = np.arange(len(obstacles.domain))
    viewers = meets[:, 1] if obstacles.scene.scenario.view_post else meets[:, 0]
    seen = np.stack([obstacles.seen_from(int(cell)) for cell in viewers])
    numbers = np.zeros((len(after), len(table.kinds)), np.int64)
    first, states, lost = [np.zeros(1, np.int64)], [np.zeros(0, np.int64)], [np.zeros(0, np.bool_)]
    for kind, known in enumerate(table.kinds):
        pairs, number = np.unique(table.keys[:, kind + 1] * len(meets) + meeting.ravel(), return_inverse=True)
        numbers[:, kind] = number + sum(map(len, lost))
        own, found, dangers = _turns_of_kind(
            obstacles.fields[kind], known.keys, known.key_slots, known.sets, known.set_slots,
            pairs // len(meets), pairs % len(meets), place[meets], meets[:, 0] == meets[:, 1], seen,
        )  # fmt: skip
        first.append(own[1:] + first[-1][-1])
        states.append(found)
        lost.append(dangers)
    return numbers, np.concatenate(first), np.concatenate(states), np.concatenate(lost)


@njit(cache=True)
def _turns_of_kind(
    field: Field,
    keys: Ints,
    key_slots: Ints,
    sets: Ints,
    set_slots: Ints,
    known: Ints,
    meeting: Ints,
    places: Ints,
    stands: Ints,
    seen: Ints,
) -> tuple[Ints, Ints, Ints]:
    """Return offsets, numbers of what may be known after each turn (-1: no row has it), and which turns are lost.

    A turn goes from the knowledge ``known`` while the robot does what ``meeting`` counts: goes from one of two
    ``places`` to the other, or ``stands``, with ``seen`` from the view cell.
    """
    first, found, count = np.zeros(len(known) + 1, np.int64), np.empty(1024, np.int64), 0
    lost, key = np.zeros(len(known), np.bool_), np.empty(2, np.int64)
    for turn in range(len(known)):
        before, after = places[meeting[turn]]
        waits = stands[meeting[turn]]
        codes, numbers, rows, entered = turn_of_kind(
            field, keys[known[turn], 0], sets[keys[known[turn], 1]], before if waits else -1, seen[meeting[turn]]
        )
        lost[turn] = not waits and (has(entered, before) or has(entered, after))
        own_sets = np.empty(len(rows), np.int64)
        for number in range(len(rows)):
            own_sets[number] = row_of(set_slots, sets, rows[number])
        if count + len(codes) > MOST_OUTCOMES:
            raise LimitExceeded("the turns of the strategy have too many outcomes to be checked")
        while count + len(codes) > len(found):
            found = np.append(found, np.empty(len(found), np.int64))
        for number in range(len(codes)):
            key[0], key[1] = codes[number], own_sets[numbers[number]]
            found[count] = row_of(key_slots, keys, key) if key[1] >= 0 else -1
            count += 1
        first[turn + 1] = count
    return first, found[:count], lost

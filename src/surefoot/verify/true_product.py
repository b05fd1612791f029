"""Check (2) of rules.md 4: strategy, belief and the true obstacle together; the goals always stay within reach."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from surefoot.errors import LimitExceeded
from surefoot.verify.belief import Obstacle, bits
from surefoot.verify.findings import Ledger
from surefoot.verify.graphs import can_reach
from surefoot.verify.navigation import WAIT, Play, describe
from surefoot.verify.scene import Scene

MOST_STATES = 100_000_000
Ints = NDArray[Any]


def check_true_obstacle(scene: Scene, obstacle: Obstacle, play: Play, start: int, ledger: Ledger) -> None:
    """Walk the product of a closed play with the true obstacle.

    Args:
        scene: the scene.
        obstacle: its obstacle.
        play: every play of the strategy.
        start: the obstacle's start cell.
        ledger: takes the findings.

    Raises:
        LimitExceeded: the product is too large to be walked.
    """
    cells = len(obstacle.domain)
    if len(play.decisions) * cells > MOST_STATES:
        raise LimitExceeded(f"the product with the true obstacle has more than {MOST_STATES} states")
    after, ends = _next_cells(obstacle)
    forbidden = np.full(len(play.decisions), -1, np.int64)
    for node, decision in enumerate(play.decisions):
        if play.orders[node] >= WAIT:
            forbidden[node] = obstacle.place.get(decision.cell, -1)
    visible, hidden = _knowledge(obstacle, play)
    states, first, successors, stray = _walk(
        play.first, play.successors, visible, hidden, forbidden, after, ends, cells, obstacle.place[start]
    )
    ledger.counts["true_product_states"] = len(states)
    if stray >= 0:
        where = (
            f"{describe(scene, play.decisions[stray // cells])}, truly in {scene.cell(obstacle.domain[stray % cells])}"
        )
        ledger.refuse("rules.md 4, belief", "the obstacle goes where the belief says it cannot be", where)
        return
    progress = np.zeros(len(play.decisions), np.bool_)
    for node in range(len(play.decisions)):
        progress[node] = play.advances[play.first[node] : play.first[node + 1]].any()
    # A goal is reached by a move: whether the memory advances depends on the robot's move, not on the obstacle.
    stuck = ~can_reach(first, successors, progress[states // cells])
    if stuck.any():
        code = int(states[int(np.flatnonzero(stuck)[0])])
        where = (
            f"{describe(scene, play.decisions[code // cells])}, truly in {scene.cell(obstacle.domain[code % cells])}"
        )
        ledger.refuse("rules.md 4, check (2)", "no goal can be reached any more", where, times=int(stuck.sum()))


def _next_cells(obstacle: Obstacle) -> tuple[Ints, Ints]:
    """Return the domain places next to each place, one row each, and how many there are."""
    after = np.zeros((len(obstacle.domain), 5), np.int64)
    ends = np.zeros(len(obstacle.domain), np.int64)
    for place, mask in enumerate(obstacle.next_of):
        near = list(bits(mask))
        after[place, : len(near)] = near
        ends[place] = len(near)
    return after, ends


def _knowledge(obstacle: Obstacle, play: Play) -> tuple[Ints, Ints]:
    """Return per decision the visible place or -1, and the belief as a row of bits."""
    visible = np.array([decision.known.visible for decision in play.decisions], np.int64)
    width = (len(obstacle.domain) + 7) // 8
    data = b"".join(decision.known.hidden.to_bytes(width, "little") for decision in play.decisions)
    return visible, np.frombuffer(data, np.uint8).reshape(len(play.decisions), width)


@njit(cache=True)
def _walk(
    first: Ints,
    successors: Ints,
    visible: Ints,
    hidden: Ints,
    forbidden: Ints,
    after: Ints,
    ends: Ints,
    cells: int,
    start: int,
) -> tuple[Ints, Ints, Ints, int]:
    """Return the reached states (decision * cells + truth), their edges, and a state that no belief covers or -1."""
    nodes = len(first) - 1
    number = np.full(nodes * cells, -1, np.int32)
    states = np.empty(1024, np.int64)
    states[0], number[start], count = start, 0, 1
    edges = np.empty(4096, np.int64)
    used, done = 0, 0
    offsets = np.zeros(1024, np.int64)
    while done < count:
        node, truth = states[done] // cells, states[done] % cells
        if visible[node] != truth and (visible[node] >= 0 or not hidden[node, truth >> 3] >> (truth & 7) & 1):
            return states[:0], offsets[:1], edges[:0], states[done]
        for place in range(ends[truth]):
            where = after[truth, place]
            if where == forbidden[node]:
                continue
            # What is seen of the obstacle decides which decision follows: its own cell if it is visible, else hidden.
            target = -1
            for edge in range(first[node], first[node + 1]):
                if visible[successors[edge]] == where:
                    target = successors[edge]
                    break
                if visible[successors[edge]] < 0:
                    target = successors[edge]
            if target < 0:
                return states[:0], offsets[:1], edges[:0], states[done]
            code = target * cells + where
            if number[code] < 0:
                number[code] = count
                if count == len(states):
                    states = np.append(states, np.empty(count, np.int64))
                    offsets = np.append(offsets, np.empty(count, np.int64))
                states[count] = code
                count += 1
            if used == len(edges):
                edges = np.append(edges, np.empty(used, np.int64))
            edges[used] = number[code]
            used += 1
        done += 1
        if done == len(offsets):
            offsets = np.append(offsets, np.empty(done, np.int64))
        offsets[done] = used
    return states[:count], offsets[: count + 1], edges[:used], -1

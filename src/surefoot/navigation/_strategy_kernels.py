"""Compiled walks through a solved navigation game: what its strategy meets, and whether it makes progress."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True)
def met(
    first: NDArray[np.int64],
    successors: NDArray[np.int32],
    order: NDArray[np.int8],
    goals: NDArray[np.bool_],
    choice: NDArray[np.int32],
    memory: int,
) -> tuple[NDArray[np.int32], NDArray[np.int16], NDArray[np.int32]]:
    """Return the decisions that plays of the strategy meet from node 0, breadth first.

    Args:
        first: of the game.
        successors: of the game.
        order: of the game.
        goals: of the game.
        choice: (goals, nodes) edge to take at decisions.
        memory: index of the goal pursued at the start.

    Returns:
        (N,) nodes, indices of the goals pursued there, and nodes of the turns chosen.
    """
    count = goals.shape[0]
    seen = np.zeros((count, order.size), np.bool_)
    nodes = np.empty(1024, np.int32)
    pursued = np.empty(1024, np.int16)
    turns = np.empty(1024, np.int32)
    nodes[0], pursued[0], seen[memory, 0] = 0, memory, True
    done, filled = 0, 1
    while done < filled:
        node, goal = nodes[done], pursued[done]
        turn = successors[first[node] + choice[goal, node]]
        turns[done] = turn
        done += 1
        after = (goal + 1) % count if goals[goal, turn] else goal
        answer = successors[first[turn]] if order[turn] >= 4 else turn
        for edge in range(first[answer], first[answer + 1]):
            following = successors[edge]
            if seen[after, following]:
                continue
            seen[after, following] = True
            if filled == nodes.size:
                nodes = np.append(nodes, np.empty(filled, np.int32))
                pursued = np.append(pursued, np.empty(filled, np.int16))
                turns = np.append(turns, np.empty(filled, np.int32))
            nodes[filled], pursued[filled] = following, after
            filled += 1
    return nodes[:filled], pursued[:filled], turns[:filled]


@njit(cache=True)
def stalled(
    first: NDArray[np.int64],
    successors: NDArray[np.int32],
    order: NDArray[np.int8],
    goals: NDArray[np.bool_],
    blocked: NDArray[np.int8],
    rank: NDArray[np.int32],
    choice: NDArray[np.int32],
    nodes: NDArray[np.int32],
    pursued: NDArray[np.int16],
    turns: NDArray[np.int32],
) -> int:
    """Return a met decision (its place in ``nodes``) from which a play could go on for ever without a goal, or -1.

    The rank must fall with every turn until the pursued goal is visited; where it stays the same, the robot must wait
    for one and the same direction, in vain, before and after: for ever, that violates assumption (c).
    """
    for place in range(nodes.size):
        goal, turn = pursued[place], turns[place]
        if goals[goal, turn]:
            continue
        before = rank[goal, nodes[place]]
        answer = successors[first[turn]] if order[turn] >= 4 else turn
        for edge in range(first[answer], first[answer + 1]):
            following = successors[edge]
            after = rank[goal, following]
            if after < 0 or after > before:
                return place
            if after == before:
                next_turn = successors[first[following] + choice[goal, following]]
                if blocked[turn] < 0 or blocked[next_turn] != blocked[turn]:
                    return place
    return -1

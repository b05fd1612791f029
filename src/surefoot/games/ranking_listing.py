"""Lists the nodes of a ranking that is small: the play of ``ranking_player`` against all inputs at once."""

from __future__ import annotations

import numpy as np

from surefoot.games.minimise import minimised
from surefoot.games.ranking_player import Bits, RankingPlayer
from surefoot.logic.ranking import Ranking
from surefoot.logic.transducer import Transducer

MOST_MOVES = 30_000
"""How many moves of the environment are answered; some seconds."""


def listed(ranking: Ranking, semantics: str = "slugs", most: int = MOST_MOVES) -> Transducer | None:
    """Return a ranking as a strategy with all its nodes, alike ones merged; None if there are too many moves.

    Args:
        ranking: the strategy.
        semantics: that it was made for: who picks the initial outputs.
        most: how many moves of the environment may be answered.

    Raises:
        ValueError: the ranking has no answer somewhere.
    """
    player = RankingPlayer(ranking)
    numbers: dict[tuple[int, bytes], int] = {}
    nodes: list[tuple[int, Bits]] = []

    def number(memory: int, state: Bits) -> int:
        goal = player.pursued(memory, state)
        key = goal, state.tobytes()
        if key not in numbers:
            numbers[key] = len(nodes)
            nodes.append((goal, state))
        return numbers[key]

    starts = player.starts(most, robotics=semantics == "robotics")
    if starts is None:
        return None
    initial = [number(memory, state) for memory, state in starts]
    edges: list[list[int]] = []
    left = most - len(initial)
    while len(edges) < len(nodes):
        memory, state = nodes[len(edges)]
        moves = player.moves(state, left)
        if moves is None:
            return None
        left -= len(moves)
        edges.append([number(*player.answer(memory, state, inputs)) for inputs in moves])
    return minimised(_transducer(player, nodes, edges, initial))


def _transducer(
    player: RankingPlayer, nodes: list[tuple[int, Bits]], edges: list[list[int]], initial: list[int]
) -> Transducer:
    ranking = player.ranking
    values = np.array([player.decoded(state) for _, state in nodes], dtype=np.int32)
    return Transducer(
        player="system",
        variables=ranking.variables,
        inputs=ranking.inputs,
        values=values.reshape(len(nodes), len(ranking.variables)),
        memory=np.array([memory for memory, _ in nodes], dtype=np.int32),
        first=np.concatenate([[0], np.cumsum([len(row) for row in edges], dtype=np.int64)]),
        successors=np.array([node for row in edges for node in row], dtype=np.int32),
        initial=np.array(initial, dtype=np.int32),
    )

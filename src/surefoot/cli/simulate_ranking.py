"""Playing a ranking for ``surefoot simulate``: nothing is listed, so moves are searched for as the play goes."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np

    from surefoot.games.ranking_player import Bits, RankingPlayer
    from surefoot.logic.ranking import Ranking

Known = dict[int, int]


def play_ranking(
    ranking: Ranking,
    steps: int,
    source: np.random.Generator,
    *,
    typed: bool,
    show: Callable[[int, tuple[int, ...], int], None],
) -> tuple[list[tuple[int, ...]], list[int], str | None]:
    """Play a ranking; return the values of all variables in every step, the goals pursued, and why it ended early.

    Args:
        ranking: the strategy.
        steps: how many.
        source: picks inputs.
        typed: whether to ask for them on standard input.
        show: called with the number, the values and the goal of every step.
    """
    from surefoot.games.ranking_player import RankingPlayer

    player = RankingPlayer(ranking)
    rows: list[tuple[int, ...]] = []
    goals: list[int] = []
    state: Bits | None = None
    memory = 0
    while len(rows) < steps:
        if player.inputs(state, {}, None) is None:
            return rows, goals, "the environment has no move"
        inputs = _chosen(player, state, source, typed=typed)
        if inputs is None:
            return rows, goals, "no more moves were typed"
        if state is None:
            begun = player.start(inputs)
            if begun is None:
                return rows, goals, "the ranking has no start for these inputs"
            memory, state = begun
        else:
            memory, state = player.answer(memory, state, inputs)
        rows.append(player.decoded(state))
        goals.append(player.pursued(memory, state))
        show(len(rows) - 1, rows[-1], goals[-1])
    return rows, goals, None


def _chosen(player: RankingPlayer, state: Bits | None, source: np.random.Generator, *, typed: bool) -> Bits | None:
    """Return the next inputs, at random or as typed; None when nothing more is typed."""
    while typed:
        print("> ", end="", file=sys.stderr, flush=True)
        line = sys.stdin.readline()
        if not line:
            return None
        known, problem = _known(player, line)
        if known is not None:
            found = player.inputs(state, known, source)
            if found is not None:
                return found
            problem = f"not allowed here; allowed is for instance: {_example(player, state)}"
        print(problem, file=sys.stderr)
    return player.inputs(state, {}, source)


def _known(player: RankingPlayer, line: str) -> tuple[Known | None, str]:
    """Return the bits that a typed move fixes; None and a sentence if it is no move."""
    from surefoot.cli.typed_moves import values_typed

    ranking = player.ranking
    wanted, problem = values_typed(line, [variable.name for variable in ranking.variables[: ranking.inputs]])
    if problem:
        return None, problem
    try:
        return player.bits_of(wanted), ""
    except ValueError as out_of_range:
        return None, str(out_of_range)


def _example(player: RankingPlayer, state: Bits | None) -> str:
    import numpy as np

    found = player.inputs(state, {}, None)
    if found is None:
        return "nothing"
    rest = np.zeros(len(player.ranking.order) - len(found), dtype=np.uint8)
    values = player.decoded(np.concatenate([found, rest]))
    inputs = player.ranking.variables[: player.ranking.inputs]
    return " ".join(f"{v.name}={value}" for v, value in zip(inputs, values, strict=False))

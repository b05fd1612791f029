"""From the action game to its strategy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.compute import Deadline
from surefoot.frames import Direction
from surefoot.games import Solution, solve
from surefoot.navigation.action_game import ActionGame, FineState, decode_states
from surefoot.navigation.action_rules import STOP_ORDER
from surefoot.navigation.strategies import ActionStrategy
from surefoot.navigation.synthesis import Unrealizable
from surefoot.verdict import Verdict


@dataclass(frozen=True, slots=True)
class FineStart:
    """Where the robot stands at the start.

    Attributes:
        row: fine row.
        column: fine column.
        moved_cells: distance from the requested place, in fine cells.
    """

    row: int
    column: int
    moved_cells: float


def solve_action(
    game: ActionGame, row: float, column: float, deadline: Deadline | None = None
) -> tuple[Verdict[Unrealizable], ActionStrategy | None, FineStart | None]:
    """Solve an action game from the winning fine cell nearest to where the robot stands.

    Args:
        game: the game.
        row: requested place in fine rows from the north border of its coarse cell; a fine cell's centre is at its
            index + 0.5.
        column: the same from the west border.
        deadline: when to give up.

    Returns:
        The verdict; with a yes the strategy from there, and the place.
    """
    solution = solve(game.arena, deadline=deadline or Deadline())
    places = np.argwhere((game.starts >= 0) & solution.winning[game.starts])
    if not len(places):
        reason = (
            f"no sequence of steps carries out {_orders_in_words(game)} from every place and with every deviation that "
            "the walking numbers allow; allow fewer deviations (walking.lateral_outcomes_cells, "
            "walking.sagittal_outcomes_cells), other step lengths, or larger cells"
        )
        return Verdict.false(Unrealizable(reason)), None, None
    distances = np.hypot(places[:, 0] + 0.5 - row, places[:, 1] + 0.5 - column)
    nearest = int(np.argmin(distances))
    place = places[nearest]
    strategy = extract_action_strategy(game, solution, int(game.starts[place[0], place[1]]))
    return Verdict.true(), strategy, FineStart(int(place[0]), int(place[1]), float(distances[nearest]))


def _orders_in_words(game: ActionGame) -> str:
    """Return the orders that the map can give."""
    words = [
        ("stop" if order == STOP_ORDER else Direction(order).name.lower())
        + (" on the stairs" if here else " onto the stairs" if there else "")
        for here, order, there in game.rules.contexts
    ]
    return f"all of the orders {', '.join(dict.fromkeys(words))}"


def extract_action_strategy(game: ActionGame, solution: Solution, start: int) -> ActionStrategy:
    """Return the actions in all states that are met when the strategy plays from a node."""
    arena = game.arena
    met = np.zeros(len(game.kind), np.bool_)
    met[start] = True
    frontier = np.array([start])
    while len(frontier):
        begin, end = arena.first[frontier], arena.first[frontier + 1]
        states = game.kind[frontier] == 0
        chosen = arena.successors[begin[states] + solution.choice[0, frontier[states]]]
        spans = [arena.successors[a:b] for a, b in zip(begin[~states], end[~states], strict=True)]
        following = np.unique(np.concatenate([chosen, *spans]))
        frontier = following[~met[following]]
        met[frontier] = True
    nodes = np.nonzero(met & (game.kind == 0))[0]
    actions = game.code[arena.successors[arena.first[nodes] + solution.choice[0, nodes]]]
    states = decode_states(game.rules, game.code[nodes]).tolist()
    return ActionStrategy({FineState(*state): int(action) for state, action in zip(states, actions, strict=True)})

"""A scene without a winning strategy, in words: how an obstacle keeps the robot from a goal."""

from __future__ import annotations

from collections.abc import Iterator

from surefoot.compute import Deadline
from surefoot.errors import LimitExceeded
from surefoot.frames import Direction
from surefoot.games.obstruction import Obstruction, obstruction
from surefoot.navigation.navigation_game import NavigationGame
from surefoot.navigation.navigation_rules import Order

LONGEST = 40
"""Turns that are shown; of a longer play the beginning and the end."""
TIME_LIMIT_S = 30.0
_ANSWERS = 8


def obstacle_play(game: NavigationGame, time_limit_s: float = TIME_LIMIT_S) -> tuple[str, ...]:
    """Return a play that the obstacles win, a sentence a turn; empty if the robot wins, or none was found in time.

    The robot heads for the goal that is denied by a shortest way; the obstacles do what keeps it away.

    Args:
        game: a navigation game.
        time_limit_s: when to give up.
    """
    try:
        found = obstruction(game.arena, 0, deadline=Deadline.after(time_limit_s))
    except LimitExceeded:
        return ()
    return () if found is None else tuple(_shortened(list(_turns(game, found))))


def _turns(game: NavigationGame, found: Obstruction) -> Iterator[str]:
    """Yield a sentence for every decision, and how the play ends."""
    turn, begins = 0, None
    for place, node in enumerate(found.nodes):
        if found.repeats_from == place:
            begins = turn
        if game.order[node] >= 0:
            continue
        following = found.nodes[place + 1 : place + 2]
        does = f"it does: {_order_words(int(game.order[following[0]]))}" if following else "no order is safe"
        where = f"the robot in {_cell(game, int(game.cell[node]))}, heading {_heading(game, node)}"
        yield f"turn {turn}: {where}; {_obstacles(game, node)}; {does}"
        turn += 1
    if found.repeats_from is None:
        yield "the robot has no safe order left"
    elif found.goal is not None:
        goal = f"goal {found.goal} in {_cell(game, game.problem.goals[found.goal])}"
        yield f"from turn {begins} on this repeats for ever, and {goal} is not reached again"


def _order_words(code: int) -> str:
    return "wait" if code >= _ANSWERS else str(Order.of(code))


def _heading(game: NavigationGame, node: int) -> str:
    return Direction(int(game.heading[node])).name.lower()


def _cell(game: NavigationGame, cell: int) -> str:
    return str(tuple(game.problem.coarse.grid.cell(cell)))


def _obstacles(game: NavigationGame, node: int) -> str:
    """Return what the robot knows of the obstacles in words."""
    state, parts = game.states[int(game.knowledge[node])], []
    for seen, hidden in zip(state.visible, state.hidden, strict=True):
        parts += [f"an obstacle in {_cell(game, cell)}" for cell in seen]
        if hidden:
            cells = game.kinds.members(hidden)
            shown = ", ".join(_cell(game, cell) for cell in cells[:4]) + (", ..." if len(cells) > 4 else "")
            place = f"one of {len(cells)} cells: {shown}" if len(cells) > 1 else shown
            parts.append(f"an obstacle out of sight, in {place}")
    return " and ".join(parts) or "no obstacles"


def _shortened(lines: list[str]) -> list[str]:
    if len(lines) <= LONGEST:
        return lines
    half = LONGEST // 2
    return [*lines[:half], f"... {len(lines) - 2 * half} turns more ...", *lines[-half:]]

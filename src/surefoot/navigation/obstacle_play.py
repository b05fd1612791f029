"""A scene without a winning strategy, in words: how an obstacle keeps the robot from a goal."""

from __future__ import annotations

from dataclasses import dataclass

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


Place = tuple[int, int]


@dataclass(frozen=True, slots=True)
class PlayTurn:
    """One decision of the robot; cells are (row, column).

    Attributes:
        turn: its number.
        cell: where the robot is.
        heading: where it faces.
        visible: for every kind the cells in which its obstacles are seen.
        hidden: for every kind the cells in which those out of sight may be.
        order: what the robot does; None when no order is safe.
    """

    turn: int
    cell: Place
    heading: str
    visible: tuple[tuple[Place, ...], ...]
    hidden: tuple[tuple[Place, ...], ...]
    order: str | None

    def __str__(self) -> str:
        """Return the decision as one sentence."""
        does = "no order is safe" if self.order is None else f"it does: {self.order}"
        return f"turn {self.turn}: the robot in {self.cell}, heading {self.heading}; {self._obstacles()}; {does}"

    def _obstacles(self) -> str:
        """Return what the robot knows of the obstacles in words."""
        parts: list[str] = []
        for seen, hidden in zip(self.visible, self.hidden, strict=True):
            parts += [f"an obstacle in {cell}" for cell in seen]
            if hidden:
                shown = ", ".join(map(str, hidden[:4])) + (", ..." if len(hidden) > 4 else "")
                place = f"one of {len(hidden)} cells: {shown}" if len(hidden) > 1 else shown
                parts.append(f"an obstacle out of sight, in {place}")
        return " and ".join(parts) or "no obstacles"


@dataclass(frozen=True, slots=True)
class Play:
    """A play that the obstacles win.

    Attributes:
        turns: the decisions of the robot.
        repeats_from: the turn from which on the play repeats for ever; None when the robot is caught at its end.
        denied_goal: the goal that is not reached again, when the play repeats.
        ending: how it ends, a sentence.
    """

    turns: tuple[PlayTurn, ...]
    repeats_from: int | None
    denied_goal: int | None
    ending: str

    def lines(self) -> list[str]:
        """Return the play as sentences; of a long one the beginning and the end."""
        return _shortened([*map(str, self.turns), *([self.ending] if self.ending else [])])


def obstacle_play(game: NavigationGame, time_limit_s: float = TIME_LIMIT_S) -> Play | None:
    """Return a play that the obstacles win; None if the robot wins, or none was found in time.

    The robot heads for the goal that is denied by a shortest way; the obstacles do what keeps it away.

    Args:
        game: a navigation game.
        time_limit_s: when to give up.
    """
    try:
        found = obstruction(game.arena, 0, deadline=Deadline.after(time_limit_s))
    except LimitExceeded:
        return None
    return None if found is None else _play(game, found)


def _play(game: NavigationGame, found: Obstruction) -> Play:
    """Return every decision, and how the play ends."""
    turns: list[PlayTurn] = []
    begins = None
    for place, node in enumerate(found.nodes):
        if found.repeats_from == place:
            begins = len(turns)
        if game.order[node] >= 0:
            continue
        following = found.nodes[place + 1 : place + 2]
        order = _order_words(int(game.order[following[0]])) if following else None
        turns.append(_turn(game, len(turns), node, order))
    if found.repeats_from is None:
        return Play(tuple(turns), None, None, "the robot has no safe order left")
    ending = ""
    if found.goal is not None:
        goal = f"goal {found.goal} in {_cell(game, game.problem.goals[found.goal])}"
        ending = f"from turn {begins} on this repeats for ever, and {goal} is not reached again"
    return Play(tuple(turns), begins, found.goal, ending)


def _turn(game: NavigationGame, number: int, node: int, order: str | None) -> PlayTurn:
    """Return a decision with what the robot knows."""
    state = game.states[int(game.knowledge[node])]
    return PlayTurn(
        turn=number,
        cell=_cell(game, int(game.cell[node])),
        heading=_heading(game, node),
        visible=tuple(tuple(_cell(game, cell) for cell in seen) for seen in state.visible),
        hidden=tuple(tuple(_cell(game, cell) for cell in game.kinds.members(mask)) for mask in state.hidden),
        order=order,
    )


def _order_words(code: int) -> str:
    return "wait" if code >= _ANSWERS else str(Order.of(code))


def _heading(game: NavigationGame, node: int) -> str:
    return Direction(int(game.heading[node])).name.lower()


def _cell(game: NavigationGame, cell: int) -> Place:
    row, column = game.problem.coarse.grid.cell(cell)
    return int(row), int(column)


def _shortened(lines: list[str]) -> list[str]:
    if len(lines) <= LONGEST:
        return lines
    half = LONGEST // 2
    return [*lines[:half], f"... {len(lines) - 2 * half} turns more ...", *lines[-half:]]

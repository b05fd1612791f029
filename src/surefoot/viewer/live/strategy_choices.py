"""Questions to a navigation strategy: goal, heading, cell, obstacles in view and belief, each among what there is."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from surefoot.navigation import NavigationStrategy, ObstacleState, Order

_Value = TypeVar("_Value")

Seen = tuple[tuple[int, ...], ...]
"""Cells of the obstacles in view, per kind."""


@dataclass(frozen=True, slots=True)
class Question:
    """What is asked.

    Attributes:
        goal: index of the goal that the robot pursues.
        heading: of the robot.
        cell: of the robot; None for every cell in which the rest can be known.
        seen: obstacles in view.
        state: index of what is known of the obstacles.
    """

    goal: int
    heading: int
    cell: int | None
    seen: Seen
    state: int


@dataclass(frozen=True, slots=True)
class Choices:
    """What may be chosen, each given the choices before it; the strategy decides for all of them.

    Attributes:
        goals, headings: ascending.
        cells: ascending, None first.
        seen: those with fewer obstacles in view first.
        states: those with larger beliefs first.
    """

    goals: tuple[int, ...]
    headings: tuple[int, ...]
    cells: tuple[int | None, ...]
    seen: tuple[Seen, ...]
    states: tuple[int, ...]


class StrategyBook:
    """A strategy that can be asked.

    Args:
        strategy: the strategy.
    """

    def __init__(self, strategy: NavigationStrategy) -> None:
        self.strategy = strategy
        numbers: dict[Seen, int] = {}
        of_state = [numbers.setdefault(state.visible, len(numbers)) for state in strategy.states]
        self.seen = tuple(numbers)
        self.sight = np.array(of_state, np.int64)[strategy.state]

    def first(self) -> Question:
        """Return what is asked at the start of the mission."""
        one = self.strategy
        state = int(one.state[0])
        return Question(int(one.goal[0]), int(one.heading[0]), int(one.cell[0]), one.states[state].visible, state)

    def settled(self, asked: Question) -> tuple[Question, Choices]:
        """Return a question that the strategy answers, and what else may be chosen.

        Choices count in their order: what does not go with those before it is replaced by the first that does.
        """
        one = self.strategy
        goals = tuple(np.unique(one.goal).tolist())
        goal = _kept(asked.goal, goals)
        rows = one.goal == goal
        headings = tuple(np.unique(one.heading[rows]).tolist())
        heading = _kept(asked.heading, headings)
        rows &= one.heading == heading
        cells: tuple[int | None, ...] = (None, *np.unique(one.cell[rows]).tolist())
        cell = _kept(asked.cell, cells)
        rows &= np.bool_(True) if cell is None else one.cell == cell
        sights = sorted((self.seen[number] for number in np.unique(self.sight[rows]).tolist()), key=_in_view)
        seen = _kept(asked.seen, tuple(sights))
        rows &= self.sight == self.seen.index(seen)
        states = tuple(sorted(np.unique(one.state[rows]).tolist(), key=lambda k: (-hidden_cells(one.states[k]), k)))
        state = _kept(asked.state, states)
        return replace(asked, goal=goal, heading=heading, cell=cell, seen=seen, state=state), Choices(
            goals, headings, cells, tuple(sights), states
        )

    def orders(self, asked: Question) -> dict[int, Order]:
        """Return the order in every cell in which the robot can have a question's goal, heading and knowledge."""
        rows = self._rows(asked)
        one = self.strategy
        return {int(one.cell[row]): Order.of(int(one.order[row])) for row in np.flatnonzero(rows)}

    def believed(self, asked: Question) -> list[tuple[int, int]]:
        """Return kinds of obstacles with the cells that a hidden one may be in."""
        masks, domain = self.strategy.states[asked.state].hidden, self.strategy.domain
        return [
            (kind, domain[bit])
            for kind, mask in enumerate(masks)
            for bit in range(mask.bit_length())
            if mask >> bit & 1
        ]

    def _rows(self, asked: Question) -> NDArray[np.bool_]:
        one = self.strategy
        rows: NDArray[np.bool_] = (one.goal == asked.goal) & (one.heading == asked.heading) & (one.state == asked.state)
        return rows


def hidden_cells(state: ObstacleState) -> int:
    """Return how many cells a belief has, counted for every kind."""
    return sum(mask.bit_count() for mask in state.hidden)


def _in_view(seen: Seen) -> tuple[int, Seen]:
    return sum(map(len, seen)), seen


def _kept(wanted: _Value, allowed: tuple[_Value, ...]) -> _Value:
    return wanted if wanted in allowed else allowed[0]

"""How much a navigation strategy gets done: simulated turns against obstacles that move at random."""

from __future__ import annotations

import random
from dataclasses import dataclass

from surefoot.frames import Direction
from surefoot.navigation.navigation_rules import NavigationProblem, Order, Rules
from surefoot.navigation.obstacles import ObstacleState
from surefoot.navigation.strategies import NavigationStrategy


@dataclass(frozen=True, slots=True)
class Throughput:
    """What happened in a number of turns.

    Attributes:
        turns: how many.
        visits: how often the next goal was reached.
        waits: in how many turns the robot waited.
        longest_leg: the most turns from one goal to the next.
        path: the robot's cell before every turn.
    """

    turns: int
    visits: int
    waits: int
    longest_leg: int
    path: tuple[int, ...]


def throughput(problem: NavigationProblem, strategy: NavigationStrategy, turns: int, seed: int = 0) -> Throughput:
    """Play a strategy against obstacles that take each of their next cells with equal chances.

    Args:
        problem: what the strategy was made for.
        strategy: the strategy.
        turns: how many turns to play.
        seed: of the obstacles.
    """
    play = _Play(problem, strategy, random.Random(seed))  # noqa: S311 - a simulation, not a secret
    path, waits, visits = [], 0, []
    for turn in range(turns):
        path.append(play.cell)
        order, visited = play.turn()
        waits += order.waits
        visits += [turn] if visited else []
    legs = [after - before for before, after in zip([0, *visits], [*visits, turns], strict=True)]
    return Throughput(turns, len(visits), waits, max(legs), tuple(path))


class _Play:
    """A play, turn by turn; observations that were worked out are remembered."""

    def __init__(self, problem: NavigationProblem, strategy: NavigationStrategy, chance: random.Random) -> None:
        self._rules, self._strategy, self._chance = Rules(problem), strategy, chance
        self._kinds = self._rules.kinds
        self._slots = [(number, kind) for number, kind in enumerate(self._kinds) for _ in kind.obstacles]
        self._truth = [problem.obstacles[obstacle].start for kind in self._kinds for obstacle in kind.obstacles]
        self._known = self._rules.start()
        self._outcomes: dict[tuple[ObstacleState, int, bool], dict[tuple[tuple[int, ...], ...], ObstacleState]] = {}
        self.cell, self._heading = problem.start, problem.heading
        self._goal = strategy.advance(0, problem.start)

    def turn(self) -> tuple[Order, bool]:
        """Play one turn; return the order, and whether it reached the goal that was pursued."""
        problem = self._rules.problem
        order = self._strategy.decide(self.cell, self._heading, self._known, self._goal)
        arrival, heading = self._rules.arrival(self.cell, self._heading, order)
        view = arrival if problem.view == "post" else self.cell
        standing = self.cell if order.waits else None
        self._truth = [
            self._chance.choice(self._kinds.reach(kind, cell, standing))
            for (_, kind), cell in zip(self._slots, self._truth, strict=True)
        ]
        self._known = self._observed(arrival, view, order)
        visited = not order.waits and arrival == problem.goals[self._goal]
        self._goal = self._strategy.advance(self._goal, arrival) if not order.waits else self._goal
        self.cell, self._heading = arrival, Direction(heading)
        return order, visited

    def _observed(self, arrival: int, view: int, order: Order) -> ObstacleState:
        """Return the knowledge that fits what is seen of the true obstacles."""
        key = (self._known, view, order.waits)
        if key not in self._outcomes:
            outcomes = self._rules.outcomes(self.cell, arrival, order, self._known)
            self._outcomes[key] = {state.visible: state for state in outcomes}
        seen: list[list[int]] = [[] for _ in self._kinds]
        for (number, _), cell in zip(self._slots, self._truth, strict=True):
            if self._rules.problem.coarse.sees[view, cell]:
                seen[number].append(cell)
        return self._outcomes[key][tuple(tuple(sorted(cells)) for cells in seen)]

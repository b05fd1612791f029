"""Planning again in the middle of a walk, when obstacles broke their assumptions (docs/formats.md 3)."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from surefoot.compute import sha256_of
from surefoot.frames import Direction
from surefoot.missions.biped.monitor import Seen, reset
from surefoot.navigation import (
    NavigationProblem,
    NavigationStrategy,
    Obstacle,
    ObstacleState,
    Order,
    Rules,
    build_navigation_game,
    save_arrays,
    solve_navigation,
)


@dataclass(frozen=True, slots=True)
class Guide:
    """A navigation strategy in force.

    Attributes:
        number: 0 for the plan's, j for that of the j-th replan.
        rules: of the game that it wins.
        strategy: which order to give.
        first_goal: the scenario's number of the goal that the strategy counts as 0.
    """

    number: int
    rules: Rules
    strategy: NavigationStrategy
    first_goal: int = 0

    @classmethod
    def of(cls, number: int, problem: NavigationProblem, strategy: NavigationStrategy, first_goal: int = 0) -> Guide:
        """Return a strategy with the rules of the problem that it solves."""
        return cls(number, Rules(problem), strategy, first_goal)

    def decide(self, cell: int, heading: Direction, state: ObstacleState, goal: int) -> Order:
        """Return the order in a cell; goals are counted as the scenario does.

        Raises:
            KeyError: if the strategy never comes there.
        """
        return self.strategy.decide(cell, heading, state, (goal - self.first_goal) % len(self.strategy.goals))

    def save(self, path: Path) -> str:
        """Save the strategy, with goals as the scenario counts them, and return the file's hash."""
        arrays = self.strategy.arrays()
        goals = (arrays["goal"] + self.first_goal) % len(self.strategy.goals)
        save_arrays(path, {**arrays, "goal": goals.astype(np.int16)})
        return sha256_of(path)


@dataclass(frozen=True, slots=True)
class Attempt:
    """What planning again found.

    Attributes:
        guide: the new strategy; None when there is none.
        took_ms: how long it took [ms].
    """

    guide: Guide | None
    took_ms: float


def replanned(
    problem: NavigationProblem, number: int, cell: int, heading: Direction, goal: int, view: int, seen: Seen
) -> Attempt:
    """Plan again from where the robot stands.

    Args:
        problem: of the mission.
        number: of the new strategy.
        cell: the robot's cell.
        heading: its heading.
        goal: the pending goal.
        view: the cell from which it looks.
        seen: where it sees obstacles; their domains grow by these cells.
    """
    begin = time.perf_counter()
    new = _from_here(problem, cell, heading, goal, view, seen)
    guide = None
    if new is not None:
        _, strategy = solve_navigation(build_navigation_game(new))
        guide = None if strategy is None else Guide.of(number, new, strategy, goal)
    return Attempt(guide, 1e3 * (time.perf_counter() - begin))


def _from_here(
    problem: NavigationProblem, cell: int, heading: Direction, goal: int, view: int, seen: Seen
) -> NavigationProblem | None:
    """Return the problem from here on.

    There is none while an obstacle is in the robot's cell, or missing although its whole domain is in view.
    """
    if any(cell in cells for cells in seen):
        return None
    grown = list(problem.obstacles)
    for kind, cells in zip(problem.obstacle_kinds, seen, strict=True):
        for obstacle in kind.obstacles:
            grown[obstacle] = _allowed_in(grown[obstacle], cells)
    new = replace(
        problem,
        start=cell,
        heading=heading,
        goals=(*problem.goals[goal:], *problem.goals[:goal]),
        obstacles=tuple(grown),
    )
    kinds = new.obstacle_kinds
    hidden = reset(kinds, view, seen)
    same = [kind.obstacles for kind in kinds] == [kind.obstacles for kind in problem.obstacle_kinds]
    missing = any(
        len(cells) < len(kind.obstacles) and not mask for kind, cells, mask in zip(kinds, seen, hidden, strict=True)
    )
    return None if missing or not same else replace(new, known=ObstacleState(seen, hidden))


def _allowed_in(obstacle: Obstacle, cells: tuple[int, ...]) -> Obstacle:
    return replace(obstacle, forbidden=obstacle.forbidden - frozenset(cells))

"""How long navigation games take, part by part, and halls of any size to grow them on."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from surefoot.compute import peak_memory_mb
from surefoot.frames import Cell, Direction
from surefoot.games import environment_cannot_keep_assumptions, solve
from surefoot.navigation.coarse import coarse_map
from surefoot.navigation.navigation_game import build_navigation_game
from surefoot.navigation.navigation_rules import NavigationProblem
from surefoot.navigation.obstacles import Obstacle
from surefoot.navigation.synthesis import extract_navigation_strategy
from surefoot.world import CoarseGrid, make_heights

_T = TypeVar("_T")


@dataclass(frozen=True, slots=True)
class GameFigures:
    """What one game took, in processor time of this process.

    Attributes:
        realizable: whether the robot wins.
        decisions: nodes at which the robot decides.
        turns: nodes at which an order is carried out.
        edges: of the graph.
        build_s: exploring the graph [s].
        assumption_s: whether obstacles can keep assumption (c) from everywhere [s].
        solve_s: the fixpoint [s].
        strategy_s: walking and checking the strategy [s].
        peak_mb: largest resident size of the process so far [MB].
    """

    realizable: bool
    decisions: int
    turns: int
    edges: int
    build_s: float
    assumption_s: float
    solve_s: float
    strategy_s: float
    peak_mb: float

    @property
    def total_s(self) -> float:
        """All parts together [s]."""
        return self.build_s + self.assumption_s + self.solve_s + self.strategy_s


def measured(problem: NavigationProblem) -> GameFigures:
    """Build, check and solve a game, part by part; compile everything first."""
    warm_up()
    game, build_s = _timed(lambda: build_navigation_game(problem))
    nodes = np.arange(game.arena.nodes)
    _, assumption_s = _timed(lambda: environment_cannot_keep_assumptions(game.arena, nodes))
    solution, solve_s = _timed(lambda: solve(game.arena))
    realizable, strategy_s = bool(solution.winning[0]), 0.0
    if realizable:
        _, strategy_s = _timed(lambda: extract_navigation_strategy(game, solution))
    return GameFigures(
        realizable,
        game.decisions,
        game.turns,
        game.arena.edges,
        build_s,
        assumption_s,
        solve_s,
        strategy_s,
        peak_memory_mb(),
    )


def warm_up() -> None:
    """Compile the exploration and the engine, or load what was compiled before, on the smallest hall."""
    game = build_navigation_game(hall(4, 3, 1))
    extract_navigation_strategy(game, solve(game.arena))


def hall(columns: int, rows: int, obstacles: int, range_cells: float = 4.0) -> NavigationProblem:
    """Return a hall with a pillar in every third cell of every third row and goals in two corners.

    Args:
        columns: free cells from west to east.
        rows: free cells from north to south.
        obstacles: how many; they may go everywhere but into the goals and around them.
        range_cells: how far the robot sees.
    """
    free = np.zeros((rows + 2, columns + 2), np.bool_)
    free[1:-1, 1:-1] = True
    free[3:-2:3, 3:-2:3] = False
    grid = CoarseGrid(1.0, (0.0, 0.0), 0.0, rows + 2, columns + 2, (0.0, rows + 2.0), free)
    goals = (Cell(1, 1), Cell(rows, columns))
    places = [cell for cell in grid.free_cells() if min(_apart(cell, goal) for goal in goals) > 1]
    around = frozenset(map(grid.index, grid.free_cells())) - frozenset(map(grid.index, places))
    middle = len(places) // 2
    starts = places[middle : middle + obstacles]
    return NavigationProblem(
        coarse=coarse_map(grid, make_heights(grid, 26, (), ()), range_cells),
        start=grid.index(goals[0]),
        heading=Direction.EAST,
        goals=tuple(map(grid.index, reversed(goals))),
        obstacles=tuple(Obstacle(grid.index(cell), around) for cell in starts),
        belief="single",
    )


def _apart(one: Cell, other: Cell) -> int:
    return max(abs(one.row - other.row), abs(one.column - other.column))


def _timed(work: Callable[[], _T]) -> tuple[_T, float]:
    begin = time.process_time()
    result = work()
    return result, time.process_time() - begin

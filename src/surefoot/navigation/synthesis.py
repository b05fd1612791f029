"""From the navigation game to its strategy: solve, check beyond realizability, extract what is played."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.compute import Deadline
from surefoot.games import Solution, environment_cannot_keep_assumptions, failing_goals, solve
from surefoot.navigation.navigation_game import NavigationGame
from surefoot.navigation.obstacle_play import Play, obstacle_play
from surefoot.navigation.strategies import NavigationStrategy
from surefoot.verdict import Verdict


@dataclass(frozen=True, slots=True)
class Unrealizable:
    """Why a game has no winning strategy.

    Attributes:
        reason: one sentence or a few.
        failing_goals: indices of the goals that cannot be pursued for ever even alone.
        losing_cells: cells at which the robot decides and cannot win, whatever it knows.
        play: how the obstacles win; None when no play was found in time.
    """

    reason: str
    failing_goals: tuple[int, ...] = ()
    losing_cells: tuple[int, ...] = ()
    play: Play | None = None


def solve_navigation(
    game: NavigationGame, deadline: Deadline | None = None
) -> tuple[Verdict[Unrealizable], NavigationStrategy | None]:
    """Solve a navigation game and run both checks beyond realizability.

    Check (2), that the true obstacles never leave the robot without a way to its goals, follows from two facts: they
    can always keep assumption (c), whatever the robot does (proved in rules.md 4), and no play of the strategy that
    keeps (c) goes on for ever without a goal (checked here on every decision).

    Args:
        game: the game.
        deadline: when to give up.

    Returns:
        The verdict, and the strategy when the verdict is yes.

    Source: Shamsah et al., T-RO 2023, VI-D; the checks: docs/rules.md 4, last paragraphs.
    """
    limit = deadline or Deadline()
    solution = solve(game.arena, deadline=limit)
    if not solution.winning[0]:
        return Verdict.false(_explain(game, solution)), None
    forced = environment_cannot_keep_assumptions(game.arena, np.arange(game.arena.nodes), deadline=limit)
    if len(forced):
        cell = game.problem.coarse.grid.cell(int(game.cell[forced[0]]))
        reason = (
            f"obstacles cannot keep assumption (c) from {len(forced)} nodes, "
            f"for instance with the robot in {tuple(cell)}"
        )
        return Verdict.false(Unrealizable(reason)), None
    strategy, stuck = extract_navigation_strategy(game, solution)
    if stuck is not None:
        return Verdict.false(Unrealizable(f"some goal may never be reached again from {stuck}")), None
    return Verdict.true(), strategy


def extract_navigation_strategy(game: NavigationGame, solution: Solution) -> tuple[NavigationStrategy, str | None]:
    """Return the decisions that are met when the strategy plays from the start.

    Returns:
        The strategy, and where a play of it can keep assumption (c) for ever without a goal, None if nowhere.
    """
    from surefoot.navigation._strategy_kernels import met, stalled

    arena, goals = game.arena, game.problem.goals
    memory = 1 % len(goals) if game.problem.start == goals[0] else 0
    graph = (arena.first, arena.successors, game.order, arena.goals)
    nodes, pursued, turns = met(*graph, solution.choice, memory)
    place = stalled(*graph, game.blocked, solution.rank, solution.choice, nodes, pursued, turns)
    stuck = f"the cell {tuple(game.problem.coarse.grid.cell(int(game.cell[nodes[place]])))}" if place >= 0 else None
    numbers, state = np.unique(game.knowledge[nodes], return_inverse=True)
    strategy = NavigationStrategy(
        game.cell[nodes],
        game.heading[nodes],
        state.astype(np.int32),
        pursued,
        game.order[turns],
        tuple(game.states[number] for number in numbers.tolist()),
        goals,
        game.kinds.cells,
        tuple(kind.obstacles for kind in game.kinds),
    )
    return strategy, stuck


def _explain(game: NavigationGame, solution: Solution) -> Unrealizable:
    """Return which goals fail even alone, and the cells from which the robot always loses."""
    grid = game.problem.coarse.grid
    failing = failing_goals(game.arena, solution, 0)
    decisions = game.order < 0
    winning_cells = set(game.cell[decisions & solution.winning].tolist())
    losing = tuple(sorted(set(game.cell[decisions].tolist()) - winning_cells))
    named = [_goal_name(game, number) for number in failing]
    which = (
        f"{' and '.join(named)} cannot be reached again and again"
        if named
        else "the goals cannot all be reached in turn"
    )
    shown = ", ".join(str(tuple(grid.cell(cell))) for cell in losing[:12]) + (", ..." if len(losing) > 12 else "")
    where = f"whatever it knows, the robot loses from {shown}" if losing else "it depends on what the robot knows"
    return Unrealizable(f"{which}; {where}", tuple(failing), losing, obstacle_play(game))


def _goal_name(game: NavigationGame, number: int) -> str:
    """Return how to call a goal, with what is wrong with its cell if it is a dead end."""
    coarse, goal = game.problem.coarse, game.problem.goals[number]
    ways = int((coarse.target[goal] >= 0).sum())
    dead_end = ", a dead end (the robot makes no U-turn)" if ways <= 1 else ""
    return f"goal {number} in cell {tuple(coarse.grid.cell(goal))}{dead_end}"

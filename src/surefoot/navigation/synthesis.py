"""From games to strategies: solve, extract what is played, and run the checks beyond realizability."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from surefoot.compute import Deadline
from surefoot.frames import Direction
from surefoot.games import Solution, environment_cannot_keep_assumptions, failing_goals, solve
from surefoot.navigation.action_game import ActionGame, FineState, decode_states
from surefoot.navigation.action_rules import STOP_ORDER
from surefoot.navigation.navigation_game import NavigationGame, Order, Rules
from surefoot.navigation.obstacles import ObstacleState
from surefoot.navigation.strategies import ActionStrategy, NavigationStrategy
from surefoot.verdict import Verdict


@dataclass(frozen=True, slots=True)
class Unrealizable:
    """Why a game has no winning strategy.

    Attributes:
        reason: one sentence or a few.
        failing_goals: indices of the goals that cannot be pursued for ever even alone.
        losing_cells: cells at which the robot decides and cannot win, whatever it knows.
    """

    reason: str
    failing_goals: tuple[int, ...] = ()
    losing_cells: tuple[int, ...] = ()


def solve_navigation(
    game: NavigationGame, deadline: Deadline | None = None
) -> tuple[Verdict[Unrealizable], NavigationStrategy | None]:
    """Solve a navigation game and run both checks beyond realizability.

    Args:
        game: the game.
        deadline: when to give up.

    Returns:
        The verdict, and the strategy when the verdict is yes.

    Source: Shamsah et al., T-RO 2023, VI-D; the checks: docs/rules.md 4, last paragraph.
    """
    solution = solve(game.arena, deadline=deadline or Deadline())
    if not solution.winning[0]:
        return Verdict.false(_explain(game, solution)), None
    forced = environment_cannot_keep_assumptions(game.arena, np.arange(game.arena.system.size))
    if len(forced):
        cell = game.problem.coarse.grid.cell(int(game.cell[forced[0]]))
        reason = (
            f"obstacles cannot keep assumption (c) from {len(forced)} nodes, "
            f"for instance with the robot in {tuple(cell)}"
        )
        return Verdict.false(Unrealizable(reason)), None
    strategy = extract_navigation_strategy(game, solution)
    stuck = deadlocks(game, strategy)
    if stuck:
        names = ", ".join(map(str, stuck[:3]))
        return Verdict.false(
            Unrealizable(f"with the true obstacle in play some goal can no longer be reached from {names}")
        ), None
    return Verdict.true(), strategy


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
    return Unrealizable(f"{which}; {where}", tuple(failing), losing)


def _goal_name(game: NavigationGame, number: int) -> str:
    """Return how to call a goal, with what is wrong with its cell if it is a dead end."""
    coarse, goal = game.problem.coarse, game.problem.goals[number]
    ways = int((coarse.target[goal] >= 0).sum())
    dead_end = ", a dead end (the robot makes no U-turn)" if ways <= 1 else ""
    return f"goal {number} in cell {tuple(coarse.grid.cell(goal))}{dead_end}"


def extract_navigation_strategy(game: NavigationGame, solution: Solution) -> NavigationStrategy:
    """Return the decisions that are met when the strategy plays from the start."""
    arena, goals = game.arena, game.problem.goals
    orders: dict[tuple[int, int, tuple[int, ...], int, int], int] = {}

    def advance(cell: int, goal: int) -> int:
        return (goal + 1) % len(goals) if cell == goals[goal] else goal

    queue = deque([(0, advance(game.problem.start, 0))])
    met = set(queue)
    while queue:
        node, goal = queue.popleft()
        turn = int(arena.successors[arena.first[node] + solution.choice[goal, node]])
        state = game.states[game.knowledge[node]]
        key = (int(game.cell[node]), int(game.heading[node]), state.visible, state.hidden, goal)
        order = Order.of(int(game.order[turn]))
        orders[key] = order.code
        for successor in arena.successors[arena.first[turn] : arena.first[turn + 1]].tolist():
            after = (successor, goal if order.waits else advance(int(game.cell[successor]), goal))
            if after not in met:
                met.add(after)
                queue.append(after)
    return NavigationStrategy(orders, goals, game.domain.cells, len(game.problem.obstacle_starts))


def deadlocks(game: NavigationGame, strategy: NavigationStrategy) -> tuple[str, ...]:
    """Return situations of strategy, belief and one true obstacle from which some goal can no longer be reached.

    With several obstacles each is followed alone among what the others may do.
    """
    if not game.problem.obstacle_starts:
        return ()
    rules = Rules(game.problem, game.domain)
    product = _TrueObstacleProduct(rules, strategy)
    stuck = product.without_progress()
    grid = game.problem.coarse.grid
    return tuple(
        f"robot {tuple(grid.cell(cell))} heading {Direction(heading).name.lower()}, obstacle {tuple(grid.cell(truth))}"
        for cell, heading, _, _, truth in stuck
    )


_Situation = tuple[int, Direction, ObstacleState, int, int]


class _TrueObstacleProduct:
    """The reachable product of a strategy, what it knows, and where one obstacle truly is."""

    def __init__(self, rules: Rules, strategy: NavigationStrategy) -> None:
        problem = rules.problem
        state = rules.start()
        goal = strategy.advance(0, problem.start)
        queue: list[_Situation] = [
            (problem.start, problem.heading, state, goal, truth) for truth in problem.obstacle_starts
        ]
        self.number = {situation: index for index, situation in enumerate(queue)}
        self.predecessors: list[list[int]] = [[] for _ in queue]
        self.progress: list[int] = []
        for index, (cell, heading, knowledge, memory, truth) in enumerate(queue):
            order = strategy.decide(cell, heading, knowledge, memory)
            arrival, facing = rules.arrival(cell, heading, order)
            memory_after = memory if order.waits else strategy.advance(memory, arrival)
            if not order.waits and arrival == problem.goals[memory]:
                self.progress.append(index)
            for truth_after, after in self._moves(rules, cell, arrival, order, knowledge, truth):
                situation = (arrival, facing, after, memory_after, truth_after)
                if situation not in self.number:
                    self.number[situation] = len(queue)
                    queue.append(situation)
                    self.predecessors.append([])
                self.predecessors[self.number[situation]].append(index)
        self.situations = queue

    @staticmethod
    def _moves(
        rules: Rules, cell: int, arrival: int, order: Order, knowledge: ObstacleState, truth: int
    ) -> list[tuple[int, ObstacleState]]:
        """Return where the true obstacle can go, with every matching observation."""
        domain = rules.domain
        view = arrival if rules.problem.view == "post" else cell
        reach = domain.reach[domain.bit[truth]] & ~(domain.mask((cell,)) if order.waits else 0)
        outcomes = rules.outcomes(cell, arrival, order, knowledge)
        moves = []
        for after in domain.members(reach):
            seen = domain.seen_from[view] >> domain.bit[after] & 1
            matching = (state for state in outcomes if (after in state.visible if seen else state.hidden))
            moves += [(after, state) for state in matching]
        return moves

    def without_progress(self) -> list[_Situation]:
        """Return the situations from which no path leads to an advance of the goal."""
        alive = set(self.progress)
        queue = deque(alive)
        while queue:
            for before in self.predecessors[queue.popleft()]:
                if before not in alive:
                    alive.add(before)
                    queue.append(before)
        return [situation for index, situation in enumerate(self.situations) if index not in alive]


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

"""The navigation game: a biped on coarse cells against obstacles that can hide (docs/rules.md, section 4)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from surefoot.compute import Deadline
from surefoot.frames import Direction
from surefoot.games import Arena
from surefoot.navigation.belief import (
    Abstraction,
    BeliefKind,
    abstraction,
    collision_image,
    first_knowledge,
    observe,
)
from surefoot.navigation.coarse import CoarseMap
from surefoot.navigation.obstacles import Blocking, ObstacleDomain, ObstacleState, obstacle_domain

View = Literal["post", "pre"]


class Order(NamedTuple):
    """What the navigation strategy asks of the action strategy.

    Attributes:
        direction: the move, or the move that is waited for.
        waits: whether the robot stops and waits.
    """

    direction: Direction
    waits: bool

    @property
    def code(self) -> int:
        """Return 0-3 for moves, 4-7 for waits."""
        return int(self.direction) + 4 * self.waits

    @classmethod
    def of(cls, code: int) -> Order:
        """Return the order with a code."""
        return cls(Direction(code % 4), code >= 4)

    def __str__(self) -> str:
        """Return for instance 'move north'."""
        return f"{'wait' if self.waits else 'move'} {self.direction.name.lower()}"


@dataclass(frozen=True, slots=True)
class NavigationProblem:
    """Everything that the navigation game is made of.

    Attributes:
        coarse: the map.
        start: the robot's cell.
        heading: the robot's heading.
        goals: cells to visit in this order, for ever.
        obstacle_starts: where the obstacles are at the start.
        forbidden: cells that no obstacle enters.
        regions: belief regions; the rest is one more.
        belief: how beliefs are abstracted.
        view: whether the robot looks after its own move ("post") or before it ("pre").
    """

    coarse: CoarseMap
    start: int
    heading: Direction
    goals: tuple[int, ...]
    obstacle_starts: tuple[int, ...] = ()
    forbidden: frozenset[int] = frozenset()
    regions: tuple[frozenset[int], ...] = ()
    belief: BeliefKind = "regions"
    view: View = "post"

    @property
    def domain(self) -> ObstacleDomain:
        """Return where obstacles may be."""
        return obstacle_domain(self.coarse, self.forbidden)


@dataclass(frozen=True, slots=True)
class NavigationGame:
    """The game graph with the meaning of its nodes.

    Attributes:
        problem: what it was built from.
        domain: where obstacles may be.
        arena: the game graph; node 0 is the start, a decision of the robot.
        cell: (nodes,) the robot's cell.
        heading: (nodes,) its heading.
        order: (nodes,) the code of the order that is carried out, -1 at decisions.
        knowledge: (nodes,) index into ``states``.
        states: what the robot can know of the obstacles.
    """

    problem: NavigationProblem
    domain: ObstacleDomain
    arena: Arena
    cell: NDArray[np.int32]
    heading: NDArray[np.int8]
    order: NDArray[np.int8]
    knowledge: NDArray[np.int32]
    states: tuple[ObstacleState, ...]

    @property
    def decisions(self) -> int:
        """Return the number of nodes at which the robot decides."""
        return int((self.order < 0).sum())

    @property
    def turns(self) -> int:
        """Return the number of nodes at which the obstacles move."""
        return int((self.order >= 0).sum())


def allowed_orders(coarse: CoarseMap, cell: int, heading: Direction) -> tuple[Order, ...]:
    """Return the orders that rules.md 4 allows: no U-turn, and on stairs only straight on."""
    open_moves = [move for move in Direction if move is not heading.opposite and coarse.target[cell, move] >= 0]
    if coarse.is_stairs(cell):
        return tuple(Order(move, False) for move in open_moves if move is heading)
    return tuple(Order(move, waits) for waits in (False, True) for move in open_moves)


class Rules:
    """The moves of both players (rules.md 4), with remembered obstacle successors."""

    def __init__(self, problem: NavigationProblem, domain: ObstacleDomain) -> None:
        self.problem = problem
        self.domain = domain
        self.abstract: Abstraction = abstraction(problem.belief, domain, problem.regions)
        self.blocking = Blocking(problem.coarse, domain)
        self._outcomes: dict[tuple[ObstacleState, int, int | None], tuple[ObstacleState, ...]] = {}

    def start(self) -> ObstacleState:
        """Return what the robot knows at the start."""
        return first_knowledge(self.domain, self.abstract, self.problem.start, self.problem.obstacle_starts)

    def arrival(self, cell: int, heading: Direction, order: Order) -> tuple[int, Direction]:
        """Return the robot's cell and heading after an order."""
        if order.waits:
            return cell, heading
        return int(self.problem.coarse.target[cell, order.direction]), order.direction

    def is_lost(self, cell: int, order: Order, state: ObstacleState) -> bool:
        """Return whether a collision is possible in this turn (the collision guarantee)."""
        if order.waits:
            return False
        target = int(self.problem.coarse.target[cell, order.direction])
        return bool(collision_image(self.domain, state) & self.domain.mask((cell, target)))

    def outcomes(self, cell: int, arrival: int, order: Order, state: ObstacleState) -> tuple[ObstacleState, ...]:
        """Return what the robot may know after the turn."""
        view = arrival if self.problem.view == "post" else cell
        standing = cell if order.waits else None
        key = (state, view, standing)
        if key not in self._outcomes:
            count = len(self.problem.obstacle_starts)
            self._outcomes[key] = observe(self.domain, self.abstract, state, count, view, standing)
        return self._outcomes[key]


def build_navigation_game(problem: NavigationProblem, deadline: Deadline | None = None) -> NavigationGame:
    """Explore the game graph from the start.

    Nodes are decisions of the robot (cell, heading, knowledge) and turns of the obstacles (cell, heading, order,
    knowledge).
    A turn in which a collision is possible is a lost node without successors.

    Args:
        problem: what to build.
        deadline: when to give up.

    Raises:
        LimitExceeded: when the deadline passes.

    Source: Shamsah et al., T-RO 2023, VI-A, VI-D, VI-E; docs/rules.md 4.
    """
    limit = deadline or Deadline()
    rules = Rules(problem, problem.domain)
    coarse = problem.coarse
    state_ids: dict[ObstacleState, int] = {}

    def identify(state: ObstacleState) -> int:
        return state_ids.setdefault(state, len(state_ids))

    orders = {
        (cell, heading): allowed_orders(coarse, cell, heading)
        for cell in map(coarse.grid.index, coarse.grid.free_cells())
        for heading in Direction
    }
    nodes: dict[tuple[int, int, int, int], int] = {}
    queue: list[tuple[int, Direction, Order | None, ObstacleState]] = []
    first: list[int] = [0]
    successors: list[int] = []
    lost: list[bool] = []
    blocked: list[int] = []

    def visit(cell: int, heading: Direction, order: Order | None, state: ObstacleState) -> int:
        key = (cell, heading, -1 if order is None else order.code, identify(state))
        if key not in nodes:
            nodes[key] = len(nodes)
            queue.append((cell, heading, order, state))
        return nodes[key]

    visit(problem.start, problem.heading, None, rules.start())
    for cell, heading, order, state in queue:
        if len(lost) % 4096 == 0:
            limit.check("building the navigation game")
        bad, waits_in_vain = False, False
        if order is None:
            successors += [visit(cell, heading, choice, state) for choice in orders[cell, heading]]
        elif not (bad := rules.is_lost(cell, order, state)):
            waits_in_vain = order.waits and rules.blocking(cell, order.direction, state)
            arrival, facing = rules.arrival(cell, heading, order)
            successors += [visit(arrival, facing, None, after) for after in rules.outcomes(cell, arrival, order, state)]
        first.append(len(successors))
        lost.append(bad)
        blocked.append(order.direction if waits_in_vain and order is not None else -1)
    keys = np.array(list(nodes), np.int32).reshape(-1, 4)
    order_code = keys[:, 2].astype(np.int8)
    moves = (order_code >= 0) & (order_code < 4)
    # A goal is visited by the turn that arrives there; standing in it does not visit it again.
    arrives_at = np.where(moves, problem.coarse.target[keys[:, 0], np.where(moves, order_code, 0)], -1)
    arena = Arena(
        system=order_code < 0,
        first=np.array(first, np.int64),
        successors=np.array(successors, np.int32),
        lost=np.array(lost, np.bool_),
        goals=np.array([arrives_at == goal for goal in problem.goals]),
        justices=_justices(order_code, np.array(blocked, np.int8)),
    )
    return NavigationGame(
        problem,
        rules.domain,
        arena,
        keys[:, 0].copy(),
        keys[:, 1].astype(np.int8),
        order_code,
        keys[:, 3].copy(),
        tuple(state_ids),
    )


def _justices(order: NDArray[np.int8], blocked: NDArray[np.int8]) -> NDArray[np.bool_]:
    """Return assumption (c), a row for every direction that is ever blocked: turns in which that wait is not in vain.

    Decisions satisfy none, so that only turns count; a direction that is never blocked would be a justice that
    always holds.
    """
    rows = [(order >= 0) & (blocked != direction) for direction in Direction if (blocked == direction).any()]
    return np.array(rows, np.bool_).reshape(-1, len(order))

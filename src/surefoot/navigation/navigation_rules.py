"""The rules of the navigation game: its problem, the robot's orders, the obstacles' answers (docs/rules.md, 4)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

from surefoot.frames import Direction
from surefoot.navigation.belief import Abstraction, BeliefKind, abstraction, first_knowledge, observe
from surefoot.navigation.coarse import CoarseMap
from surefoot.navigation.obstacles import BeliefTracking, Obstacle, ObstacleKinds, ObstacleState, obstacle_kinds

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
        obstacles: what moves there.
        regions: belief regions; the rest is one more.
        belief: how beliefs are abstracted.
        view: whether the robot looks after its own move ("post") or before it ("pre").
        belief_tracking: whether equal obstacles are told apart ("separate") or not ("joint").
        escape_clause: whether assumption (c) counts only threats of obstacles that could make way; False, a reading of
            the paper, counts every threat, visible or believed (docs/navigation.md).
    """

    coarse: CoarseMap
    start: int
    heading: Direction
    goals: tuple[int, ...]
    obstacles: tuple[Obstacle, ...] = ()
    regions: tuple[frozenset[int], ...] = ()
    belief: BeliefKind = "regions"
    view: View = "post"
    belief_tracking: BeliefTracking = "joint"
    escape_clause: bool = True
    known: ObstacleState | None = None

    @property
    def obstacle_starts(self) -> tuple[int, ...]:
        """Return where the obstacles are at the start."""
        return tuple(obstacle.start for obstacle in self.obstacles)

    @property
    def obstacle_kinds(self) -> ObstacleKinds:
        """Return the obstacles, sorted into kinds."""
        return obstacle_kinds(self.coarse, self.obstacles, self.belief_tracking)


def allowed_orders(coarse: CoarseMap, cell: int, heading: Direction) -> tuple[Order, ...]:
    """Return the orders that rules.md 4 allows: no U-turn, and on stairs only straight on."""
    open_moves = [move for move in Direction if move is not heading.opposite and coarse.target[cell, move] >= 0]
    if coarse.is_stairs(cell):
        return tuple(Order(move, False) for move in open_moves if move is heading)
    return tuple(Order(move, waits) for waits in (False, True) for move in open_moves)


class Rules:
    """The moves of both players (rules.md 4), one turn at a time."""

    def __init__(self, problem: NavigationProblem) -> None:
        self.problem = problem
        self.kinds = problem.obstacle_kinds
        self.abstract: Abstraction = abstraction(problem.belief, self.kinds, problem.regions)

    def start(self) -> ObstacleState:
        """Return what the robot knows at the start."""
        problem = self.problem
        if problem.known is None:
            return first_knowledge(self.kinds, self.abstract, problem.start, problem.obstacle_starts)
        hidden = (
            self.abstract(self.kinds, kind, mask, problem.start) if mask else 0
            for kind, mask in zip(self.kinds, problem.known.hidden, strict=True)
        )
        return ObstacleState(problem.known.visible, tuple(hidden))

    def arrival(self, cell: int, heading: Direction, order: Order) -> tuple[int, Direction]:
        """Return the robot's cell and heading after an order."""
        if order.waits:
            return cell, heading
        return int(self.problem.coarse.target[cell, order.direction]), order.direction

    def is_lost(self, cell: int, order: Order, state: ObstacleState) -> bool:
        """Return whether a collision is possible in this turn (the collision guarantee)."""
        if order.waits:
            return False
        passed = self.kinds.mask((cell, int(self.problem.coarse.target[cell, order.direction])))
        possible = state.possible(self.kinds)
        return any(kind.image(mask) & passed for kind, mask in zip(self.kinds, possible, strict=True))

    def outcomes(self, cell: int, arrival: int, order: Order, state: ObstacleState) -> tuple[ObstacleState, ...]:
        """Return what the robot may know after the turn."""
        view = arrival if self.problem.view == "post" else cell
        return observe(self.kinds, self.abstract, state, view, cell if order.waits else None)

"""The navigation game: a biped on coarse cells against obstacles that can hide (docs/rules.md, section 4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.compute import Deadline
from surefoot.frames import Direction
from surefoot.games import Arena
from surefoot.navigation.navigation_rules import NavigationProblem, Rules
from surefoot.navigation.obstacles import ObstacleKinds, ObstacleState


@dataclass(frozen=True, slots=True, eq=False)
class NavigationGame:
    """The game graph with the meaning of its nodes.

    A node is a decision of the robot, a turn of the obstacles (an order is carried out), or the obstacles' answer to
    every order that waits in one place.

    Attributes:
        problem: what it was built from.
        kinds: the obstacles.
        arena: the game graph; node 0 is the start, a decision of the robot.
        cell: (nodes,) the robot's cell.
        heading: (nodes,) its heading; at a turn that moves the robot, the heading of the move.
        order: (nodes,) the code of the order that is carried out, -1 at decisions, 8 at common answers to waits.
        blocked: (nodes,) the direction of a wait that assumption (c) promises not to last, else -1.
        knowledge: (nodes,) index into ``states``.
        states: what the robot can know of the obstacles.
    """

    problem: NavigationProblem
    kinds: ObstacleKinds
    arena: Arena
    cell: NDArray[np.int32]
    heading: NDArray[np.int8]
    order: NDArray[np.int8]
    blocked: NDArray[np.int8]
    knowledge: NDArray[np.int32]
    states: tuple[ObstacleState, ...]

    @property
    def decisions(self) -> int:
        """Return the number of nodes at which the robot decides."""
        return int((self.order < 0).sum())

    @property
    def turns(self) -> int:
        """Return the number of nodes at which an order is carried out."""
        return int(((self.order >= 0) & (self.order < 8)).sum())


def build_navigation_game(problem: NavigationProblem, deadline: Deadline | None = None) -> NavigationGame:
    """Explore the game graph from the start.

    Orders with which a collision is possible are left out, so that a decision without a safe order is a dead end.

    Args:
        problem: what to build.
        deadline: when to give up.

    Raises:
        LimitExceeded: when the deadline passes, or the game is too large.

    Source: Shamsah et al., T-RO 2023, VI-A, VI-D, VI-E, VI-F; docs/rules.md 4.
    """
    from surefoot.navigation._exploration import explored, states_of
    from surefoot.navigation._world_arrays import world_of

    rules = Rules(problem)
    tables = explored(rules, world_of(rules), deadline or Deadline())
    nodes = int(tables.nodes.used[0])
    code = tables.nodes.left[:nodes]
    numbers, knowledge = np.unique(tables.nodes.right[:nodes], return_inverse=True)
    cell, order, blocked = (code // 64).astype(np.int32), (code % 16 - 1).astype(np.int8), tables.blocked[:nodes].copy()
    return NavigationGame(
        problem=problem,
        kinds=rules.kinds,
        arena=Arena(
            system=order < 0,
            first=tables.first[: nodes + 1].copy(),
            successors=tables.edges[: tables.first[nodes]].copy(),
            lost=np.zeros(nodes, np.bool_),
            goals=_goals(problem, cell, order),
            justices=_justices(order, blocked),
        ),
        cell=cell,
        heading=(code // 16 % 4).astype(np.int8),
        order=order,
        blocked=blocked,
        knowledge=knowledge.astype(np.int32),
        states=states_of(tables, rules.kinds, numbers),
    )


def _goals(problem: NavigationProblem, cell: NDArray[np.int32], order: NDArray[np.int8]) -> NDArray[np.bool_]:
    """Return for every goal the turns that arrive there; standing in a goal does not visit it again."""
    moves = (order >= 0) & (order < 4)
    arrives_at = np.where(moves, problem.coarse.target[cell, np.where(moves, order, 0)], -1)
    return np.array([arrives_at == goal for goal in problem.goals])


def _justices(order: NDArray[np.int8], blocked: NDArray[np.int8]) -> NDArray[np.bool_]:
    """Return assumption (c), a row for every direction that is ever blocked: turns in which that wait is not in vain.

    Only turns count, not decisions or answers; a direction that is never blocked would be a justice that always holds.
    """
    turn = (order >= 0) & (order < 8)
    rows = [turn & (blocked != direction) for direction in Direction if (blocked == direction).any()]
    return np.array(rows, np.bool_).reshape(-1, len(order))

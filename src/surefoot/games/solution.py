"""What every engine that solves games takes and returns, and how a solution is played."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from surefoot.compute import Deadline
from surefoot.games.arena import Arena
from surefoot.logic.transducer import EnvDeadEnd as EnvDeadEnd

FOREVER = Deadline()


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """Who wins where, and a strategy for the system wherever it wins.

    With N nodes and G goals, or G = 1 when the arena has none: its only goal then holds everywhere.

    Playing it: the memory is the index of the goal pursued, at first 0. Whenever the play VISITS a node, the first one
    included, and whoever moves there, the memory m becomes (m + 1) mod G if the node is in ``goals[m]``, by one at
    most; then, at a system node, the play takes edge ``choice[m]`` with the new memory. See ``visit`` and ``follow``.
    (Updating the memory after the choice, by the same rule, wins as well.)

    Along such a play the rank for the pursued goal never rises until that goal is visited, and where it stays the same,
    the play stays in nodes that wait for one and the same justice, which holds in none of them.

    Attributes:
        winning: (N,) True where the system wins.
        rank: (G, N) a measure of what is left to do for each goal, -1 where not winning. 0 where the goal holds (and
            where the environment has no move and thereby loses).
        choice: (G, N) at a winning system node the edge to take while that goal is pursued, counted from
            ``first[node]``; -1 elsewhere. The lowest rank, then the first edge; where the goal holds, the
            lowest rank for the next goal.
        waits_for: (G, N) the justice that never holds again if the play stays at this rank, which the environment alone
            can bring about; -1 where the rank falls with the next move, where the goal holds, and where not winning.
    """

    winning: NDArray[np.bool_]
    rank: NDArray[np.int32]
    choice: NDArray[np.int32]
    waits_for: NDArray[np.int32]


class Engine(Protocol):
    """A method that solves games; every engine gives the same ``winning``, ranks and choices may differ."""

    def __call__(self, arena: Arena, *, env_dead_end: EnvDeadEnd = "wins", deadline: Deadline = FOREVER) -> Solution:
        """Solve the game "if the environment keeps all justices, the system keeps all goals, and never gets lost".

        Args:
            arena: the game graph. A system node without successors is lost.
            env_dead_end: who wins when the environment has no move: the system ("wins") or not ("loses").
            deadline: when to give up.

        Raises:
            LimitExceeded: once the deadline has passed.
        """
        ...


def visit(arena: Arena, memory: int, node: int) -> int:
    """Return the memory of a play after it has visited a node."""
    goals = len(arena.goals)
    return (memory + 1) % goals if goals and arena.goals[memory, node] else memory


def follow(arena: Arena, solution: Solution, memory: int, node: int) -> int:
    """Return the successor that the strategy takes at a winning system node; the memory has visited it already."""
    edge = int(solution.choice[memory, node])
    if edge < 0:
        raise ValueError(f"node {node} is not a winning node of the system: the strategy has no move there")
    return int(arena.successors[arena.first[node] + edge])

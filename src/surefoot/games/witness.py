"""Why a game is lost, or won for the wrong reason."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from surefoot.compute import Deadline
from surefoot.games.arena import Arena, reachable, restrict, swap_players, with_goals
from surefoot.games.explicit import solve
from surefoot.games.solution import FOREVER, EnvDeadEnd, Solution


def failing_goals(
    arena: Arena,
    solution: Solution,
    initial: int,
    *,
    env_dead_end: EnvDeadEnd = "wins",
    deadline: Deadline = FOREVER,
) -> tuple[int, ...]:
    """Return the goals that the system cannot reach again and again even if each were its only one.

    Empty where the game is won, and where it is lost although every goal alone can be won: they exclude each other.
    All of them when the system cannot even stay safe (see ``can_stay_safe``).

    Args:
        arena: the game.
        solution: its solution.
        initial: the node where the play starts.
        env_dead_end: as it was given to the solver.
        deadline: when to give up.

    Raises:
        LimitExceeded: once the deadline has passed.
    """
    if solution.winning[initial]:
        return ()
    part, start = _reachable_part(arena, initial)
    alone = (solve(with_goals(part, g), env_dead_end=env_dead_end, deadline=deadline) for g in range(len(arena.goals)))
    return tuple(g for g, answer in enumerate(alone) if not answer.winning[start])


def can_stay_safe(
    arena: Arena, initial: int, *, env_dead_end: EnvDeadEnd = "wins", deadline: Deadline = FOREVER
) -> bool:
    """Return whether the system can avoid lost nodes and its own dead ends for ever, with no goal at all."""
    part, start = _reachable_part(arena, initial)
    answer = solve(with_goals(part, ()), env_dead_end=env_dead_end, deadline=deadline)
    return bool(answer.winning[start])


def environment_cannot_keep_assumptions(
    arena: Arena, nodes: ArrayLike, *, deadline: Deadline = FOREVER
) -> NDArray[np.int64]:
    """Return those of the given nodes from which the environment cannot keep all its justices, whatever it does.

    There the system can win by making the environment break its word. A play into a lost node or into a dead end of
    the system is the system's mistake and counts for the environment; a dead end of the environment counts against it.

    Args:
        arena: the game; its goals do not matter.
        nodes: node numbers, for instance all that a strategy can visit.
        deadline: when to give up.

    Returns:
        node numbers in their given order.

    Raises:
        LimitExceeded: once the deadline has passed.

    Source: this is well-separation, node by node; Maoz and Ringert, "On well-separation of GR(1) specifications", 2016.
    """
    asked = np.asarray(nodes, dtype=np.int64).reshape(-1)
    keeps = solve(swap_players(arena), env_dead_end="wins", deadline=deadline).winning
    return asked[~keeps[asked]]


def _reachable_part(arena: Arena, initial: int) -> tuple[Arena, int]:
    """Return the arena of the nodes that a play from the initial one can visit, and that node's number in it."""
    seen = reachable(arena, initial)
    return restrict(arena, seen), int(np.count_nonzero(seen[:initial]))

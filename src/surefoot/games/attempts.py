"""Solving symbolically within limits: variable orders in turn, and a watch over operations that run too long."""

from __future__ import annotations

import threading
from collections.abc import Callable
from functools import partial
from itertools import count
from math import inf
from time import monotonic
from typing import TypeVar

from surefoot.compute import Deadline
from surefoot.errors import LimitExceeded
from surefoot.games.bits import BitGame
from surefoot.games.diagrams import Backend, Set
from surefoot.games.ordering import variable_orders
from surefoot.games.relation import OutOfWork
from surefoot.games.solution import EnvDeadEnd
from surefoot.games.symbolic import SymbolicGame, SymbolicResult, solve_symbolically

FIRST_SHARE = 400_000  # new nodes; some tenths of a second
_GROWTH = 4
_THREAD = "symbolic engine"
_GRACE_S = 0.5
_T = TypeVar("_T")


def attempt(
    game: BitGame,
    *,
    robotics: bool,
    env_dead_end: EnvDeadEnd,
    deadline: Deadline,
    backend: Backend = "oxidd",
    node_limit: int | None = None,
    keep_layers: bool = False,
    whole_region: bool = False,
    most_work: int | None = None,
) -> tuple[SymbolicGame, SymbolicResult]:
    """Solve a game with one variable order after the other, with growing shares of work, until one is done.

    The better order may be faster by a factor of a hundred, and no measure of the order alone tells which it is. The
    shares count nodes, not seconds, so that the outcome is the same every time.

    Raises:
        LimitExceeded: once the deadline or the node limit is passed.
        OutOfWork: once all orders have used up ``most_work``.
    """
    orders = variable_orders(game)
    for turn in count():
        share = FIRST_SHARE * _GROWTH ** (turn // len(orders))
        if most_work is not None and share > most_work:
            raise OutOfWork
        try:
            solved = SymbolicGame(
                game,
                env_dead_end=env_dead_end,
                deadline=deadline,
                backend=backend,
                node_limit=node_limit,
                order=orders[turn % len(orders)],
                most_work=share,
            )
            stop = _never if whole_region else partial(_is_lost, solved, robotics)
            return solved, solve_symbolically(solved, stop=stop, keep_layers=keep_layers)
        except OutOfWork:
            continue
    raise AssertionError


def _is_lost(game: SymbolicGame, robotics: bool, winning: Set) -> bool:
    return not game.wins_initially(winning, robotics)


def _never(winning: Set) -> bool:
    return False


def left_behind() -> bool:
    """Return whether a computation that was given up still runs."""
    return any(thread.name == _THREAD for thread in threading.enumerate())


def watched(work: Callable[[], _T], deadline: Deadline) -> _T:
    """Return what a computation returns, or give up on time even inside one long operation of the back end.

    The computation runs in a thread of its own; when it overruns, or the user interrupts, it is left behind. It ends
    with its operation, or with the process.

    Raises:
        LimitExceeded: once the deadline has passed.
    """
    outcome: list[tuple[_T | None, BaseException | None]] = []

    def run() -> None:
        try:
            outcome.append((work(), None))
        except BaseException as problem:
            outcome.append((None, problem))

    thread = threading.Thread(target=run, name=_THREAD, daemon=True)
    thread.start()
    thread.join(None if deadline.end_s == inf else max(deadline.end_s - monotonic(), 0.0) + _GRACE_S)
    if not outcome:
        raise LimitExceeded("solving the game: the time limit was reached")
    value, problem = outcome[0]
    if problem is not None:
        raise problem
    return value  # type: ignore[return-value]

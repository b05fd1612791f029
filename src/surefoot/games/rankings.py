"""The layers of the symbolic fixpoint as a strategy that can be saved, played and checked.

Source: Piterman, Pnueli and Sa'ar, VMCAI 2006, Sec. 5: the memory of the fixpoint is the strategy.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surefoot.compute import Deadline
from surefoot.errors import LimitExceeded
from surefoot.games.attempts import FIRST_SHARE
from surefoot.games.diagrams import Set
from surefoot.games.reach import Reach
from surefoot.games.relation import OutOfWork
from surefoot.games.symbolic import SymbolicGame, SymbolicResult
from surefoot.games.walks import Tables
from surefoot.logic.ranking import Ranking

MOST_ROWS = 20_000_000


def ranking_of(game: SymbolicGame, result: SymbolicResult, deadline: Deadline) -> Ranking:
    """Return the ranking of a game that was solved with its layers kept.

    Raises:
        LimitExceeded: if it has more rows than a file may hold, or the deadline has passed.
    """
    tables = Tables(game.manager)

    def rows(sets: Sequence[Set]) -> list[int]:
        deadline.check("writing the strategy out")
        if tables.size > MOST_ROWS:
            raise LimitExceeded(f"the strategy has more than {MOST_ROWS} rows")
        return [tables.root(one) for one in sets]

    layers = [layer for of_goal in result.layers for layer in of_goal]
    env_init, sys_init, winning = rows([game.env_init, game.sys_init, result.winning])
    roots = {
        "environment": rows(game.environment.rules),
        "system": rows(game.system.rules),
        "goals": rows([goal.set for goal in game.goals]),
        "justices": rows([justice.set for justice in game.justices]),
        "layers": [row for layer in layers for row in rows([layer.reached])],
    }
    variable, low, high = tables.arrays()
    spec = game.game.spec
    return Ranking(
        variables=spec.variables,
        inputs=len(spec.inputs),
        order=np.array([bit for bit, _ in sorted(game.encoder.place.items(), key=lambda item: item[1])]),
        variable=variable,
        low=low,
        high=high,
        env_init=env_init,
        sys_init=sys_init,
        winning=winning,
        first=np.cumsum([0, *(len(of_goal) for of_goal in result.layers)]),
        waits_for=np.array([layer.justice for layer in layers]),
        **{name: np.array(row) for name, row in roots.items()},
    )


def reaches_dead_ends(game: SymbolicGame, result: SymbolicResult) -> bool:
    """Return whether plays inside the winning states may get where the environment has no move; False if unknown."""
    manager, encoder = game.manager, game.encoder
    stuck = manager.conjoin(result.winning, ~game.environment.some(manager.true))
    if stuck == manager.false:
        return False
    encoder.most_work = encoder.work + 4 * FIRST_SHARE
    try:
        return bool(manager.conjoin(Reach(game, result.winning).closure(), stuck) != manager.false)
    except OutOfWork:
        return False
    finally:
        encoder.most_work = None

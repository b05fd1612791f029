"""The explicit engine: the three-nested fixpoint of GR(1) games, node by node.

    nu Z . AND_g  mu Y . OR_j  nu X . (goal_g and cpre(Z)) or cpre(Y) or (not justice_j and cpre(X))

``cpre(S)``: at a system node some successor lies in S, at an environment node all of them do. Three shortcuts leave the
result as it is. Y is sought inside Z only: whoever follows a strategy that wins stays among nodes that win. Z is cut
down as soon as one goal has shrunk it, and kept so that Z = cpre(Z) on it; the goal is then any node of goal_g and Z.
And cpre(Y) is saturated before an assumption is used ("bias for action": the robot moves rather than waits).

Source: Piterman, Pnueli and Sa'ar, "Synthesis of reactive(1) designs", VMCAI 2006; Bloem et al., JCSS 78, 2012, Sec. 3.
"""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING, TypeVar, get_args

import numpy as np
from numpy.typing import NDArray

from surefoot.compute import Deadline
from surefoot.games.arena import Arena
from surefoot.games.solution import FOREVER, EnvDeadEnd, Solution

if TYPE_CHECKING:
    from surefoot.games._sweeps import Game, Layers, Region

_Scalar = TypeVar("_Scalar", bound=np.generic)


def solve(arena: Arena, *, env_dead_end: EnvDeadEnd = "wins", deadline: Deadline = FOREVER) -> Solution:
    """Solve a game; see ``solution.Engine`` for the arguments and ``Solution`` for the strategy.

    The first call on a machine compiles for some seconds; see ``warm_up``.
    """
    from surefoot.games._sweeps import Game

    if env_dead_end not in get_args(EnvDeadEnd):
        raise ValueError(f"env_dead_end is one of {', '.join(get_args(EnvDeadEnd))}, not {env_dead_end!r}")
    game = Game.of(arena, env_dead_end)
    layers = _nu_z(game, _goals(arena), deadline)
    rank = np.stack([y.rank for y in layers])
    choices = [game.best_edges(now, after) for now, after in zip(rank, np.roll(rank, -1, axis=0), strict=True)]
    return Solution(
        winning=_read_only(rank[0] >= 0),
        rank=_read_only(rank),
        choice=_read_only(np.stack(choices)),
        waits_for=_read_only(np.stack([y.waits_for for y in layers])),
    )


def _nu_z(game: Game, goals: NDArray[np.bool_], deadline: Deadline) -> list[Layers]:
    """Solve nu Z . AND_g Y_g(Z): goal after goal, until each of them covers the Z that all of them leave."""
    z = game.all_but_lost()
    layers: dict[int, Layers] = {}
    for g in cycle(range(len(goals))):
        layers[g] = _mu_y(game, z, goals[g], deadline)
        if not layers[g].covers_region:
            z.keep(layers[g])
            layers.clear()
        elif len(layers) == len(goals):
            break
    return [layers[g] for g in range(len(goals))]


def _mu_y(game: Game, z: Region, goal: NDArray[np.bool_], deadline: Deadline) -> Layers:
    """Solve mu Y . OR_j nu X . (goal and Z) or cpre(Y) or (not justice_j and cpre(X)), inside Z."""
    y = game.first_layer(z, goal)
    y.add_attractor()
    before = -1
    while before < y.size and not y.covers_region:
        deadline.check("solving the game")
        before = y.size
        for j in range(len(game.arena.justices)):
            y.add_waiting(j)
        y.add_attractor()
    return y


def _goals(arena: Arena) -> NDArray[np.bool_]:
    return arena.goals if len(arena.goals) else np.ones((1, arena.nodes), dtype=np.bool_)


def _read_only(array: NDArray[_Scalar]) -> NDArray[_Scalar]:
    array.flags.writeable = False
    return array

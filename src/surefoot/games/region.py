"""The winning region of a specification, as repair needs it: all states, reachable or not."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from surefoot.compute import Deadline
from surefoot.games.attempts import attempt, watched
from surefoot.games.bits import bit_game
from surefoot.games.diagrams import Set
from surefoot.games.solution import FOREVER, EnvDeadEnd
from surefoot.games.symbolic import SymbolicGame
from surefoot.games.walks import Walker
from surefoot.logic.syntax import Specification


@dataclass(frozen=True, slots=True, eq=False)
class WinningRegion:
    """The states from which the system wins.

    Attributes:
        game: the symbolic game.
        states: the set.
        walker: looks states up.
    """

    game: SymbolicGame
    states: Set
    walker: Walker

    def contains(self, valuation: Mapping[str, int]) -> bool:
        """Return whether the system wins from a state, given by the value of every variable.

        Raises:
            ValueError: if a value is missing or out of range.
        """
        bits = np.zeros(len(self.game.game.bits), dtype=np.uint8)
        for variable, group in zip(self.game.game.spec.variables, self.game.game.groups, strict=True):
            value = valuation.get(variable.name)
            if value is None or value not in variable.values:
                raise ValueError(f"{variable.name} is one of {list(variable.values)[:8]}, not {value}")
            for weight, bit in enumerate(group):
                bits[bit] = (int(value) - variable.values[0]) >> weight & 1
        return self.walker.contains(self.states, bits)


def winning_region(
    spec: Specification, *, env_dead_end: EnvDeadEnd = "wins", deadline: Deadline = FOREVER
) -> WinningRegion:
    """Return all states from which the system wins, whatever the initial conditions say.

    Raises:
        LimitExceeded: once the deadline has passed.
    """
    game, result = watched(
        lambda: attempt(
            bit_game(spec), robotics=False, env_dead_end=env_dead_end, deadline=deadline, whole_region=True
        ),
        deadline,
    )
    return WinningRegion(game, result.winning, Walker(game))

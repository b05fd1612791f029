"""The states that plays can reach, symbolically: how many there are decides which engine solves the game.

Bits whose present value no rule reads are projected away: two states that differ in them alone are one.
"""

from __future__ import annotations

from surefoot.games.bits import bits_of
from surefoot.games.diagrams import Set
from surefoot.games.relation import mentions
from surefoot.games.symbolic import SymbolicGame


class Reach:
    """Forward images of a game, as far as the system has not lost.

    Args:
        game: the game.
        safe: states outside of which the system has lost; plays end there.
    """

    def __init__(self, game: SymbolicGame, safe: Set) -> None:
        encoder, bits = game.encoder, range(len(game.game.bits))
        read = game.game.read
        self._game, self._manager = game, game.manager
        self._read = len(bits_of(read))
        self._unread = mentions(encoder, ((1 << len(bits)) - 1) & ~read, following=False)
        self._unread_next = mentions(encoder, ((1 << len(bits)) - 1) & ~read, following=True)
        self._present = mentions(encoder, read, following=False)
        self._back = game.manager.renaming([(encoder.then(bit), encoder.now(bit)) for bit in bits])
        self._safe = safe
        self._rules = [*game.environment.rules, *game.system.rules]

    def initial(self) -> Set:
        """Return the initial states that both sides allow, in the bits that matter."""
        together = self._manager.conjoin(self._game.env_init, self._safe)
        return self._manager.and_exists(together, self._game.sys_init, self._unread)

    def image(self, states: Set) -> Set:
        """Return the states after one step by both sides' rules."""
        steps = states
        for rule in self._rules:
            steps = self._manager.conjoin(steps, rule)
        steps = self._manager.exists(self._manager.exists(steps, self._unread_next), self._present)
        return self._manager.conjoin(self._manager.rename(steps, self._back), self._safe)

    def closure(self) -> Set:
        """Return all states that plays can reach."""
        reached = frontier = self.initial()
        while frontier != self._manager.false:
            frontier = self._manager.conjoin(self._game.encoder.spend(self.image(frontier)), ~reached)
            reached = self._manager.unite(reached, frontier)
        return reached

    def count(self, states: Set) -> int:
        """Return how many states a set has, in the bits that matter."""
        variables = 2 * len(self._game.game.bits)
        return self._manager.count(states, variables) >> (variables - self._read)

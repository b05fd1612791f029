"""Is a specification realizable with fewer of the system's lines? Asked again and again, on the same diagrams.

The environment's rules, most of the work, are translated once. What wins with fewer promises contains what wins with
more, so that the winning states of a smaller set, once known, are where the search in a larger one begins.
"""

from __future__ import annotations

from functools import partial

from surefoot.compute import Deadline
from surefoot.games.attempts import FIRST_SHARE
from surefoot.games.bits import bit_game
from surefoot.games.diagrams import Set
from surefoot.games.ordering import variable_orders
from surefoot.games.relation import OutOfWork
from surefoot.games.solution import EnvDeadEnd
from surefoot.games.symbolic import SymbolicGame, solve_symbolically
from surefoot.logic.syntax import Conjunct, Specification

_FIRST_WORK = 4 * FIRST_SHARE
_GLANCE_WORK = 2 * FIRST_SHARE
_GROWTH = 4
_BOUNDS = 3
Order = tuple[int, ...]


class Subsets:
    """Decides a specification with any set of candidates kept.

    Args:
        specification: the whole one.
        candidates: lines that may be left out; all others stay.
        robotics: the reading of realizability.
        env_dead_end: who wins where the environment has no move.
    """

    def __init__(
        self,
        specification: Specification,
        candidates: tuple[Conjunct, ...],
        *,
        robotics: bool,
        env_dead_end: EnvDeadEnd,
    ) -> None:
        """Take the specification; nothing is translated yet."""
        self._game = bit_game(specification)
        self._candidates = frozenset(map(id, candidates))
        self._robotics, self._env_dead_end = robotics, env_dead_end
        self._orders = [tuple(order) for order in variable_orders(self._game)]
        self._encoded: dict[Order, SymbolicGame] = {}
        self._known: list[tuple[Order, frozenset[int], Set]] = []

    def realizable(self, kept: tuple[Conjunct, ...], deadline: Deadline) -> bool:
        """Return whether the system can win if it promises, of the candidates, those kept.

        The order that did the last question is tried first, then the others, with growing shares of work.

        Raises:
            LimitExceeded: once the deadline has passed, or the diagrams are too large.
        """
        work = _FIRST_WORK
        while (answer := self._asked(kept, deadline, work, len(self._orders))) is None:
            work *= _GROWTH
        return answer

    def glanced(self, kept: tuple[Conjunct, ...], deadline: Deadline) -> bool | None:
        """Return the same as ``realizable`` if little work with the best order tells, else None."""
        return self._asked(kept, deadline, _GLANCE_WORK, 1)

    def _asked(self, kept: tuple[Conjunct, ...], deadline: Deadline, work: int, orders: int) -> bool | None:
        names = frozenset(map(id, kept))
        for order in self._orders[:orders]:
            try:
                answer = self._attempt(order, names, deadline, work)
            except OutOfWork:
                continue
            self._orders.remove(order)
            self._orders.insert(0, order)
            return answer
        return None

    def _attempt(self, order: Order, names: frozenset[int], deadline: Deadline, work: int) -> bool:
        whole = self._encoding(order, deadline, work)
        encoder = whole.encoder
        encoder.deadline, encoder.most_work = deadline, encoder.work + work
        game = whole.promising(lambda line: id(line) in names or id(line) not in self._candidates)
        bound = whole.manager.true
        for _, _, winning in self._bounds(order, names):
            bound = encoder.spend(whole.manager.conjoin(bound, winning))
        result = solve_symbolically(game, stop=partial(_is_lost, game, self._robotics), within=bound)
        if not result.stopped_early:
            self._known.append((order, names, result.winning))
        return not result.stopped_early and game.wins_initially(result.winning, self._robotics)

    def _encoding(self, order: Order, deadline: Deadline, work: int) -> SymbolicGame:
        if order not in self._encoded:
            self._encoded[order] = SymbolicGame(
                self._game, env_dead_end=self._env_dead_end, deadline=deadline, order=list(order), most_work=work
            )
        return self._encoded[order]

    def _bounds(self, order: Order, names: frozenset[int]) -> list[tuple[Order, frozenset[int], Set]]:
        """Return what wins with the largest known subsets of a set."""
        inside = [known for known in self._known if known[0] == order and known[1] <= names]
        return sorted(inside, key=lambda known: -len(known[1]))[:_BOUNDS]


def _is_lost(game: SymbolicGame, robotics: bool, winning: Set) -> bool:
    return not game.wins_initially(winning, robotics)

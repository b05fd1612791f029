"""Which engine solves a game: measured, not guessed.

Where a strategy is wanted, the reachable states and moves are counted with little work, and few are enumerated and
solved explicitly: solving takes some hundredths of a second either way, and strategies come a little faster. Where it
is not, the symbolic engine begins, for it needs no compiled code to be loaded, which takes longer than all the rest.
Then a small share of work goes to the symbolic engine; then the states are counted with more work; otherwise the
symbolic engine goes on.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from surefoot.compute import Deadline
from surefoot.errors import LimitExceeded
from surefoot.games.attempts import FIRST_SHARE, attempt
from surefoot.games.bits import BitGame
from surefoot.games.few_states import FEW_MOVES, ExplicitPlayer, ExplicitResult, Measured, measure, solve_few
from surefoot.games.relation import OutOfWork
from surefoot.games.symbolic import SymbolicGame, SymbolicResult
from surefoot.logic.ranking import Ranking
from surefoot.logic.transducer import Transducer

SMALL_MOVES = 20_000
_SMALL_SHARE = FIRST_SHARE // 8
_COUNTING_SHARE = 10 * FIRST_SHARE


@dataclass(frozen=True, slots=True, eq=False)
class Solved:
    """A solved game, by whichever engine.

    Attributes:
        engine: which one.
        why: the reason.
        realizable: the verdict.
        states: reachable states as far as they were counted.
        game: the symbolic game.
        result: what the engine found.
    """

    engine: Literal["explicit", "symbolic"]
    why: str
    realizable: bool
    states: int | None
    game: SymbolicGame
    result: SymbolicResult | ExplicitResult

    def machine(self, *, robotics: bool, deadline: Deadline, most_edges: int) -> Transducer | None:
        """Return the strategy of whoever wins, state by state.

        Raises:
            LimitExceeded: if it is too large, or the deadline has passed.
        """
        from surefoot.games.counter import environment_machine
        from surefoot.games.machines import Player, SystemPlayer, system_machine
        from surefoot.games.walks import Walker

        self.game.encoder.most_work = None
        if not self.realizable:
            return environment_machine(self.game, robotics=robotics, deadline=deadline, most_edges=most_edges)
        walker = Walker(self.game)
        player: Player = (
            ExplicitPlayer(walker, self.result)
            if isinstance(self.result, ExplicitResult)
            else SystemPlayer(walker, self.result)
        )
        return system_machine(walker, player, robotics=robotics, deadline=deadline, most_edges=most_edges)

    def ranking(self, options: dict[str, Any]) -> tuple[Ranking, bool]:
        """Return the strategy of the system as a ranking, and whether the environment may be without a move on its way.

        A game that was solved explicitly is solved again.

        Raises:
            LimitExceeded: if it is too large, or the deadline has passed.
        """
        from surefoot.games.rankings import ranking_of, reaches_dead_ends

        game, result = self.game, self.result
        if isinstance(result, ExplicitResult):
            game, result = attempt(game.game, keep_layers=True, **options)
        game.encoder.most_work = None
        return ranking_of(game, result, options["deadline"]), reaches_dead_ends(game, result)


def solve_by(game: BitGame, engine: str, *, keep_layers: bool, robotics: bool, **options: Any) -> Solved:
    """Solve a game by the engine asked for, or by the one that suits it.

    Args:
        game: the game.
        engine: ``auto``, ``explicit`` or ``symbolic``.
        keep_layers: whether a strategy will be made.
        robotics: the reading of realizability.
        options: env_dead_end, deadline, node_limit and backend; see ``synthesize``.

    Raises:
        LimitExceeded: once a limit is passed.
    """
    if engine == "symbolic":
        return _symbolic(game, "it was asked for", None, keep_layers, robotics, options)
    if engine == "explicit":
        counted = _counted(game, options, None)
        return _explicit(*counted, "it was asked for", robotics, options)
    if keep_layers and (small := _small(game, robotics, options)) is not None:
        return small
    try:
        return _symbolic(game, "it took little work", None, keep_layers, robotics, options, most_work=FIRST_SHARE)
    except OutOfWork:
        pass
    try:
        symbolic, measured = _counted(game, options, _COUNTING_SHARE)
    except OutOfWork:
        why = "counting the reachable states takes too much work"
        return _symbolic(game, why, None, keep_layers, robotics, options)
    if measured.moves <= FEW_MOVES:
        try:
            return _explicit(symbolic, measured, _few_words(measured), robotics, options)
        except LimitExceeded:
            options["deadline"].check("solving the game")
    why = f"{measured.states} states with {measured.moves} moves of the environment are reachable: too many to list"
    return _symbolic(game, why, measured.states, keep_layers, robotics, options)


def _small(game: BitGame, robotics: bool, options: dict[str, Any]) -> Solved | None:
    """Return the game solved explicitly if a little counting shows that it is small."""
    try:
        symbolic, measured = _counted(game, options, _SMALL_SHARE)
    except OutOfWork:
        return None
    if measured.moves > SMALL_MOVES:
        return None
    symbolic.encoder.most_work = None
    try:
        return _explicit(symbolic, measured, _few_words(measured), robotics, options)
    except LimitExceeded:
        options["deadline"].check("solving the game")
        return None


def _few_words(measured: Measured) -> str:
    return f"{measured.states} states with {measured.moves} moves of the environment are reachable: few"


def _symbolic(
    game: BitGame,
    why: str,
    states: int | None,
    keep_layers: bool,
    robotics: bool,
    options: dict[str, Any],
    most_work: int | None = None,
) -> Solved:
    solved, result = attempt(game, robotics=robotics, keep_layers=keep_layers, most_work=most_work, **options)
    if states is None:
        states = _few_counted(solved)
    wins = not result.stopped_early and solved.wins_initially(result.winning, robotics)
    return Solved("symbolic", why, wins, states, solved, result)


def _few_counted(game: SymbolicGame) -> int | None:
    """Return the number of reachable states if counting is cheap."""
    from surefoot.games.reach import Reach

    game.encoder.most_work = game.encoder.work + FIRST_SHARE
    reach = Reach(game, game.manager.true)
    try:
        return reach.count(reach.closure())
    except OutOfWork:
        return None


def _counted(game: BitGame, options: dict[str, Any], most_work: int | None) -> tuple[SymbolicGame, Measured]:
    symbolic = SymbolicGame(game, most_work=most_work, **options)
    return symbolic, measure(symbolic)


def _explicit(symbolic: SymbolicGame, measured: Measured, why: str, robotics: bool, options: dict[str, Any]) -> Solved:
    result = solve_few(
        symbolic,
        measured,
        robotics=robotics,
        env_dead_end=options["env_dead_end"],
        deadline=options["deadline"],
    )
    return Solved("explicit", why, result.realizable, measured.states, symbolic, result)

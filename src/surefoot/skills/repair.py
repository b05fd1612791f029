"""Symbolic repair: which transitions would make a lost game won.

One edit at a time, and the winning region is computed again after each. With W the region:

    aim      re-aim a postcondition: a skill that starts outside of W, and stays there, ends in W instead
    extend   extend a precondition: a skill whose outcomes all lie in W may also start in a cell outside of W
    stand    the same for standing still in a cell of W; at the goal this is an ``extend``

Every edit is made to a copy; the skill itself stays as it was (its "backup"). What an edit makes is a move between
neighbours that physics has not refused, so it is one of the given ``inventable`` moves. Only what the final strategy
uses is suggested.

Two failures are told apart. If the goal itself cannot be kept, nothing helps: idling is a move of the robot's, so this
happens only where the goal is lost. Otherwise the start is outside of W, and edits go on until it is inside. ``stand``
is ours: with it a repair is found whenever the inventable moves allow for one (a property test).

Source: docs/skills.md, "Repair"; Pacheck and Kress-Gazit, T-RO 2023, as used by Zhou et al., 2025, Sec. VI-C.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Generic, Protocol

from surefoot.skills.skill_game import Move, S, SkillGame, Solved, solve_game
from surefoot.skills.values import Primitive


class Kind(StrEnum):
    """What an edit changes."""

    AIM = "aim"
    EXTEND = "extend"
    STAND = "stand"


@dataclass(frozen=True, slots=True)
class Edit(Generic[S]):
    """One change of a specification.

    Attributes:
        kind: what is changed.
        edited: the move whose copy is changed; None: standing still.
        made: the transition that comes out.
        needs: primitives that a way from its source through it would need beside the skills at hand, itself included.
    """

    kind: Kind
    edited: Move[S] | None
    made: Move[S]
    needs: frozenset[Primitive]


class Order(Protocol):
    """Which of several edits to make."""

    @property
    def thrifty(self) -> bool:
        """Whether the strategy is confined to the edits that the start needs."""
        ...

    def choose(self, edits: Sequence[Edit[S]]) -> Edit[S]:
        """Return one of the edits, of which there is at least one."""
        ...


@dataclass(slots=True)
class RandomOrder:
    """The paper's order: aim and extend take turns, and among edits of one kind all are equally likely.

    Attributes:
        seed: of the draws.
    """

    seed: int = 9
    _draw: random.Random = field(init=False)
    _first: Kind = field(init=False, default=Kind.AIM)
    thrifty: bool = field(init=False, default=False)

    def __post_init__(self) -> None:
        """Seed the draws."""
        self._draw = random.Random(self.seed)  # noqa: S311 - draws, no secrets

    def choose(self, edits: Sequence[Edit[S]]) -> Edit[S]:
        """Return an edit of the kind whose turn it is, if there is one."""
        second = Kind.EXTEND if self._first is Kind.AIM else Kind.AIM
        ranked = {self._first: 0, second: 1, Kind.STAND: 2}
        kind = min((edit.kind for edit in edits), key=ranked.__getitem__)
        self._first = second
        return self._draw.choice([edit for edit in edits if edit.kind is kind])


@dataclass(frozen=True, slots=True)
class CostAwareOrder:
    """The edit whose source then needs the least predicted cost of new skills.

    Attributes:
        predict: cost of trying a primitive that is not at hand, above 0; see ``prediction``.
    """

    predict: Callable[[Primitive], float]
    thrifty: bool = field(init=False, default=True)

    def choose(self, edits: Sequence[Edit[S]]) -> Edit[S]:
        """Return the cheapest edit, the first of several."""
        return min(edits, key=lambda edit: sum(map(self.predict, edit.needs)))


@dataclass(frozen=True, slots=True)
class Suggestion(Generic[S]):
    """A repair.

    Attributes:
        edits: all that were made.
        moves: the transitions made that the strategy uses.
        winning: the winning region at the end.
    """

    edits: tuple[Edit[S], ...]
    moves: tuple[Move[S], ...]
    winning: frozenset[S]

    @property
    def primitives(self) -> tuple[Primitive, ...]:
        """What physics has to be asked about, each once."""
        return tuple(dict.fromkeys(move.skill for move in self.moves))


def failing_goal(game: SkillGame[S]) -> frozenset[S]:
    """Return the goal if nobody could stay alive after visiting it, however the robot got there; else nothing."""
    return game.goal if game.goal <= game.lost else frozenset()


def repair(game: SkillGame[S], inventable: Iterable[Move[S]], order: Order) -> Suggestion[S] | None:
    """Return transitions that would make the game won, or None if no inventable ones do.

    Args:
        game: a game; if it is won already, nothing is suggested.
        inventable: transitions that a repair may make: between neighbours, not known to be infeasible, not disallowed.
        order: which edit to make where several are possible.
    """
    if failing_goal(game):
        return None
    makeable = [move for move in inventable if not game.breaks(move)]
    solved, edits, current = solve_game(game), list[Edit[S]](), game
    needs: dict[S, frozenset[Primitive]] = dict.fromkeys(solved.winning, frozenset())
    while game.start not in solved.winning:
        possible = list(_possible(current, makeable, solved, needs))
        if not possible:
            return None
        edit = order.choose(possible)
        edits.append(edit)
        current = current.with_moves((*current.moves, edit.made))
        solved = solve_game(current)
        _settle(needs, solved, made=current.moves[len(game.moves) :])
    if order.thrifty:
        kept = [edit.made for edit in edits if edit.made.skill in needs[game.start]]
        solved = solve_game(game.with_moves((*game.moves, *kept)))
    made = {edit.made for edit in edits}
    used = tuple(move for move in solved.used(game.start) if move in made)
    return Suggestion(tuple(edits), used, solved.winning)


def _possible(
    game: SkillGame[S], makeable: Sequence[Move[S]], solved: Solved[S], needs: dict[S, frozenset[Primitive]]
) -> Iterator[Edit[S]]:
    """Yield every edit that brings a state into the winning region."""
    stuck = {move.source: move for move in reversed(game.moves) if move.source not in solved.winning}
    entering = {
        target: move
        for move in reversed(game.moves)
        if solved.winning.issuperset(move.targets)
        for target in move.targets
    }
    for move in makeable:
        if move.source in solved.winning or not solved.winning.issuperset(move.targets):
            continue
        required = frozenset({move.skill}).union(*(needs[target] for target in move.targets))
        target = move.targets[0]
        if move.source in stuck:
            yield Edit(Kind.AIM, stuck[move.source], move, required)
        if target in entering or target in game.goal:
            yield Edit(Kind.EXTEND, entering.get(target), move, required)
        elif move.source not in stuck:
            yield Edit(Kind.STAND, None, move, required)


def _settle(needs: dict[S, frozenset[Primitive]], solved: Solved[S], made: Sequence[Move[S]]) -> None:
    """Note for every state that has joined the winning region which new primitives it relies on.

    The strategy only ever moves on to states that joined before, so each round settles at least one.
    """
    joined = [state for state in solved.winning if state not in needs]
    while joined:
        for state in joined:
            move = solved.strategy[state]
            if move is not None and all(target in needs for target in move.targets):
                own = frozenset({move.skill} if move in made else ())
                needs[state] = own.union(*(needs[target] for target in move.targets))
        joined = [state for state in joined if state not in needs]


def greedily_reduced(
    wanted: Sequence[Primitive], wins_with: Callable[[Sequence[Primitive]], bool]
) -> tuple[Primitive, ...]:
    """Return what is left when everything is dropped, one after another, without which the game is still won."""
    kept = list(wanted)
    for primitive in wanted:
        rest = [other for other in kept if other != primitive]
        if wins_with(rest):
            kept = rest
    return tuple(kept)

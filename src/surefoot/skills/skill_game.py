"""The game of a pair after partial evaluation: cells and skills, small enough to be solved within a millisecond.

It is the game of ``encoding.pair_specification``, written down directly. The environment moves first: the running skill
leads to one of its post-states; then the robot chooses the next skill among those whose precondition holds, or none.

    state s     the robot has landed in s and chooses         (a node of the system)
    idle s      no skill runs in s: the robot stays           (a node of the environment)
    move m      a skill runs: it ends in one of its targets   (a node of the environment)
    broken      a hard guarantee was violated                 (lost)

States are any values: cells, or cells with a heading.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import chain
from typing import Generic, Protocol, TypeVar

import numpy as np

from surefoot.games.arena import Arena
from surefoot.games.explicit import solve
from surefoot.skills.encoding import Edge, check_pair
from surefoot.skills.values import OBSTACLE, Cell, Direction, Primitive, TerrainState, Way

S = TypeVar("S", bound=Hashable)


@dataclass(frozen=True, slots=True)
class Move(Generic[S]):
    """A skill in one of its pre-states.

    Attributes:
        source: the pre-state.
        skill: what runs.
        targets: its post-states; the environment chooses.
    """

    source: S
    skill: Primitive
    targets: tuple[S, ...]


@dataclass(frozen=True, slots=True)
class SkillGame(Generic[S]):
    """A game over states and moves.

    Attributes:
        states: where the robot may be.
        start: where it begins, with no skill running.
        goal: the states that it has to visit again and again.
        lost: states that it must never enter: obstacles.
        moves: what its skills do.
        disallowed: pairs of states; moving from one to the other is a violation, for this terrain only.
    """

    states: tuple[S, ...]
    start: S
    goal: frozenset[S]
    lost: frozenset[S]
    moves: tuple[Move[S], ...]
    disallowed: frozenset[tuple[S, S]] = field(default=frozenset())

    def with_moves(self, moves: Iterable[Move[S]]) -> SkillGame[S]:
        """Return the same game with other moves."""
        return replace(self, moves=tuple(moves))

    def breaks(self, move: Move[S]) -> bool:
        """Return whether a move may violate a hard guarantee."""
        return any((move.source, target) in self.disallowed or target in self.lost for target in move.targets)


@dataclass(frozen=True, slots=True)
class Solved(Generic[S]):
    """Who wins, and how.

    Attributes:
        winning: states from which the robot wins.
        strategy: the move in every winning state; None: stay. It needs no memory, there is one goal.
    """

    winning: frozenset[S]
    strategy: dict[S, Move[S] | None]

    def used(self, start: S) -> tuple[Move[S], ...]:
        """Return the moves that the strategy makes from a state on, in the order of finding them."""
        seen, stack, found = {start}, [start], []
        while stack:
            move = self.strategy[stack.pop()]
            if move is not None:
                found.append(move)
                stack.extend(target for target in move.targets if target not in seen)
                seen.update(move.targets)
        return tuple(found)


def ways_of(solved: Solved[S]) -> dict[S, Way | None]:
    """Return where the strategy goes or turns in every winning state; None: it stays."""
    return {state: None if move is None else move.skill.direction for state, move in solved.strategy.items()}


def directions_of(solved: Solved[Cell]) -> dict[Cell, Direction | None]:
    """Return the same for cells without headings, where nothing turns."""
    return {cell: None if way is None else Direction(way) for cell, way in ways_of(solved).items()}


def solve_game(game: SkillGame[S]) -> Solved[S]:
    """Solve a game with the explicit engine; an environment without a move would lose the game for the robot."""
    arena = arena_of(game)
    solution = solve(arena, env_dead_end="loses")
    wins, chosen = solution.winning.tolist(), solution.choice[0].tolist()
    options = _options(game)
    winning = [state for number, state in enumerate(game.states) if wins[number]]
    strategy: dict[S, Move[S] | None] = {}
    for number, state in enumerate(game.states):
        if wins[number]:
            edge = chosen[number]
            strategy[state] = None if edge == 0 else game.moves[options[number][edge - 1]]
    return Solved(frozenset(winning), strategy)


def arena_of(game: SkillGame[S]) -> Arena:
    """Return the game graph; nodes are states, then idling in them, then moves, then the violation."""
    count, moves = len(game.states), len(game.moves)
    number = {state: index for index, state in enumerate(game.states)}
    broken = 2 * count + moves
    rows: list[list[int]] = [
        [count + index, *(2 * count + move for move in own)] for index, own in enumerate(_options(game))
    ]
    rows += [[index] for index in range(count)]
    rows += [
        [broken if (move.source, target) in game.disallowed else number[target] for target in move.targets]
        for move in game.moves
    ]
    rows.append([])
    system = np.zeros(broken + 1, dtype=np.bool_)
    system[[*range(count), broken]] = True
    lost = np.zeros(broken + 1, dtype=np.bool_)
    lost[[broken, *(number[state] for state in game.lost)]] = True
    goal = np.zeros((1, broken + 1), dtype=np.bool_)
    goal[0, [number[state] for state in game.goal]] = True
    return Arena(
        system=system,
        first=np.cumsum([0, *map(len, rows)], dtype=np.int64),
        successors=np.fromiter(chain.from_iterable(rows), dtype=np.int32),
        lost=lost,
        goals=goal,
        justices=np.zeros((0, broken + 1), dtype=np.bool_),
    )


def _options(game: SkillGame[S]) -> list[list[int]]:
    """Return the numbers of the moves that begin in each state."""
    number = {state: index for index, state in enumerate(game.states)}
    found: list[list[int]] = [[] for _ in game.states]
    for index, move in enumerate(game.moves):
        found[number[move.source]].append(index)
    return found


class Frame(Protocol[S]):
    """How a pair of a terrain state and a request becomes a game: cells alone, or cells with a heading."""

    def states(self, state: TerrainState) -> tuple[S, ...]:
        """Return where the robot may be."""
        ...

    def start(self, state: TerrainState) -> S:
        """Return where it begins."""
        ...

    def goals(self, request: Cell) -> frozenset[S]:
        """Return what fulfils a request."""
        ...

    def cell(self, state: S) -> Cell:
        """Return the cell of a state of the robot."""
        ...

    def moves(self, state: TerrainState) -> tuple[Move[S], ...]:
        """Return what the robot could do if it had every primitive; every move has one target."""
        ...


class CellFrame:
    """The robot is in a cell and always faces ahead; a ``Frame``."""

    def states(self, state: TerrainState) -> tuple[Cell, ...]:
        """Return every cell."""
        return state.cells()

    def start(self, state: TerrainState) -> Cell:
        """Return the cell in the middle."""
        return state.centre

    def goals(self, request: Cell) -> frozenset[Cell]:
        """Return the request itself."""
        return frozenset({request})

    def cell(self, state: Cell) -> Cell:
        """Return the cell."""
        return state

    def moves(self, state: TerrainState) -> tuple[Move[Cell], ...]:
        """Return the moves to neighbours; see ``every_move``."""
        return every_move(state)


CELLS = CellFrame()


def pair_game(
    state: TerrainState, request: Cell, primitives: Iterable[Primitive], *, disallowed: Iterable[Edge] = ()
) -> SkillGame[Cell]:
    """Return the game of a terrain state and a request, without headings; see ``framed_game``."""
    return framed_game(CELLS, state, request, primitives, disallowed=disallowed)


def framed_game(
    frame: Frame[S],
    state: TerrainState,
    request: Cell,
    primitives: Iterable[Primitive],
    *,
    disallowed: Iterable[tuple[S, S]] = (),
) -> SkillGame[S]:
    """Return the game of a terrain state and a request.

    Args:
        frame: what the robot's states are.
        state: classes of the cells.
        request: the cell to reach.
        primitives: the skills of the robot; each may be used wherever its classes stand side by side.
        disallowed: moves between the robot's states that failed at run time.

    Raises:
        InputError: see ``check_pair``.
    """
    check_pair(state, request)
    known = frozenset(primitives)
    states = frame.states(state)
    return SkillGame(
        states=states,
        start=frame.start(state),
        goal=frame.goals(request),
        lost=frozenset(one for one in states if state.label(frame.cell(one)) == OBSTACLE),
        moves=tuple(move for move in frame.moves(state) if move.skill in known),
        disallowed=frozenset(disallowed),
    )


@lru_cache(maxsize=1024)
def every_move(state: TerrainState) -> tuple[Move[Cell], ...]:
    """Return what the robot could do if it had every primitive."""
    found = []
    for cell in state.cells():
        for direction in Direction:
            primitive = state.primitive(cell, direction)
            if primitive is not None:
                found.append(Move(cell, primitive, (direction.of(cell),)))
    return tuple(found)

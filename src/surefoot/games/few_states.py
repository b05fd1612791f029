"""The explicit route: a specification with few reachable states, enumerated and handed to the explicit solver.

Before counting, the system's safety is used: states that lose within a step or two are outside, plays end there. A
navigation game with hundreds of millions of moves may have a few hundred thousand that matter.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from surefoot.compute import Deadline
from surefoot.errors import LimitExceeded
from surefoot.games.diagrams import Set
from surefoot.games.enumeration import Enumerated, Enumeration, Keys, pack
from surefoot.games.explicit import solve
from surefoot.games.reach import Reach
from surefoot.games.solution import EnvDeadEnd, Solution, follow, visit
from surefoot.games.symbolic import SymbolicGame
from surefoot.games.walks import Bits, Walker

FEW_MOVES = 2_000_000
MOST_MOVES = 40_000_000
_MOST_INITIAL = 2_000_000
_SAFETY_STEPS = 8


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """The reachable part of a game.

    Attributes:
        reached: its states.
        safe: a set outside of which the system has lost.
        states: how many states, in the bits that matter.
        moves: how many moves the environment has in them.
    """

    reached: Set
    safe: Set
    states: int
    moves: int


def measure(game: SymbolicGame, few_moves: int = FEW_MOVES) -> Measured:
    """Count the reachable states, with more of the system's safety as long as that makes them many fewer.

    Raises:
        OutOfWork: if counting takes more work than the game allows.
    """
    safe = game.manager.true
    best = _measured(game, safe)
    for _ in range(_SAFETY_STEPS):
        if best.moves <= few_moves // 4:
            break
        smaller = game.cpre(game.next(safe), safe)
        if smaller == safe:
            break
        following = _measured(game, smaller)
        shrunk = following.moves <= 0.8 * best.moves
        safe, best = smaller, following
        if not shrunk:
            break
    return best


def _measured(game: SymbolicGame, safe: Set) -> Measured:
    reach = Reach(game, safe)
    reached = reach.closure()
    enumeration = Enumeration(game, reached, safe)
    moves = enumeration.edges() if enumeration.fits() else 1 << 62
    return Measured(reached, safe, reach.count(reached), moves)


@dataclass(frozen=True, slots=True, eq=False)
class ExplicitResult:
    """A solved arena.

    Attributes:
        game: the symbolic game that it was enumerated from.
        enumerated: the arena with the meaning of its nodes.
        solution: its solution.
        starts: initial states, packed: all inputs, then the outputs that matter.
        wins: which of them the system wins.
        realizable: the verdict.
    """

    game: SymbolicGame
    enumerated: Enumerated
    solution: Solution
    starts: Keys
    wins: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]
    realizable: bool


def solve_few(
    game: SymbolicGame,
    measured: Measured,
    *,
    robotics: bool,
    env_dead_end: EnvDeadEnd,
    deadline: Deadline,
    most_moves: int = MOST_MOVES,
) -> ExplicitResult:
    """Enumerate and solve a game explicitly.

    Raises:
        LimitExceeded: if there are too many moves or initial states, or the deadline has passed.
    """
    if measured.moves > most_moves:
        raise LimitExceeded(f"more than {most_moves} moves are reachable: too many for the explicit engine")
    enumeration = Enumeration(game, measured.reached, measured.safe)
    enumerated = enumeration.arena(most_moves)
    if enumerated is None:
        raise LimitExceeded(f"more than {most_moves} moves are reachable: too many for the explicit engine")
    deadline.check("enumerating the states")
    solution = solve(enumerated.arena, env_dead_end=env_dead_end, deadline=deadline)
    starts = _starts(game, enumeration)
    wins = _winning(starts, game, enumerated, solution)
    return ExplicitResult(game, enumerated, solution, starts, wins, _realizable(game, starts, wins, robotics))


def _initial_bits(game: SymbolicGame) -> list[int]:
    bits, read = range(len(game.game.bits)), game.game.read
    return [bit for bit in bits if bit < game.game.inputs or read >> bit & 1]


def _starts(game: SymbolicGame, enumeration: Enumeration) -> Keys:
    manager, variables = game.manager, 2 * len(game.game.bits)
    bits = _initial_bits(game)
    if len(bits) > 63:
        raise LimitExceeded("an initial state has too many bits for the explicit engine")
    kept = set(bits)
    dropped = manager.cube(game.encoder.now(bit) for bit in range(len(game.game.bits)) if bit not in kept)
    initial = manager.exists(manager.conjoin(game.env_init, game.sys_init), dropped)
    if manager.count(initial, variables) >> (variables - len(bits)) > _MOST_INITIAL:
        raise LimitExceeded("there are too many initial states for the explicit engine")
    return enumeration.states_of(initial, bits)


def _state_keys(starts: Keys, game: SymbolicGame, enumerated: Enumerated) -> Keys:
    place = {bit: k for k, bit in enumerate(_initial_bits(game))}
    keys = np.zeros_like(starts)
    for k, bit in enumerate(enumerated.state_bits):
        keys |= ((starts >> np.uint64(place[bit])) & np.uint64(1)) << np.uint64(k)
    return keys


def _winning(
    starts: Keys, game: SymbolicGame, enumerated: Enumerated, solution: Solution
) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Return which initial states the system wins; those that are no nodes are outside the safe states."""
    if not enumerated.states.size:
        return np.zeros(starts.size, dtype=np.bool_)
    keys = _state_keys(starts, game, enumerated)
    node = np.minimum(np.searchsorted(enumerated.states, keys), enumerated.states.size - 1)
    wins: np.ndarray[tuple[int, ...], np.dtype[np.bool_]] = (enumerated.states[node] == keys) & solution.winning[node]
    return wins


def _realizable(
    game: SymbolicGame, starts: Keys, wins: np.ndarray[tuple[int, ...], np.dtype[np.bool_]], robotics: bool
) -> bool:
    if robotics:
        return bool(wins.all())
    variables = 2 * len(game.game.bits)
    asked = game.manager.count(game.env_init, variables) >> (variables - game.game.inputs)
    mask = np.uint64((1 << game.game.inputs) - 1)
    return int(np.unique(starts[wins] & mask).size) == asked


class ExplicitPlayer:
    """Answers the environment by the solution of the arena; see ``machines.Player``."""

    def __init__(self, walker: Walker, result: ExplicitResult) -> None:
        self._walker, self._result = walker, result
        self._arena, self._found = result.enumerated.arena, result.enumerated
        game = result.game
        self._steps = [(n, p.set) for n, p in enumerate((*game.goals, *game.justices)) if not p.of_states]

    def initial(self, robotics: bool) -> Iterator[tuple[Bits, int]]:
        """Return the initial states that the strategy allows for, with their memory."""
        result, game = self._result, self._result.game
        bits = _initial_bits(game)
        place = np.searchsorted(self._found.states, _state_keys(result.starts, game, self._found))
        seen: set[int] = set()
        won = np.flatnonzero(result.wins)
        for row in won[np.argsort(result.solution.rank[0, place[won]], kind="stable")]:
            key = int(result.starts[row])
            inputs = key & ((1 << game.game.inputs) - 1)
            if robotics or inputs not in seen:
                seen.add(inputs)
                memory = visit(self._arena, 0, int(place[row]))
                completed = self._walker.completed_states((game.sys_init,), bits, key)
                for state in completed if robotics else completed[:1]:
                    yield state, memory

    def answer(self, memory: int, state: Bits, inputs: Bits) -> tuple[int, Bits]:
        """Return the next memory and the next outputs."""
        found = self._found
        following = np.concatenate([inputs, np.zeros(len(state) - len(inputs), dtype=np.uint8)])
        key = pack(state, found.choice_now) | pack(following, found.choice_next) << len(found.choice_now)
        node = found.states.size + int(np.searchsorted(found.choices, np.uint64(key)))
        target = follow(self._arena, self._result.solution, memory, node)
        fixed = {bit: int(found.states[target]) >> k & 1 for k, bit in enumerate(found.state_bits)}
        flags = int(found.flags[target])
        kept = [wanted if flags >> n & 1 else ~wanted for n, wanted in self._steps]
        outputs = self._walker.answers(state, inputs, self._walker.roots(kept), 1, fixed)[0]
        return visit(self._arena, memory, target), outputs

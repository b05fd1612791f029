"""A specification as an explicit arena over its reachable states, in the bits that matter.

Nodes of the environment are states, told apart by which primed promises the last transition kept; nodes of the
system are (what its rules read of the state, next inputs), so that states that leave it the
same choice share one. The rules are walked as decision diagrams; nothing is enumerated that no play can reach.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.games._diagram_kernels import expand, hold_at
from surefoot.games.arena import Arena
from surefoot.games.bits import bits_of
from surefoot.games.diagrams import Set
from surefoot.games.relation import Move, mentions
from surefoot.games.symbolic import SymbolicGame
from surefoot.games.walks import Tables

Keys = NDArray[np.uint64]
_WIDEST_KEY = 63


@dataclass(frozen=True, slots=True, eq=False)
class Enumerated:
    """The arena, and what its nodes mean.

    Attributes:
        arena: nodes of the environment first, then those of the system.
        states: (N,) rising packed states, bit k the value of ``state_bits[k]``.
        flags: (N,) which primed promises the transition into the node kept (goals first, then justices).
        choices: (M,) rising packed nodes of the system: ``choice_now`` bits of the state, then ``choice_next`` inputs.
        state_bits, choice_now, choice_next: numbers of bits.
    """

    arena: Arena
    states: Keys
    flags: Keys
    choices: Keys
    state_bits: tuple[int, ...]
    choice_now: tuple[int, ...]
    choice_next: tuple[int, ...]


class Enumeration:
    """The measures of a game's reachable part, and its arena if that is wanted."""

    def __init__(self, game: SymbolicGame, reached: Set, safe: Set) -> None:
        self._game, self._manager, self._encoder = game, game.manager, game.encoder
        self._reached = reached
        spec = game.game
        steps = [part for part in (*spec.goals, *spec.justices) if part.following]
        inputs, everything = spec.input_mask, (1 << len(spec.bits)) - 1
        live_now = live_next = sys_now = sys_next = 0
        for part in steps:
            live_now, live_next = live_now | part.current, live_next | part.following
        for part in spec.sys_trans:
            sys_now, sys_next = sys_now | part.current, sys_next | part.following
        self.kept_next = spec.read | live_next
        self.choice_next = (sys_next | self.kept_next) & inputs
        self.choice_now = sys_now | live_now
        self._outputs = everything & ~inputs
        self._env_rules = self._projected(game.environment, inputs & ~self.choice_next)
        self._sys_rules = [*self._projected(game.system, self._outputs & ~self.kept_next), game.next(safe)]

    def _projected(self, move: Move, dropped: int) -> list[Set]:
        """Return a side's rules without the next bits that matter to nobody."""
        cube = mentions(self._encoder, dropped, following=True)
        touched: list[Set] = []
        rest: list[Set] = []
        for rule in move.rules:
            (touched if self._manager.exists(rule, cube) != rule else rest).append(rule)
        together = self._encoder.conjunction(touched)
        return [*rest, self._manager.exists(together, cube)]

    def edges(self) -> int:
        """Return how many moves the environment has in all reachable states together."""
        moves = self._reached
        for rule in self._env_rules:
            moves = self._encoder.spend(self._manager.conjoin(moves, rule))
        variables = 2 * len(self._game.game.bits)
        width = self._game.game.read.bit_count() + self.choice_next.bit_count()
        return self._manager.count(moves, variables) >> (variables - width)

    def fits(self) -> bool:
        """Return whether states and choices fit in one machine word each."""
        state = self._game.game.read | self.kept_next
        widths = (state.bit_count(), self.choice_now.bit_count() + self.choice_next.bit_count())
        return max(widths) <= _WIDEST_KEY

    def arena(self, most_edges: int) -> Enumerated | None:
        """Return the arena; None when it has more edges than allowed."""
        spec, tables = self._game.game, Tables(self._manager)
        state_bits = bits_of(spec.read)
        now, following = bits_of(self.choice_now), bits_of(self.choice_next)
        base = self._all(tables, self._reached, state_bits)
        env_first, moves = self._expanded(tables, self._env_rules, state_bits, base, following, most_edges)
        if env_first[-1] < 0:
            return None
        part = _packed(base, state_bits, now)
        choice_keys = np.repeat(part, np.diff(env_first)) | (moves << np.uint64(len(now)))
        choices, env_targets = np.unique(choice_keys, return_inverse=True)
        del choice_keys, moves
        answered = bits_of(self._outputs & self.kept_next)
        sys_first, answers = self._choices_expanded(tables, choices, now, following, answered, most_edges)
        if sys_first[-1] < 0:
            return None
        return self._joined(
            tables, base, env_first, env_targets, choices, sys_first, answers, (now, following, answered, state_bits)
        )

    def states_of(self, states: Set, bits: Sequence[int]) -> Keys:
        """Return a set of states that mentions no other bits, packed and rising."""
        return self._all(Tables(self._manager), states, bits)

    def _all(self, tables: Tables, states: Set, bits: Sequence[int]) -> Keys:
        none = np.zeros(1, dtype=np.uint64)
        roots = np.array([tables.root(states)], dtype=np.int32)
        _, found = expand(*tables.arrays(), roots, self._now([]), none, self._now(bits), 1 << 62)
        return np.sort(found)

    def _expanded(
        self, tables: Tables, rules: Sequence[Set], given: Sequence[int], keys: Keys, free: Sequence[int], most: int
    ) -> tuple[NDArray[np.int64], Keys]:
        roots = np.array([tables.root(rule) for rule in rules], dtype=np.int32)
        first, found = expand(*tables.arrays(), roots, self._now(given), keys, self._then(free), most)
        return first, found

    def _choices_expanded(
        self, tables: Tables, keys: Keys, now: list[int], following: list[int], answered: list[int], most: int
    ) -> tuple[NDArray[np.int64], Keys]:
        roots = np.array([tables.root(rule) for rule in self._sys_rules], dtype=np.int32)
        given = np.concatenate([self._now(now), self._then(following)])
        first, found = expand(*tables.arrays(), roots, given, keys, self._then(answered), most)
        return first, found

    def _joined(
        self,
        tables: Tables,
        base: Keys,
        env_first: NDArray[np.int64],
        env_targets: NDArray[np.intp],
        choices: Keys,
        sys_first: NDArray[np.int64],
        answers: Keys,
        layout: tuple[list[int], list[int], list[int], list[int]],
    ) -> Enumerated:
        now, following, answered, state_bits = layout
        spread = np.repeat(choices, np.diff(sys_first))
        inputs = spread >> np.uint64(len(now))
        target = _packed(inputs, following, state_bits) | _packed(answers, answered, state_bits)
        flags = self._flags(tables, spread, inputs, answers, layout)
        nodes, sys_targets = self._nodes(base, target, flags)
        states, marks = nodes
        place = np.searchsorted(base, states)
        degree = np.diff(env_first)[place]
        offsets = np.concatenate(([0], np.cumsum(degree)))
        edges = np.repeat(env_first[:-1][place] - offsets[:-1], degree) + np.arange(offsets[-1])
        count = states.size
        successors = np.concatenate([env_targets[edges] + count, sys_targets]).astype(np.int32)
        system = np.zeros(count + choices.size, dtype=np.bool_)
        system[count:] = True
        goals, justices = self._promises(tables, states, marks, state_bits, system.size)
        arena = Arena(
            system=system,
            first=np.concatenate([offsets, offsets[-1] + sys_first[1:]]),
            successors=successors,
            lost=np.zeros(system.size, dtype=np.bool_),
            goals=goals,
            justices=justices,
        )
        return Enumerated(arena, states, marks, choices, tuple(state_bits), tuple(now), tuple(following))

    def _nodes(self, base: Keys, target: Keys, flags: Keys) -> tuple[tuple[Keys, Keys], NDArray[np.intp]]:
        """Return the states and flags of the environment's nodes: all states without flags, and those entered."""
        if not flags.any():
            found = np.searchsorted(base, target)
            return (base, np.zeros_like(base)), found
        pairs = np.stack([np.concatenate([base, target]), np.concatenate([np.zeros_like(base), flags])], axis=1)
        unique, inverse = np.unique(pairs, axis=0, return_inverse=True)
        inverse = inverse.reshape(-1)
        return (unique[:, 0].copy(), unique[:, 1].copy()), inverse[base.size :]

    def _flags(self, tables: Tables, spread: Keys, inputs: Keys, answers: Keys, layout: tuple[list[int], ...]) -> Keys:
        """Return for every answer which promises about transitions it keeps, as a mask."""
        now, following, answered, _ = layout
        flags = np.zeros(spread.size, dtype=np.uint64)
        variables = [self._encoder.now(bit) for bit in now]
        variables += [self._encoder.then(bit) for bit in (*following, *answered)]
        together = spread | (answers << np.uint64(len(now) + len(following)))
        if len(variables) > _WIDEST_KEY + 1:
            raise ValueError("the transitions are too wide to enumerate")
        for number, promise in enumerate((*self._game.goals, *self._game.justices)):
            if not promise.of_states:
                kept = self._held(tables, promise.set, variables, together)
                flags |= kept.astype(np.uint64) << np.uint64(number)
        return flags

    def _held(self, tables: Tables, function: Set, variables: Sequence[int], keys: Keys) -> NDArray[np.bool_]:
        place = np.zeros(2 * len(self._game.game.bits), dtype=np.int64)
        place[list(variables)] = np.arange(len(variables))
        root = tables.root(function)
        held: NDArray[np.bool_] = hold_at(*tables.arrays(), root, place, keys)
        return held

    def _promises(
        self, tables: Tables, states: Keys, marks: Keys, state_bits: list[int], nodes: int
    ) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        rows = []
        variables = [self._encoder.now(bit) for bit in state_bits]
        for number, promise in enumerate((*self._game.goals, *self._game.justices)):
            row = np.zeros(nodes, dtype=np.bool_)
            if promise.of_states:
                row[: states.size] = self._held(tables, promise.set, variables, states)
            else:
                row[: states.size] = (marks >> np.uint64(number)) & np.uint64(1) == 1
            rows.append(row)
        goals = len(self._game.goals)
        together = np.array(rows, dtype=np.bool_).reshape(len(rows), nodes)
        return together[:goals], together[goals:]

    def _now(self, bits: Sequence[int]) -> NDArray[np.int64]:
        return np.array([self._encoder.now(bit) for bit in bits], dtype=np.int64)

    def _then(self, bits: Sequence[int]) -> NDArray[np.int64]:
        return np.array([self._encoder.then(bit) for bit in bits], dtype=np.int64)


def _packed(keys: Keys, bits: Sequence[int], wanted: Sequence[int]) -> Keys:
    """Return packed valuations of other bits; those that are not among the given ones are 0."""
    place = {bit: k for k, bit in enumerate(bits)}
    result = np.zeros_like(keys)
    for k, bit in enumerate(wanted):
        if bit in place:
            result |= ((keys >> np.uint64(place[bit])) & np.uint64(1)) << np.uint64(k)
    return result


def pack(state: NDArray[np.uint8], bits: Sequence[int]) -> int:
    """Return chosen bits of a state as one number."""
    return sum(int(state[bit]) << k for k, bit in enumerate(bits))

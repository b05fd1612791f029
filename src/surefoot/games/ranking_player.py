"""Playing a ranking, step by step: nothing is listed, each answer is looked up in the layers.

In pursuit of a goal, from a state in layer k, for the next inputs: an answer that meets the goal; otherwise one into
the lowest layer that can be had; otherwise one that stays in layer k while its justice does not hold. Goals of states
that hold already are passed over. Among equal answers the first in the order of the diagrams is taken, false before
true.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from surefoot.games._diagram_kernels import FREE, complete, holds
from surefoot.logic.ranking import Ranking

Bits = NDArray[np.uint8]
_OUTSIDE = np.iinfo(np.int32).max


class RankingPlayer:
    """Plays a ranking; states are rows of bits, as the variables are declared.

    Args:
        ranking: what is played.
    """

    def __init__(self, ranking: Ranking) -> None:
        """Take the diagrams, the sets of states a second time as conditions on next states."""
        self.ranking = ranking
        self._tables = _three_copies(ranking)
        self._bits = len(ranking.order)
        self._inputs = sum(len(v.bits) for v in ranking.variables[: ranking.inputs])
        place = np.empty(self._bits, dtype=np.int64)
        place[ranking.order] = np.arange(self._bits)
        self._now, self._then = 2 * place, 2 * place + 1
        self._of_states = [not self._speaks_of_next(int(goal)) for goal in ranking.goals]

    def start(self, inputs: Bits) -> tuple[int, Bits] | None:
        """Return the memory and the state in which the play starts; None where no start is allowed or winning."""
        ranking = self.ranking
        for layer in range(int(ranking.first[0]), int(ranking.first[1])):
            roots = (ranking.env_init, ranking.sys_init, int(ranking.layers[layer]))
            values = self._values(self._now[: self._inputs], inputs)
            found = self._completed(values, self._now[self._inputs :], roots)
            if found is not None:
                return 0, np.concatenate([inputs, found])
        return None

    def answer(self, memory: int, state: Bits, inputs: Bits) -> tuple[int, Bits]:
        """Return the next memory and the next state.

        Raises:
            ValueError: the ranking has no answer: the state is not winning, or the inputs are not allowed.
        """
        goal = self._pursued(memory, state)
        layers, rank = self._layers(goal), self._rank(goal, state)
        if not self._of_states[goal]:
            following = (goal + 1) % len(self._of_states)
            into = self._layers(following)
            met = self._lowest(state, inputs, into, int(self.ranking.goals[goal]))
            if met is not None:
                return following, met
        found = self._lowest(state, inputs, layers[:rank])
        justice = int(self.ranking.waits_for[self.ranking.first[goal] + rank])
        if found is None and justice >= 0:
            found = self._waiting(state, inputs, layers[rank], int(self.ranking.justices[justice]))
        if found is None and self._of_states[goal] and self._holds(int(self.ranking.goals[goal]), state):
            found = self._stepped(state, inputs, (self._next(self.ranking.winning),))
        if found is None:
            raise ValueError("the ranking has no answer here")
        return goal, found

    def inputs(self, state: Bits | None, known: Mapping[int, int], source: np.random.Generator | None) -> Bits | None:
        """Return next inputs that the environment may choose, or initial ones; None if there are none.

        Args:
            state: the present state; None at the beginning.
            known: bits that are given.
            source: picks the others; None: the first possible ones.
        """
        variables = self._now if state is None else self._then
        roots = [self.ranking.env_init] if state is None else self.ranking.environment.tolist()
        values = np.zeros(2 * self._bits, dtype=np.uint8) if state is None else self._values(self._now, state)
        chosen = dict(known)
        if self._tried(values, variables, roots, chosen) is None:
            return None
        order = [] if source is None else source.permutation(self._inputs).tolist()
        for bit in order:
            if bit not in chosen:
                chosen[bit] = int(source.integers(2)) if source is not None else 0
                if self._tried(values, variables, roots, chosen) is None:
                    chosen[bit] ^= 1
        return self._tried(values, variables, roots, chosen)

    def moves(self, state: Bits | None, most: int) -> Bits | None:
        """Return all next inputs that the environment may choose (None: initial ones), as rows; None if too many."""
        variables = self._now if state is None else self._then
        roots = [self.ranking.env_init] if state is None else self.ranking.environment.tolist()
        values = np.zeros(2 * self._bits, dtype=np.uint8) if state is None else self._values(self._now, state)
        return self._all(values, variables[: self._inputs], roots, most)

    def starts(self, most: int, *, robotics: bool) -> list[tuple[int, Bits]] | None:
        """Return the memory and the states in which plays start; None if there are too many.

        Raises:
            ValueError: an initial input has no start.
        """
        ranking = self.ranking
        if robotics:
            nothing = np.zeros(2 * self._bits, dtype=np.uint8)
            states = self._all(nothing, self._now, [ranking.env_init, ranking.sys_init], most)
            return None if states is None else [(0, state) for state in states]
        inputs = self.moves(None, most)
        if inputs is None:
            return None
        begun = [self.start(one) for one in inputs]
        found = [one for one in begun if one is not None]
        if len(found) < len(begun):
            raise ValueError("the ranking has no start for some initial inputs")
        return found

    def decoded(self, state: Bits) -> tuple[int, ...]:
        """Return the values of all variables in a state, inputs first."""
        values, bit = [], 0
        for variable in self.ranking.variables:
            weight = sum(int(state[bit + k]) << k for k in range(len(variable.bits)))
            values.append(weight + (0 if variable.is_boolean else variable.values[0]))
            bit += len(variable.bits)
        return tuple(values)

    def bits_of(self, values: Mapping[str, int]) -> dict[int, int]:
        """Return the bits that values of some variables fix.

        Raises:
            ValueError: a variable cannot have its value.
        """
        found: dict[int, int] = {}
        bit = 0
        for variable in self.ranking.variables:
            if variable.name in values:
                value = values[variable.name]
                if value not in variable.values:
                    raise ValueError(f"{variable.name} is from {variable.values[0]} to {variable.values[-1]}")
                code = value - (0 if variable.is_boolean else variable.values[0])
                found |= {bit + k: code >> k & 1 for k in range(len(variable.bits))}
            bit += len(variable.bits)
        return found

    def pursued(self, memory: int, state: Bits) -> int:
        """Return the goal that is pursued from a state on."""
        return self._pursued(memory, state)

    def _pursued(self, memory: int, state: Bits) -> int:
        goals = len(self._of_states)
        for goal in ((memory + step) % goals for step in range(goals)):
            if not (self._of_states[goal] and self._holds(int(self.ranking.goals[goal]), state)):
                return goal
        return (memory + 1) % goals

    def _layers(self, goal: int) -> list[int]:
        first = self.ranking.first
        return [int(root) for root in self.ranking.layers[first[goal] : first[goal + 1]]]

    def _rank(self, goal: int, state: Bits) -> int:
        layers = self._layers(goal)
        rank = bisect_left(layers, True, key=lambda root: self._holds(root, state))
        if rank == len(layers):
            raise ValueError("the state is not winning")
        return rank

    def _lowest(self, state: Bits, inputs: Bits, layers: Sequence[int], *extra: int) -> Bits | None:
        """Return the first answer into the lowest layer that can be had; layers grow, so bisection finds it."""

        def answer(layer: int) -> Bits | None:
            return self._stepped(state, inputs, (*extra, self._next(layer)))

        if not layers or (highest := answer(layers[-1])) is None:
            return None
        lowest = bisect_left(layers[:-1], True, key=lambda layer: answer(layer) is not None)
        return highest if lowest == len(layers) - 1 else answer(layers[lowest])

    def _waiting(self, state: Bits, inputs: Bits, layer: int, justice: int) -> Bits | None:
        """Return the first answer that stays in a layer while a justice does not hold."""
        return self._stepped(state, inputs, (self._next(layer), self._complement(justice)))

    def _stepped(self, state: Bits, inputs: Bits, extra: Sequence[int]) -> Bits | None:
        values = self._values(self._now, state)
        values[self._then[: self._inputs]] = inputs
        roots = (*self.ranking.system.tolist(), *extra)
        found = self._completed(values, self._then[self._inputs :], roots)
        return None if found is None else np.concatenate([inputs, found])

    def _values(self, variables: NDArray[np.int64], bits: Bits) -> Bits:
        values = np.zeros(2 * self._bits, dtype=np.uint8)
        values[variables] = bits
        return values

    def _tried(
        self, values: Bits, variables: NDArray[np.int64], roots: Sequence[int], chosen: Mapping[int, int]
    ) -> Bits | None:
        values = values.copy()
        free = [bit for bit in range(self._inputs) if bit not in chosen]
        for bit, value in chosen.items():
            values[variables[bit]] = value
        found = self._completed(values, variables[free], roots)
        if found is None:
            return None
        inputs = values[variables[: self._inputs]]
        inputs[free] = found
        return inputs

    def _all(self, values: Bits, free: NDArray[np.int64], roots: Sequence[int], most: int) -> Bits | None:
        """Return all values of free variables with which all diagrams hold, as rows; None if there are too many."""
        values = values.copy()
        values[free] = FREE
        found, whole = complete(*self._tables, np.array(roots, dtype=np.int32), values, most)
        if not whole:
            return None
        rows: Bits = found[:, np.argsort(np.argsort(free))]
        return rows

    def _completed(self, values: Bits, free: NDArray[np.int64], roots: Sequence[int]) -> Bits | None:
        """Return values of free variables with which all diagrams hold; None if there are none."""
        values = values.copy()
        values[free] = FREE
        found, _ = complete(*self._tables, np.array(roots, dtype=np.int32), values, 1)
        if not len(found):
            return None
        row: Bits = found[0, np.argsort(np.argsort(free))]
        return row

    def _next(self, root: int) -> int:
        return root if root <= 1 else root + len(self.ranking.variable)

    def _complement(self, root: int) -> int:
        return 1 - root if root <= 1 else root + 2 * len(self.ranking.variable)

    def _holds(self, root: int, state: Bits) -> bool:
        return bool(holds(*self._tables, root, self._values(self._now, state)))

    def _speaks_of_next(self, root: int) -> bool:
        seen, pending = {0, 1}, [root]
        while pending:
            row = pending.pop()
            if row not in seen:
                seen.add(row)
                if self.ranking.variable[row] % 2:
                    return True
                pending += [int(self.ranking.low[row]), int(self.ranking.high[row])]
        return False


def _three_copies(ranking: Ranking) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]]:
    """Return the rows as they are, then about next states, then complemented."""
    rows = len(ranking.variable)
    variable = ranking.variable.copy()
    variable[:2] = _OUTSIDE
    shifted = np.where(variable == _OUTSIDE, variable, variable + 1)

    def parts(row: NDArray[np.int32]) -> NDArray[np.int32]:
        inner = row > 1
        return np.concatenate([row, np.where(inner, row + rows, row), np.where(inner, row + 2 * rows, 1 - row)])

    return np.concatenate([variable, shifted, variable]), parts(ranking.low), parts(ranking.high)

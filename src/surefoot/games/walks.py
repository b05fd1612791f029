"""Valuations by the walk over tables: all next inputs, all answers to them, the first answer into a set."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from surefoot.games._diagram_kernels import FREE, complete, holds
from surefoot.games.diagrams import Diagrams, Set
from surefoot.games.symbolic import SymbolicGame

Bits = NDArray[np.uint8]
_CONSTANT = np.iinfo(np.int32).max


class Tables:
    """Diagrams written out; a function that was asked for before is not written again."""

    def __init__(self, manager: Diagrams) -> None:
        self._manager = manager
        self._row: dict[Set, int] = {manager.false: 0, manager.true: 1}
        self._rows: list[tuple[int, int, int]] = [(_CONSTANT, 0, 0), (_CONSTANT, 1, 1)]
        self._arrays: tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]] | None = None

    @property
    def size(self) -> int:
        """How many rows there are."""
        return len(self._rows)

    def root(self, function: Set) -> int:
        """Return the row of a function, its nodes written below it."""
        stack = [function]
        while stack:
            node = stack[-1]
            if node in self._row:
                stack.pop()
                continue
            parts = self._manager.cofactors(node)
            assert parts is not None  # the constants stand in the table from the beginning
            missing = [part for part in parts[1:] if part not in self._row]
            if missing:
                stack.extend(missing)
                continue
            self._row[node] = len(self._rows)
            self._rows.append((parts[0], self._row[parts[1]], self._row[parts[2]]))
            self._arrays = None
            stack.pop()
        return self._row[function]

    def arrays(self) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]]:
        """Return the columns: variable, low, high."""
        if self._arrays is None:
            table = np.array(self._rows, dtype=np.int32)
            self._arrays = tuple(np.ascontiguousarray(table[:, k]) for k in range(3))  # type: ignore[assignment]
        assert self._arrays is not None
        return self._arrays


class Walker:
    """Walks over the rules of a game with present states and next states as rows of bits (inputs first)."""

    def __init__(self, game: SymbolicGame) -> None:
        self.game = game
        self.tables = Tables(game.manager)
        encoder, bits = game.encoder, len(game.game.bits)
        self._bits, self._inputs = bits, game.game.inputs
        self._now = np.array([encoder.now(bit) for bit in range(bits)], dtype=np.int64)
        self._then = np.array([encoder.then(bit) for bit in range(bits)], dtype=np.int64)
        self._env = self.roots(game.environment.rules)
        self._sys = self.roots(game.system.rules)

    def roots(self, functions: Iterable[Set]) -> tuple[int, ...]:
        """Return the rows of functions."""
        return tuple(self.tables.root(function) for function in functions)

    def contains(self, states: Set, state: Bits) -> bool:
        """Return whether a set of states contains one."""
        values = np.zeros(2 * self._bits, dtype=np.uint8)
        values[self._now] = state
        root = self.tables.root(states)
        return bool(holds(*self.tables.arrays(), root, values))

    def has_step(self, transitions: Set, state: Bits, following: Bits) -> bool:
        """Return whether a set of transitions contains one."""
        values = np.zeros(2 * self._bits, dtype=np.uint8)
        values[self._now], values[self._then] = state, following
        root = self.tables.root(transitions)
        return bool(holds(*self.tables.arrays(), root, values))

    def next_inputs(self, state: Bits, extra: Sequence[int] = (), most: int = 1 << 40) -> Bits:
        """Return (n, inputs) the next inputs that the environment's rules (and more conditions) allow."""
        values = np.zeros(2 * self._bits, dtype=np.uint8)
        values[self._now] = state
        return self._completed(values, self._then[: self._inputs], (*self._env, *extra), most)

    def answers(
        self,
        state: Bits,
        inputs: Bits,
        extra: Sequence[int] = (),
        most: int = 1 << 40,
        fixed: Mapping[int, int] | None = None,
    ) -> Bits:
        """Return (n, outputs) the next outputs that the system's rules (and more conditions) allow.

        Args:
            state: (bits,) the present state.
            inputs: (inputs,) the next inputs.
            extra: rows of further conditions.
            most: stop after so many.
            fixed: values of next bits that are known already.
        """
        values = np.zeros(2 * self._bits, dtype=np.uint8)
        values[self._now], values[self._then[: self._inputs]] = state, inputs
        known = {bit: value for bit, value in (fixed or {}).items() if bit >= self._inputs}
        open_bits = [bit for bit in range(self._inputs, self._bits) if bit not in known]
        for bit, value in known.items():
            values[self._then[bit]] = value
        found = self._completed(values, self._then[open_bits], (*self._sys, *extra), most)
        outputs = np.empty((len(found), self._bits - self._inputs), dtype=np.uint8)
        outputs[:, [bit - self._inputs for bit in open_bits]] = found
        for bit, value in known.items():
            outputs[:, bit - self._inputs] = value
        return outputs

    def completed_states(self, functions: Iterable[Set], bits: Sequence[int], key: int) -> Bits:
        """Return (n, bits) the states in all of some sets, with the bits packed in a key given."""
        values = np.zeros(2 * self._bits, dtype=np.uint8)
        for k, bit in enumerate(bits):
            values[self._now[bit]] = key >> k & 1
        open_bits = [bit for bit in range(self._bits) if bit not in set(bits)]
        found = self._completed(values, self._now[open_bits], self.roots(functions), 1 << 40)
        states = np.tile(values[self._now], (len(found), 1))
        states[:, open_bits] = found
        return states

    def states(self, functions: Iterable[Set], fixed_inputs: Bits | None = None, most: int = 1 << 40) -> Bits:
        """Return (n, bits) the states in all of some sets of states, those with given inputs when there are some."""
        values = np.zeros(2 * self._bits, dtype=np.uint8)
        chosen = self._now
        if fixed_inputs is not None:
            values[self._now[: self._inputs]] = fixed_inputs
            chosen = self._now[self._inputs :]
        found = self._completed(values, chosen, self.roots(functions), most)
        if fixed_inputs is None:
            return found
        return np.concatenate([np.tile(fixed_inputs, (len(found), 1)), found], axis=1)

    def inputs(self, functions: Iterable[Set], most: int = 1 << 40) -> Bits:
        """Return (n, inputs) the present inputs in all of some sets that mention nothing else."""
        values = np.zeros(2 * self._bits, dtype=np.uint8)
        return self._completed(values, self._now[: self._inputs], self.roots(functions), most)

    def _completed(self, values: Bits, chosen: NDArray[np.int64], roots: Sequence[int], most: int) -> Bits:
        values[chosen] = FREE
        found, _ = complete(*self.tables.arrays(), np.array(roots, dtype=np.int32), values, most)
        rows: Bits = found[:, np.argsort(np.argsort(chosen))]
        return rows

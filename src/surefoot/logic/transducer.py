"""Strategies as values: executable transducers of either player, with integers as integers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from surefoot.logic.syntax import Variable

Player = Literal["system", "environment"]
Semantics = Literal["slugs", "robotics"]
EnvDeadEnd = Literal["wins", "loses"]
NO_MOVE = -(2**31)
"""Fills the row of ``Transducer.moves`` where the environment has no move."""


@dataclass(frozen=True, slots=True, eq=False)
class Transducer:
    """A strategy: N nodes, each a valuation of all V variables and a memory; E edges in compressed rows.

    The environment moves first in every step: it picks the next inputs, then the system the next outputs.

    Attributes:
        player: whose strategy it is.
        variables: inputs, then outputs.
        inputs: how many of the variables are inputs.
        values: (N, V) int32; Booleans are 0 and 1.
        memory: (N,) int32: index of the goal that the system pursues, or that the environment denies; -1 for none.
        first: (N + 1,) int64: the successors of node n are ``successors[first[n]:first[n + 1]]``.
        successors: (E,) int32. Of the system: one for every next input that its environment may choose. Of the
            environment: one for every answer to its move that the system may give; none where the system is stuck.
        initial: (I,) int32. Of the system: one for every initial input (slugs), or for every initial state (robotics).
            Of the environment: one for every initial output that may follow ``initial_inputs`` (slugs), or one state.
        moves: (N, inputs) int32: the next inputs that the environment picks; a row of ``NO_MOVE`` where it has none.
            None for a strategy of the system.
        initial_inputs: (inputs,) int32: the initial inputs that the environment picks; None for the system.
    """

    player: Player
    variables: tuple[Variable, ...]
    inputs: int
    values: NDArray[np.int32]
    memory: NDArray[np.int32]
    first: NDArray[np.int64]
    successors: NDArray[np.int32]
    initial: NDArray[np.int32]
    moves: NDArray[np.int32] | None = None
    initial_inputs: NDArray[np.int32] | None = None

    def __post_init__(self) -> None:
        """Take read-only arrays of the right types and refuse shapes that do not fit."""
        kinds: dict[str, Any] = dict.fromkeys(("values", "memory", "successors", "initial"), np.int32)
        for name, kind in (kinds | {"first": np.int64, "moves": np.int32, "initial_inputs": np.int32}).items():
            given = getattr(self, name)
            if given is not None:
                array = np.array(given, dtype=kind)
                array.flags.writeable = False
                object.__setattr__(self, name, array)
        if self.values.shape != (self.nodes, len(self.variables)) or self.first.shape != (self.nodes + 1,):
            raise ValueError(
                "values need one row per node and one column per variable, first one entry per node and one more"
            )
        if self.first[0] != 0 or self.first[-1] != len(self.successors):
            raise ValueError("first begins with 0 and ends with the number of edges")

    @property
    def nodes(self) -> int:
        """How many nodes there are."""
        return len(self.memory)

    def after(self, node: int) -> NDArray[np.int32]:
        """Return the successors of a node."""
        return self.successors[self.first[node] : self.first[node + 1]]

    def valuation(self, node: int) -> dict[str, int]:
        """Return the value of every variable in a node."""
        return {v.name: int(value) for v, value in zip(self.variables, self.values[node], strict=True)}

    def shown(self, node: int) -> str:
        """Return the valuation of a node for a person."""
        return ", ".join(v.shown(int(value)) for v, value in zip(self.variables, self.values[node], strict=True))

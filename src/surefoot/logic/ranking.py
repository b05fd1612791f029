"""Strategies as rankings: for games with too many choices to list them.

A ranking is the proof that the system wins, as sets of states: the winning states, and for every goal the layers from
which it is reached. How it is played stands in docs/formats.md, section 4: from layer to layer downwards. All sets are
decision diagrams in one table of rows.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.logic.syntax import Variable

Column = NDArray[np.int32]
SINGLE = ("env_init", "sys_init", "winning")
SEVERAL = ("environment", "system", "goals", "justices")
ARRAYS = ("order", "variable", "low", "high", *SINGLE, *SEVERAL, "first", "layers", "waits_for")


@dataclass(frozen=True, slots=True, eq=False)
class Ranking:
    """A strategy of the system, by layers; B bits, T rows, G goals, L layers of all goals together.

    Attributes:
        variables: inputs, then outputs.
        inputs: how many of the variables are inputs.
        order: (B,) the bits (of all variables, as they are declared, least significant first) by their place in the
            order of the diagrams; the present value of the bit at place p is variable 2 p, the next one 2 p + 1.
        variable, low, high: (T,) rows: what is decided, and the rows where it is false and true; rows 0 and 1 are the
            constants false and true; both parts of a row stand before it.
        env_init, sys_init, winning: rows of sets of states.
        environment, system: rows of sets of steps; the steps of either side are in all of its sets.
        goals, justices: rows of sets of steps. No goals: one that holds always.
        first: (G + 1,) the layers of goal g are ``first[g]`` to ``first[g + 1] - 1``.
        layers: (L,) rows of sets of states, each inside the next one, the last one the winning states.
        waits_for: (L,) the justice that a play may wait for in a layer, -1 for none.
    """

    variables: tuple[Variable, ...]
    inputs: int
    order: Column
    variable: Column
    low: Column
    high: Column
    env_init: int
    sys_init: int
    winning: int
    environment: Column
    system: Column
    goals: Column
    justices: Column
    first: Column
    layers: Column
    waits_for: Column

    def __post_init__(self) -> None:
        """Take read-only arrays; refuse diagrams that are none and rows that do not exist."""
        for name in ("order", "variable", "low", "high", *SEVERAL, "first", "layers", "waits_for"):
            array = np.array(getattr(self, name), dtype=np.int32)
            if array.ndim != 1:
                raise ValueError(f"{name} has one axis")
            array.flags.writeable = False
            object.__setattr__(self, name, array)
        self._check_rows()
        self._check_layers()

    def _check_rows(self) -> None:
        rows, bits = len(self.variable), sum(len(variable.bits) for variable in self.variables)
        if rows < 2 or len(self.low) != rows or len(self.high) != rows:
            raise ValueError("variable, low and high have one length, at least 2")
        if not np.array_equal(np.sort(self.order), np.arange(bits)):
            raise ValueError(f"order holds the bits 0 to {bits - 1}, each once")
        inner, places = self.variable[2:], np.arange(2, rows)
        level = np.concatenate([[2 * bits, 2 * bits], inner])
        for part in (self.low[2:], self.high[2:]):
            if (part < 0).any() or (part >= places).any() or (level[part] <= inner).any():
                raise ValueError("both parts of a row stand before it and decide later variables")
        if (inner < 0).any() or (self.low[2:] == self.high[2:]).any():
            raise ValueError("a row decides a variable, and its parts differ")
        for name in (*SINGLE, *SEVERAL, "layers"):
            root = np.asarray(getattr(self, name))
            if (root < 0).any() or (root >= rows).any():
                raise ValueError(f"{name} names rows that do not exist")

    def _check_layers(self) -> None:
        goals = len(self.goals)
        if not goals or len(self.first) != goals + 1 or self.first[0] != 0 or self.first[-1] != len(self.layers):
            raise ValueError("there is a goal, and first goes from 0 to the number of layers")
        if (np.diff(self.first) < 1).any() or len(self.waits_for) != len(self.layers):
            raise ValueError("every goal has a layer, and every layer an entry in waits_for")
        if (self.waits_for < -1).any() or (self.waits_for >= len(self.justices)).any():
            raise ValueError("waits_for names justices that do not exist")

    def arrays(self) -> dict[str, Any]:
        """Return all that a file keeps, by name."""
        return {name: np.asarray(getattr(self, name), dtype=np.int32) for name in ARRAYS}

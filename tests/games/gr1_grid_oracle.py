"""Brute force on tiny specifications: all pairs of states as one Boolean matrix, the fixpoint letter for letter."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.logic import Conjunct, Evaluator, Specification, Variable
from surefoot.logic.syntax import And, Atom, Comparison, Expression, Iff, Integer, Not, Number, Or

Matrix = NDArray[np.bool_]


@dataclass(frozen=True)
class Grid:
    """Everything about a tiny specification: (S, S) matrices over pairs of states."""

    spec: Specification
    states: NDArray[np.int32]
    move: Matrix  # (S, X) the environment may choose these next inputs
    answer: Matrix  # (S, S) the system may choose this next state
    column: NDArray[np.intp]  # (S,) the number of the inputs of a state
    goals: list[Matrix]
    justices: list[Matrix]
    env_init: Matrix
    sys_init: Matrix

    @classmethod
    def of(cls, spec: Specification) -> Grid:
        states = np.array(list(product(*(v.values for v in spec.variables))), dtype=np.int32)
        now = {v.name: states[:, None, k] for k, v in enumerate(spec.variables)}
        then = {v.name: states[None, :, k] for k, v in enumerate(spec.variables)}
        evaluator, size = Evaluator(spec), len(states)

        def matrix(lines: Sequence[Conjunct]) -> Matrix:
            result: Matrix = np.ones((size, size), dtype=np.bool_)
            for line in lines:
                result = np.logical_and(result, np.broadcast_to(evaluator(line.expression, now, then), (size, size)))
            return result

        _, column = np.unique(states[:, : len(spec.inputs)], axis=0, return_inverse=True)
        column = column.reshape(-1)
        env = matrix(spec.environment_safety)
        move = np.zeros((size, int(column.max()) + 1), dtype=np.bool_)
        for target in range(size):
            move[:, column[target]] |= env[:, target]
        return cls(
            spec,
            states,
            move,
            matrix(spec.system_safety),
            column,
            [matrix([line]) for line in spec.sys_liveness] or [np.ones((size, size), dtype=np.bool_)],
            [matrix([line]) for line in spec.env_liveness] or [np.ones((size, size), dtype=np.bool_)],
            matrix(spec.env_init)[:, 0],
            matrix(spec.sys_init)[:, 0],
        )

    def cpre(self, good: Matrix, env_dead_end: str) -> Matrix:
        able = np.zeros_like(self.move)
        allowed = self.answer & good
        for x in range(self.move.shape[1]):
            able[:, x] = allowed[:, self.column == x].any(axis=1)
        forced: Matrix = np.all(~self.move | able, axis=1)
        return forced & self.move.any(axis=1) if env_dead_end == "loses" else forced

    def winning(self, env_dead_end: str) -> Matrix:
        z = np.ones(len(self.states), dtype=np.bool_)
        while True:
            following = z.copy()
            for goal in self.goals:
                following &= self._mu_y(goal, z, env_dead_end)
            if (following == z).all():
                return z
            z = following

    def _mu_y(self, goal: Matrix, z: Matrix, env_dead_end: str) -> Matrix:
        y = np.zeros_like(z)
        while True:
            grown = y.copy()
            for justice in self.justices:
                x = np.ones_like(z)
                while True:
                    smaller = self.cpre((goal & z) | y | (~justice & x), env_dead_end)
                    if (smaller == x).all():
                        break
                    x = smaller
                grown |= x
            if (grown == y).all():
                return y
            y = grown

    def realizable(self, semantics: str, env_dead_end: str) -> bool:
        winning = self.winning(env_dead_end)
        if semantics == "robotics":
            return bool(winning[self.env_init & self.sys_init].all())
        asked, answered = set(self.column[self.env_init]), set(self.column[self.env_init & self.sys_init & winning])
        return asked == answered

    def reachable(self) -> int:
        """Return how many states plays can reach by both sides' rules."""
        step = self.answer & self.move[:, self.column]
        seen = self.env_init & self.sys_init
        while True:
            grown = seen | step[seen].any(axis=0)
            if (grown == seen).all():
                return int(seen.sum())
            seen = grown


def random_game(source: random.Random) -> Specification:
    """Return a specification of 8 to 48 states with interesting rules: updates, forbidden steps, goals, assumptions."""
    inputs = (Variable("a"), *((Variable("i", 0, 2),) if source.random() < 0.4 else (Variable("b"),)))
    outputs = (Variable("o"), *((Variable("n", -1, 2 if source.random() < 0.5 else 1),)))
    everything, count = inputs + outputs, source.randint

    def lines(name: str, number: int, now: Sequence[Variable], then: Sequence[Variable], depth: int = 2) -> None:
        sections[name] = tuple(
            Conjunct(name.upper(), _formula(source, now, then, depth), f"rule {k}", k + 1) for k in range(number)
        )

    sections: dict[str, Any] = {}
    lines("env_init", count(0, 1), inputs, ())
    lines("sys_init", count(0, 1), everything, ())
    lines("env_trans", count(0, 2), everything, inputs)
    lines("sys_trans", count(0, 2), everything, everything)
    lines("env_liveness", count(0, 2) if source.random() < 0.65 else 0, everything, inputs, 1)
    lines("sys_liveness", count(0, 2), everything, everything if source.random() < 0.4 else (), 1)
    return Specification(inputs, outputs, **sections)


def _formula(source: random.Random, now: Sequence[Variable], then: Sequence[Variable], depth: int) -> Expression:
    if depth == 0 or source.random() < 0.15:
        primed = bool(then) and (not now or source.random() < 0.6)
        variable = source.choice(list(then if primed else now))
        if variable.is_boolean:
            atom = Atom(variable.name, primed)
            return atom if source.random() < 0.5 else Not(atom)
        number = Number(source.choice(list(variable.values)))
        return Comparison(source.choice(["=", "!=", "<=", ">"]), Integer(variable.name, primed), number)
    left, right = (_formula(source, now, then, depth - 1) for _ in range(2))
    kind = source.random()
    return Or((left, right)) if kind < 0.55 else And((left, right)) if kind < 0.75 else Iff(left, right)

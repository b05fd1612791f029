"""A naive GR(1) solver over sets of states, for tiny specifications: an oracle that shares nothing with ``games``.

It enumerates all valuations, evaluates every line with the evaluator of the integer level, and extracts strategies of
both players from the layers of the fixpoints (Bloem et al., JCSS 2012; for the dual Könighofer, Hofferek and Bloem,
FMCAD 2009).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.logic import Conjunct, Evaluator, Specification, Transducer
from surefoot.logic.transducer import NO_MOVE, Player

State = tuple[int, ...]
Edge = tuple[State, State]


@dataclass(frozen=True)
class Answer:
    """Whether the system wins, and a strategy of whoever does."""

    realizable: bool
    strategy: Transducer


class Game:
    """A specification, enumerated."""

    def __init__(self, spec: Specification, *, env_dead_end: str = "wins") -> None:
        self.spec = spec
        self.dead_end_won = env_dead_end == "wins"
        self.evaluate = Evaluator(spec)
        self.inputs = len(spec.inputs)
        self.states: list[State] = list(product(*(v.values for v in spec.variables)))
        choices: list[State] = list(product(*(v.values for v in spec.inputs)))
        per_input = len(self.states) // len(choices)
        self.table = np.array(self.states, dtype=np.int64).reshape(len(self.states), len(spec.variables))
        allowed = self.everywhere(spec.environment_safety)[:, ::per_input]
        answers = self.everywhere(spec.system_safety)
        self.moves: dict[State, list[State]] = {}
        self.answers: dict[tuple[State, State], list[State]] = {}
        for s, state in enumerate(self.states):
            self.moves[state] = [choices[i] for i in np.flatnonzero(allowed[s])]
            for i in np.flatnonzero(allowed[s]):
                block = answers[s, i * per_input : (i + 1) * per_input]
                self.answers[state, choices[i]] = [self.states[i * per_input + t] for t in np.flatnonzero(block)]
        legal = np.repeat(allowed, per_input, axis=1) & answers
        self.goals = [self._edges_with(c, legal) for c in spec.sys_liveness] or [self._edges_with(None, legal)]
        self.justices = [self._edges_with(c, legal) for c in spec.env_liveness] or [self._edges_with(None, legal)]

    def everywhere(self, conjuncts: Iterable[Conjunct]) -> NDArray[np.bool_]:
        """Return (states, states) on which steps some lines hold; what needs no next outputs is judged with any."""
        names = [v.name for v in self.spec.variables]
        now = {name: self.table[:, k][:, None] for k, name in enumerate(names)}
        after = {name: self.table[:, k][None, :] for k, name in enumerate(names)}
        holds = np.ones((len(self.states), len(self.states)), dtype=np.bool_)
        for conjunct in conjuncts:
            holds &= self.evaluate(conjunct.expression, now, after)
        return holds

    def begins(self, conjuncts: Iterable[Conjunct]) -> list[State]:
        """Return the states in which some lines without primes hold."""
        now = {v.name: self.table[:, k] for k, v in enumerate(self.spec.variables)}
        holds = np.ones(len(self.states), dtype=np.bool_)
        for conjunct in conjuncts:
            holds &= self.evaluate(conjunct.expression, now)
        return [self.states[s] for s in np.flatnonzero(holds)]

    def _edges_with(self, conjunct: Conjunct | None, legal: NDArray[np.bool_]) -> set[Edge]:
        holds = legal if conjunct is None else legal & self.everywhere([conjunct])
        return {(self.states[s], self.states[t]) for s, t in zip(*np.nonzero(holds), strict=True)}

    def reachable(self) -> set[State]:
        """Return the states that plays visit in which both players keep their safety."""
        queue = self.begins(self.spec.env_init + self.spec.sys_init)
        seen = set(queue)
        for state in queue:
            for inputs in self.moves[state]:
                queue += [t for t in self.answers[state, inputs] if t not in seen]
                seen.update(self.answers[state, inputs])
        return seen

    def system_pre(self, good: Callable[[Edge], bool]) -> set[State]:
        """Return from where the system can answer every move with a good edge."""
        return {
            s
            for s in self.states
            if (self.moves[s] or self.dead_end_won)
            and all(any(good((s, t)) for t in self.answers[s, i]) for i in self.moves[s])
        }

    def environment_pre(self, good: Callable[[Edge], bool]) -> set[State]:
        """Return from where the environment has a move that only good edges answer."""
        return set(self.states) - self.system_pre(lambda edge: not good(edge))


def solve_naively(spec: Specification, *, semantics: str = "slugs", env_dead_end: str = "wins") -> Answer:
    """Solve a tiny specification."""
    game = Game(spec, env_dead_end=env_dead_end)
    winning, layers = _system_fixpoint(game)
    bad, starts = _starts(game, winning, semantics)
    if bad is None:
        return Answer(True, _system_strategy(game, winning, layers, starts))
    return Answer(False, _environment_strategy(game, starts, bad))


def decide_naively(game: Game, *, semantics: str = "slugs") -> bool:
    """Return whether a tiny specification is realizable."""
    winning, _ = _system_fixpoint(game)
    return _starts(game, winning, semantics)[0] is None


def _starts(game: Game, winning: set[State], semantics: str) -> tuple[State | None, list[State]]:
    """Return initial inputs that the environment wins with (None: there are none), and the initial states of a play."""
    spec = game.spec
    starts = game.begins(spec.env_init + spec.sys_init)
    if semantics == "robotics":
        bad = next((s for s in starts if s not in winning), None)
        return (None, starts) if bad is None else (bad[: game.inputs], [bad])
    first_inputs = list(dict.fromkeys(s[: game.inputs] for s in game.begins(spec.env_init)))
    by_inputs = {i: [s for s in starts if s[: game.inputs] == i] for i in first_inputs}
    lost = next((i for i, states in by_inputs.items() if not winning & set(states)), None)
    if lost is None:
        return None, [next(s for s in states if s in winning) for states in by_inputs.values()]
    return lost, by_inputs[lost]


Layers = list[list[list[set[State]]]]


def _system_fixpoint(game: Game) -> tuple[set[State], Layers]:
    """Return the winning states, and X sets by goal, layer and justice."""
    z = set(game.states)
    while True:
        layers = [_mu_y(game, goal, z) for goal in game.goals]
        after = z.intersection(*(set().union(*(x for layer in y for x in layer)) for y in layers))
        if after == z:
            return z, layers
        z = after


def _mu_y(game: Game, goal: set[Edge], z: set[State]) -> list[list[set[State]]]:
    y: set[State] = set()
    layers: list[list[set[State]]] = []
    while True:
        layer = [_nu_x(game, goal, z, y, justice) for justice in game.justices]
        grown = y.union(*layer)
        if grown == y:
            return layers
        layers.append(layer)
        y = grown


def _nu_x(game: Game, goal: set[Edge], z: set[State], y: set[State], justice: set[Edge]) -> set[State]:
    x = set(game.states)
    while True:
        now = x
        after = game.system_pre(
            lambda e: (e in goal and e[1] in z) or e[1] in y or (e not in justice and e[1] in now)  # noqa: B023
        )
        if after == x:
            return x
        x = after


def _system_strategy(game: Game, z: set[State], layers: Layers, starts: list[State]) -> Transducer:
    def rank(g: int, s: State) -> int:
        return next((k for k, layer in enumerate(layers[g]) if any(s in x for x in layer)), 10**9)

    def answer(s: State, g: int, i: State) -> tuple[State, int]:
        k = rank(g, s)
        targets = game.answers[s, i]
        for t in targets:
            if (s, t) in game.goals[g] and t in z:
                return t, (g + 1) % len(game.goals)
        best = min(targets, key=lambda t: rank(g, t))
        if rank(g, best) < k:
            return best, g
        for j, x in enumerate(layers[g][k]):
            if s in x:
                for t in targets:
                    if (s, t) not in game.justices[j] and t in x:
                        return t, g
        raise AssertionError("no answer")

    return _explored(
        game, "system", [(s, 0) for s in starts], lambda s, g: [answer(s, g, i) for i in game.moves[s]], lambda m: m
    )


def _environment_fixpoint(game: Game) -> list[list[tuple[set[State], list[list[set[State]]]]]]:
    """Return, by layer of Z and goal, the set Y and the layers of X by justice."""
    z: set[State] = set()
    found: list[list[tuple[set[State], list[list[set[State]]]]]] = []
    while True:
        row = [_nu_y_dual(game, goal, z) for goal in game.goals]
        grown = z.union(*(y for y, _ in row))
        if grown == z:
            return found
        found.append(row)
        z = grown


def _nu_y_dual(game: Game, goal: set[Edge], z: set[State]) -> tuple[set[State], list[list[set[State]]]]:
    y = set(game.states)
    while True:
        xs = [_mu_x_dual(game, goal, z, y, justice) for justice in game.justices]
        after = set(game.states).intersection(*(layers[-1] if layers else set() for layers in xs))
        if after == y:
            return y, xs
        y = after


def _mu_x_dual(game: Game, goal: set[Edge], z: set[State], y: set[State], justice: set[Edge]) -> list[set[State]]:
    x: set[State] = set()
    layers: list[set[State]] = []
    while True:
        grown = x | game.environment_pre(lambda e: _good_for_environment(e, goal, z, y, justice, x))  # noqa: B023
        if grown == x:
            return layers
        layers.append(grown)
        x = grown


def _good_for_environment(
    e: Edge, goal: set[Edge], z: set[State], y: set[State], justice: set[Edge], x: set[State]
) -> bool:
    return (e not in goal or e[1] in z) and e[1] in y and (e in justice or e[1] in x)


def _environment_strategy(game: Game, starts: list[State], inputs: State) -> Transducer:
    found = _environment_fixpoint(game)
    below = [set().union(*(y for row in found[:r] for y, _ in row)) for r in range(len(found) + 1)]

    def level(s: State) -> int:
        return next(r for r in range(len(found)) if s in below[r + 1])

    def placed(s: State, g: int, j: int) -> tuple[State, tuple[int, int, int]]:
        r = level(s)
        if s in found[r][g][0]:
            return s, (r, g, j)
        return s, (r, next(k for k, (y, _) in enumerate(found[r]) if s in y), 0)

    def move(s: State, memory: tuple[int, int, int]) -> State | None:
        r, g, j = memory
        y, xs = found[r][g]
        x = xs[j]
        k = next(k for k, layer in enumerate(x) if s in layer)
        inner = x[k - 1] if k else set()
        for i in game.moves[s]:
            edges = [(s, t) for t in game.answers[s, i]]
            if all(_good_for_environment(e, game.goals[g], below[r], y, game.justices[j], inner) for e in edges):
                return i
        return None

    def after(s: State, memory: tuple[int, int, int]) -> list[tuple[State, tuple[int, int, int]]]:
        i = move(s, memory)
        out = []
        for t in game.answers[s, i] if i is not None else []:
            r, g, j = memory
            following = (j + 1) % len(game.justices) if (s, t) in game.justices[j] else j
            if level(t) < r:
                following = 0
            out.append(placed(t, g, following))
        return out

    nodes = [placed(s, 0, 0) for s in starts]
    return _explored(game, "environment", nodes, after, lambda m: m[1], move, inputs)


def _explored(
    game: Game,
    player: Player,
    starts: list[Any],
    after: Callable[..., list[Any]],
    memory_of: Callable[[Any], int],
    move: Callable[..., State | None] | None = None,
    initial_inputs: State | None = None,
) -> Transducer:
    number = {node: k for k, node in enumerate(dict.fromkeys(starts))}
    queue = list(number)
    first: list[int] = [0]
    successors: list[int] = []
    for node in queue:
        for following in after(*node):
            if following not in number:
                number[following] = len(number)
                queue.append(following)
            successors.append(number[following])
        first.append(len(successors))
    moves = None
    if move is not None:
        rows = [move(*node) for node in queue]
        moves = np.array([[NO_MOVE] * game.inputs if r is None else r for r in rows]).reshape(len(queue), game.inputs)
    return Transducer(
        player=player,
        variables=game.spec.variables,
        inputs=game.inputs,
        values=np.array([s for s, _ in queue]).reshape(len(queue), len(game.spec.variables)),
        memory=np.array([memory_of(m) for _, m in queue], dtype=int),
        first=np.array(first),
        successors=np.array(successors, dtype=int),
        initial=np.array([number[node] for node in starts], dtype=int),
        moves=moves,
        initial_inputs=None if initial_inputs is None else np.array(initial_inputs, dtype=int),
    )

"""Strategies of the system from the layers of the symbolic fixpoint, played out over all that is reachable.

At state s in pursuit of goal g, for every next input: an answer that meets the goal and stays in Z, otherwise into the
lowest layer that can be had, otherwise one that stays while the justice of the layer fails. Goals of states that hold
already are skipped before the choice, several at once. Among equal answers the first in the variable order is taken.

Source: Piterman, Pnueli and Sa'ar, VMCAI 2006, Sec. 5; Bloem et al., JCSS 78, 2012, Sec. 3.3.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from typing import Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from surefoot.compute import Deadline
from surefoot.errors import LimitExceeded
from surefoot.games.symbolic import Layer, SymbolicGame, SymbolicResult
from surefoot.games.walks import Bits, Walker
from surefoot.logic.syntax import Variable
from surefoot.logic.transducer import NO_MOVE, Transducer
from surefoot.logic.transducer import Player as Owner

FEW_EDGES = 120_000
"""Above this a ranking says the same with less."""
MOST_EDGES = 3_000_000
_SAMPLE = 100
M = TypeVar("M", bound=Hashable)


class Player(Protocol):
    """Plays for the system from states that it wins."""

    def initial(self, robotics: bool) -> Iterable[tuple[Bits, int]]:
        """Return the initial states that the strategy allows for, with their memory."""
        ...

    def answer(self, memory: int, state: Bits, inputs: Bits) -> tuple[int, Bits]:
        """Return the next memory and the next outputs for a state, the memory and the next inputs."""
        ...


class SystemPlayer:
    """Answers the environment by the layers."""

    def __init__(self, walker: Walker, result: SymbolicResult) -> None:
        self._walker, self._game = walker, walker.game
        self._z = result.winning
        self._z_next = self._game.next(result.winning)
        self._layers = result.layers
        self._rank: dict[tuple[int, bytes], int] = {}
        self._into: dict[tuple[int, int], int] = {}
        for goal, layers in enumerate(self._layers):
            for layer in range(len(layers)):
                self._layer_root(goal, layer)
                walker.tables.root(layers[layer].reached)

    def initial(self, robotics: bool) -> Iterator[tuple[Bits, int]]:
        """Return the initial states that the strategy allows for, with their memory."""
        game, walker = self._game, self._walker
        if robotics:
            for state in walker.states((game.env_init, game.sys_init)):
                yield state, 0
            return
        for inputs in walker.inputs((game.env_init,)):
            candidates = walker.states((game.sys_init, self._z), inputs)
            ranks = [self.rank(0, state) for state in candidates]
            yield candidates[int(np.argmin(ranks))], 0

    def rank(self, goal: int, state: Bits) -> int:
        """Return the first layer of a goal that contains a state of Z."""
        key = (goal, state.tobytes())
        if key not in self._rank:
            layers = self._layers[goal]
            self._rank[key] = bisect_left(layers, True, key=lambda layer: self._walker.contains(layer.reached, state))
        return self._rank[key]

    def answer(self, memory: int, state: Bits, inputs: Bits) -> tuple[int, Bits]:
        """Return the next memory and the next outputs."""
        goal = self._after_goals(memory, state)
        promise = self._game.goals[goal]
        if not promise.of_states:
            met = self._walker.roots((promise.set, self._z_next))
            following = (goal + 1) % len(self._game.goals)
            found = self._best(following, state, inputs, met)
            if found is not None:
                return following, found
        layer = self._layers[goal][self.rank(goal, state)]
        found = self._best(goal, state, inputs, (), self.rank(goal, state))
        if found is None and layer.justice >= 0:
            found = self._waiting(layer, state, inputs)
        if found is None:  # the goal holds here and all others too: any answer inside Z
            found = self._walker.answers(state, inputs, self._walker.roots((self._z_next,)), 1)[0]
        return goal, found

    def _after_goals(self, memory: int, state: Bits) -> int:
        goals = self._game.goals
        for step in range(len(goals)):
            goal = (memory + step) % len(goals)
            if not (goals[goal].of_states and self._walker.contains(goals[goal].set, state)):
                return goal
        return (memory + 1) % len(goals)

    def _best(
        self, goal: int, state: Bits, inputs: Bits, extra: Sequence[int], below: int | None = None
    ) -> Bits | None:
        """Return the first answer into the lowest layer of a goal; layers grow, so bisection finds it."""
        layers = range(len(self._layers[goal]) if below is None else below)

        def answers(layer: int) -> Bits:
            return self._walker.answers(state, inputs, (*extra, self._layer_root(goal, layer)), 1)

        if not layers or not len(highest := answers(layers[-1])):
            return None
        lowest = bisect_left(layers[:-1], True, key=lambda layer: len(answers(layer)) > 0)
        best: Bits = (highest if lowest == len(layers) - 1 else answers(lowest))[0]
        return best

    def _layer_root(self, goal: int, layer: int) -> int:
        if (goal, layer) not in self._into:
            following = self._game.next(self._layers[goal][layer].reached)
            self._into[goal, layer] = self._walker.tables.root(following)
        return self._into[goal, layer]

    def _waiting(self, layer: Layer, state: Bits, inputs: Bits) -> Bits | None:
        game = self._game
        roots = self._walker.roots((game.next(layer.reached), ~game.justices[layer.justice].set))
        found = self._walker.answers(state, inputs, roots, 1)
        return found[0] if len(found) else None


def system_machine(
    walker: Walker, player: Player, *, robotics: bool, deadline: Deadline, most_edges: int = MOST_EDGES
) -> Transducer:
    """Return the strategy of a player of the system as a transducer of the reachable nodes.

    Raises:
        LimitExceeded: if it has more edges than allowed, or the deadline has passed.
    """
    nodes: Nodes[int] = Nodes(deadline, most_edges)
    initial = [nodes.number(*place) for place in player.initial(robotics)]
    while (place := nodes.next()) is not None:
        state, memory = place
        for following in walker.next_inputs(state):
            goal, outputs = player.answer(memory, state, following)
            nodes.edge(np.concatenate([following, outputs]), goal)
    return nodes.transducer(walker.game, "system", initial, shown=lambda memory: memory)


class Nodes(Generic[M]):
    """The nodes of a transducer in the order of their discovery, with their edges."""

    def __init__(self, deadline: Deadline, most_edges: int) -> None:
        self._deadline, self._most = deadline, most_edges
        self._numbers: dict[tuple[bytes, M], int] = {}
        self.states: list[Bits] = []
        self.memories: list[M] = []
        self._first: list[int] = []
        self._successors: list[int] = []

    def number(self, state: Bits, memory: M) -> int:
        """Return the number of a node, a new one if it is new."""
        key = (state.tobytes(), memory)
        if key not in self._numbers:
            self._numbers[key] = len(self.states)
            self.states.append(state)
            self.memories.append(memory)
        return self._numbers[key]

    def next(self) -> tuple[Bits, M] | None:
        """Open the next node; its edges follow. None when all are done."""
        place = len(self._first)
        if place == len(self.states):
            return None
        self._deadline.check("making the strategy")
        self._check_prospect(place)
        self._first.append(len(self._successors))
        return self.states[place], self.memories[place]

    def _check_prospect(self, opened: int) -> None:
        """Give up a short list once the nodes that are known will clearly have more edges than allowed."""
        prospect = len(self.states) * len(self._successors)
        if self._most <= FEW_EDGES and opened > _SAMPLE and prospect > 2 * self._most * opened:
            raise LimitExceeded(f"the strategy has more than {self._most} transitions")

    def edge(self, state: Bits, memory: M) -> None:
        """Add an edge to the open node."""
        if len(self._successors) == self._most:
            raise LimitExceeded(f"the strategy has more than {self._most} transitions")
        self._successors.append(self.number(state, memory))

    def transducer(
        self,
        game: SymbolicGame,
        player: Owner,
        initial: Sequence[int],
        *,
        shown: Callable[[M], int],
        moves: list[Bits | None] | None = None,
        initial_inputs: Bits | None = None,
    ) -> Transducer:
        """Return the nodes as a transducer over the variables of the specification."""
        spec, bits = game.game.spec, len(game.game.bits)
        rows = np.array(self.states, dtype=np.uint8).reshape(len(self.states), bits)
        return Transducer(
            player=player,
            variables=spec.variables,
            inputs=len(spec.inputs),
            values=_decoded(rows, spec.variables, game.game.groups),
            memory=np.array([shown(memory) for memory in self.memories], dtype=np.int32),
            first=np.array([*self._first, len(self._successors)], dtype=np.int64),
            successors=np.array(self._successors, dtype=np.int32),
            initial=np.array(initial, dtype=np.int32),
            moves=None if moves is None else _decoded_moves(moves, spec.inputs, game.game.groups),
            initial_inputs=None
            if initial_inputs is None
            else _decoded(initial_inputs[None, :], spec.inputs, game.game.groups)[0],
        )


def _decoded(rows: Bits, variables: Sequence[Variable], groups: Sequence[tuple[int, ...]]) -> NDArray[np.int32]:
    """Return the values of variables from rows of bits."""
    values = np.zeros((len(rows), len(variables)), dtype=np.int32)
    for column, (variable, group) in enumerate(zip(variables, groups, strict=False)):
        for weight, bit in enumerate(group):
            values[:, column] += rows[:, bit].astype(np.int32) << weight
        values[:, column] += 0 if variable.is_boolean else variable.values[0]
    return values


def _decoded_moves(
    moves: Sequence[Bits | None], variables: Sequence[Variable], groups: Sequence[tuple[int, ...]]
) -> NDArray[np.int32]:
    values = np.full((len(moves), len(variables)), NO_MOVE, dtype=np.int32)
    for row, move in enumerate(moves):
        if move is not None:
            values[row] = _decoded(move[None, :], variables, groups)[0]
    return values

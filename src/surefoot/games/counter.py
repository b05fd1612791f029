"""The environment's side: where it wins an unrealizable specification, and its counter-strategy.

The dual of the system's fixpoint, with epre(T) = { s : some next input that the environment's rules allow, such that
every answer that the system's rules allow leads into T }:

    mu Z . OR_g  nu Y . AND_j  mu X . epre( (not goal_g or Z') and Y' and (justice_j or X') )

Each step of Z remembers the goal that is denied there, Y, and the layers of X for every justice. The environment stays
in Y, never lets the goal happen, and brings the justices about in turn; or it gets into an earlier Z, for good.

Source: Koenighofer, Hofferek and Bloem, "Debugging formal specifications: a practical approach using model-based
diagnosis and counterstrategies", STTT 15, 2013; Piterman, Pnueli and Sa'ar, VMCAI 2006.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.compute import Deadline
from surefoot.games.diagrams import Set
from surefoot.games.machines import MOST_EDGES, Nodes
from surefoot.games.symbolic import SymbolicGame
from surefoot.games.walks import Bits, Walker
from surefoot.logic.transducer import Transducer


@dataclass(frozen=True, slots=True, eq=False)
class Denial:
    """One step of mu Z: where the environment can deny a goal for ever, or get into an earlier step.

    Attributes:
        before: Z before the step.
        goal: the goal denied.
        region: Y.
        layers: for every justice the sets X in their order, each containing the one before; the last one is Y.
    """

    before: Set
    goal: int
    region: Set
    layers: tuple[tuple[Set, ...], ...]


class Denials:
    """The dual fixpoint of a game."""

    def __init__(self, game: SymbolicGame) -> None:
        self._game, self._manager = game, game.manager

    def solve(self, enough: Set) -> tuple[Denial, ...]:
        """Return the steps of mu Z, until Z contains the states given or grows no more."""
        manager = self._manager
        z = manager.false
        steps: list[Denial] = []
        grown = True
        while grown:
            grown = False
            for g in range(len(self._game.goals)):
                region, layers = self._nu_y(g, z)
                if manager.conjoin(region, ~z) != manager.false:
                    steps.append(Denial(z, g, region, layers))
                    z = manager.unite(z, region)
                    grown = True
                if manager.conjoin(enough, ~z) == manager.false:
                    return tuple(steps)
        return tuple(steps)

    def target(self, goal: int, before: Set, y: Set, justice: Set, x: Set) -> Set:
        """Return (not goal or Z') and Y' and (justice or X')."""
        manager, game = self._manager, self._game
        denied = manager.unite(~game.goals[goal].set, game.next(before))
        pressed = manager.unite(justice, game.next(x))
        return manager.conjoin(manager.conjoin(denied, game.next(y)), pressed)

    def justices(self) -> list[Set]:
        """Return the justices, the true one when there are none."""
        return [justice.set for justice in self._game.justices] or [self._manager.true]

    def _nu_y(self, goal: int, before: Set) -> tuple[Set, tuple[tuple[Set, ...], ...]]:
        y = self._manager.true
        while True:
            layers = []
            smaller = y
            for justice in self.justices():
                found = self._mu_x(goal, before, smaller, justice)
                layers.append(found)
                smaller = found[-1]
            if smaller == y:
                return y, tuple(layers)
            y = smaller

    def _mu_x(self, goal: int, before: Set, y: Set, justice: Set) -> tuple[Set, ...]:
        layers = [self._manager.false]
        while True:
            x = self._game.epre(self.target(goal, before, y, justice, layers[-1]))
            if x == layers[-1]:
                return tuple(layers[1:]) or (x,)
            layers.append(x)


Memory = tuple[int, int]  # the step of mu Z, the justice that is brought about


class EnvironmentPlayer:
    """Picks next inputs by the steps of the dual fixpoint."""

    def __init__(self, walker: Walker, steps: tuple[Denial, ...]) -> None:
        self._walker, self._game, self._steps = walker, walker.game, steps
        self._denials = Denials(walker.game)
        self._justices = self._denials.justices()
        self._winning: dict[tuple[int, int, int], Set] = {}

    def start(self, state: Bits) -> Memory:
        """Return the memory at the beginning: the first step that contains the state."""
        return next(k for k, step in enumerate(self._steps) if self._walker.contains(step.region, state)), 0

    def move(self, state: Bits, memory: Memory) -> Bits | None:
        """Return the next inputs; None where the environment has no move and needs none."""
        k, j = memory
        layers = self._steps[k].layers[j]
        lowest = next(n for n, x in enumerate(layers) if self._walker.contains(x, state))
        moves = self._walker.next_inputs(state, self._walker.roots((self._good_moves(k, j, lowest),)), 1)
        return moves[0] if len(moves) else None

    def after(self, memory: Memory, state: Bits, following: Bits) -> Memory:
        """Return the memory after a transition."""
        k, j = memory
        earlier, _ = self.start(following)
        if earlier < k:
            return earlier, 0
        met = self._walker.has_step(self._justices[j], state, following)
        return k, (j + 1) % len(self._justices) if met else j

    def goal(self, memory: Memory) -> int:
        """Return the goal that is denied."""
        return self._steps[memory[0]].goal

    def _good_moves(self, k: int, j: int, lowest: int) -> Set:
        if (k, j, lowest) not in self._winning:
            step, manager = self._steps[k], self._game.manager
            x = step.layers[j][lowest - 1] if lowest else manager.false
            target = self._denials.target(step.goal, step.before, step.region, self._justices[j], x)
            self._winning[k, j, lowest] = ~self._game.system.some(~target)
        return self._winning[k, j, lowest]


def environment_machine(
    game: SymbolicGame, *, robotics: bool, deadline: Deadline, most_edges: int = MOST_EDGES
) -> Transducer | None:
    """Return a counter-strategy as a transducer of the reachable nodes; None if the system wins.

    Raises:
        LimitExceeded: if it has more edges than allowed, or the deadline has passed.
    """
    manager = game.manager
    steps = Denials(game).solve(manager.conjoin(game.env_init, game.sys_init))
    won = manager.false
    for step in steps:
        won = manager.unite(won, step.region)
    walker = Walker(game)
    found = _initial(game, walker, won, robotics)
    if found is None:
        return None
    states, inputs = found
    player = EnvironmentPlayer(walker, steps)
    nodes: Nodes[Memory] = Nodes(deadline, most_edges)
    initial = [nodes.number(state, player.start(state)) for state in states]
    moves: list[Bits | None] = []
    while (place := nodes.next()) is not None:
        state, memory = place
        move = player.move(state, memory)
        moves.append(move)
        for outputs in walker.answers(state, move) if move is not None else ():
            following = np.concatenate([move, outputs])
            nodes.edge(following, player.after(memory, state, following))
    return nodes.transducer(game, "environment", initial, shown=player.goal, moves=moves, initial_inputs=inputs)


def _initial(game: SymbolicGame, walker: Walker, won: Set, robotics: bool) -> tuple[Bits, Bits] | None:
    """Return the initial states that the environment picks, and their inputs."""
    manager, count = game.manager, game.game.inputs
    if robotics:
        states = walker.states((game.env_init, game.sys_init, won), most=1)
        return (states, states[0, :count]) if len(states) else None
    escapes = manager.and_exists(game.sys_init, ~won, game.output_cube)
    inputs = walker.inputs((game.env_init, ~escapes), most=1)
    if not len(inputs):
        return None
    return walker.states((game.sys_init,), inputs[0]), inputs[0]

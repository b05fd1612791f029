"""The symbolic engine: the three-nested fixpoint of GR(1) games on sets of states.

    nu Z . AND_g  mu Y . OR_j  nu X . cpre( (goal_g and Z') or Y' or (not justice_j and X') )

Goals and justices are sets of transitions, so they stand inside the controllable predecessor. Where a goal and the
justices read the present state only, the goal's part is taken out of it: within Z, goal_g and cpre(Z) is computed once.

What makes it fast, and leaves the result as it is: X and Y live inside Z; Z is cut as soon as one goal has shrunk it;
each X starts from what it was in the last round for the same goal, justice and layer (recycling); the loop ends once
every goal covers the same Z, or once no initial state can win (early detection).

Source: Piterman, Pnueli and Sa'ar, VMCAI 2006; Ehlers and Raman, "Slugs: extensible GR(1) synthesis", CAV 2016; Firman,
Maoz and Ringert, Acta Informatica 57, 2020 (arXiv 1712.01103).
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from itertools import count, cycle

from surefoot.compute import Deadline
from surefoot.games.bits import BitGame, Part
from surefoot.games.diagram_backends import diagrams
from surefoot.games.diagrams import Backend, Set
from surefoot.games.ordering import variable_orders
from surefoot.games.relation import Encoder, Move, primed
from surefoot.games.solution import EnvDeadEnd
from surefoot.logic.syntax import Conjunct


@dataclass(frozen=True, slots=True, eq=False)
class Liveness:
    """A promise: a set of transitions, or of states when it reads present values only."""

    set: Set
    of_states: bool


@dataclass(frozen=True, slots=True, eq=False)
class Layer:
    """What one step of mu Y added for one goal: all of Y so far, and how it was reached.

    Attributes:
        reached: Y after the step.
        justice: the justice waited for, -1 for a step of the attractor.
    """

    reached: Set
    justice: int


@dataclass(frozen=True, slots=True, eq=False)
class SymbolicResult:
    """Who wins where.

    Attributes:
        winning: Z; when ``stopped_early`` only a set that contains it.
        layers: for every goal the layers of mu Y inside Z, in their order.
        stopped_early: whether no initial state was left to win, so that the rest was not computed.
    """

    winning: Set
    layers: tuple[tuple[Layer, ...], ...]
    stopped_early: bool


class SymbolicGame:
    """A game over decision diagrams: the sets of its rules, and the moves."""

    def __init__(
        self,
        game: BitGame,
        *,
        env_dead_end: EnvDeadEnd,
        deadline: Deadline,
        backend: Backend = "oxidd",
        node_limit: int | None = None,
        order: list[int] | None = None,
        most_work: int | None = None,
    ) -> None:
        self.game = game
        order = order or variable_orders(game)[0]
        self.manager = diagrams(2 * len(game.bits), backend=backend, node_limit=node_limit)
        self.encoder = encoder = Encoder(game, order, self.manager, deadline)
        encoder.most_work = most_work
        inputs = range(game.inputs)
        outputs = range(game.inputs, len(game.bits))
        self.environment = Move(encoder, [g for g in game.groups if g and g[0] in inputs], game.env_trans)
        self.system = Move(encoder, [g for g in game.groups if g and g[0] in outputs], game.sys_trans)
        self.env_init = encoder.conjunction(encoder.set_of(part.formula) for part in game.env_init)
        self.sys_init = encoder.conjunction(encoder.set_of(part.formula) for part in game.sys_init)
        self.goals = [self._liveness(part) for part in game.goals] or [Liveness(self.manager.true, True)]
        self.justices = [self._liveness(part) for part in game.justices]
        self.output_cube = self.manager.cube(encoder.now(bit) for bit in outputs)
        everything = range(len(game.bits))
        self._to_next = self.manager.renaming(primed(encoder, everything))
        self.can_go_on = self.environment.some(self.manager.true) if env_dead_end == "loses" else self.manager.true

    def _liveness(self, part: Part) -> Liveness:
        return Liveness(self.encoder.set_of(part.formula), not part.following)

    def promising(self, kept: Callable[[Conjunct], bool]) -> SymbolicGame:
        """Return the same game with those lines of the system alone that are kept; sets of both can be compared."""
        fewer, game, encoder = copy(self), self.game, self.encoder
        outputs = range(game.inputs, len(game.bits))
        groups = [group for group in game.groups if group and group[0] in outputs]
        fewer.system = Move(encoder, groups, [part for part in game.sys_trans if kept(part.origin)])
        starts = [encoder.set_of(part.formula) for part in game.sys_init if kept(part.origin)]
        fewer.sys_init = encoder.conjunction(starts)
        goals = [self._liveness(part) for part in game.goals if kept(part.origin)]
        fewer.goals = goals or [Liveness(self.manager.true, True)]
        return fewer

    def next(self, states: Set) -> Set:
        """Return a set of states as a condition on the next state."""
        return self.manager.rename(states, self._to_next)

    def cpre(self, transitions: Set, care: Set) -> Set:
        """Return those states of ``care`` from where the system can force the next transition to be one of these."""
        helpless = self.environment.some(~self.system.some(transitions))
        return self.manager.conjoin(care, ~helpless)

    def epre(self, transitions: Set) -> Set:
        """Return from where the environment can force the next transition to be one of these.

        Where it has no move at all it wins if such dead ends count against the system.
        """
        forced = self.environment.some(~self.system.some(~transitions))
        return self.manager.unite(forced, ~self.can_go_on)

    def closed(self, states: Set) -> Set:
        """Return the greatest part of a set in which the system can stay for ever."""
        states = self.manager.conjoin(states, self.can_go_on)
        while (inner := self.cpre(self.next(states), states)) != states:
            states = inner
        return states

    def wins_initially(self, winning: Set, robotics: bool) -> bool:
        """Return whether the system wins from the initial states, by either reading of realizability."""
        manager = self.manager
        if robotics:
            return bool(manager.conjoin(manager.conjoin(self.env_init, self.sys_init), ~winning) == manager.false)
        answered = manager.and_exists(self.sys_init, winning, self.output_cube)
        return bool(manager.conjoin(self.env_init, ~answered) == manager.false)


def solve_symbolically(
    game: SymbolicGame,
    *,
    stop: Callable[[Set], bool] = lambda _: False,
    keep_layers: bool = False,
    within: Set | None = None,
) -> SymbolicResult:
    """Solve a game.

    Args:
        game: the game.
        stop: called with every Z that shrank; True ends the computation, for no initial state wins any more.
        keep_layers: whether a strategy will be made; otherwise the layers are dropped as they come.
        within: a set that is known to contain the winning states.

    Raises:
        LimitExceeded: once the deadline of the game or its node limit is passed.
    """
    z = game.closed(game.manager.true if within is None else within)
    recycled: dict[tuple[int, int, int], Set] = {}
    layers: dict[int, tuple[Layer, ...]] = {}
    for g in cycle(range(len(game.goals))):
        if stop(z):
            return SymbolicResult(z, (), True)
        found = _MuY(game, g, z, recycled).solve()
        if found[-1].reached != z:
            z = game.closed(found[-1].reached)
            layers.clear()
            continue
        layers[g] = found if keep_layers else ()
        if len(layers) == len(game.goals):
            break
    return SymbolicResult(z, tuple(layers[g] for g in range(len(game.goals))), False)


class _MuY:
    """The computation of mu Y for one goal inside Z, with Z = cpre(Z) on it."""

    def __init__(self, game: SymbolicGame, goal: int, z: Set, recycled: dict[tuple[int, int, int], Set]) -> None:
        self._game, self._manager, self._z = game, game.manager, z
        self._number, self._recycled = goal, recycled
        promise = game.goals[goal]
        if promise.of_states:
            self._base = game.manager.conjoin(promise.set, z)
            self._transitions = game.manager.false
        else:
            self._base = game.manager.false
            self._transitions = game.manager.conjoin(promise.set, game.next(z))
        self._y = game.manager.false
        self._layers: list[Layer] = []

    def solve(self) -> tuple[Layer, ...]:
        """Return the layers: the attractor is saturated before a justice is waited for ("bias for action")."""
        self._attract()
        for turn in count():
            before = self._y
            for j, justice in enumerate(self._game.justices):
                if self._y != self._z:
                    self._add(self._nu_x(turn, j, justice), j)
            if self._y in (before, self._z):
                break
            self._attract()
        return tuple(self._layers)

    def _add(self, reached: Set, justice: int) -> bool:
        if reached == self._y and self._layers:
            return False
        self._y = reached
        self._layers.append(Layer(reached, justice))
        return True

    def _attract(self) -> None:
        """Add all from where the system can force the play into Y."""
        while self._add(self._forced(), -1) and self._y != self._z:
            pass

    def _forced(self) -> Set:
        """Return base or cpre(goal transitions or Y'), inside Z and with Y."""
        manager, game = self._manager, self._game
        known = manager.unite(self._base, self._y)
        if known == self._y or self._transitions != manager.false:
            target = manager.unite(self._transitions, game.next(self._y))
            return manager.unite(known, game.cpre(target, manager.conjoin(self._z, ~known)))
        return known

    def _nu_x(self, turn: int, j: int, justice: Liveness) -> Set:
        """Return Y and the states from which the play stays where the justice fails, or enters Y or the goal."""
        manager, game, key = self._manager, self._game, (self._number, turn, j)
        x = manager.unite(self._y, manager.conjoin(self._recycled.get(key, self._z), self._z))
        while True:
            game.encoder.deadline.check("solving the game")
            smaller = manager.unite(self._y, self._stays(x, justice))
            if smaller == x:
                break
            x = smaller
        self._recycled[key] = x
        return x

    def _stays(self, x: Set, justice: Liveness) -> Set:
        manager, game = self._manager, self._game
        outside = manager.conjoin(x, ~self._y)
        if justice.of_states:
            target = manager.unite(self._transitions, game.next(x))
            return game.cpre(target, manager.conjoin(outside, ~justice.set))
        waiting = manager.conjoin(game.next(x), ~justice.set)
        into = manager.unite(self._transitions, game.next(self._y))
        return game.cpre(manager.unite(into, waiting), outside)

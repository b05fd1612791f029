"""How the environment wins an explicit game: a play in which the system heads for its goal and gets there no more.

The dual fixpoint on nodes; attr is the attractor of the environment:

    mu Z . attr( lost or Z or OR_g nu Y . AND_j mu X . not goal_g and ( (justice_j and epre(Y)) or epre(X) or Z ) )

Each step remembers how the environment gets on. A play against it is won, whatever the system does; here the system
takes, wherever it has the choice, a shortest way to the goal that is denied.

Source: Piterman, Pnueli and Sa'ar, VMCAI 2006; Koenighofer, Hofferek and Bloem, STTT 15, 2013.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.compute import Deadline
from surefoot.games._kernels import OPEN, OUTSIDE, Graph, attract, reverse
from surefoot.games.arena import Arena
from surefoot.games.solution import FOREVER

Nodes = NDArray[np.bool_]
Ranks = NDArray[np.int32]
_FAR = np.iinfo(np.int32).max


@dataclass(frozen=True, slots=True)
class Obstruction:
    """A play that the environment wins.

    Attributes:
        nodes: as they are visited.
        repeats_from: the play goes on for ever from the last node to the node of this index; None where it ends, since
            the system is lost or has no move.
        goal: the goal that is denied in the end; None where the play ends.
    """

    nodes: tuple[int, ...]
    repeats_from: int | None
    goal: int | None


@dataclass(frozen=True, slots=True, eq=False)
class _Step:
    """One step of mu Z: a way into what was won before (goal None), or a region where a goal is denied for ever.

    Attributes:
        region: the nodes that it added.
        goal: which one.
        ranks: for every justice the moves that are left until it holds; of a way a single row.
    """

    region: Nodes
    goal: int | None
    ranks: tuple[Ranks, ...]


def obstruction(arena: Arena, initial: int, *, deadline: Deadline = FOREVER) -> Obstruction | None:
    """Return a play from a node that the environment wins; None if the system wins from there.

    A dead end of the environment counts as a win of the system.

    Args:
        arena: the game.
        initial: where the play starts.
        deadline: when to give up.

    Raises:
        LimitExceeded: once the deadline has passed.
    """
    solver = _Dual(arena, deadline)
    steps = solver.steps(initial)
    return None if steps is None else _played(solver, steps, initial)


class _Dual:
    """The dual fixpoint over an arena."""

    def __init__(self, arena: Arena, deadline: Deadline) -> None:
        self.arena, self._deadline = arena, deadline
        before, predecessors = reverse(arena.first, arena.successors)
        self._graph = Graph(arena.system, arena.first, arena.successors, before, predecessors)
        self._degree = arena.degree
        self.over: Nodes = arena.lost | (arena.system & (self._degree == 0))
        self._sources = np.repeat(np.arange(arena.nodes), self._degree)

    def steps(self, initial: int) -> list[_Step] | None:
        """Return the steps of mu Z up to the one that contains a node."""
        everywhere = np.ones(self.arena.nodes, dtype=np.bool_)
        found: list[_Step] = []
        won = self.over
        while True:
            rank = self._attracted(won, everywhere)
            found.append(_Step(rank >= 0, None, (rank,)))
            won = rank >= 0
            step = None if won[initial] else self._denied(won)
            if step is None:
                return found if won[initial] else None
            found.append(step)
            won = won | step.region

    def _denied(self, won: Nodes) -> _Step | None:
        """Return a region where some goal can be denied for ever, or left for what is won."""
        for goal, holds in enumerate(self.arena.goals):
            region, ranks = self._nu_y(won, ~holds)
            if (region & ~won).any():
                return _Step(region, goal, ranks)
        return None

    def _nu_y(self, won: Nodes, allowed: Nodes) -> tuple[Nodes, tuple[Ranks, ...]]:
        justices = list(self.arena.justices) or [np.ones(self.arena.nodes, dtype=np.bool_)]
        y = allowed | won
        while True:
            ranks, smaller = [], y
            for justice in justices:
                self._deadline.check("searching for a play of the environment")
                base = won | (allowed & justice & self._epre(smaller))
                ranks.append(self._attracted(base, allowed))
                smaller = ranks[-1] >= 0
            if (smaller == y).all():
                return y, tuple(ranks)
            y = smaller

    def _epre(self, target: Nodes) -> Nodes:
        """Return from where the environment can force the next node into a target."""
        counts = np.bincount(self._sources, target[self.arena.successors], self.arena.nodes)
        needed = np.where(self.arena.system, self._degree, 1)
        return self.over | (counts >= needed)

    def _attracted(self, base: Nodes, allowed: Nodes) -> Ranks:
        """Return in how many moves at most the environment gets from allowed nodes into a set, -1 where it cannot."""
        level = np.where(base, 0, np.where(allowed, OPEN, OUTSIDE)).astype(np.int32)
        missing = np.where(self.arena.system, self._degree, 1).astype(np.int32)
        queue = np.empty(self.arena.nodes, dtype=np.int32)
        start = np.flatnonzero(base)
        queue[: len(start)] = start
        attract(self._graph, level, missing, queue, 0, len(start), self.arena.nodes + 1, 0)
        return np.where(level >= 0, level, -1).astype(np.int32)

    def distances(self, targets: Nodes) -> Ranks:
        """Return how far the targets are if both sides wanted to get there."""
        level = np.where(targets, 0, OPEN).astype(np.int32)
        queue = np.empty(self.arena.nodes, dtype=np.int32)
        start = np.flatnonzero(targets)
        queue[: len(start)] = start
        once = np.ones(self.arena.nodes, dtype=np.int32)
        attract(self._graph, level, once, queue, 0, len(start), self.arena.nodes + 1, 0)
        return np.where(level >= 0, level, _FAR).astype(np.int32)


def _played(solver: _Dual, steps: list[_Step], initial: int) -> Obstruction:
    """Play the environment's strategy against a system that heads for the goal that is denied."""
    arena = solver.arena
    far: dict[int | None, Ranks] = {}
    seen: dict[tuple[int, int, int], int] = {}
    nodes: list[int] = []
    node, level, justice = initial, len(steps), 0
    while True:
        here = next(k for k, step in enumerate(steps) if step.region[node])
        if here != level:
            level, justice = here, 0
        if (node, level, justice) in seen:
            return Obstruction(tuple(nodes), seen[node, level, justice], _goal(steps, level))
        seen[node, level, justice] = len(nodes)
        nodes.append(node)
        if solver.over[node]:
            return Obstruction(tuple(nodes), None, None)
        step = steps[level]
        if step.goal is not None and len(arena.justices) and arena.justices[justice, node]:
            justice = (justice + 1) % len(arena.justices)
        following = arena.successors_of(node)
        if arena.system[node]:
            goal = _goal(steps, level)
            if goal not in far:
                far[goal] = solver.distances(arena.lost if goal is None else arena.goals[goal])
            node = int(following[np.argmin(far[goal][following])])
        else:
            node = _move(steps, level, justice, following)


def _goal(steps: list[_Step], level: int) -> int | None:
    """Return the goal that the environment denies in a step, or in the first one after a way; None if in none."""
    return next((step.goal for step in (*steps[level:], *steps) if step.goal is not None), None)


def _move(steps: list[_Step], level: int, justice: int, following: NDArray[np.int32]) -> int:
    """Return the move of the environment: into the first step that it can reach, by the lowest rank there."""
    best: tuple[tuple[int, int], int] | None = None
    for target in following.tolist():
        step = next((k for k, one in enumerate(steps[: level + 1]) if one.region[target]), None)
        if step is None:
            continue
        ranks = steps[step].ranks
        rank = int(ranks[justice if step == level and len(ranks) > 1 else 0][target])
        if best is None or (step, rank) < best[0]:
            best = (step, rank), target
    assert best is not None  # the region is closed: the environment can stay in it, or leave it for an earlier one
    return best[1]

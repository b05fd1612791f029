"""The two sets that a solver moves: Z, which shrinks (Region), and Y, which grows (Layers); compiled sweeps beneath.

These are work spaces of one call of ``solve``, the only values of this room that change.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.games._kernels import OPEN, OUTSIDE, Graph, attract, best_edges, hold, reverse
from surefoot.games.arena import Arena
from surefoot.games.solution import EnvDeadEnd


@dataclass(frozen=True, slots=True, eq=False)
class Game:
    """An arena with its edges reversed.

    Attributes:
        arena: the game graph.
        graph: its edges, both ways.
        dead_end_lost: (N,) nodes without a successor where the system loses.
        dead_end_won: (N,) nodes without a successor where it wins.
    """

    arena: Arena
    graph: Graph
    dead_end_lost: NDArray[np.bool_]
    dead_end_won: NDArray[np.bool_]

    @classmethod
    def of(cls, arena: Arena, env_dead_end: EnvDeadEnd) -> Game:
        """Prepare an arena."""
        before, predecessors = reverse(arena.first, arena.successors)
        dead_end = arena.first[1:] == arena.first[:-1]
        won = dead_end & ~arena.system if env_dead_end == "wins" else np.zeros_like(dead_end)
        graph = Graph(arena.system, arena.first, arena.successors, before, predecessors)
        return cls(arena, graph, dead_end & ~won, won)

    def all_but_lost(self) -> Region:
        """Return the greatest Z without lost nodes on which Z = cpre(Z)."""
        return Region(self)

    def first_layer(self, region: Region, goal: NDArray[np.bool_]) -> Layers:
        """Return the first Y of a goal: where it holds in Z, and where the environment is stuck."""
        return Layers(self, region, goal | self.dead_end_won)

    def best_edges(self, rank: NDArray[np.int32], after: NDArray[np.int32]) -> NDArray[np.int32]:
        """Return the choices of one goal; see the kernel."""
        choice: NDArray[np.int32] = best_edges(self.graph, rank, after)
        return choice


class Region:
    """Z, kept so that Z = cpre(Z) on it: what leaves it draws along all that the environment can force out.

    That is the attractor of the environment to everything outside, so a node of the environment leaves with its first
    edge out, and a node of the system with its last one. Over a whole solution every edge is swept once.
    """

    def __init__(self, game: Game) -> None:
        arena = game.arena
        self._graph = game.graph
        self._left = np.full(arena.nodes, OPEN, dtype=np.int32)  # OPEN while a node is in Z
        self._missing = np.where(arena.system, arena.degree, np.int32(1))
        self._queue = np.empty(arena.nodes, dtype=np.int32)
        self._gone = 0
        self._remove(np.flatnonzero(arena.lost | game.dead_end_lost))

    @property
    def nodes(self) -> NDArray[np.bool_]:
        """(N,) True in Z."""
        inside: NDArray[np.bool_] = self._left == OPEN
        return inside

    @property
    def size(self) -> int:
        """How many nodes Z has."""
        return self._left.size - self._gone

    def keep(self, layers: Layers) -> None:
        """Replace Z by the greatest part of Y that is closed again."""
        self._remove(np.flatnonzero(layers.rank == OPEN))

    def _remove(self, nodes: NDArray[np.intp]) -> None:
        done, filled = self._gone, self._gone + nodes.size
        self._left[nodes] = 0
        self._queue[done:filled] = nodes
        _, self._gone, _ = attract(
            self._graph, self._left, self._missing, self._queue, done, filled, self._left.size, 0
        )


class Layers:
    """Y for one goal inside Z: the nodes of rank 0 and more, in the order of joining.

    Attributes:
        rank: (N,) the layer of a node; OUTSIDE where not in Z, OPEN in Z but not in Y.
        waits_for: (N,) the justice of the layer, -1 for a layer of the attractor.
    """

    def __init__(self, game: Game, region: Region, target: NDArray[np.bool_]) -> None:
        arena = game.arena
        inside = region.nodes
        seeds = np.flatnonzero(target & inside)
        self._arena, self._graph = arena, game.graph
        self._enough = region.size
        self.rank = np.where(inside, np.int32(OPEN), np.int32(OUTSIDE))
        self.rank[seeds] = 0
        self.waits_for = np.full(arena.nodes, -1, dtype=np.int32)
        self._missing = np.where(arena.system, np.int32(1), arena.degree)
        self._queue = np.empty(arena.nodes, dtype=np.int32)
        self._queue[: seeds.size] = seeds
        self._done, self.size, self._top = 0, seeds.size, 0
        self._waiting: dict[int, NDArray[np.int32]] = {}
        self._watch = np.empty(0, dtype=np.int64)

    @property
    def covers_region(self) -> bool:
        """Whether Y is all of Z."""
        return self.size == self._enough

    def add_attractor(self) -> None:
        """Add all from where the system can force the play into Y: mu Y . Y or cpre(Y)."""
        self._done, self.size, self._top = attract(
            self._graph, self.rank, self._missing, self._queue, self._done, self.size, self._enough, self._top
        )

    def add_waiting(self, justice: int) -> None:
        """Add a layer where justice_j never holds until the play enters Y: nu X . Y or (not justice_j and cpre(X))."""
        candidates = self._open_without(justice)
        if not candidates.size:
            return
        if not self._watch.size:
            self._watch = np.empty(self.rank.size, dtype=np.int64)
        stay = hold(self._graph, self.rank, self._watch, candidates, self._top)
        if stay.size:
            self._top += 1
            self._queue[self.size : self.size + stay.size] = stay
            self.size += stay.size
            self.waits_for[stay] = justice

    def _open_without(self, justice: int) -> NDArray[np.int32]:
        """Return the nodes of Z outside Y where a justice does not hold; Y only grows, so the list only shrinks."""
        if justice in self._waiting:
            nodes = self._waiting[justice]
            nodes = nodes[self.rank[nodes] == OPEN]
        else:
            nodes = np.flatnonzero((self.rank == OPEN) & ~self._arena.justices[justice]).astype(np.int32)
        self._waiting[justice] = nodes
        return nodes

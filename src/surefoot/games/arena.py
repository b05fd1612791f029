"""The game graph: who moves where, what is lost, and what each side has promised."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

_MOST_NODES = np.iinfo(np.int32).max
_Scalar = TypeVar("_Scalar", bound=np.generic)


@dataclass(frozen=True, slots=True, eq=False)
class Arena:
    """A turn-based game graph; the arrays are read-only, writable ones are copied.

    The successors of node ``v`` are ``successors[first[v] : first[v + 1]]`` (compressed rows). With N nodes, E edges:

    Attributes:
        system: (N,) True where the system (the robot) moves, False where the environment moves.
        first: (N + 1,) where the successors of each node begin.
        successors: (E,) node numbers.
        lost: (N,) nodes that the system must never enter.
        goals: (G, N) sets of nodes that the system promises to visit again and again. No row: it only has to stay safe.
        justices: (J, N) sets of nodes that the environment promises to visit again and again.

    Raises:
        ValueError: if shapes, offsets or node numbers do not fit together.
    """

    system: NDArray[np.bool_]
    first: NDArray[np.int64]
    successors: NDArray[np.int32]
    lost: NDArray[np.bool_]
    goals: NDArray[np.bool_]
    justices: NDArray[np.bool_]

    def __post_init__(self) -> None:
        nodes = np.asarray(self.system).size
        if nodes > _MOST_NODES:
            raise ValueError(f"an arena has at most {_MOST_NODES} nodes, not {nodes}")
        set_field = object.__setattr__
        for name in ("system", "lost"):
            set_field(self, name, _mask(name, getattr(self, name), nodes, dimensions=1))
        for name in ("goals", "justices"):
            set_field(self, name, _mask(name, getattr(self, name), nodes, dimensions=2))
        set_field(self, "successors", _successors(self.successors, nodes))
        set_field(self, "first", _offsets(self.first, nodes, self.successors.size))

    @property
    def nodes(self) -> int:
        """The number of nodes N."""
        return self.system.size

    @property
    def edges(self) -> int:
        """The number of edges E."""
        return self.successors.size

    @property
    def degree(self) -> NDArray[np.int32]:
        """(N,) the number of successors of every node."""
        return np.diff(self.first).astype(np.int32)

    def successors_of(self, node: int) -> NDArray[np.int32]:
        """Return the successors of a node in the order of its edges."""
        return self.successors[self.first[node] : self.first[node + 1]]


def reachable(arena: Arena, initial: ArrayLike) -> NDArray[np.bool_]:
    """Return which nodes some play from the initial ones visits, whoever moves.

    Args:
        arena: the game graph; plays go on behind lost nodes when these have successors.
        initial: one node number or several.

    Returns:
        (N,) True where a play can come.

    Raises:
        ValueError: if an initial node does not exist.
    """
    from surefoot.games._kernels import explore

    start = np.atleast_1d(np.asarray(initial, dtype=np.int64))
    if start.size and not 0 <= start.min() <= start.max() < arena.nodes:
        raise ValueError(f"initial nodes are numbers from 0 to {arena.nodes - 1}, not {start.tolist()[:5]}")
    seen: NDArray[np.bool_] = explore(arena.first, arena.successors, np.unique(start).astype(np.int32))
    return seen


def restrict(arena: Arena, keep: NDArray[np.bool_]) -> Arena:
    """Return the arena on the kept nodes alone; edges into the others vanish.

    Node i of the result is node ``np.flatnonzero(keep)[i]`` of the arena. A winner is unchanged when the kept set is
    closed under successors, as a reachable set is; otherwise the side whose edges vanish has fewer moves.

    Args:
        arena: the game graph.
        keep: (N,) True at the nodes that stay.
    """
    kept = _mask("keep", keep, arena.nodes, dimensions=1)
    edge_stays = np.repeat(kept, arena.degree) & kept[arena.successors]
    before = np.zeros(arena.edges + 1, dtype=np.int64)
    np.cumsum(edge_stays, out=before[1:])
    number = np.cumsum(kept, dtype=np.int32) - np.int32(1)
    return Arena(
        system=arena.system[kept],
        first=np.append(before[arena.first[:-1][kept]], before[-1]),
        successors=number[arena.successors[edge_stays]],
        lost=arena.lost[kept],
        goals=arena.goals[:, kept],
        justices=arena.justices[:, kept],
    )


def with_goals(arena: Arena, chosen: ArrayLike) -> Arena:
    """Return the same game with the chosen rows of its goals alone; none chosen leaves the safety game."""
    return replace(arena, goals=arena.goals[np.asarray(chosen, dtype=np.intp).reshape(-1)])


def swap_players(arena: Arena) -> Arena:
    """Return the game in which the environment pursues its own promises against any system.

    Owners are exchanged, the justices are the goals, and nothing is promised in return. A lost node becomes a dead end
    of the side that moved into it by mistake, the former system; so solve this game with ``env_dead_end="wins"``.
    """
    degree = np.where(arena.lost, 0, arena.degree)
    return Arena(
        system=~arena.system & ~arena.lost,
        first=np.concatenate(([0], np.cumsum(degree, dtype=np.int64))),
        successors=arena.successors[np.repeat(~arena.lost, arena.degree)],
        lost=np.zeros(arena.nodes, dtype=np.bool_),
        goals=arena.justices,
        justices=np.zeros((0, arena.nodes), dtype=np.bool_),
    )


def _read_only(array: NDArray[_Scalar]) -> NDArray[_Scalar]:
    """Return the array itself when nobody can write to it, otherwise a read-only copy in C order."""
    if array.flags.writeable or not array.flags.c_contiguous:
        array = array.copy(order="C")
        array.flags.writeable = False
    return array


def _mask(name: str, given: Any, nodes: int, *, dimensions: int) -> NDArray[np.bool_]:
    array = np.asarray(given)
    if array.dtype != np.bool_ or array.ndim != dimensions or array.shape[-1] != nodes:
        shape = f"({nodes},)" if dimensions == 1 else f"(any, {nodes})"
        raise ValueError(f"{name} is a boolean array of shape {shape}, not {array.dtype} of shape {array.shape}")
    return _read_only(array)


def _successors(given: Any, nodes: int) -> NDArray[np.int32]:
    array = np.asarray(given)
    if array.ndim != 1 or array.dtype.kind not in "iu":
        raise ValueError(f"successors is a row of integers, not {array.dtype} of shape {array.shape}")
    if array.size and not 0 <= array.min() <= array.max() < nodes:
        raise ValueError(f"successors are node numbers from 0 to {nodes - 1}, not {array.min()} to {array.max()}")
    return _read_only(array.astype(np.int32, copy=False))


def _offsets(given: Any, nodes: int, edges: int) -> NDArray[np.int64]:
    array = np.asarray(given)
    if array.shape != (nodes + 1,) or array.dtype.kind not in "iu":
        raise ValueError(f"first is a row of {nodes + 1} integers, not {array.dtype} of shape {array.shape}")
    if array[0] != 0 or array[-1] != edges or (array[1:] < array[:-1]).any():
        raise ValueError(f"first rises from 0 to the number of edges, {edges}, and never falls")
    return _read_only(array.astype(np.int64, copy=False))

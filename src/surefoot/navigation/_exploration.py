"""Runs the compiled exploration of a navigation game, making room for it, within limits."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.compute import Deadline
from surefoot.errors import LimitExceeded
from surefoot.navigation import _game_kernels as kernels
from surefoot.navigation import _observation_kernel as observation
from surefoot.navigation._game_kernels import Tables
from surefoot.navigation._interning import empty_masks, empty_pairs, larger_masks, larger_pairs, put, put_mask
from surefoot.navigation._observation_kernel import empty_scratch
from surefoot.navigation._world_arrays import World, words_of
from surefoot.navigation.navigation_rules import Rules
from surefoot.navigation.obstacles import ObstacleKinds, ObstacleState

MOST_NODES = 20_000_000
MOST_EDGES = 120_000_000
MOST_OUTCOMES = 20_000_000
"""Of one kind of obstacles in one turn."""

TOO_LARGE = (
    "use larger cells (grid.cell_size_m), a shorter view (sensor.range_m), fewer or coarser belief regions "
    "(navigation.belief: single), areas that obstacles never enter (obstacles[].forbidden), or fewer obstacles"
)


def explored(rules: Rules, world: World, deadline: Deadline) -> Tables:
    """Return the tables of the whole reachable graph.

    Raises:
        LimitExceeded: when the deadline passes, or the game has too many nodes or edges.
    """
    base = len(rules.kinds.cells) + 1
    if any(base ** len(kind.obstacles) >= 2**62 for kind in rules.kinds):
        raise LimitExceeded(f"so many equal obstacles on so many cells cannot be told by 62 bits; {TOO_LARGE}")
    tables = _with_start(_empty(world), rules)
    progress = np.zeros(3, np.int64)
    while status := kernels.explore(world, tables, progress):
        deadline.check(f"building the navigation game ({progress[0]:,} nodes so far)")
        tables = _roomier(tables, status)
        _check_size(tables, progress)
    return tables


def _check_size(tables: Tables, progress: NDArray[np.int64]) -> None:
    """Refuse to go on with a game that will not fit."""
    nodes, edges = int(tables.nodes.used[0]), int(progress[1])
    if nodes > MOST_NODES or edges > MOST_EDGES or len(tables.scratch.visible) > MOST_OUTCOMES:
        raise LimitExceeded(
            f"the navigation game is too large: {nodes:,} nodes and {edges:,} edges after {int(progress[0]):,} nodes; "
            f"at most {MOST_NODES:,} and {MOST_EDGES:,} are tried; {TOO_LARGE}"
        )


def _empty(world: World) -> Tables:
    return Tables(
        masks=empty_masks(256, world.within.shape[1]),
        known=empty_pairs(1 << 10),
        states=empty_pairs(1 << 10),
        seen=empty_pairs(1 << 12),
        begin=np.zeros(1 << 12, np.int64),
        end=np.zeros(1 << 12, np.int64),
        outcomes=np.zeros(1 << 14, np.int32),
        scratch=empty_scratch(1 << 8),
        nodes=empty_pairs(1 << 14),
        blocked=np.full(1 << 14, -1, np.int8),
        first=np.zeros((1 << 14) + 1, np.int64),
        edges=np.zeros(1 << 15, np.int32),
        front=np.zeros(1 << 10, np.int64),
    )


def _with_start(tables: Tables, rules: Rules) -> Tables:
    """Enter the first node."""
    problem, kinds = rules.problem, rules.kinds
    known, base, state = rules.start(), len(kinds.cells) + 1, -1
    width = tables.masks.words.shape[1]
    for kind, (seen, hidden) in enumerate(zip(known.visible, known.hidden, strict=True)):
        packed = sum((kinds.bit[cell] + 1) * base**place for place, cell in enumerate(seen))
        belief = put_mask(tables.masks, words_of((hidden,), width)[0])
        state = put(tables.states, state, put(tables.known, packed, belief * len(kinds.kinds) + kind))
    put(tables.nodes, 16 * (4 * problem.start + problem.heading), state)
    return tables


def _roomier(tables: Tables, status: int) -> Tables:
    """Return the same tables with twice the room where it was used up."""
    if status == observation.MASKS_FULL:
        return tables._replace(masks=larger_masks(tables.masks))
    if status == observation.KNOWN_FULL:
        return tables._replace(known=larger_pairs(tables.known))
    if status == observation.OUTCOMES_FULL:
        return tables._replace(outcomes=_doubled(tables.outcomes))
    if status == observation.SCRATCH_FULL:
        return tables._replace(scratch=empty_scratch(2 * len(tables.scratch.visible)))
    if status == kernels.STATES_FULL:
        return tables._replace(states=larger_pairs(tables.states))
    if status == kernels.SEEN_FULL:
        return tables._replace(seen=larger_pairs(tables.seen), begin=_doubled(tables.begin), end=_doubled(tables.end))
    if status == kernels.NODES_FULL:
        return tables._replace(
            nodes=larger_pairs(tables.nodes), blocked=_doubled(tables.blocked, -1), first=_doubled(tables.first)
        )
    if status == kernels.EDGES_FULL:
        return tables._replace(edges=_doubled(tables.edges))
    if status == kernels.FRONT_FULL:
        return tables._replace(front=_doubled(tables.front))
    return tables


def _doubled(array: NDArray[Any], fill: int = 0) -> NDArray[Any]:
    return np.concatenate((array, np.full(len(array), fill, array.dtype)))


def states_of(tables: Tables, kinds: ObstacleKinds, numbers: NDArray[np.int64]) -> tuple[ObstacleState, ...]:
    """Return the obstacle states of some numbers."""
    masks = [int.from_bytes(row.tobytes(), "little") for row in tables.masks.words[: tables.masks.used[0]]]
    count, base = len(kinds.kinds), len(kinds.cells) + 1
    known = [
        (_unpacked(packed, base, kinds.cells), masks[hidden // count])
        for packed, hidden in zip(
            tables.known.left[: tables.known.used[0]].tolist(),
            tables.known.right[: tables.known.used[0]].tolist(),
            strict=True,
        )
    ]
    left, right = tables.states.left, tables.states.right
    columns = []
    for _ in range(count):
        columns.append(right[numbers].tolist())
        numbers = left[numbers]
    if not count:
        return (ObstacleState((), ()),)
    return tuple(
        ObstacleState(tuple(known[entry][0] for entry in row), tuple(known[entry][1] for entry in row))
        for row in zip(*reversed(columns), strict=True)
    )


def _unpacked(packed: int, base: int, cells: tuple[int, ...]) -> tuple[int, ...]:
    """Return the visible cells of a packed number."""
    seen = []
    while packed:
        seen.append(cells[packed % base - 1])
        packed //= base
    return tuple(seen)

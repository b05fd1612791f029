"""Grids with headings, and an oracle that knows nothing of games: shortest paths on the graph of (cell, heading)."""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Iterator, Mapping

from hypothesis import strategies as st
from hypothesis.strategies import SearchStrategy

from surefoot.skills.headings import Pose, PoseEdge, Turning
from surefoot.skills.values import OBSTACLE, Cell, Direction, Primitive, TerrainState, Turn

CLASSES = ("flat", "bars", "rods")
"""Bars lie across the heading where rods lie along it."""

TURNED = {"flat": "flat", "bars": "rods", "rods": "bars"}
FORWARD_ONLY = (Direction.FORWARD,)
ALL = (
    *(Primitive(way, here, there) for way in Direction for here in CLASSES for there in CLASSES),
    *(Primitive(turn, name, TURNED[name]) for turn in Turn for name in CLASSES),
)
_FRONT = ((-1, 0), (0, -1), (1, 0), (0, 1))
_SIDES = {"forward": 0, "left": 1, "backward": 2, "right": 3}


def turning(directions: Collection[Direction] = tuple(Direction), facing: Collection[int] = range(4)) -> Turning:
    """Return the turning of these classes."""
    return Turning(tuple(TURNED.items()), tuple(directions), tuple(facing))


def grid(*rows: str) -> TerrainState:
    """Return a terrain state from rows of initials; # is an obstacle."""
    names = {name[0]: name for name in CLASSES} | {"#": OBSTACLE}
    return TerrainState(tuple(tuple(names[letter] for letter in row) for row in rows))


@st.composite
def terrain_states(draw: st.DrawFn) -> TerrainState:
    """Return a random 3 x 3 grid whose centre is no obstacle."""
    letters = [draw(st.sampled_from("fbr#")) for _ in range(9)]
    letters[4] = draw(st.sampled_from("fbr"))
    return grid(*("".join(letters[3 * row : 3 * row + 3]) for row in range(3)))


def primitive_sets() -> SearchStrategy[frozenset[Primitive]]:
    """Return random sets of primitives, turns among them."""
    return st.frozensets(st.sampled_from(ALL), max_size=30)


def direction_sets() -> SearchStrategy[tuple[Direction, ...]]:
    """Return random choices of directions."""
    chosen = st.sets(st.sampled_from(list(Direction)), min_size=1)
    return chosen.map(lambda ways: tuple(sorted(ways)))


def edges_of(state: TerrainState, directions: Collection[Direction]) -> dict[PoseEdge, Primitive]:
    """Return what every move and every turn needs."""
    return {(pose, target): one for pose, target, one in _edges(state, directions)}


def _edges(state: TerrainState, directions: Collection[Direction]) -> Iterator[tuple[Pose, Pose, Primitive]]:
    for cell in ((row, column) for row in range(3) for column in range(3)):
        here = state.labels[cell[0]][cell[1]]
        for heading in range(4) if here != OBSTACLE else ():
            seen = TURNED[here] if heading in (1, 3) else here
            for turn, step in ((Turn.LEFT, 1), (Turn.RIGHT, 3)):
                yield (cell, heading), (cell, (heading + step) % 4), Primitive(turn, seen, TURNED[seen])
            for way in directions:
                down, right = _FRONT[(heading + _SIDES[way]) % 4]
                target = (cell[0] + down, cell[1] + right)
                if 0 <= target[0] < 3 and 0 <= target[1] < 3 and state.labels[target[0]][target[1]] != OBSTACLE:
                    there = state.labels[target[0]][target[1]]
                    next_seen = TURNED[there] if heading in (1, 3) else there
                    yield (cell, heading), (target, heading), Primitive(way, seen, next_seen)


def distances(
    state: TerrainState,
    request: Cell,
    primitives: Collection[Primitive],
    directions: Collection[Direction],
    disallowed: Collection[PoseEdge] = (),
    facing: Collection[int] = range(4),
) -> Mapping[Pose, int]:
    """Return how many skills it takes from every pose from which the request can be fulfilled."""
    if state.labels[request[0]][request[1]] == OBSTACLE:
        return {}
    before: dict[Pose, list[Pose]] = {}
    for (pose, target), one in edges_of(state, directions).items():
        if one in primitives and (pose, target) not in disallowed:
            before.setdefault(target, []).append(pose)
    found: dict[Pose, int] = {(request, heading): 0 for heading in facing}
    queue = deque(found)
    while queue:
        target = queue.popleft()
        for pose in before.get(target, ()):
            if pose not in found:
                found[pose] = found[target] + 1
                queue.append(pose)
    return found

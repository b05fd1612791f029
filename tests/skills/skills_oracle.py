"""Random grids and physics, and an oracle that knows nothing of games: reachability on the graph of cells."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from itertools import combinations

from hypothesis import strategies as st
from hypothesis.strategies import SearchStrategy

from surefoot.skills.values import OBSTACLE, Cell, CheckResult, Direction, Physics, Primitive, TerrainState

CLASSES = ("flat", "dense", "sparse", "gap")
OFFSETS = {"forward": (-1, 0), "backward": (1, 0), "left": (0, -1), "right": (0, 1)}
ALL = tuple(Primitive(direction, here, there) for direction in Direction for here in CLASSES for there in CLASSES)


def grid(*rows: str) -> TerrainState:
    """Return a terrain state from rows of initials; # is an obstacle."""
    names = {name[0]: name for name in CLASSES} | {"#": OBSTACLE}
    return TerrainState(tuple(tuple(names[letter] for letter in row) for row in rows))


@st.composite
def terrain_states(draw: st.DrawFn, sizes: Sequence[int] = (3, 5)) -> TerrainState:
    """Return a random grid whose centre is no obstacle."""
    rows, columns = draw(st.sampled_from(sizes)), draw(st.sampled_from(sizes))
    labels = [[draw(st.sampled_from((*CLASSES, OBSTACLE))) for _ in range(columns)] for _ in range(rows)]
    if labels[rows // 2][columns // 2] == OBSTACLE:
        labels[rows // 2][columns // 2] = CLASSES[0]
    return TerrainState(tuple(map(tuple, labels)))


def primitive_sets() -> SearchStrategy[frozenset[Primitive]]:
    """Return random sets of primitives."""
    return st.frozensets(st.sampled_from(ALL), max_size=40)


def edges_of(state: TerrainState) -> dict[tuple[Cell, Cell], Primitive]:
    """Return the primitive of every move between cells that are no obstacles."""
    found = {}
    for row, labels in enumerate(state.labels):
        for column, here in enumerate(labels):
            for name, (down, right) in OFFSETS.items():
                target = (row + down, column + right)
                if 0 <= target[0] < len(state.labels) and 0 <= target[1] < len(labels):
                    there = state.labels[target[0]][target[1]]
                    if OBSTACLE not in (here, there):
                        found[(row, column), target] = Primitive(Direction(name), here, there)
    return found


def winners(
    state: TerrainState,
    request: Cell,
    primitives: Collection[Primitive],
    disallowed: Collection[tuple[Cell, Cell]] = (),
) -> set[Cell]:
    """Return the cells from which the request can be reached."""
    if state.labels[request[0]][request[1]] == OBSTACLE:
        return set()
    allowed = [edge for edge, one in edges_of(state).items() if one in primitives and edge not in disallowed]
    found = {request}
    while grown := {source for source, target in allowed if target in found} - found:
        found |= grown
    return found


def can_win(
    state: TerrainState,
    request: Cell,
    primitives: Collection[Primitive],
    disallowed: Collection[tuple[Cell, Cell]] = (),
) -> bool:
    """Return whether the request can be reached from the centre."""
    centre = (len(state.labels) // 2, len(state.labels[0]) // 2)
    return centre in winners(state, request, primitives, disallowed)


def fewest_by_enumeration(
    state: TerrainState, request: Cell, at_hand: Collection[Primitive], refused: Collection[Primitive], most: int
) -> int | None:
    """Return the least number of new primitives by trying all sets up to a size; None if none of them does."""
    new = sorted({*edges_of(state).values()} - {*at_hand} - {*refused})
    usable = {*at_hand} - {*refused}
    sizes = (
        size
        for size in range(most + 1)
        for chosen in combinations(new, size)
        if can_win(state, request, usable.union(chosen))
    )
    return next(sizes, None)


class Recorded:
    """Physics from a table; it notes what it was asked."""

    def __init__(self, feasible: Collection[Primitive], unknown: Collection[Primitive] = ()) -> None:
        self.feasible, self.unknown = frozenset(feasible), frozenset(unknown)
        self.asked: list[Primitive] = []

    def __call__(self, primitives: Sequence[Primitive]) -> list[CheckResult]:
        """Answer from the table."""
        self.asked += primitives
        return [self._one(primitive) for primitive in primitives]

    def _one(self, primitive: Primitive) -> CheckResult:
        if primitive in self.unknown:
            return CheckResult(primitive, Physics.UNKNOWN, "trot", "the time limit was reached", 0.1)
        if primitive in self.feasible:
            return CheckResult(primitive, Physics.FEASIBLE, "trot", "", 0.1, horizon_s=2.0, cost=1.0)
        return CheckResult(primitive, Physics.INFEASIBLE, "trot", "the feet cannot reach", 0.1)


def results(feasible: Collection[Primitive]) -> Mapping[Primitive, CheckResult]:
    """Return the answers that make some primitives skills."""
    return {one: result for one in feasible for result in Recorded(feasible)([one])}

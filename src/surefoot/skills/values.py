"""Plain values that geometry, physics and synthesis exchange: cells, terrain states, primitives, skills, answers.

Row 0 of a local grid is its front row, towards the heading, and column 0 its left one; the robot stands in the centre.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum

from surefoot.errors import InputError

Cell = tuple[int, int]
OBSTACLE = "obstacle"


class Direction(StrEnum):
    """A move to one of the four neighbours of a cell, seen from the robot."""

    FORWARD = "forward"
    BACKWARD = "backward"
    LEFT = "left"
    RIGHT = "right"

    @property
    def offset(self) -> Cell:
        """The change of (row, column)."""
        return _OFFSETS[self]

    def of(self, cell: Cell) -> Cell:
        """Return the neighbour of a cell in this direction."""
        rows, columns = _OFFSETS[self]
        return cell[0] + rows, cell[1] + columns


class Turn(StrEnum):
    """A turn in place by 90 degrees; it leaves the robot in its cell."""

    LEFT = "turn-left"
    RIGHT = "turn-right"

    @property
    def quarter_turns(self) -> int:
        """The change of heading, counter-clockwise."""
        return 1 if self is Turn.LEFT else -1


Way = Direction | Turn
"""Where a skill takes the robot: to a neighbour (translational), or round (rotational)."""

_OFFSETS = {
    Direction.FORWARD: (-1, 0),
    Direction.BACKWARD: (1, 0),
    Direction.LEFT: (0, -1),
    Direction.RIGHT: (0, 1),
}
_WAYS: dict[str, Way] = {way.value: way for way in (*Direction, *Turn)}


@dataclass(frozen=True, slots=True, order=True)
class Primitive:
    """A move between two classes of terrain, wherever they stand side by side; or a turn on one class.

    Attributes:
        direction: where the robot goes, or which way it turns.
        here: class of the cell that it leaves.
        next: class of the cell that it enters; of a turn, what the same cell is called after it.
    """

    direction: Way
    here: str
    next: str

    @property
    def name(self) -> str:
        """The primitive in words, such as ``forward flat->gap``."""
        return f"{self.direction} {self.here}->{self.next}"

    @classmethod
    def parse(cls, name: str) -> Primitive:
        """Return the primitive of a name.

        Raises:
            InputError: the name is not ``DIRECTION CLASS->CLASS``.
        """
        direction, _, classes = name.partition(" ")
        here, arrow, target = classes.partition("->")
        way = _WAYS.get(direction)
        if way is None or not (here and arrow and target):
            raise InputError(f"{name!r} is no primitive; one reads `forward flat->gap`")
        return cls(way, here, target)


@dataclass(frozen=True, slots=True, order=True)
class TerrainState:
    """Classes of the cells of a local grid.

    Attributes:
        labels: [rows][columns] class names, or ``obstacle``; both counts are odd.

    Raises:
        InputError: the rows differ in length, or there is no centre.
    """

    labels: tuple[tuple[str, ...], ...]

    def __post_init__(self) -> None:
        """Refuse a grid without a centre."""
        sizes = {len(row) for row in self.labels}
        if len(sizes) != 1 or len(self.labels) % 2 == 0 or min(sizes) % 2 == 0:
            raise InputError("a local grid has an odd number of rows, all with the same odd number of columns")

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(self.labels)

    @property
    def columns(self) -> int:
        """Number of columns."""
        return len(self.labels[0])

    @property
    def centre(self) -> Cell:
        """The cell that the robot stands in."""
        return self.rows // 2, self.columns // 2

    def label(self, cell: Cell) -> str:
        """Return the class of a cell; what lies outside of the grid is an obstacle."""
        row, column = cell
        return self.labels[row][column] if 0 <= row < self.rows and 0 <= column < self.columns else OBSTACLE

    def cells(self) -> tuple[Cell, ...]:
        """Return every cell, row by row."""
        return tuple((row, column) for row in range(self.rows) for column in range(self.columns))

    def primitive(self, cell: Cell, direction: Direction) -> Primitive | None:
        """Return what the robot has to master to leave a cell that way; None where an obstacle forbids it."""
        here, there = self.label(cell), self.label(direction.of(cell))
        return None if OBSTACLE in (here, there) else Primitive(direction, here, there)


@dataclass(frozen=True, slots=True)
class Skill:
    """A primitive that physics certified.

    Attributes:
        primitive: what it does.
        gait: name or description of the gait of the certificate.
        plan: SHA-256 of the certificate's plan file; None if there is none.
        horizon_s: how long it takes [s].
        cost: objective of the certificate.
    """

    primitive: Primitive
    gait: str
    plan: str | None
    horizon_s: float
    cost: float


class Physics(StrEnum):
    """What physics answers about a primitive."""

    FEASIBLE = "feasible"
    INFEASIBLE = "infeasible"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class CheckResult:
    """The answer of physics about one primitive.

    Attributes:
        primitive: what was asked about.
        verdict: feasible, infeasible or unknown.
        gait: the gait that does it, or those that were tried.
        explanation: why it is infeasible, or which limit left it unknown; empty if it is feasible.
        time_s: processor time that the check took [s].
        horizon_s: how long the feasible motion takes [s].
        cost: objective of the feasible motion.
        plan: text of the certificate, a plan file (JSON); None if there is none.
    """

    primitive: Primitive
    verdict: Physics
    gait: str
    explanation: str
    time_s: float
    horizon_s: float = 0.0
    cost: float = 0.0
    plan: str | None = None

    def skill(self, plan_sha256: str | None) -> Skill:
        """Return the certified skill; only a feasible check makes one."""
        assert self.verdict is Physics.FEASIBLE
        return Skill(self.primitive, self.gait, plan_sha256, self.horizon_s, self.cost)


PhysicsCheck = Callable[[Sequence[Primitive]], Iterable[CheckResult]]
"""Answers about several primitives, in any order and best as soon as each is known: what is known is never lost."""

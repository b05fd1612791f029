"""Skills with headings: where the robot is and which way it faces, in quarter turns.

A pose is a cell with a heading from 0 to 3, counter-clockwise and with wrap-around: 0 faces the front row of the grid,
1 its left column, 2 the rear row, 3 the right column; -180 and 180 degrees are one heading. A translational skill keeps
the heading and goes along it (or back, or aside); a rotational one keeps the cell. Classes are seen from the heading:
bars across it lie along it after a quarter turn.

Source: Zhou et al., 2025, IX-F; docs/skills.md, "Headings".
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from surefoot.errors import InputError
from surefoot.skills.classes import ClassSet
from surefoot.skills.skill_game import Move
from surefoot.skills.values import OBSTACLE, Cell, Direction, Primitive, TerrainState, Turn, Way

Pose = tuple[Cell, int]
PoseEdge = tuple[Pose, Pose]
HEADINGS = 4
FACING = ("ahead", "left", "back", "right")
"""What the headings are called, seen from the grid."""


@dataclass(frozen=True, slots=True)
class Turning:
    """How a robot that turns sees a grid; a ``Frame`` of the skill game.

    Attributes:
        turned: pairs of a class and what it is called after a quarter turn, one for every class.
        directions: translational skills that are allowed, seen from the robot.
        facing: headings that fulfil a request.
    """

    turned: tuple[tuple[str, str], ...]
    directions: tuple[Direction, ...] = tuple(Direction)
    facing: tuple[int, ...] = tuple(range(HEADINGS))

    def __post_init__(self) -> None:
        """Refuse names that do not come back after half a turn, and headings that there are not."""
        names = dict(self.turned)
        if len(names) != len(self.turned) or any(names.get(other) != name for name, other in self.turned):
            raise InputError("every class needs one name after a quarter turn, and its own name after two")
        if not self.facing or not set(self.facing) <= set(range(HEADINGS)):
            raise InputError(f"a request is fulfilled with some of the headings 0 to {HEADINGS - 1}", key="facing")

    def seen(self, label: str, heading: int) -> str:
        """Return what a class of the grid is called by a robot with a heading; and the other way round."""
        return label if label == OBSTACLE or heading % 2 == 0 else dict(self.turned)[label]

    def after(self, pose: Pose, way: Way) -> Pose:
        """Return the pose that a skill leads to, also where the grid ends."""
        cell, heading = pose
        if isinstance(way, Turn):
            return cell, (heading + way.quarter_turns) % HEADINGS
        rows, columns = seen_from_grid(way, heading)
        return (cell[0] + rows, cell[1] + columns), heading

    def primitive(self, state: TerrainState, pose: Pose, way: Way) -> Primitive | None:
        """Return what a skill in a pose has to master; None where an obstacle or the chosen directions forbid it."""
        target, heading = self.after(pose, way)
        labels = state.label(pose[0]), state.label(target)
        if OBSTACLE in labels or (isinstance(way, Direction) and way not in self.directions):
            return None
        return Primitive(way, self.seen(labels[0], pose[1]), self.seen(labels[1], heading))

    def states(self, state: TerrainState) -> tuple[Pose, ...]:
        """Return every cell with every heading."""
        return tuple((cell, heading) for cell in state.cells() for heading in range(HEADINGS))

    def start(self, state: TerrainState) -> Pose:
        """Return the middle cell and heading 0: a grid is seen from the robot when it is made."""
        return state.centre, 0

    def goals(self, request: Cell) -> frozenset[Pose]:
        """Return the requested cell with the headings that fulfil a request."""
        return frozenset((request, heading) for heading in self.facing)

    def cell(self, state: Pose) -> Cell:
        """Return the cell of a pose."""
        return state[0]

    def moves(self, state: TerrainState) -> tuple[Move[Pose], ...]:
        """Return what the robot could do if it had every primitive."""
        return _moves(self, state)

    def exhaustive(self) -> int:
        """Return how many primitives there are."""
        return len(self.directions) * len(self.turned) ** 2 + len(Turn) * len(self.turned)


@lru_cache(maxsize=1024)
def _moves(turning: Turning, state: TerrainState) -> tuple[Move[Pose], ...]:
    found = []
    for pose in turning.states(state):
        for way in (*turning.directions, *Turn):
            primitive = turning.primitive(state, pose, way)
            if primitive is not None:
                found.append(Move(pose, primitive, (turning.after(pose, way),)))
    return tuple(found)


def turning_of(classes: ClassSet, directions: Iterable[Direction] = tuple(Direction)) -> Turning:
    """Return how a robot that turns sees grids of a set of classes.

    Args:
        classes: the set.
        directions: translational skills that are allowed.
    """
    return Turning(tuple((name, classes.turned(name, 1)) for name in classes.names), tuple(directions))


def turn_primitives(classes: ClassSet) -> tuple[Primitive, ...]:
    """Return the turns on every class."""
    return tuple(Primitive(turn, name, classes.turned(name, 1)) for name in classes.names for turn in Turn)


def seen_from_grid(direction: Direction, heading: int) -> Cell:
    """Return the change of (row, column) of a direction that is seen from a robot with a heading."""
    rows, columns = direction.offset
    for _ in range(heading % HEADINGS):
        rows, columns = -columns, rows
    return rows, columns


def turning_object(turning: Turning) -> dict[str, Any]:
    """Return the block of a library with headings (docs/formats.md)."""
    return {"directions": [way.value for way in turning.directions], "turned": dict(turning.turned)}


def read_turning(value: Mapping[str, Any], classes: Iterable[str]) -> Turning:
    """Return the turning of such a block.

    Raises:
        InputError: a class has no name after a quarter turn.
    """
    turned, names = dict(value["turned"]), list(classes)
    if sorted(turned) != sorted(names):
        raise InputError(f"needs the name after a quarter turn of exactly {', '.join(names)}", key="headings.turned")
    return Turning(tuple((name, str(turned[name])) for name in names), tuple(map(Direction, value["directions"])))


def read_way(value: str | None) -> Way | None:
    """Return a direction or a turn; None: stay.

    Raises:
        ValueError: there is no such way.
    """
    return None if value is None else Turn(value) if value in list(Turn) else Direction(value)

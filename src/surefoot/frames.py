"""Frames and headings, the conventions of the whole package.

*World* is the frame of the map: x east, y north, z up, metres (ROS map_server). The *grid* frame is the world shifted
to the grid's origin and turned by its rotation; east, north, west and south are meant in the grid frame. Cells count
by (row, column), row 0 in the north and column 0 in the west, as in a picture. Yaw runs counter-clockwise from east;
*headings* are whole numbers that run clockwise from north, because that is how the games count them.
"""

from __future__ import annotations

import math
from enum import IntEnum
from typing import NamedTuple


class Direction(IntEnum):
    """The four directions of the coarse grid, clockwise from north."""

    NORTH = 0
    EAST = 1
    SOUTH = 2
    WEST = 3

    @property
    def offset(self) -> tuple[int, int]:
        """Return the change of (row, column) of one cell in this direction."""
        return _OFFSETS[self]

    @property
    def opposite(self) -> Direction:
        """Return the direction of a U-turn."""
        return Direction((self + 2) % 4)

    @property
    def left(self) -> Direction:
        """Return the direction a quarter turn counter-clockwise."""
        return Direction((self + 3) % 4)

    @property
    def right(self) -> Direction:
        """Return the direction a quarter turn clockwise."""
        return Direction((self + 1) % 4)

    @property
    def yaw_rad(self) -> float:
        """Return the yaw in the grid frame: east 0, north pi/2, counter-clockwise."""
        return heading_yaw_rad(int(self), 4)


_OFFSETS = {Direction.NORTH: (-1, 0), Direction.EAST: (0, 1), Direction.SOUTH: (1, 0), Direction.WEST: (0, -1)}


class Foot(IntEnum):
    """Which foot stands on the ground."""

    LEFT = 0
    RIGHT = 1

    @property
    def other(self) -> Foot:
        """Return the swing foot."""
        return Foot(1 - self)

    @property
    def side(self) -> int:
        """Return +1 for the left side of the heading, -1 for the right."""
        return 1 if self is Foot.LEFT else -1


class Cell(NamedTuple):
    """A cell of the coarse grid; row 0 is the northernmost, column 0 the westernmost."""

    row: int
    column: int

    def neighbour(self, direction: Direction) -> Cell:
        """Return the next cell in a direction."""
        rows, columns = direction.offset
        return Cell(self.row + rows, self.column + columns)


def heading_yaw_rad(heading: int, headings: int) -> float:
    """Return the yaw of a heading index, in (-pi, pi].

    Args:
        heading: index, clockwise from north.
        headings: how many headings make a full turn (4 on the coarse grid, 16 for turns of 22.5 degrees).
    """
    yaw = math.pi / 2 - heading * 2 * math.pi / headings
    return math.atan2(math.sin(yaw), math.cos(yaw))

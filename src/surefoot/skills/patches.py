"""The worst case of a class as polygons: what physics certifies a primitive on.

Patterns are regular and centred on their cell (docs/skills.md, "Classes"); the foot's margin is taken off every edge.
The band of a gap lies across the way of the primitive.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.footholds.terrain import Polygon, polygon
from surefoot.skills.class_blocks import GroundBlock
from surefoot.skills.values import Direction

BAR_M = 0.03
"""Width of a bar (IX-B2)."""

WAYS = {
    Direction.FORWARD: (1.0, 0.0),
    Direction.BACKWARD: (-1.0, 0.0),
    Direction.LEFT: (0.0, 1.0),
    Direction.RIGHT: (0.0, -1.0),
}
"""Unit vectors of the directions in the robot's frame: x forward, y left."""


@dataclass(frozen=True, slots=True)
class Rectangle:
    """A rectangle with sides along x and y [m]."""

    west: float
    south: float
    east: float
    north: float

    def shrunk(self, margin_m: float) -> Rectangle:
        """Return it with a margin taken off every edge."""
        return Rectangle(self.west + margin_m, self.south + margin_m, self.east - margin_m, self.north - margin_m)

    def moved(self, x_m: float, y_m: float) -> Rectangle:
        """Return it elsewhere."""
        return Rectangle(self.west + x_m, self.south + y_m, self.east + x_m, self.north + y_m)

    def corners(self, height_m: float = 0.0) -> list[list[float]]:
        """Return its corners, counter-clockwise."""
        west, south, east, north = self.west, self.south, self.east, self.north
        return [[x, y, height_m] for x, y in ((west, south), (east, south), (east, north), (west, north))]


def class_rectangles(ground: GroundBlock, cell_m: float, *, sideways: bool = False) -> tuple[Rectangle, ...]:
    """Return the pattern of a class in a cell about the origin, before the margin.

    Args:
        ground: the pattern.
        cell_m: side of the cell.
        sideways: whether the way leads to the left or right, so that a gap's band lies along x.
    """
    return tuple(_PATTERNS[ground.pattern](ground, cell_m, sideways))


def class_polygons(
    ground: GroundBlock, cell_m: float, margin_m: float, centre_m: NDArray[np.float64], *, sideways: bool = False
) -> tuple[Polygon, ...]:
    """Return where a foot may stand on the worst case of a class.

    Args:
        ground: the pattern; its height is left to ``centre_m``.
        cell_m: side of the cell.
        margin_m: taken off every edge.
        centre_m: centre of the cell.
        sideways: see ``class_rectangles``.
    """
    x, y, z = map(float, centre_m)
    return tuple(
        polygon(one.shrunk(margin_m).moved(x, y).corners(z))
        for one in class_rectangles(ground, cell_m, sideways=sideways)
    )


def _whole(_ground: GroundBlock, cell_m: float, _sideways: bool) -> Iterator[Rectangle]:
    half = cell_m / 2
    yield Rectangle(-half, -half, half, half)


def _stones(ground: GroundBlock, cell_m: float, _sideways: bool) -> Iterator[Rectangle]:
    pitch = cell_m / ground.per_side
    half = (pitch - ground.spacing_m) / 2
    places = [(k + 0.5) * pitch - cell_m / 2 for k in range(ground.per_side)]
    for x in places:
        for y in places:
            yield Rectangle(x - half, y - half, x + half, y + half)


def _strips(ground: GroundBlock, cell_m: float, sideways: bool) -> Iterator[Rectangle]:
    half, inner = cell_m / 2, ground.open_m / 2
    for low, high in ((-half, -inner), (inner, half)):
        yield Rectangle(-half, low, half, high) if sideways else Rectangle(low, -half, high, half)


def _bars(ground: GroundBlock, cell_m: float, _sideways: bool) -> Iterator[Rectangle]:
    half, thin = cell_m / 2, BAR_M / 2
    for x in bar_places(ground.across, cell_m):
        yield Rectangle(x - thin, -half, x + thin, half)
    for y in bar_places(ground.along, cell_m):
        yield Rectangle(-half, y - thin, half, y + thin)


def bar_places(spacing: float | str, cell_m: float) -> list[float]:
    """Return where the centre lines of bars lie: as many as fit into the cell, about its centre."""
    if isinstance(spacing, str):
        return [0.0] if spacing == "single" else []
    count = int((cell_m - BAR_M) / spacing + 1e-9) + 1
    return [(k - (count - 1) / 2) * spacing for k in range(count)]


_PATTERNS = {"whole": _whole, "stones": _stones, "strips": _strips, "bars": _bars}

"""The world of a quadruped's mission: ground, what has appeared on it, and the classes that the robot sees.

Source: Zhou et al. 2025, VII; docs/quadruped.md.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import shapely  # type: ignore[import-untyped]

from surefoot.footholds.problem import Array
from surefoot.footholds.terrain import Polygon, PolygonError, polygon
from surefoot.skills import LocalGrid, QuadrupedTerrain
from surefoot.skills.measures import WINDOW_M
from surefoot.skills.patches import Rectangle
from surefoot.skills.values import OBSTACLE, Cell, TerrainState

LEAST_AREA_M2 = 1e-5
"""Smaller leftovers of a polygon that was cut are no places for a foot."""
TOUCH_M = 1e-6
"""How far from a polygon a foot may be that stands on it."""


@dataclass(frozen=True, eq=False)
class World:
    """What is there.

    Attributes:
        terrain: ground, cut where something stands or where it is gone.
        obstacles: ground plans of what stands there; no cell that they touch may be entered.
    """

    terrain: QuadrupedTerrain
    obstacles: tuple[Rectangle, ...] = ()

    @cached_property
    def _seen(self) -> dict[tuple[Cell, int], TerrainState | None]:
        return {}

    def state(self, cell: Cell, quarter_turns: int = 0) -> TerrainState | None:
        """Return the classes about a cell of the map, as a robot in it sees them; None where it cannot stand."""
        key = (cell, quarter_turns % 4)
        if key not in self._seen:
            grid = LocalGrid(self.terrain, self.terrain.centre_m(cell), key[1])
            labels = self._blocked(grid) if grid.standing else None
            centre = (len(labels) // 2, len(labels[0]) // 2) if labels else (0, 0)
            free = labels is not None and labels[centre[0]][centre[1]] != OBSTACLE
            self._seen[key] = TerrainState(labels) if labels is not None and free else None
        return self._seen[key]

    def _blocked(self, grid: LocalGrid) -> tuple[tuple[str, ...], ...]:
        def label(row: int, column: int, seen: str) -> str:
            square = grid.square_m((row, column))
            return OBSTACLE if any(overlap(square, one) for one in self.obstacles) else seen

        return tuple(tuple(label(r, c, seen) for c, seen in enumerate(row)) for r, row in enumerate(grid.labels))

    def inside(self, cell: Cell) -> bool:
        """Return whether the map has a cell."""
        rows, columns = self.terrain.cells
        return 0 <= cell[0] < rows and 0 <= cell[1] < columns

    def ground_in(self, area: Rectangle) -> list[tuple[Polygon, Any]]:
        """Return the polygons that meet an area, each with its part there as seen from above, margin put back."""
        ground, box = self.terrain.ground, shapely.box(area.west, area.south, area.east, area.north)
        found = []
        for number in sorted(ground.tree.query(box).tolist()):
            part = ground.shapes[number].intersection(box)
            if part.area > 0:
                found.append((self.terrain.polygons[number], part))
        return found

    def holds(self, point_m: Array) -> bool:
        """Return whether there is ground below a foot that stands."""
        return any(one.excess(point_m) <= TOUCH_M for one in self.terrain.polygons)

    def height_m(self, cell: Cell) -> float:
        """Return the mean height of the ground in a cell of the map."""
        return self.terrain.measured[cell].height_m

    def without_ground(self, hole: Rectangle) -> World:
        """Return the world in which there is no ground any more in a rectangle."""
        terrain = self.terrain
        left = tuple(piece for one in terrain.polygons for piece in cut(one, hole))
        near = hole.shrunk(-WINDOW_M - terrain.cell_m)
        untouched = [cell for cell in terrain.measured if not overlap(terrain.square_m(cell), near)]
        return World(terrain.with_polygons(left, untouched), self.obstacles)

    def with_obstacle(self, box: Rectangle) -> World:
        """Return the world with something that stands on a rectangle."""
        return replace(self.without_ground(box), obstacles=(*self.obstacles, box))


def overlap(a: Rectangle, b: Rectangle) -> bool:
    """Return whether two rectangles share more than their sides."""
    return a.west < b.east - 1e-9 and b.west < a.east - 1e-9 and a.south < b.north - 1e-9 and b.south < a.north - 1e-9


def cut(one: Polygon, hole: Rectangle) -> Iterator[Polygon]:
    """Yield convex pieces of a polygon that are outside of a rectangle; the polygon itself if they do not meet."""
    outline = shapely.Polygon(one.vertices_m[:, :2])
    if not outline.intersects(shapely.box(hole.west, hole.south, hole.east, hole.north)):
        yield one
        return
    (west, south), (east, north) = one.vertices_m[:, :2].min(axis=0) - 1, one.vertices_m[:, :2].max(axis=0) + 1
    around = (
        Rectangle(west, south, hole.west, north),
        Rectangle(hole.east, south, east, north),
        Rectangle(hole.west, south, hole.east, hole.south),
        Rectangle(hole.west, hole.north, hole.east, north),
    )
    for box in around:
        piece = clipped(one, box) if box.west < box.east and box.south < box.north else None
        if piece is not None:
            yield piece


def clipped(one: Polygon, box: Rectangle) -> Polygon | None:
    """Return the part of a polygon above a rectangle; None where next to nothing is left."""
    outline = shapely.Polygon(one.vertices_m[:, :2])
    part = outline.intersection(shapely.box(box.west, box.south, box.east, box.north))
    if part.geom_type != "Polygon" or part.area < LEAST_AREA_M2:
        return None
    if part.area > outline.area - 1e-12:
        return one
    flat = np.array(part.exterior.coords)[:-1]
    try:
        return polygon(on_plane(one, flat).tolist(), one.friction)
    except PolygonError:
        return None


def on_plane(one: Polygon, places_m: Array) -> Array:
    """Return the points of a polygon's plane above places, shape (n, 3)."""
    x, y, z = one.normal
    heights = (one.offset - places_m @ np.array([x, y])) / z
    return np.column_stack((places_m, heights))

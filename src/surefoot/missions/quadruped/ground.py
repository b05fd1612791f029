"""The ground between two cells of the real map: polygons to step on, and where feet may be about a step's edge.

Level ground is taken as it is, a little beyond both cells. Where the cells differ in height, their ground is cut at the
edge of the step, so that no foot stands on the low side below the high ground, and feet keep to the low side of the
edge or above it (Zhou et al. 2025, VII-A2).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from surefoot.footholds.problem import Array
from surefoot.footholds.terrain import Polygon
from surefoot.missions.quadruped.world import TOUCH_M, World, clipped, on_plane
from surefoot.skills.patches import Rectangle
from surefoot.skills.values import Cell

STEP_EDGE_M = 0.03
"""Cells that differ by less are level."""
BEYOND_M = 0.12
"""How far beyond the two cells level ground is stepped on."""
_EDGE_M = 0.01
_SAME_LEVEL_M = 0.06
_UNDER_M = 1e-4

FreeRegions = tuple[tuple[Array, Array], ...]


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """What a crossing may use.

    Attributes:
        polygons: where feet may stand.
        free_regions: where feet may be; none where everything is level.
        rise_m: of the next cell's ground.
    """

    polygons: tuple[Polygon, ...]
    free_regions: FreeRegions
    rise_m: float


def ground_between(world: World, here: Cell, there: Cell, feet_m: Array, *, collision: bool = True) -> Ground:
    """Return the ground of a crossing.

    Args:
        world: the map.
        here: cell that is left.
        there: cell that is entered; the same one to turn in place.
        feet_m: where the feet stand, shape (4, 3): the ground below them belongs to it.
        collision: whether feet keep clear of the edges of steps.
    """
    low_m, high_m = sorted((world.height_m(here), world.height_m(there)))
    rise_m = world.height_m(there) - world.height_m(here)
    area = _around(world, here, there)
    if abs(rise_m - _sloped_m(world, here, there)) < STEP_EDGE_M:
        return Ground(_with_start(world, tuple(_even(world, here, there)), feet_m), (), rise_m)
    way = np.subtract(world.terrain.centre_m(there), world.terrain.centre_m(here)) * np.sign(rise_m)
    way /= np.linalg.norm(way)
    upper = [piece for one in _near(world, area, high_m) if (piece := clipped(one, area)) is not None]
    lower = [piece for one in _near(world, area, low_m) if (piece := clipped(one, area)) is not None]
    if not upper or not lower:
        return Ground(_with_start(world, tuple(upper + lower), feet_m), (), rise_m)
    edge_m = min(float((one.vertices_m[:, :2] @ way).min()) for one in upper) - world.terrain.margin_m
    before = _side(area, way, edge_m)
    lower = [piece for one in lower if (piece := clipped(one, before)) is not None]
    polygons = _with_start(world, (*lower, *upper), feet_m)
    if not collision:
        return Ground(polygons, (), rise_m)
    top_m = min(float(one.vertices_m[:, 2].min()) for one in upper) - _UNDER_M
    regions = [_half(np.array([*way, 0.0]), edge_m - _EDGE_M), _half(np.array([0.0, 0.0, -1.0]), -top_m)]
    outside = [p for p in feet_m if not any((matrix @ p <= bound).all() for matrix, bound in regions)]
    if outside:
        # a foot still stands on lower ground behind: it may leave that upwards and forwards
        regions.append(_half(-np.array([*way, 0.0]), -min(float(p[:2] @ way) for p in outside) + _EDGE_M))
    return Ground(polygons, tuple(regions), rise_m)


def _half(normal: Array, bound: float) -> tuple[Array, Array]:
    return normal[None, :], np.array([bound])


def _around(world: World, here: Cell, there: Cell) -> Rectangle:
    a, b = world.terrain.square_m(here), world.terrain.square_m(there)
    return Rectangle(min(a.west, b.west), min(a.south, b.south), max(a.east, b.east), max(a.north, b.north))


def _side(area: Rectangle, way: Array, edge_m: float) -> Rectangle:
    """Return the part of an area that lies before an edge across one of the four ways."""
    x, y = way
    if abs(x) > 0.5:
        place = edge_m * x
        return (
            Rectangle(area.west, area.south, min(area.east, place), area.north)
            if x > 0
            else Rectangle(max(area.west, place), area.south, area.east, area.north)
        )
    place = edge_m * y
    return (
        Rectangle(area.west, area.south, area.east, min(area.north, place))
        if y > 0
        else Rectangle(area.west, max(area.south, place), area.east, area.north)
    )


def _sloped_m(world: World, here: Cell, there: Cell) -> float:
    """Return by how much the ground would rise from cell to cell if there were no edge between them."""
    way = np.subtract(world.terrain.centre_m(there), world.terrain.centre_m(here))
    return float((_gradient(world, here) + _gradient(world, there)) @ way) / 2


def _gradient(world: World, cell: Cell) -> Array:
    """Return the mean slope of the ground in a cell along x and y."""
    parts = world.ground_in(world.terrain.square_m(cell))
    areas = np.array([part.area for _, part in parts])
    slopes = np.array([-one.normal[:2] / one.normal[2] for one, _ in parts])
    gradient: Array = areas @ slopes / areas.sum()
    return gradient


def _even(world: World, here: Cell, there: Cell) -> Iterator[Polygon]:
    """Yield the polygons in and about two cells without an edge between them, which may lie on a slope."""
    middle = np.add(world.terrain.centre_m(here), world.terrain.centre_m(there)) / 2
    height_m = (world.height_m(here) + world.height_m(there)) / 2
    gradient = (_gradient(world, here) + _gradient(world, there)) / 2
    for one, part in world.ground_in(_around(world, here, there).shrunk(-BEYOND_M)):
        place = np.array([part.centroid.x, part.centroid.y])
        expected_m = height_m + float(gradient @ (place - middle))
        if abs(float(on_plane(one, place[None])[0, 2]) - expected_m) < _SAME_LEVEL_M:
            yield one


def _near(world: World, area: Rectangle, height_m: float) -> list[Polygon]:
    """Return the polygons that meet an area and belong to a level."""
    return [
        one for one, _ in world.ground_in(area) if abs(float(one.vertices_m[:, 2].mean()) - height_m) < _SAME_LEVEL_M
    ]


def _with_start(world: World, polygons: tuple[Polygon, ...], feet_m: Array) -> tuple[Polygon, ...]:
    """Return polygons and, where none of them holds a foot that stands, the one of the map that does."""
    added: list[Polygon] = []
    for foot in feet_m:
        if any(one.excess(foot) <= TOUCH_M for one in (*polygons, *added)):
            continue
        holds = [one for one in world.terrain.polygons if one.excess(foot) <= TOUCH_M]
        added += holds[:1]
    return (*polygons, *added)

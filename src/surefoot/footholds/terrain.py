"""Steppable polygons: half-planes, planes, friction pyramids, and hulls of several of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

PLANE_TOLERANCE_M = 1e-6
_PLANAR_M = 1e-4
_LEAST_AREA_M2 = 1e-8
_LEAST_UPWARD = 0.05


class PolygonError(ValueError):
    """A list of vertices is no polygon that a foot can stand on."""


@dataclass(frozen=True, eq=False)
class Polygon:
    """A convex polygon in space, on which a foot may stand.

    Attributes:
        vertices_m: shape (k, 3), counter-clockwise seen from above.
        friction: coefficient of friction.
        normal: unit normal, upwards.
        sides: shape (k, 3); a point p of the plane is inside when ``sides @ p <= bounds``.
        bounds: shape (k,).
    """

    vertices_m: Array
    friction: float
    normal: Array
    sides: Array
    bounds: Array

    @cached_property
    def offset(self) -> float:
        """The plane is ``normal @ p == offset``."""
        return float(self.normal @ self.vertices_m.mean(axis=0))

    @cached_property
    def tangents(self) -> Array:
        """Return t1 (world x projected on the plane, normalised) and t2 = n x t1, shape (2, 3)."""
        first = np.array([1.0, 0.0, 0.0]) - self.normal[0] * self.normal
        first = first / np.linalg.norm(first)
        return np.array([first, np.cross(self.normal, first)])

    @cached_property
    def pyramid(self) -> Array:
        """Return the rows c of the inner friction pyramid, shape (5, 3): a force is in it when ``c @ f <= 0``.

        Source: Zhou et al. 2025, Eqs. (10)-(11), with mu / sqrt(2) for the pyramid.
        """
        t, slope = self.tangents, self.friction / np.sqrt(2.0) * self.normal
        return np.array([t[0] - slope, -t[0] - slope, t[1] - slope, -t[1] - slope, -self.normal])

    @cached_property
    def rays(self) -> Array:
        """Return the four edges of the friction pyramid, shape (4, 3)."""
        t, slope = self.tangents, self.friction / np.sqrt(2.0)
        return np.array([self.normal + slope * (a * t[0] + b * t[1]) for a, b in ((1, 1), (1, -1), (-1, 1), (-1, -1))])

    def excess(self, point_m: Array) -> float:
        """Return by how much a point misses the polygon or its plane [m]; at most 0 when it is inside."""
        off = abs(float(self.normal @ point_m) - self.offset)
        return max(off - PLANE_TOLERANCE_M, float((self.sides @ point_m - self.bounds).max()))

    def nearest(self, point_m: Array) -> Array:
        """Return the point of the polygon nearest to a point."""
        flat = point_m - (self.normal @ point_m - self.offset) * self.normal
        if (self.sides @ flat <= self.bounds).all():
            return flat
        begin, along = self.vertices_m, np.roll(self.vertices_m, -1, axis=0) - self.vertices_m
        part = np.clip(((flat - begin) * along).sum(1) / (along**2).sum(1), 0.0, 1.0)
        feet = begin + part[:, None] * along
        closest: Array = feet[((feet - flat) ** 2).sum(1).argmin()]
        return closest


def polygon(vertices_m: Sequence[Sequence[float]], friction: float = 0.6) -> Polygon:
    """Return a polygon from its vertices, in either sense of rotation.

    Raises:
        PolygonError: they are fewer than three, not planar, not convex, cross themselves, enclose no area, or stand
            upright.
    """
    points = np.asarray(vertices_m, dtype=float)
    points = points[np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1) > 1e-9]
    if len(points) < 3:
        raise PolygonError("needs at least three different vertices")
    centre = points.mean(axis=0)
    spokes = points - centre
    newell = np.cross(spokes, np.roll(spokes, -1, axis=0)).sum(axis=0) / 2
    area = float(np.linalg.norm(newell))
    _, _, axes = np.linalg.svd(spokes)
    if float(np.abs(spokes @ axes[2]).max()) > _PLANAR_M:
        raise PolygonError("is not planar: its vertices have to lie in one plane")
    sides = np.roll(points, -1, axis=0) - points
    normal = axes[2] * (1 if axes[2][2] >= 0 else -1)
    turns = np.cross(sides, np.roll(sides, -1, axis=0)) @ normal
    angles = np.arctan2(turns, (sides * np.roll(sides, -1, axis=0)).sum(1))
    if float(np.linalg.norm(sides, axis=1).max()) * float(np.abs(spokes @ axes[1]).max()) < _LEAST_AREA_M2:
        raise PolygonError("has no area: its vertices lie on one line")
    scale = float((sides**2).sum(1).max())
    if (turns > 1e-9 * scale).any() and (turns < -1e-9 * scale).any():
        raise PolygonError("is not convex, or crosses itself; cut it into convex polygons")
    if abs(abs(angles.sum()) - 2 * np.pi) > 1e-3:
        raise PolygonError("crosses itself; the vertices have to go round once")
    if area < _LEAST_AREA_M2:
        raise PolygonError("has no area")
    if normal[2] < _LEAST_UPWARD:
        raise PolygonError("stands upright; a foot needs a surface that faces upwards")
    if angles.sum() < 0:
        points = points[::-1]
    along = np.roll(points, -1, axis=0) - points
    outward = np.cross(along, normal)
    outward /= np.linalg.norm(outward, axis=1)[:, None]
    return Polygon(points, float(friction), normal, outward, (outward * points).sum(1))


@dataclass(frozen=True, slots=True, eq=False)
class Hull:
    """Half-spaces that hold the convex hull of several polygons: ``planes @ p <= bounds``, and perhaps a plane.

    Attributes:
        planes: shape (k, 3).
        bounds: shape (k,).
        normal: of the plane that all of them share, or None.
        offset: of that plane.
    """

    planes: Array
    bounds: Array
    normal: Array | None
    offset: float


def hull_of(polygons: Sequence[Polygon]) -> Hull:
    """Return the convex hull of some polygons; exact for one of them, and for any in general position.

    Every half-space is moved until it supports the vertices, so that rounding never cuts anything off.
    """
    if len(polygons) == 1:
        one = polygons[0]
        return Hull(one.sides, one.bounds, one.normal, one.offset)
    points = np.concatenate([one.vertices_m for one in polygons])
    normal, offset = polygons[0].normal, polygons[0].offset
    if float(np.abs(points @ normal - offset).max()) < 1e-9:
        planes = _flat_hull(points, normal)
        return Hull(planes, (points @ planes.T).max(axis=0), normal, offset)
    planes = _solid_hull(points)
    return Hull(planes, (points @ planes.T).max(axis=0), None, 0.0)


def _flat_hull(points: Array, normal: Array) -> Array:
    """Return the outward sides of the hull of points in one plane, by the monotone chain."""
    first = np.array([1.0, 0.0, 0.0]) - normal[0] * normal
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)
    flat = np.round(np.stack([points @ first, points @ second], axis=1), 12)
    corners = chain_hull(flat)
    along = np.roll(corners, -1, axis=0) - corners
    outward = np.stack([along[:, 1], -along[:, 0]], axis=1)
    outward /= np.linalg.norm(outward, axis=1)[:, None]
    planes: Array = outward @ np.stack([first, second])
    return planes


def chain_hull(points: Array) -> Array:
    """Return the corners of the convex hull of points in the plane, counter-clockwise (Andrew's monotone chain)."""
    ordered = sorted({(float(x), float(y)) for x, y in points})

    def half(sequence: list[tuple[float, float]]) -> list[tuple[float, float]]:
        chain: list[tuple[float, float]] = []
        for x, y in sequence:
            while len(chain) > 1:
                (ax, ay), (bx, by) = chain[-2], chain[-1]
                if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 1e-12:
                    break
                chain.pop()
            chain.append((x, y))
        return chain[:-1]

    return np.array(half(ordered) + half(ordered[::-1]))


def _solid_hull(points: Array) -> Array:
    """Return outward normals of the hull of points in space; of their bounding box where Qhull gives up."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        equations = ConvexHull(points).equations[:, :3]
    except QhullError:
        return np.concatenate([np.eye(3), -np.eye(3)])
    _, kept = np.unique(np.round(equations, 9), axis=0, return_index=True)
    planes: Array = equations[np.sort(kept)]
    return planes


def cone_hull(polygons: Sequence[Polygon]) -> Array:
    """Return rows c of a cone that holds the friction pyramids of all the polygons: ``c @ f <= 0``."""
    first_pyramid = polygons[0].pyramid
    if all((one.pyramid == first_pyramid).all() for one in polygons[1:]):
        return first_pyramid
    rays = np.concatenate([one.rays for one in polygons])
    up = np.array([0.0, 0.0, 1.0])
    if rays[:, 2].min() < 0.05:
        normals = np.array([one.normal for one in polygons])
        up = normals.mean(axis=0)
        up /= np.linalg.norm(up)
        if (rays @ up).min() < 0.05:
            return np.zeros((0, 3))
    first = np.cross(up, [0.0, 1.0, 0.0])
    first /= np.linalg.norm(first)
    second = np.cross(up, first)
    flat = np.stack([rays @ first, rays @ second], axis=1) / (rays @ up)[:, None]
    corners = chain_hull(flat)
    if len(corners) < 3:
        return np.zeros((0, 3))
    along = np.roll(corners, -1, axis=0) - corners
    outward = np.stack([along[:, 1], -along[:, 0]], axis=1)
    outward /= np.linalg.norm(outward, axis=1)[:, None]
    reach = (flat @ outward.T).max(axis=0)
    cone = outward @ np.stack([first, second]) - reach[:, None] * up
    return np.concatenate([cone, -up[None, :]])

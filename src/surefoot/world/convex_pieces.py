"""Splits polygons with holes into few convex pieces.

Every corner that turns inward is cut: where possible by a segment that resolves two of them at once, else along the
extension of one of its edges until the boundary or an earlier cut. Pieces whose union is convex are joined again.

Source: Chazelle and Dobkin, "Decomposing a polygon into its convex parts" (naive decomposition, at most one piece more
than there are inward corners); Hertel and Mehlhorn (joining, and the fallback on triangles).
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import shapely  # type: ignore[import-untyped]
from numpy.typing import NDArray

from surefoot.world._convex_kernels import convex_ring, merged_faces, without_straight

Floats = NDArray[np.float64]

_EPS = 1e-9
_MOST_CORNERS = 600
_NEAREST = 12
_ROUNDING = 2e-6
_REPEATED = 1e-7


def convex_pieces(polygon: Any, smallest: float = 0.0) -> list[Floats]:
    """Return a partition of a polygon into convex pieces.

    Args:
        polygon: a shapely polygon, perhaps with holes.
        smallest: pieces of less area are left out.

    Returns:
        Outlines (n, 2), counter-clockwise, strictly convex, largest first.
    """
    if polygon.is_empty or polygon.area <= smallest:
        return []
    if not shapely.get_num_interior_rings(polygon):
        ring = convex_ring(shapely.get_coordinates(polygon)[:-1], _REPEATED)
        if len(ring):
            return [without_straight(ring)]
    polygon = shapely.orient_polygons(shapely.remove_repeated_points(polygon, _REPEATED))
    if _is_convex(polygon):
        return [piece for piece in [clean_outline(polygon)] if len(piece) >= 3]
    corners = _Corners(polygon)
    if len(corners.reflex) > _MOST_CORNERS:
        joined = merged_triangles(polygon)
    else:
        faces = _faces(polygon, corners.cuts())
        joined = _joined(
            [piece for face in faces for piece in ([face] if _is_convex(face) else merged_triangles(face))]
        )
    scale = max(polygon.area, 1e-12)
    pieces = [clean_outline(face) for face in joined if face.area > max(smallest, 1e-9 * scale)]
    return sorted((piece for piece in pieces if len(piece) >= 3), key=lambda piece: -area_of(piece))


def clean_outline(face: Any) -> Floats:
    """Return a convex outline, counter-clockwise, without points that lie on its edges."""
    hull = shapely.convex_hull(face)
    if hull.geom_type != "Polygon":
        return np.empty((0, 2))
    points = shapely.get_coordinates(shapely.orient_polygons(hull))[:-1]
    outline: Floats = without_straight(points)
    return outline


def area_of(points: Floats) -> float:
    """Return the area of a polygon, positive when it runs counter-clockwise."""
    (x, y), (x0, y0), (x1, y1) = points.T, points[0], points[-1]
    return 0.5 * float(x[:-1] @ y[1:] - y[:-1] @ x[1:] + x1 * y0 - y1 * x0)


class _Corners:
    """The corners and edges of a polygon whose inside lies to the left of every ring."""

    def __init__(self, polygon: Any) -> None:
        rings = [shapely.get_coordinates(ring)[:-1] for ring in (polygon.exterior, *polygon.interiors)]
        self.points = np.vstack(rings)
        self.starts = self.points
        self.ends = np.vstack([np.roll(ring, -1, axis=0) for ring in rings])
        into = np.vstack([ring - np.roll(ring, 1, axis=0) for ring in rings])
        out = self.ends - self.starts
        self.into = into / np.maximum(np.hypot(*into.T), _EPS)[:, None]
        self.out = out / np.maximum(np.hypot(*out.T), _EPS)[:, None]
        self.reflex = np.flatnonzero(_cross(self.into, self.out) < -1e-6)

    def cuts(self) -> list[Floats]:
        """Return one cut for every inward corner, shared by two where that is possible."""
        walls = _Walls(self.starts, self.ends, len(self.reflex))
        left = set(self.reflex.tolist())
        for a, b in self._bridges():
            if a in left and b in left and not walls.cross(self.points[a], self.points[b]):
                left -= {a, b}
                walls.add(self.points[a], self.points[b])
        for k in sorted(left):
            ends = [walls.hit(self.points[k], way) for way in (self.into[k], -self.out[k])]
            walls.add(self.points[k], min(ends, key=lambda end: float(np.hypot(*(end - self.points[k])))))
        return walls.added()

    def _bridges(self) -> list[tuple[int, int]]:
        """Return pairs of inward corners that one segment would resolve, shortest first."""
        found = []
        for k in self.reflex:
            ways = self.points[self.reflex] - self.points[k]
            lengths = np.hypot(*ways.T)
            near = np.argsort(lengths, kind="stable")[1 : _NEAREST + 1]
            for m in near:
                other = int(self.reflex[m])
                if other > k and lengths[m] > _EPS:
                    way = ways[m] / lengths[m]
                    if self._resolves(int(k), way) and self._resolves(other, -way):
                        found.append((float(lengths[m]), int(k), other))
        return [(a, b) for _, a, b in sorted(found)]

    def _resolves(self, k: int, way: Floats) -> bool:
        """Return whether a cut in a direction leaves no inward corner on either side."""
        return bool(_cross(self.into[k], way) >= -1e-6 and _cross(self.out[k], way) >= -1e-6)


class _Walls:
    """Segments that cuts may not cross: the boundary, and the cuts so far."""

    def __init__(self, starts: Floats, ends: Floats, room: int) -> None:
        self.first = self.count = len(starts)
        self.a = np.vstack((starts, np.zeros((room, 2))))
        self.edge = np.vstack((ends - starts, np.zeros((room, 2))))

    def add(self, start: Floats, end: Floats) -> None:
        """Add a cut."""
        self.a[self.count], self.edge[self.count] = start, end - start
        self.count += 1

    def added(self) -> list[Floats]:
        """Return the cuts."""
        return [np.array([self.a[k], self.a[k] + self.edge[k]]) for k in range(self.first, self.count)]

    def _meetings(self, start: Floats, way: Floats) -> tuple[Floats, NDArray[np.bool_]]:
        """Return where along a line it meets each wall's line, and whether that is on the wall."""
        a, edge = self.a[: self.count] - start, self.edge[: self.count]
        scale = way[0] * edge[:, 1] - way[1] * edge[:, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            t = (a[:, 0] * edge[:, 1] - a[:, 1] * edge[:, 0]) / scale
            s = (a[:, 0] * way[1] - a[:, 1] * way[0]) / scale
        return t, (np.abs(scale) > 1e-12) & (s >= -1e-9) & (s <= 1 + 1e-9)

    def hit(self, start: Floats, way: Floats) -> Floats:
        """Return where a ray first meets a wall, and a trifle beyond."""
        t, on = self._meetings(start, way)
        ahead = t[on & (t > 1e-7)]
        end: Floats = start + way * (float(ahead.min()) + 1e-7) if len(ahead) else start
        return end

    def cross(self, start: Floats, end: Floats) -> bool:
        """Return whether an open segment meets any wall."""
        t, on = self._meetings(start, end - start)
        slack = 1e-7 / max(float(np.hypot(*(end - start))), 1e-7)
        return bool((on & (t > slack) & (t < 1 - slack)).any())


def _cross(a: Floats, b: Floats) -> Any:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _faces(polygon: Any, cuts: list[Floats]) -> list[Any]:
    """Return the faces that the cuts divide a polygon into."""
    lines = shapely.union_all([polygon.boundary, *(shapely.linestrings(cut) for cut in cuts)])
    found = shapely.get_parts(shapely.polygonize([lines]))
    inside = shapely.contains_properly(polygon, shapely.point_on_surface(found))
    faces = list(found[inside])
    if abs(sum(face.area for face in faces) - polygon.area) > 1e-6 * polygon.area:
        return merged_triangles(polygon)
    return faces


def merged_triangles(polygon: Any) -> list[Any]:
    """Return convex faces: constrained triangles without the diagonals that are not needed (Hertel and Mehlhorn)."""
    triangles = [part for part in shapely.get_parts(shapely.constrained_delaunay_triangles(polygon)) if part.area > 0]
    points = shapely.get_coordinates(shapely.orient_polygons(np.array(triangles, object))).reshape(-1, 4, 2)[:, :3]
    corners, number = np.unique(points.reshape(-1, 2), axis=0, return_inverse=True)
    faces = _without_diagonals(corners, number.ravel().astype(np.int64))
    hulls = shapely.convex_hull(np.array(faces, object))
    areas = shapely.area(np.array(faces, object))
    if (shapely.area(hulls) - areas > _bend(areas)).any():  # slivers have bent a face
        return _joined(triangles)
    return faces


def _without_diagonals(corners: Floats, start: NDArray[np.int64]) -> list[Any]:
    """Remove diagonals of triangles, longest first, as long as faces stay convex; return the faces.

    Args:
        corners: (n, 2) positions.
        start: (3 t,) the corner where every directed edge starts, three a triangle, counter-clockwise.
    """
    end = np.roll(start.reshape(-1, 3), -1, axis=1).ravel()
    ways, back = start * len(corners) + end, end * len(corners) + start
    order = np.argsort(ways, kind="stable")
    place = np.minimum(np.searchsorted(ways[order], back), len(order) - 1)
    twin = order[place]
    edges = np.flatnonzero((ways[twin] == back) & (start < end))
    lengths = np.hypot(*(corners[start[edges]] - corners[end[edges]]).T)
    edges = edges[np.argsort(-lengths, kind="stable")]
    rings, begins = merged_faces(corners, start, edges, twin[edges])
    return [shapely.polygons(rings[a:b]) for a, b in pairwise(begins.tolist())]


def _bend(area: Any) -> Any:
    """Return the area by which a hull may exceed what counts as convex: rounding, never a hole."""
    return np.minimum(1e-5 * area, _ROUNDING)


def _is_convex(face: Any) -> bool:
    return not face.interiors and bool(shapely.convex_hull(face).area - face.area <= _bend(face.area))


def _joined(faces: list[Any]) -> list[Any]:
    """Join neighbours whose union is convex, those that gain the most first."""
    while len(faces) > 1:
        shapes = np.array(faces, object)
        first, second = shapely.STRtree(shapes).query(shapes, predicate="intersects")
        pairs = np.flatnonzero(first < second)
        first, second = first[pairs], second[pairs]
        areas = shapely.area(shapes)
        sums = areas[first] + areas[second]
        if not len(first):
            return faces
        hulls = shapely.convex_hull(shapely.geometrycollections(np.column_stack((shapes[first], shapes[second]))))
        gain = np.flatnonzero(shapely.area(hulls) - sums <= _bend(sums))
        if not len(gain):
            return faces
        taken: set[int] = set()
        joined = []
        for k in gain[np.argsort(-sums[gain], kind="stable")]:
            a, b = int(first[k]), int(second[k])
            if a not in taken and b not in taken:
                taken |= {a, b}
                joined.append(hulls[k])
        faces = joined + [face for k, face in enumerate(faces) if k not in taken]
    return faces

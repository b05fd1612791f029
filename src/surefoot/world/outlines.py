"""From the cells of a region to a polygon with straight edges, kept away from the region's edge by the foot margin.

Cells make staircases of slanted edges, and corners of a contour are blunt. So a contour is simplified, and then each of
its edges is fitted to the contour points that it replaces: on average that is the true edge. A guard keeps the result
within half a cell of the plain answer.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

SIMPLIFY_CELLS = (1.0, 0.6)
UNSURE_CELLS = 0.5
"""A scan knows an edge to half a cell."""
FEW = 6
SURE_POINTS = 10
THIN = 0.35
"""A region of which the margin leaves less is thin: between other things whose corners may reach into it unseen."""


def inset_outline(mask: Flags, margin_cells: float) -> tuple[Any, float]:
    """Return the part of a region that keeps a margin from its edge.

    Args:
        mask: (rows, columns), the cells of one region.
        margin_cells: the margin, in cells.

    Returns:
        A polygon or multipolygon in (column, row) coordinates, whole numbers at the centres of cells, perhaps empty; and
        the area [cells] that the margin leaves of the plain contour, to measure the former against.
    """
    rings = contour_rings(mask)
    contour = _region(rings)
    plain = _shrunk(contour, margin_cells)
    inward, apart = max(margin_cells - UNSURE_CELLS / 2, min(margin_cells, UNSURE_CELLS)), UNSURE_CELLS
    if plain.area < THIN * contour.area:
        inward, apart = margin_cells, 2 * UNSURE_CELLS
    outside = _beside(mask)
    for tolerance in SIMPLIFY_CELLS:
        inset = _shrunk(_region([straightened(ring, tolerance) for ring in rings]), inward)
        near = _too_near(inset, outside, min(inward, apart))
        if 0 < len(near) <= FEW:
            x, y, reach = near[:, 0], near[:, 1], inward + UNSURE_CELLS
            inset = shapely.difference(inset, shapely.union_all(shapely.box(x - reach, y - reach, x + reach, y + reach)))
        if len(near) <= FEW and inset.area > 0.9 * plain.area:
            return _polygons(inset), float(plain.area)
    return _shrunk(contour, inward), float(plain.area)


def _beside(mask: Flags) -> Floats:
    """Return the centres of the cells that touch a region from outside."""
    from scipy import ndimage

    framed = np.pad(mask, 1)
    rows, columns = np.nonzero(ndimage.binary_dilation(framed, np.ones((3, 3), np.bool_)) & ~framed)
    sides = np.column_stack((columns, rows)).astype(np.float64) - 1.0
    rows, columns = mask.shape
    edge = [(-1.0, y) for y in range(rows)] + [(float(columns), y) for y in range(rows)]
    edge += [(x, -1.0) for x in range(columns)] + [(x, float(rows)) for x in range(columns)]
    return np.vstack((sides, np.array(edge)))


def _too_near(shape: Any, points: Floats, distance: float) -> Floats:
    """Return the points that are nearer to a shape than a distance."""
    if shape.is_empty:
        return points[:0]
    shapely.prepare(shape)
    found: Floats = points[shapely.dwithin(shape, shapely.points(points), distance - 1e-6)]
    return found


def _shrunk(shape: Any, cells: float) -> Any:
    return shapely.buffer(shape, -cells, join_style="mitre", mitre_limit=3.0)


def contour_rings(mask: Flags) -> list[Floats]:
    """Return the closed contours (n, 2) of a mask in (column, row) coordinates, without the repeated last point."""
    from skimage.measure import find_contours

    rings = find_contours(np.pad(mask, 1).astype(np.float64), 0.5, fully_connected="low")
    return [ring[:-1, ::-1] - 1.0 for ring in rings if len(ring) > 3]


def straightened(ring: Floats, tolerance: float) -> Floats:
    """Return a ring with few, straight edges that run through the middle of the given points.

    Short and crooked edges are known badly; they are moved inward, towards the innermost of their points.

    Args:
        ring: (n, 2) contour with the region to its left (y down as if it were up), as ``contour_rings`` gives them.
        tolerance: of the simplification, in cells.
    """
    start = int(np.argmax(((ring - ring.mean(axis=0)) ** 2).sum(axis=1)))
    points = np.roll(ring, -start, axis=0)
    corners = _corners(points, tolerance)
    if len(corners) < 3:
        return ring
    lines = [_line(points, a, b) for a, b in zip(corners, np.roll(corners, -1), strict=True)]
    out = []
    for k, corner in enumerate(corners):
        out.extend(_meeting(lines[k - 1], lines[k], points[corner]))
    return np.array(out) if len(out) >= 3 else ring


def _corners(points: Floats, tolerance: float) -> NDArray[np.intp]:
    """Return the indices of the points that a simplification keeps."""
    closed = np.vstack((points, points[:1]))
    kept = shapely.get_coordinates(shapely.simplify(shapely.linestrings(closed), tolerance))[:-1]
    index = {(x, y): k for k, (x, y) in enumerate(points.tolist())}
    return np.array([index[x, y] for x, y in kept.tolist()], np.intp)


def _line(points: Floats, a: int, b: int) -> tuple[Floats, Floats]:
    """Return a point and the unit direction of the line through the points from a to b."""
    stop = b if b > a else b + len(points)
    chosen = points[np.arange(a, stop + 1) % len(points)]
    if len(chosen) > 5:
        chosen = chosen[1:-1]
    middle = chosen.mean(axis=0)
    along = points[b] - points[a]
    if len(chosen) > 3:
        _, _, axes = np.linalg.svd(chosen - middle, full_matrices=False)
        along = axes[0] if axes[0] @ along > 0 else -axes[0]
    else:
        middle = (points[a] + points[b]) / 2
    along = along / np.linalg.norm(along)
    inward = np.array([-along[1], along[0]])
    depth = (chosen - middle) @ inward
    shift = float(depth.max()) if len(chosen) < SURE_POINTS else float(np.quantile(depth, 0.9)) - UNSURE_CELLS
    middle = middle + max(shift, 0.0) * inward
    return middle, along


def _meeting(before: tuple[Floats, Floats], after: tuple[Floats, Floats], corner: Floats) -> list[Floats]:
    """Return where two fitted edges meet; where they are almost parallel, the corner moved onto each of them."""
    (p, u), (q, v) = before, after
    cross = float(u[0] * v[1] - u[1] * v[0])
    if abs(cross) > 0.2:
        t = float((q - p)[0] * v[1] - (q - p)[1] * v[0]) / cross
        meeting = p + t * u
        if float(np.hypot(*(meeting - corner))) <= 2.0:
            return [meeting]
    first, second = p + ((corner - p) @ u) * u, q + ((corner - q) @ v) * v
    return [(first + second) / 2] if float(np.hypot(*(first - second))) < 0.6 else [first, second]


def _region(rings: list[Floats]) -> Any:
    """Return the polygons that nested rings bound: a point is inside when an odd number of rings is around it."""
    shapes = [shapely.make_valid(shapely.polygons(ring)) for ring in rings if len(ring) >= 3]
    if not shapes:
        return shapely.Polygon()
    if len(shapes) == 1:
        return _polygons(shapes[0])
    order = np.argsort([-shape.area for shape in shapes], kind="stable")
    outer, result = shapes[order[0]], shapes[order[0]]
    holes = [shapes[k] for k in order[1:] if outer.intersects(shapes[k])]
    if holes:
        result = shapely.difference(outer, shapely.union_all(holes))
    return _polygons(result)


def _polygons(shape: Any) -> Any:
    """Return the polygons of a geometry, without lines and points."""
    parts = [part for part in shapely.get_parts(shape) if part.geom_type in ("Polygon", "MultiPolygon") and part.area]
    flat = [piece for part in parts for piece in shapely.get_parts(part)]
    if len(flat) == 1:
        return flat[0]
    return shapely.MultiPolygon(flat)

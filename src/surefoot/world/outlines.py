"""From the cells of a region to a polygon with straight edges, kept away from the region's edge by the foot margin.

Cells make staircases of slanted edges, and corners of a contour are blunt. So a contour is simplified, and then each of
its edges is fitted to the contour points that it replaces: on average that is the true edge. A guard keeps the result
within half a cell of the plain answer.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import shapely  # type: ignore[import-untyped]
from numpy.typing import NDArray

from surefoot.world._outline_kernels import UNSURE_CELLS, beside, contours, corners_of, fitted, framed, opened

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
NO_TIPS: Floats = np.empty((0, 2))

SIMPLIFY_CELLS = (1.0, 0.6)
CLEAR_CELLS = 0.6
"""Half a cell, and what making pieces convex may add."""
FEW = 6
TIP_CELLS = 1.45
TIP_NEIGHBOURS = 5
"""A cell with so many neighbours in the region is a tip: the corner it belongs to may reach farther, unseen."""
ENOUGH = 0.9
"""A fitted outline that leaves less than this of the plain one is not trusted."""
THIN = 0.35
"""A region of which the margin leaves less is thin: between other things whose corners may reach into it unseen."""


def inset_outline(
    mask: Flags, margin_cells: float, least_cells: float = 0.0, empty: Flags | None = None
) -> tuple[Any, float]:
    """Return the part of a region that keeps a margin from its edge.

    Args:
        mask: (rows, columns), the cells of one region.
        margin_cells: the margin, in cells.
        least_cells: what is smaller than this is not worth the work.
        empty: cells without data, with two cells more around than the mask; None for none.

    Returns:
        A polygon or multipolygon in (column, row) coordinates, whole numbers at the centres of cells, perhaps empty;
        and the area [cells] that the margin leaves of the plain contour, to measure the former against.
    """
    wide = framed(mask)
    rings = contour_rings(wide)
    outside, reaching = beside(wide, TIP_NEIGHBOURS)
    tips = outside[reaching]
    contour = _region(contour_rings(wide, tips), sound=True)
    plain = shrunk(contour, margin_cells)
    if plain.area < least_cells:
        return shapely.Polygon(), float(plain.area)
    if plain.area < THIN * contour.area:
        return plain, float(plain.area)
    inward = taken_off(margin_cells)
    for tolerance in SIMPLIFY_CELLS:
        inset = shrunk(_region([straightened(ring, tolerance) for ring in rings]), inward)
        poked = tips[too_near(inset, tips, TIP_CELLS)] if margin_cells > 0 and len(tips) else tips[:0]
        inset = _without(inset, poked, inward + UNSURE_CELLS)
        near = outside[too_near(inset, outside, min(inward, UNSURE_CELLS))]
        if len(near) <= FEW:
            inset = _without(inset, near, inward + UNSURE_CELLS)
            if inset.area > ENOUGH * plain.area:
                return _polygons(_clear(inset, empty, inward)), float(plain.area)
    return _polygons(_clear(shrunk(contour, inward), empty, inward)), float(plain.area)


def _clear(inset: Any, empty: Flags | None, inward: float) -> Any:
    """Return an outline that enters no cell without data.

    Where half a cell was not taken off, it is now. Elsewhere an edge may cut the corner of such a cell, as a slanted
    edge does; only cells that hold a corner of the outline, or whose centre lies in it, count as entered.
    """
    if empty is None or not empty.any():
        return inset
    holes: Floats = np.argwhere(empty)[:, ::-1].astype(np.float64) - 2.0
    if inward >= UNSURE_CELLS:
        return _without(inset, holes[_held(inset, holes)], CLEAR_CELLS)
    if not _entered(inset, holes).any():
        return inset
    return clear_of(shrunk(inset, UNSURE_CELLS - inward), empty)


def clear_of(inset: Any, empty: Flags) -> Any:
    """Return an outline that does not even cut the corners of cells without data."""
    holes: Floats = np.argwhere(empty)[:, ::-1].astype(np.float64) - 2.0
    return _polygons(_without(inset, holes[_entered(inset, holes)], CLEAR_CELLS))


def _entered(shape: Any, centres: Floats) -> Flags:
    """Return into which cells a shape reaches, or nearly so."""
    x, y = centres.T
    shapely.prepare(shape)
    boxes = shapely.box(x - CLEAR_CELLS, y - CLEAR_CELLS, x + CLEAR_CELLS, y + CLEAR_CELLS)
    found: Flags = shapely.intersects(shape, boxes)
    return found


def _held(shape: Any, centres: Floats) -> Flags:
    """Return which cells hold a corner of a shape, or have their centre in it."""
    corners = np.floor(shapely.get_coordinates(shape) + 0.5)
    cornered = {(x, y) for x, y in corners.tolist()}
    held = np.array([(x, y) in cornered for x, y in centres.tolist()])
    return held | too_near(shape, centres, 0.0)


def taken_off(margin_cells: float) -> float:
    """Return what is taken off an edge: the margin less a quarter of a cell, yet not less than half a cell of it."""
    return max(margin_cells - UNSURE_CELLS / 2, min(margin_cells, UNSURE_CELLS))


def within(shape: Any, box: tuple[float, float, float, float]) -> Any:
    """Return the polygons of a shape inside a rectangle: fitted edges may reach beyond the scan."""
    west, south, east, north = shape.bounds
    if west >= box[0] and south >= box[1] and east <= box[2] and north <= box[3]:
        return shape
    return _polygons(shapely.intersection(shape, shapely.box(*box)))


def too_near(shape: Any, points: Floats, distance: float) -> Flags:
    """Return which points are in a shape, or nearer to it than a distance; or each in a shape of its own."""
    shapely.prepare(shape)
    found: Flags = shapely.dwithin(shape, shapely.points(points), max(distance - 1e-6, 0.0))
    return found


def _without(shape: Any, points: Floats, reach: float) -> Any:
    """Return a shape without the squares around some points."""
    if not len(points):
        return shape
    x, y = points.T
    boxes = shapely.box(x - reach, y - reach, x + reach, y + reach)
    return shapely.difference(shape, shapely.disjoint_subset_union_all(boxes))


def shrunk(shape: Any, cells: float) -> Any:
    """Return a shape, or an array of shapes, with a margin taken off."""
    return shapely.buffer(shape, -cells, join_style="mitre", mitre_limit=3.0)


def contour_rings(wide: Flags, tips: Floats = NO_TIPS) -> list[Floats]:
    """Return the closed contours (n, 2) of a framed mask in (column, row) coordinates, without the repeated point.

    Args:
        wide: the mask.
        tips: cells outside whose corners are not cut.
    """
    whole = np.zeros_like(wide)
    columns, rows = tips.T.astype(np.intp)
    whole[rows + 2, columns + 2] = True
    points, begins = contours(wide, whole)
    return [points[a:b] for a, b in pairwise(begins.tolist())]


def straightened(ring: Floats, tolerance: float) -> Floats:
    """Return a ring with few, straight edges that run through the middle of the given points.

    Short and crooked edges are known badly; they are moved inward, towards the innermost of their points.

    Args:
        ring: (n, 2) contour with the region to its left (y down as if it were up), as ``contour_rings`` gives them.
        tolerance: of the simplification, in cells.
    """
    points = opened(ring)
    corners = corners_of(points, shapely.get_coordinates(shapely.simplify(shapely.linestrings(points), tolerance)))
    if len(corners) < 4:
        return ring
    out = fitted(points, corners)
    return out if len(out) >= 3 else ring


def _region(rings: list[Floats], *, sound: bool = False) -> Any:
    """Return the polygons that nested rings bound: a point is inside when an odd number of rings is around it.

    Contours are sound: no ring of theirs meets itself.
    """
    shapes = [shapely.polygons(ring) for ring in rings if len(ring) >= 3]
    shapes = shapes if sound else [_valid(shape) for shape in shapes]
    if not shapes:
        return shapely.Polygon()
    if len(shapes) == 1:
        return shapes[0] if shapes[0].geom_type == "Polygon" else _polygons(shapes[0])
    order = np.argsort([-shape.area for shape in shapes], kind="stable")
    outer, result = shapes[order[0]], shapes[order[0]]
    holes = [shapes[k] for k in order[1:] if outer.intersects(shapes[k])]
    if holes:
        result = shapely.difference(outer, shapely.disjoint_subset_union_all(np.array(holes, object)))
    return _polygons(result)


def _valid(shape: Any) -> Any:
    return shape if shapely.is_valid(shape) else shapely.make_valid(shape)


def _polygons(shape: Any) -> Any:
    """Return the polygons of a geometry, without lines and points."""
    if shape.geom_type == "Polygon":
        return shape
    parts = [part for part in shapely.get_parts(shape) if part.geom_type in ("Polygon", "MultiPolygon") and part.area]
    flat = [piece for part in parts for piece in shapely.get_parts(part)]
    if len(flat) == 1:
        return flat[0]
    return shapely.MultiPolygon(flat)

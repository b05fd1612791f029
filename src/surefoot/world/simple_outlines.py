"""Outlines of many regions at once: calls of geometry on arrays cost a tenth of as many single ones.

Most regions of stony ground have one contour, and nothing special happens to them: the plain answer, the fitted one,
and no cell beside the region too near to it. These are worked out together, step by step as in ``outlines``; all
others go there one by one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely  # type: ignore[import-untyped]
from numpy.typing import NDArray

from surefoot.world._outline_kernels import UNSURE_CELLS, beside, corners_of, fitted, framed, opened
from surefoot.world.outlines import (
    ENOUGH,
    SIMPLIFY_CELLS,
    THIN,
    TIP_NEIGHBOURS,
    Flags,
    Floats,
    contour_rings,
    inset_outline,
    shrunk,
    taken_off,
    too_near,
)

Shapes = NDArray[np.object_]


def inset_outlines(
    masks: Sequence[Flags], margin_cells: float, least_cells: Sequence[float], empty: Sequence[Flags | None]
) -> list[tuple[Any, float]]:
    """Return of every region what ``inset_outline`` returns.

    Args:
        masks: the cells of every region.
        margin_cells: the margin, in cells.
        least_cells: of every region, what is smaller than this is not worth the work.
        empty: of every region, cells without data around it; None for none.
    """
    found: dict[int, tuple[Any, float]] = {}
    rings: dict[int, Floats] = {}
    around: dict[int, Floats] = {}
    for number, mask in enumerate(masks):
        wide = framed(mask)
        found_rings, holes = contour_rings(wide), empty[number]
        if len(found_rings) == 1 and (holes is None or not holes.any()):
            outside, reaching = beside(wide, TIP_NEIGHBOURS)
            if not reaching.any():
                rings[number], around[number] = found_rings[0], outside
    numbers = list(rings)
    plain = shrunk(_polygons([rings[k] for k in numbers]), margin_cells) if numbers else []
    areas, whole = shapely.area(plain), shapely.area(_polygons(list(rings.values())))
    left = []
    for k, area, all_of_it, shape in zip(numbers, areas.tolist(), whole.tolist(), plain, strict=True):
        if area < least_cells[k]:
            found[k] = shapely.Polygon(), area
        elif area < THIN * all_of_it:
            found[k] = shape, area
        else:
            left.append((k, area))
    found |= _fitted(left, rings, around, taken_off(margin_cells))
    return [
        found[k] if k in found else inset_outline(mask, margin_cells, least_cells[k], empty[k])
        for k, mask in enumerate(masks)
    ]


def _fitted(
    left: list[tuple[int, float]], rings: dict[int, Floats], around: dict[int, Floats], inward: float
) -> dict[int, tuple[Any, float]]:
    """Return the fitted outlines of the regions to which nothing special happens."""
    closed = [opened(rings[k]) for k, _ in left]
    if not closed:
        return {}
    lines = shapely.linestrings(np.concatenate(closed), indices=np.repeat(np.arange(len(closed)), [*map(len, closed)]))
    kept, which = shapely.get_coordinates(shapely.simplify(lines, SIMPLIFY_CELLS[0]), return_index=True)
    ends = np.searchsorted(which, np.arange(len(closed) + 1))
    edges: dict[int, Floats] = {}
    for number, points in enumerate(closed):
        corners = corners_of(points, kept[ends[number] : ends[number + 1]])
        if len(corners) >= 4 and len(out := fitted(points, corners)) >= 3:
            edges[number] = out
    shapes = _polygons(list(edges.values()))
    valid = np.flatnonzero(shapely.is_valid(shapes))
    chosen = [list(edges)[k] for k in valid]
    insets = shrunk(shapes[valid], inward)
    near = _near(insets, [around[left[k][0]] for k in chosen], min(inward, UNSURE_CELLS))
    areas = shapely.area(insets)
    types = shapely.get_type_id(insets)
    return {
        left[k][0]: (insets[n], left[k][1])
        for n, k in enumerate(chosen)
        if not near[n] and areas[n] > ENOUGH * left[k][1] and types[n] == shapely.GeometryType.POLYGON
    }


def _near(shapes: Shapes, points: list[Floats], distance: float) -> NDArray[np.int64]:
    """Return how many points of its own every shape is too near to."""
    if not points:
        return np.zeros(0, np.int64)
    whose = np.repeat(np.arange(len(points)), [*map(len, points)])
    shapely.prepare(shapes)
    return np.bincount(whose, too_near(shapes[whose], np.concatenate(points), distance), len(points)).astype(np.int64)


def _polygons(rings: list[Floats]) -> Shapes:
    """Return the polygons of open rings."""
    if not rings:
        return np.empty(0, object)
    whose = np.repeat(np.arange(len(rings)), [len(ring) + 1 for ring in rings])
    closed = np.concatenate([part for ring in rings for part in (ring, ring[:1])])
    shapes: Shapes = shapely.polygons(shapely.linearrings(closed, indices=whose))
    return shapes

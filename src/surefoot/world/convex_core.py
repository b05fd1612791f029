"""One convex part of a polygon that is as large as cutting its inward corners off allows.

For small ground: a partition may leave only pieces that are too small to stand on, where most of the whole is one.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely  # type: ignore[import-untyped]
from numpy.typing import NDArray

from surefoot.world.convex_pieces import clean_outline

Floats = NDArray[np.float64]
_INWARD = -1e-6
_REPEATED = 1e-7
_MOST_CUTS = 40


def convex_core(polygon: Any) -> Floats:
    """Return a convex outline (n, 2) inside a polygon, counter-clockwise; an empty one where that is not found.

    Args:
        polygon: a shapely polygon. Where it has holes, or too many inward corners, nothing is found.
    """
    nothing: Floats = np.empty((0, 2))
    for _ in range(_MOST_CUTS):
        if polygon.is_empty or polygon.interiors:
            return nothing
        ring = shapely.get_coordinates(shapely.remove_repeated_points(shapely.orient_polygons(polygon), _REPEATED))[:-1]
        if len(ring) < 3:
            return nothing
        into, out = _ways(ring - np.roll(ring, 1, axis=0)), _ways(np.roll(ring, -1, axis=0) - ring)
        turns = into[:, 0] * out[:, 1] - into[:, 1] * out[:, 0]
        corner = int(turns.argmin())
        if turns[corner] >= _INWARD:
            return clean_outline(polygon)
        polygon = max(
            (_cut(polygon, ring[corner], way) for way in (into[corner], out[corner], into[corner] + out[corner])),
            key=lambda part: float(part.area),
        )
    return nothing


def _ways(edges: Floats) -> Floats:
    ways: Floats = edges / np.maximum(np.hypot(*edges.T), 1e-12)[:, None]
    return ways


def _cut(polygon: Any, corner: Floats, way: Floats) -> Any:
    """Return the largest part of what lies to the left of a line, which the inward corner bounds then."""
    west, south, east, north = polygon.bounds
    far = 2 * float(np.hypot(east - west, north - south))
    along = way / max(float(np.hypot(*way)), 1e-12)
    left = np.array([-along[1], along[0]])
    side = shapely.polygons(
        [corner - far * along, corner + far * along, corner + far * (along + left), corner - far * (along - left)]
    )
    parts = [part for part in shapely.get_parts(shapely.intersection(polygon, side)) if part.geom_type == "Polygon"]
    return max(parts, key=lambda part: float(part.area), default=shapely.Polygon())

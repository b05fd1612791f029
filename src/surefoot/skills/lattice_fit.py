"""Where the lines of a lattice should lie so that the edges of the ground fall on them.

Edges are those of the ground, the margin put back: sides that pieces of one region share are none. Directions in which
edges run come first; then, for a side of the cells, the offset at which the longest edges lie on lines.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely  # type: ignore[import-untyped]
from numpy.typing import NDArray

from surefoot.footholds.terrain import Polygon

Array = NDArray[np.float64]

_LEAST_EDGE_M = 0.08
_OUTSIDE_M = 1e-3
_ALONG_DEG = 10.0
_BLUR_DEG = 3.0
_NEAR_M = 0.035
_OFFSET_STEP_M = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class Edges:
    """Edges of the ground, seen from above.

    Attributes:
        middles_m: (n, 2).
        lengths_m: (n,).
        angles_rad: (n,) of their direction, counter-clockwise from x.
    """

    middles_m: Array
    lengths_m: Array
    angles_rad: Array


@dataclass(frozen=True, slots=True)
class Offset:
    """Where lines lie along one axis: at ``offset_m + k * side``, and the length of edges on them beyond chance."""

    offset_m: float
    gain_m: float


def ground_edges(polygons: Sequence[Polygon], margin_m: float) -> Edges:
    """Return the edges of the ground, where they were before the margin was taken off."""
    shapes = [shapely.Polygon(one.vertices_m[:, :2]) for one in polygons]
    rings = [_counter_clockwise(one.vertices_m[:, :2]) for one in polygons]
    begin = np.concatenate(rings)
    along = np.concatenate([np.roll(ring, -1, axis=0) - ring for ring in rings])
    owner = np.repeat(np.arange(len(rings)), [len(ring) for ring in rings])
    lengths = np.linalg.norm(along, axis=1)
    outward = np.column_stack((along[:, 1], -along[:, 0])) / np.maximum(lengths, 1e-12)[:, None]
    middles = begin + along / 2
    who, what = shapely.STRtree(shapes).query(shapely.points(middles + _OUTSIDE_M * outward), predicate="intersects")
    shared = np.zeros(len(begin), dtype=bool)
    shared[who[what != owner[who]]] = True
    used = ~shared & (lengths >= _LEAST_EDGE_M)
    angles = np.arctan2(along[used, 1], along[used, 0])
    return Edges((middles + margin_m * outward)[used], lengths[used], angles)


def headings_rad(edges: Edges, count: int) -> tuple[float, ...]:
    """Return the directions from -45 to 45 degrees along or across which most edges run, the best first; 0 if none."""
    degrees = np.degrees(edges.angles_rad) % 90.0
    scale = np.arange(90.0)
    apart = np.abs((degrees[None, :] - scale[:, None] + 45.0) % 90.0 - 45.0)
    weight = np.exp(-((apart / _BLUR_DEG) ** 2)) @ edges.lengths_m if len(degrees) else np.zeros(90)
    peaks = [k for k in range(90) if weight[k] > weight[k - 1] and weight[k] >= weight[(k + 1) % 90]]
    found = []
    for peak in sorted(peaks, key=lambda k: (-weight[k], k))[:count]:
        off = (degrees - peak + 45.0) % 90.0 - 45.0
        near = np.exp(-((off / _BLUR_DEG) ** 2)) * edges.lengths_m
        refined = peak + float(near @ off / near.sum())
        found.append(math.radians((refined + 45.0) % 90.0 - 45.0))
    return tuple(found) or (0.0,)


def offsets(edges: Edges, heading_rad: float, axis: int, side_m: float, count: int) -> tuple[Offset, ...]:
    """Return the offsets along an axis of a turned frame at which most edges lie on lines, the best first."""
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    normal = np.array([(c, s), (-s, c)][axis])
    across = np.degrees(edges.angles_rad - heading_rad) - (90.0, 0.0)[axis]
    used = np.abs((across + 90.0) % 180.0 - 90.0) <= _ALONG_DEG
    places, weights = edges.middles_m[used] @ normal, edges.lengths_m[used]
    tried = np.arange(0.0, side_m - _OFFSET_STEP_M / 2, _OFFSET_STEP_M)
    apart = np.abs((places[None, :] - tried[:, None] + side_m / 2) % side_m - side_m / 2)
    on_lines = np.exp(-((apart / _NEAR_M) ** 2)) @ weights
    found: list[Offset] = []
    for k in np.argsort(-on_lines, kind="stable").tolist():
        far = (abs((tried[k] - one.offset_m + side_m / 2) % side_m - side_m / 2) for one in found)
        if all(apart_m > side_m / 5 for apart_m in far):
            found.append(Offset(float(tried[k]), float(on_lines[k] - on_lines.mean())))
        if len(found) == count:
            break
    return tuple(found)


def _counter_clockwise(ring: Array) -> Array:
    x, y = ring.T
    return ring if float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) > 0 else ring[::-1]

"""Measures the ground in a cell again, written from docs/skills.md, "Measures, exactly"."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import median

import numpy as np
import shapely  # type: ignore[import-untyped]
from numpy.typing import NDArray

from surefoot.verify.values import Rectangle

Array = NDArray[np.float64]
Box = tuple[tuple[float, float], tuple[float, float]]
"""A cell: from where to where it reaches along x, and along y."""

NEAR_M = 0.35
PIECE_M2 = 0.005
_SEAM_M = 2e-5
_SPECK_M2 = 1e-9
_SHADOW_M2 = 1e-4
_LAP_M = 0.02
_RIM_M = 0.03
_LONG = 3.0
_ONE_BAR, _NO_BAR = 10.0, 100.0


@dataclass(frozen=True, slots=True, eq=False)
class Plate:
    """A convex piece of ground: its corners seen from above with the margin put back, and its plane z = a x + b y + c.

    Attributes:
        outline: seen from above.
        plane: a, b and c.
    """

    outline: shapely.Polygon
    plane: Array

    @classmethod
    def of(cls, corners_m: Array, margin_m: float) -> Plate:
        """Return the plate of a polygon whose margin was taken off."""
        flat = np.column_stack((corners_m[:, :2], np.ones(len(corners_m))))
        plane: Array = np.linalg.lstsq(flat, corners_m[:, 2], rcond=None)[0].astype(np.float64)
        outline = shapely.Polygon(corners_m[:, :2]).buffer(margin_m + _SEAM_M, join_style="mitre")
        return cls(outline, plane)

    def height_m(self, part: shapely.Geometry) -> float:
        """Return the height above the middle of a part of it."""
        return float(self.plane @ (part.centroid.x, part.centroid.y, 1.0))

    @property
    def slope_deg(self) -> float:
        """How steep it is."""
        return math.degrees(math.atan(math.hypot(self.plane[0], self.plane[1])))


def measures(plates: Sequence[Plate], cell: Box, *, bars: bool) -> tuple[dict[str, float], float]:
    """Return the measures of a cell but for its rise, and the mean height of its ground (NaN without any)."""
    inside = [(one, part) for one in plates if (part := _within(one.outline, cell)).area > _SPECK_M2]
    level = inside if bars else ([(one, part) for one, part in inside if _reach(part.bounds) >= _RIM_M] or inside)
    heights = [one.height_m(part) for one, part in level]
    areas = [part.area for _, part in level]
    large = [height for height, area in zip(heights, areas, strict=True) if area >= PIECE_M2]
    found = {"spread_m": max(large) - min(large) if large else 0.0}
    mean_m = float(np.average(heights, weights=areas)) if inside else math.nan
    if bars:
        near = [one for one in plates if _meet(one.outline.bounds, _grown(cell, cell[0][1] - cell[0][0]))]
        lines = [line for one in near if (line := _middle_line(one.outline)) is not None]
        return found | {"across_m": _spread_of_bars(lines, cell, 0), "along_m": _spread_of_bars(lines, cell, 1)}, mean_m
    whole = shapely.union_all([part for _, part in inside])
    size = math.prod(high - low for low, high in cell)
    found["coverage"] = whole.area / size
    found["largest"] = max((part.area for part in shapely.get_parts(whole)), default=0.0) / size
    found["slope_deg"] = max((one.slope_deg for one, _ in level), default=0.0)
    found["band_m"] = max(_band(plates, cell, 0), _band(plates, cell, 1))
    found["spacing_m"] = _spacing(plates, cell)
    return found, mean_m


def _reach(bounds: Rectangle) -> float:
    return min(bounds[2] - bounds[0], bounds[3] - bounds[1])


def _within(shape: shapely.Geometry, box: Box) -> shapely.Geometry:
    (west, east), (south, north) = box
    return shapely.intersection(shape, shapely.box(west, south, east, north))


def _meet(bounds: Rectangle, box: Box) -> bool:
    (west, east), (south, north) = box
    return bounds[0] <= east and west <= bounds[2] and bounds[1] <= north and south <= bounds[3]


def _grown(box: Box, margin_m: float, axes: Sequence[int] = (0, 1)) -> Box:
    first, second = ((low - margin_m * (k in axes), high + margin_m * (k in axes)) for k, (low, high) in enumerate(box))
    return first, second


def _band(plates: Sequence[Plate], cell: Box, axis: int) -> float:
    """Return the widest stretch along an axis over which nothing lies, from side to side of the cell."""
    slab = _grown(cell, NEAR_M, (axis,))
    shadows = [part.bounds for one in plates if (part := _within(one.outline, slab)).area > _SHADOW_M2]
    spans = sorted((bounds[axis], bounds[axis + 2]) for bounds in shadows)
    low, high = cell[axis]
    widest, end = 0.0, -math.inf
    for start, stop in [*spans, (math.inf, math.inf)]:
        inside = min(start, high) - max(end, low)
        if inside > _LAP_M:
            widest = max(widest, start - end if math.isfinite(start - end) else inside)
        end = max(end, stop)
    return widest


def _spacing(plates: Sequence[Plate], cell: Box) -> float:
    """Return the median distance of the connected pieces in a cell to their nearest neighbours."""
    window = _grown(cell, NEAR_M)
    around = shapely.union_all([_within(one.outline, window) for one in plates])
    parts = [part for part in shapely.get_parts(around) if part.area >= PIECE_M2]
    own = [k for k, part in enumerate(parts) if _within(part, cell).area >= PIECE_M2]
    others = own if len(own) > 1 else range(len(parts))
    nearest = [min((parts[k].distance(parts[n]) for n in others if n != k), default=math.inf) for k in own]
    return median(nearest) if nearest else math.inf


def _middle_line(outline: shapely.Polygon) -> Array | None:
    """Return the ends of the middle line of a bar, the narrowest box about it; None for what is not long and thin."""
    corners = np.array(outline.convex_hull.exterior.coords)[:-1]
    best: tuple[float, Array, float] | None = None
    for begin, end in pairwise([*corners, corners[0]]):
        along = (end - begin) / max(float(np.linalg.norm(end - begin)), 1e-12)
        across = np.array([-along[1], along[0]])
        (a, b), (c, d) = ((float((corners @ way).min()), float((corners @ way).max())) for way in (along, across))
        if best is None or (b - a) * (d - c) < best[0]:
            long = b - a >= d - c
            middle = (a + b) / 2 * along + (c + d) / 2 * across
            half = (b - a) / 2 * along if long else (d - c) / 2 * across
            ratio = max(b - a, d - c) / max(min(b - a, d - c), 1e-12)
            best = (b - a) * (d - c), np.array([middle - half, middle + half]), ratio
    return None if best is None or best[2] < _LONG else best[1]


def _spread_of_bars(lines: Sequence[Array], cell: Box, axis: int) -> float:
    """Return the largest spacing along an axis of the bars across it that has its middle in the cell."""
    low, high = cell[axis]
    places = sorted(place for line in lines for place in _crossings(line, cell, axis))
    inside = [place for place in places if low - 1e-9 <= place <= high + 1e-9]
    if len(inside) < 2:
        return _ONE_BAR if inside else _NO_BAR
    widths = [b - a for a, b in pairwise(places) if low <= (a + b) / 2 <= high]
    if places[0] == inside[0]:
        widths.append(inside[0] - low)
    if places[-1] == inside[-1]:
        widths.append(high - inside[-1])
    return max(widths)


def _crossings(line: Array, cell: Box, axis: int) -> Iterator[float]:
    """Yield where a bar across an axis passes the middle of a cell, if it passes at least half of the cell."""
    side = 1 - axis
    first, last = line[np.argsort(line[:, side])]
    if last[side] - first[side] <= abs(last[axis] - first[axis]):
        return
    low, high = cell[side]
    if min(last[side], high) - max(first[side], low) < (high - low) / 2:
        return
    part = ((low + high) / 2 - first[side]) / (last[side] - first[side])
    yield float(first[axis] + part * (last[axis] - first[axis]))


def without(corners_m: Sequence[Array], hole: Rectangle) -> list[Array]:
    """Return convex pieces of polygons that are outside of a rectangle: beside it, then before and behind it."""
    west, south, east, north = hole
    boxes = (
        ((-math.inf, west), (-math.inf, math.inf)),
        ((east, math.inf), (-math.inf, math.inf)),
        ((west, east), (-math.inf, south)),
        ((west, east), (north, math.inf)),
    )
    left = []
    for corners in corners_m:
        (x0, y0), (x1, y1) = corners[:, :2].min(axis=0), corners[:, :2].max(axis=0)
        if x1 < west or east < x0 or y1 < south or north < y0:
            left.append(corners)
            continue
        pieces = [_clipped(corners, box) for box in boxes]
        left += [piece for piece in pieces if _area(piece) >= LEAST_M2]
    return left


LEAST_M2 = 1e-5
"""Smaller leftovers of a polygon that was cut are no ground any more."""


def _clipped(corners: Array, box: Box) -> Array:
    """Return the part of a convex polygon that lies above a box."""
    for axis, (low, high) in enumerate(box):
        for bound, sign in ((low, -1.0), (high, 1.0)):
            corners = _cut_off(corners, sign * corners[:, axis] - sign * bound) if math.isfinite(bound) else corners
    return corners


def _cut_off(corners: Array, beyond: Array) -> Array:
    """Return what is left of a convex polygon when the part with positive distances is cut off."""
    kept: list[Array] = []
    for k in range(len(corners)):
        here, there = beyond[k], beyond[(k + 1) % len(corners)]
        if here <= 0:
            kept.append(corners[k])
        if (here < 0 < there) or (there < 0 < here):
            kept.append(corners[k] + here / (here - there) * (corners[(k + 1) % len(corners)] - corners[k]))
    return np.array(kept).reshape(-1, 3)


def _area(corners: Array) -> float:
    if len(corners) < 3:
        return 0.0
    x, y = corners[:, 0], corners[:, 1]
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2

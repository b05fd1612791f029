"""What is measured of the ground in a cell, so that rules can tell its class.

Margins that were taken off polygons are put back first. Ground that two cells share is seen through a window around
the cell: a gap that is cut by a cell's side has its whole width, and a stone's neighbour may stand in the next cell.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
import shapely  # type: ignore[import-untyped]

from surefoot.footholds.terrain import Polygon
from surefoot.skills.patches import Rectangle

WINDOW_M = 0.35
SLIVER_M = 0.03
"""What reaches less far into a cell is the edge of a neighbour's ground: it has no say in the cell's height."""
_PIECE_M2 = 0.005
_TOUCH_M = 0.02
_BAR_ASPECT = 3.0
_JOIN_M = 2e-5
"""What touches is one piece, in spite of rounded corners."""
SINGLE, NONE = 10.0, 100.0
"""Measures of a single bar, which has no spacing, and of no bar."""


@dataclass(frozen=True, slots=True)
class Measured:
    """The measures of a cell.

    Attributes:
        values: by name, without the height's relation to the robot.
        height_m: mean height of the ground, by area; NaN without ground.
    """

    values: Mapping[str, float]
    height_m: float

    def seen_from(self, support_m: float) -> dict[str, float]:
        """Return all measures for a robot that stands at a height."""
        rise = self.height_m - support_m
        return {**self.values, "rise_m": round(rise, 6) if math.isfinite(rise) else 0.0}

    def turned(self, quarter_turns: int) -> Measured:
        """Return what a robot measures that is turned that many times by 90 degrees."""
        if quarter_turns % 2 == 0 or "across_m" not in self.values:
            return self
        swapped = {**self.values, "across_m": self.values["along_m"], "along_m": self.values["across_m"]}
        return Measured(swapped, self.height_m)


class Ground:
    """The polygons of a terrain, ready to be measured.

    Args:
        polygons: where a foot may stand.
        margin_m: what was taken off their edges.
        kind: ``ground`` or ``bars``.
    """

    def __init__(self, polygons: Sequence[Polygon], margin_m: float, kind: str) -> None:
        self.polygons, self.kind = tuple(polygons), kind
        outlines = [shapely.Polygon(one.vertices_m[:, :2]) for one in polygons]
        self.shapes: list[Any] = [one.buffer(margin_m + _JOIN_M, join_style="mitre") for one in outlines]
        self.tree = shapely.STRtree(self.shapes)

    def measure(self, cell: Rectangle) -> Measured:
        """Return the measures of a cell whose sides lie along x and y."""
        inside = [one for k in self._near(cell) if (one := self._cut(k, cell)).area > 1e-9]
        level = inside if self.kind == "bars" else ([one for one in inside if one.reach_m >= SLIVER_M] or inside)
        areas = np.array([one.area for one in level])
        heights = np.array([one.height_m for one in level])
        large = heights[areas >= _PIECE_M2]
        values = {"spread_m": round(float(np.ptp(large)), 6) if len(large) else 0.0}
        values |= self._bars(cell) if self.kind == "bars" else self._ground(cell, inside, level)
        return Measured(values, float(areas @ heights / areas.sum()) if len(level) else math.nan)

    def _near(self, cell: Rectangle) -> list[int]:
        return sorted(self.tree.query(shapely.box(cell.west, cell.south, cell.east, cell.north)).tolist())

    def _cut(self, number: int, cell: Rectangle) -> _Piece:
        shape = shapely.clip_by_rect(self.shapes[number], cell.west, cell.south, cell.east, cell.north)
        return _Piece(shape, self.polygons[number])

    def _ground(self, cell: Rectangle, inside: list[_Piece], level: list[_Piece]) -> dict[str, float]:
        area = (cell.east - cell.west) * (cell.north - cell.south)
        joined = shapely.union_all([one.shape for one in inside])
        parts = [part.area for part in shapely.get_parts(joined)]
        window = cell.shrunk(-WINDOW_M)
        around = shapely.union_all([self._cut(k, window).shape for k in self._near(window)])
        slopes = [math.degrees(math.acos(min(float(one.polygon.normal[2]), 1.0))) for one in level]
        return {
            "coverage": round(joined.area / area, 6),
            "largest": round(max(parts, default=0.0) / area, 6),
            "band_m": round(max(self._band(cell, along=0), self._band(cell, along=1)), 6),
            "spacing_m": _spacing(around, cell),
            "slope_deg": round(max(slopes, default=0.0), 6),
        }

    def _band(self, cell: Rectangle, *, along: int) -> float:
        """Return the width of the widest band without ground across a cell, along x (0) or y (1)."""
        low, high = (cell.west, cell.east) if along == 0 else (cell.south, cell.north)
        slab = (
            Rectangle(cell.west - WINDOW_M, cell.south, cell.east + WINDOW_M, cell.north)
            if along == 0
            else Rectangle(cell.west, cell.south - WINDOW_M, cell.east, cell.north + WINDOW_M)
        )
        pieces = [one for k in self._near(slab) if (one := self._cut(k, slab)).area > 1e-4]
        spans = sorted((one.shape.bounds[along], one.shape.bounds[along + 2]) for one in pieces)
        widest, reached = 0.0, -math.inf
        for begin, end in [*spans, (math.inf, math.inf)]:
            if begin > reached and min(begin, high) - max(reached, low) > _TOUCH_M:
                bounded = math.isfinite(begin) and math.isfinite(reached)
                widest = max(widest, begin - reached if bounded else min(begin, high) - max(reached, low))
            reached = max(reached, end)
        return widest

    def _bars(self, cell: Rectangle) -> dict[str, float]:
        return {"across_m": self._spacing_of_bars(cell, axis=0), "along_m": self._spacing_of_bars(cell, axis=1)}

    def _spacing_of_bars(self, cell: Rectangle, *, axis: int) -> float:
        """Return the largest spacing along an axis of the bars that lie across that axis."""
        low, high = (cell.west, cell.east) if axis == 0 else (cell.south, cell.north)
        side = high - low
        window = cell.shrunk(-side)
        places = sorted(
            place for k in self._near(window) if (place := self._place(self._lines[k], cell, axis)) is not None
        )
        within = [place for place in places if low - 1e-9 <= place <= high + 1e-9]
        if len(within) < 2:
            return SINGLE if within else NONE
        spans = [b - a for a, b in pairwise(places) if low <= (a + b) / 2 <= high]
        open_ends = [within[0] - low] * (places[0] == within[0]) + [high - within[-1]] * (places[-1] == within[-1])
        return round(max([*spans, *open_ends]), 6)

    @cached_property
    def _lines(self) -> list[Any]:
        """Centre lines of the bars; None for polygons that are none."""
        return [_centre_line(shape) for shape in self.shapes]

    def _place(self, line: Any, cell: Rectangle, axis: int) -> float | None:
        """Return where a bar across an axis passes the middle of a cell; None if it lies along it or elsewhere."""
        if line is None:
            return None
        (a, b) = line
        across = 1 - axis
        if abs(b[across] - a[across]) <= abs(b[axis] - a[axis]):
            return None
        low, high = (cell.south, cell.north) if axis == 0 else (cell.west, cell.east)
        begin, end = sorted((a[across], b[across]))
        if min(end, high) - max(begin, low) < (high - low) / 2:
            return None
        part = ((low + high) / 2 - a[across]) / (b[across] - a[across])
        return float(a[axis] + part * (b[axis] - a[axis]))


class _Piece:
    """A polygon cut to a rectangle."""

    def __init__(self, shape: Any, polygon: Polygon) -> None:
        self.shape, self.polygon = shape, polygon
        self.area = float(shape.area)

    @property
    def reach_m(self) -> float:
        """Its lesser extent along x or y."""
        west, south, east, north = self.shape.bounds
        return float(min(east - west, north - south))

    @property
    def height_m(self) -> float:
        """Height of its plane above its centre."""
        centre, normal = self.shape.centroid, self.polygon.normal
        return float((self.polygon.offset - normal[0] * centre.x - normal[1] * centre.y) / normal[2])


def _spacing(around: Any, cell: Rectangle) -> float:
    """Return the median distance of the parts in a cell to the nearest other one in it.

    One part alone is measured to what stands around the cell; the distance is infinite where there is nothing.
    """
    parts = [part for part in shapely.get_parts(around) if part.area >= _PIECE_M2]
    box = shapely.box(cell.west, cell.south, cell.east, cell.north)
    within = [part for part in parts if part.intersection(box).area >= _PIECE_M2]
    others = within if len(within) > 1 else parts
    distances = [
        min((part.distance(other) for other in others if other is not part), default=math.inf) for part in within
    ]
    return round(float(np.median(distances)), 6) if distances else math.inf


def _centre_line(shape: Any) -> Any:
    """Return the ends of a bar's centre line, shape (2, 2); None for what is not long and thin."""
    corners = shapely.get_coordinates(shape.minimum_rotated_rectangle)[:4]
    if len(corners) < 4:
        return None
    sides = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)
    first = int(np.argmin(sides))
    if sides[(first + 1) % 4] < _BAR_ASPECT * sides[first]:
        return None
    turned = np.roll(corners, -first, axis=0)
    return np.array([turned[:2].mean(axis=0), turned[2:].mean(axis=0)])

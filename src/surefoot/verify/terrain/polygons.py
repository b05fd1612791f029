"""Checks a saved terrain file against the scan that it names; written from formats.md, section "Terrain".

Every polygon has to be convex, planar and not too steep, and to lie on measured ground within the errors that the file
states: no cell below it may be a hole (narrow dropouts apart), and the ground averaged over 3 x 3 cells of the polygon,
like every single cell, may be no farther from its plane than stated.
"""

from __future__ import annotations

import hashlib
import math
from pathlib import Path

import numpy as np
import shapely  # type: ignore[import-untyped]
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.verify.artefacts import read_fields
from surefoot.verify.findings import Ledger
from surefoot.verify.terrain.statements import (
    Piece,
    check_narrow,
    check_regions,
    check_shares,
    check_shares_of_regions,
    check_warnings,
)
from surefoot.verify.values import Fields
from surefoot.world.elevation import ElevationMap
from surefoot.world.elevation_readers import read_elevation
from surefoot.world.planar_regions import PlanarRegion, read_planar_regions

FLAT_M = 1e-6
CONVEX_M = 1e-9
SLACK_M = 1e-6
LONGEST_DROPOUT_M = 0.1
LONGEST_DROPOUT_CELLS = 5
Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Numbers = NDArray[np.floating]


def check_terrain(path: Path, ledger: Ledger) -> None:
    """Check a terrain file.

    Args:
        path: of the file.
        ledger: takes the findings and counts.

    Raises:
        InputError: the file or its scan cannot be read, or the scan has changed.
    """
    fields = read_fields(path, "terrain")
    options, stated = fields.mapping("options"), fields.mapping("statistics")
    polygons, sources = fields.items("polygons"), fields.items("sources")
    if len(polygons) != len(sources):
        raise fields.wrong("sources", "has to be as long as polygons")
    shapes = [
        _Polygon(Fields.of(one, path, f"polygons[{k}]"), Fields.of(source, path, f"sources[{k}]"), k)
        for k, (one, source) in enumerate(zip(polygons, sources, strict=True))
    ]
    steepest = options.number("max_slope_deg")
    good = [shape for shape in shapes if shape.check(steepest, ledger)]
    friction = options.number("friction", least=0.0)
    for shape in shapes:
        if shape.friction != friction:
            ledger.refuse("terrain, friction", "is not that of the options", f"polygons[{shape.number}].friction")
    area_m2 = sum(shape.area_m2() for shape in good)
    if len(good) == len(shapes) and abs(area_m2 - stated.number("area_m2")) > 1e-6 * max(area_m2, 1.0):
        ledger.refuse(
            "terrain, area", f"the polygons measure {area_m2:.6g} m2, not what is stated", "statistics.area_m2"
        )
    ledger.counts.update({"polygons": len(shapes), "area_m2": area_m2})
    source, reading = _input(fields, path)
    whole = len(good) == len(shapes)
    if reading.get("as") == "planar regions":
        given = _check_on_regions(source, reading, good, ledger)
        if whole:
            check_regions(fields, [shape.piece(0) for shape in shapes], ledger)
            check_shares_of_regions(fields, *_areas(given, options), ledger)
        return
    scan = _scan(source, reading)
    ground = _Ground(scan, options.number("fill_m"))
    errors = (stated.number("max_plane_error_m"), stated.number("max_cell_error_m"))
    if errors[0] > options.number("max_error_m") + SLACK_M:
        ledger.refuse("terrain, error", "the stated plane error is above the limit", "statistics.max_plane_error_m")
    below = {shape.number: ground.check(shape, errors, ledger) for shape in good if shape.region >= 0}
    if whole:
        pieces = [shape.piece(below.get(shape.number, 0)) for shape in shapes]
        regions = check_regions(fields, pieces, ledger)
        check_shares(fields, scan, pieces, regions, int(ground.dropout.sum()), ledger)
        things = check_narrow(fields, scan, pieces, ledger)
        check_warnings(fields, scan.resolution_m, things, ground.dropouts, ledger)
    ledger.counts.update({"cells": ground.cells, "dropouts": ground.dropouts, "largest_error_m": ground.largest_m})


class _Polygon:
    """One polygon of the file."""

    def __init__(self, fields: Fields, source: Fields, number: int) -> None:
        rows = fields.items("vertices_m")
        place = f"{fields.place}.vertices_m"
        named = [Fields({"p": row}, fields.source, place) for row in rows]
        self.points = np.array([row.numbers("p", 3) for row in named], np.float64).reshape(-1, 3)
        self.friction = fields.number("friction", least=0.0)
        self.number = number
        self.region = source.whole("region", least=-1)
        self.normal = np.array(source.numbers("normal", 3))
        self.offset_m = source.number("offset_m")

    def check(self, steepest_deg: float, ledger: Ledger) -> bool:
        """Note what is wrong with the shape; return whether it can be looked at further."""
        where = f"polygons[{self.number}]"
        before = ledger.total
        if len(self.points) < 3:
            ledger.refuse("terrain, shape", "has fewer than three vertices", where)
            return False
        if abs(float(np.linalg.norm(self.normal)) - 1) > 1e-9 or self.normal[2] <= 0:
            ledger.refuse("terrain, plane", "the normal is no unit vector that points up", where)
            return False
        if float(self.normal[2]) < math.cos(math.radians(steepest_deg)) - 1e-9:
            ledger.refuse("terrain, slope", "is steeper than the limit", where)
        if np.abs(self.points @ self.normal - self.offset_m).max() > FLAT_M:
            ledger.refuse("terrain, plane", "a vertex is off the stated plane", where)
        edges = np.roll(self.points, -1, axis=0) - self.points
        turns = _cross(edges[:, :2], np.roll(edges, -1, axis=0)[:, :2])
        lengths = np.hypot(edges[:, 0], edges[:, 1])
        if lengths.min() <= 0 or (turns < -CONVEX_M * lengths.max()).any() or not self._winds_once(edges):
            ledger.refuse("terrain, convex", "is not convex, counter-clockwise and simple", where)
        elif self.area_m2() <= 0:
            ledger.refuse("terrain, shape", "has no area", where)
        return ledger.total == before

    def _winds_once(self, edges: Floats) -> bool:
        angles = np.arctan2(edges[:, 1], edges[:, 0])
        steps = np.remainder(np.roll(angles, -1) - angles + math.pi, 2 * math.pi) - math.pi
        return abs(float(steps.sum()) - 2 * math.pi) < 1e-6

    def area_m2(self) -> float:
        """Return the area in the polygon's own plane."""
        first = self.points[0]
        spans = np.cross(self.points[1:-1] - first, self.points[2:] - first)
        return 0.5 * float(np.linalg.norm(spans.sum(axis=0)))

    def piece(self, cells: int) -> Piece:
        """Return what statements about polygons are compared with."""
        return Piece(self.region, self.points, self.normal, self.area_m2(), cells)

    def contains(self, x: Numbers, y: Numbers) -> Flags:
        """Return which places, seen from above, lie in the polygon."""
        inside = np.ones(x.shape, np.bool_)
        for (ax, ay, _), (bx, by, _) in zip(self.points, np.roll(self.points, -1, axis=0), strict=True):
            inside &= (bx - ax) * (y - ay) - (by - ay) * (x - ax) >= -1e-12
        return inside

    def height_m(self, x: Numbers, y: Numbers) -> Floats:
        """Return the height of the plane."""
        height: Floats = (self.offset_m - self.normal[0] * x - self.normal[1] * y) / self.normal[2]
        return height


class _Ground:
    """The scan below polygons."""

    def __init__(self, scan: ElevationMap, fill_m: float) -> None:
        self.scan = scan
        self.empty = np.isnan(scan.height_m)
        self.dropout = _narrow_gaps(self.empty, scan.resolution_m, fill_m)
        self.cells = self.dropouts = 0
        self.largest_m = 0.0

    def check(self, shape: _Polygon, errors: tuple[float, float], ledger: Ledger) -> int:
        """Compare one polygon with the cells whose centres lie below it, and those below its corners; count these."""
        where = f"polygons[{shape.number}]"
        cell_m, (west, south) = self.scan.resolution_m, self.scan.origin_m
        rows_all, columns_all = self.scan.height_m.shape
        low, high = shape.points[:, :2].min(axis=0), shape.points[:, :2].max(axis=0)
        first, last = _index(low[0] - west, cell_m), _index(high[0] - west, cell_m)
        top, bottom = rows_all - 1 - _index(high[1] - south, cell_m), rows_all - 1 - _index(low[1] - south, cell_m)
        if first < 0 or top < 0 or last >= columns_all or bottom >= rows_all:
            ledger.refuse("terrain, hole", "reaches beyond the scan", where)
            return 0
        columns, rows = np.meshgrid(np.arange(first, last + 1), np.arange(top, bottom + 1))
        x, y = west + (columns + 0.5) * cell_m, south + (rows_all - rows - 0.5) * cell_m
        below = shape.contains(x, y)
        corners = np.zeros_like(below)
        for px, py, _ in shape.points:
            corners[rows_all - 1 - _index(py - south, cell_m) - top, _index(px - west, cell_m) - first] = True
        holes = (below | corners) & self.empty[rows, columns]
        if (holes & ~self.dropout[rows, columns]).any():
            ledger.refuse(
                "terrain, hole", f"covers {int((holes & ~self.dropout[rows, columns]).sum())} empty cells", where
            )
        apart = np.where(
            below & ~self.empty[rows, columns], self.scan.height_m[rows, columns] - shape.height_m(x, y), np.nan
        )
        self.cells += int(below.sum())
        self.dropouts += int((holes & self.dropout[rows, columns]).sum())
        self._compare(apart, errors, where, ledger)
        return int(below.sum())

    def _compare(self, apart: Floats, errors: tuple[float, float], where: str, ledger: Ledger) -> None:
        known = ~np.isnan(apart)
        if not known.any():
            return
        if np.abs(apart[known]).max() > errors[1] + SLACK_M:
            ledger.refuse(
                "terrain, cells", f"a cell is {np.abs(apart[known]).max():.4f} m off, more than stated", where
            )
        framed, weight = np.pad(np.where(known, apart, 0.0), 1), np.pad(known.astype(np.float64), 1)
        rows, columns = apart.shape
        spots = [(i, j) for i in range(3) for j in range(3)]
        total = sum(framed[i : i + rows, j : j + columns] for i, j in spots)
        count = sum(weight[i : i + rows, j : j + columns] for i, j in spots)
        whole = known & (np.asarray(count) == 9)
        if whole.any():
            worst = float(np.abs(np.asarray(total)[whole] / 9).max())
            self.largest_m = max(self.largest_m, worst)
            if worst > errors[0] + SLACK_M:
                ledger.refuse("terrain, error", f"the ground is {worst:.4f} m off the plane, more than stated", where)


def _narrow_gaps(empty: Flags, cell_m: float, fill_m: float) -> Flags:
    """Return the empty cells that no empty square wider than ``fill_m`` covers, and that are in short groups."""
    narrow = empty.copy()
    if fill_m <= 0 or not empty.any():
        return np.zeros_like(empty)
    side = max(1, math.floor(fill_m / cell_m + 1e-6)) + 1
    framed = np.pad(empty, side, constant_values=True)
    rows, columns = framed.shape
    full = np.ones((rows - side + 1, columns - side + 1), np.bool_)
    for i in range(side):
        for j in range(side):
            full &= framed[i : i + full.shape[0], j : j + full.shape[1]]
    covered = np.zeros_like(framed)
    for i in range(side):
        for j in range(side):
            covered[i : i + full.shape[0], j : j + full.shape[1]] |= full
    narrow &= ~covered[side:-side, side:-side]
    return _short_groups(narrow, max(LONGEST_DROPOUT_CELLS, round(LONGEST_DROPOUT_M / cell_m)))


def _short_groups(cells: Flags, longest: int) -> Flags:
    """Return the cells in groups (joined by sides) that extend over at most so many rows and columns."""
    kept = np.zeros_like(cells)
    left = {(int(r), int(c)) for r, c in np.argwhere(cells)}
    while left:
        group, open_ = [], [left.pop()]
        while open_:
            r, c = open_.pop()
            group.append((r, c))
            for place in ((r + 1, c), (r - 1, c), (r, c + 1), (r, c - 1)):
                if place in left:
                    left.remove(place)
                    open_.append(place)
        table = np.array(group)
        if (np.ptp(table, axis=0) < longest).all():
            kept[table[:, 0], table[:, 1]] = True
    return kept


def _check_on_regions(
    source: Path, reading: dict[str, object], shapes: list[_Polygon], ledger: Ledger
) -> tuple[PlanarRegion, ...]:
    """Check that every polygon of given regions lies on a plane of theirs, within its outline and off its holes."""
    topic = reading.get("topic")
    number = reading.get("message", -1)
    regions = read_planar_regions(
        source, topic=topic if isinstance(topic, str) else None, message=number if isinstance(number, int) else -1
    )
    for shape in shapes:
        middle = shape.points.mean(axis=0)
        probes = np.vstack([shape.points + share * (middle - shape.points) for share in (1e-6, 0.5)])
        if not any(
            _lies_in(probes, region.position_m, region.rotation, region.outer_m, region.holes_m) for region in regions
        ):
            ledger.refuse("terrain, region", "lies in none of the given regions", f"polygons[{shape.number}]")
    return regions


def _areas(regions: tuple[PlanarRegion, ...], options: Fields) -> tuple[list[tuple[float, float]], int]:
    """Return the areas of regions that are not too steep, before and after the margin, and how many are too steep."""
    upright = math.cos(math.radians(options.number("max_slope_deg")))
    flat = [one for one in regions if abs(float(one.rotation[2, 2])) >= upright]
    areas = []
    for one in flat:
        outline = shapely.make_valid(shapely.Polygon(one.outer_m))
        for hole in one.holes_m:
            outline = shapely.difference(outline, shapely.make_valid(shapely.Polygon(hole)))
        margin_m = options.number("margin_m", least=0.0)
        inset = shapely.buffer(outline, -margin_m, join_style="mitre", mitre_limit=3.0)
        areas.append((float(outline.area), float(inset.area)))
    return areas, len(regions) - len(flat)


def _lies_in(points: Floats, position: Floats, rotation: Floats, outer: Floats, holes: tuple[Floats, ...]) -> bool:
    own = (points - position) @ rotation
    if np.abs(own[:, 2]).max() > 1e-6:
        return False
    inside = _even_odd(own[:, :2], outer)
    return bool(inside.all()) and not any(_even_odd(own[:, :2], hole).any() for hole in holes)


def _even_odd(points: Floats, ring: Floats) -> Flags:
    inside = np.zeros(len(points), np.bool_)
    for (ax, ay), (bx, by) in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        if ay == by:
            continue
        spans = (ay > points[:, 1]) != (by > points[:, 1])
        inside ^= spans & (points[:, 0] < ax + (points[:, 1] - ay) / (by - ay) * (bx - ax))
    return inside


def _input(fields: Fields, path: Path) -> tuple[Path, dict[str, object]]:
    """Return the file that the terrain was made from, after comparing its hash, and how it was read."""
    made_from = fields.mapping("input")
    name = made_from.text("path")
    if Path(name).is_absolute():
        raise made_from.wrong("path", "has to be relative to the artefact's own folder")
    source = path.parent / name
    try:
        if source.is_dir():
            lines = [f"{item.name} {_sha256(item)}\n" for item in sorted(source.iterdir()) if item.is_file()]
            found = hashlib.sha256("".join(lines).encode()).hexdigest()
        else:
            found = _sha256(source)
    except OSError as problem:
        raise InputError("cannot be read; the terrain was made from it", source=source) from problem
    if found != made_from.text("sha256"):
        raise made_from.wrong("sha256", f"does not fit {name}: the terrain was made from another version of it")
    return source, dict(made_from.mapping("reading").values)


def _sha256(path: Path) -> str:
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _scan(source: Path, reading: dict[str, object]) -> ElevationMap:
    """Read the scan again, as the file says that it was read."""
    kind = reading.get("as")
    if kind == "grid map":
        topic, layer, number = reading.get("topic"), reading.get("layer"), reading.get("message")
        return read_elevation(
            source,
            topic=topic if isinstance(topic, str) else None,
            layer=layer if isinstance(layer, str) else None,
            message=number if isinstance(number, int) else -1,
        )
    values = Fields(reading, source, "input.reading")
    span = None if reading.get("height_range_m") is None else values.numbers("height_range_m", 2)
    no_data, name = reading.get("no_data"), reading.get("name")
    return read_elevation(
        source,
        resolution_m=values.number("resolution_m"),
        height_range_m=None if span is None else (span[0], span[1]),
        origin_m=values.point("origin_m"),
        layer=name if isinstance(name, str) else None,
        no_data=no_data if isinstance(no_data, int) else None,
    )


def _index(distance_m: float, cell_m: float) -> int:
    return math.floor(distance_m / cell_m)


def _cross(a: Floats, b: Floats) -> Floats:
    turn: Floats = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return turn

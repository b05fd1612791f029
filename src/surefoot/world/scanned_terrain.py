"""Turns a scan into terrain polygons: its planar regions, the foot margin taken off, split into convex pieces."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.world.elevation import ElevationMap, elevation_map
from surefoot.world.narrow_things import NarrowThing
from surefoot.world.segmentation import CellClass, Segmentation, SegmentOptions, segment
from surefoot.world.terrain_polygons import Terrain, TerrainPolygon, TerrainRegion

Floats = NDArray[np.float64]
_BATCH_CELLS = 8_000_000
_INSIDE_CELLS = 1e-6
"""Without a margin too, polygons end before the scan does."""


def segment_terrain(elevation: ElevationMap, options: SegmentOptions | None = None) -> Terrain:
    """Return the steppable polygons of an elevation map.

    Args:
        elevation: the heights.
        options: limits; None means the defaults.

    Returns:
        The polygons, with measures of what was kept and how well they fit.
    """
    options = options or SegmentOptions()
    begin = time.perf_counter()
    found = segment(elevation, options)
    builder = _Builder(elevation, options, found)
    builder.add_regions()
    return builder.terrain(begin)


def warm_up() -> None:
    """Compile the sweeps (or load them from the cache), so that times measured afterwards are those of the work."""
    rows, columns = np.indices((12, 12))
    heights = np.where(columns < 6, 0.0, 0.2) + 1e-3 * ((rows + columns) % 2)
    heights[5, 5] = np.nan
    segment_terrain(elevation_map(heights, 0.02))


@dataclass(frozen=True, slots=True, eq=False)
class _Region:
    """A region of cells: which, where they are, the cells without data around, and its plane in the world."""

    label: int
    place: tuple[slice, slice]
    size: int
    mask: NDArray[np.bool_]
    around: NDArray[np.bool_]
    normal: tuple[float, float, float]
    offset_m: float


class _Builder:
    """Collects polygons of regions; it lives within one call of ``segment_terrain``."""

    def __init__(self, elevation: ElevationMap, options: SegmentOptions, found: Segmentation) -> None:
        self.elevation, self.options, self.found = elevation, options, found
        self.polygons: list[TerrainPolygon] = []
        self.regions: list[TerrainRegion] = []
        self.taken = np.zeros(found.labels.shape, np.bool_)
        self.empty = np.pad(found.holes, 2)
        self.holed = bool(found.holes.any())
        self.classes = found.classes.copy()
        self.plain_m2 = 0.0
        self.flat_m2 = 0.0
        self.small = 0
        self.small_m2 = 0.0
        self.error_m = 0.0
        self.cell_error_m = 0.0

    def add_regions(self) -> None:
        """Add the polygons of every region, largest region first."""
        from scipy import ndimage

        labels = self.found.labels
        places = ndimage.find_objects(labels)
        sizes = np.bincount(labels.ravel(), minlength=len(places) + 1)
        batch: list[_Region] = []
        cells = 0
        for label in np.argsort(-sizes[1:], kind="stable") + 1:
            if sizes[label] and places[label - 1] is not None:
                batch.append(self._region(int(label), places[label - 1], int(sizes[label])))
                cells += batch[-1].mask.size
                if cells > _BATCH_CELLS:
                    self._add_batch(batch)
                    batch, cells = [], 0
        self._add_batch(batch)

    def _region(self, label: int, place: tuple[slice, slice], size: int) -> _Region:
        normal, offset_m = self._plane(label)
        mask = self.found.labels[place] == label
        around = self.empty[place[0].start : place[0].stop + 4, place[1].start : place[1].stop + 4]
        return _Region(label, place, size, mask, around, normal, offset_m)

    def _add_batch(self, batch: list[_Region]) -> None:
        """Add the polygons of regions whose outlines are worked out together."""
        from surefoot.world.simple_outlines import inset_outlines

        cell_m, least_m2 = self.elevation.resolution_m, self.options.min_area_m2
        upright = math.cos(math.radians(self.options.max_slope_deg))
        flat = [region for region in batch if region.normal[2] >= upright]
        least_cells = [least_m2 * region.normal[2] / cell_m**2 for region in flat]
        empty = [region.around for region in flat]
        insets = inset_outlines([region.mask for region in flat], self.options.margin_m / cell_m, least_cells, empty)
        for region in batch:
            if region.normal[2] < upright:
                self.classes[region.place][region.mask] = CellClass.STEEP
        for region, (inset, plain_cells) in zip(flat, insets, strict=True):
            self._add_region(region, inset, plain_cells)

    def _add_region(self, region: _Region, inset: Any, plain_cells: float) -> None:
        from surefoot.world.convex_pieces import area_of
        from surefoot.world.outlines import clear_of, within

        cell_m, place, mask = self.elevation.resolution_m, region.place, region.mask
        normal, offset_m, rise = region.normal, region.offset_m, region.normal[2]
        least_m2 = self.options.min_area_m2 * rise
        inset = within(inset, self._extent(place)) if not inset.is_empty else inset
        parts, pieces = self._pieces(inset, place, least_m2)
        if self._enter_holes(pieces):
            parts, pieces = self._pieces(clear_of(inset, region.around), place, least_m2)
        areas = [area_of(piece) for piece in pieces]
        kept = [piece for piece, area in zip(pieces, areas, strict=True) if area >= least_m2]
        lost = [*(area for area in areas if area < least_m2), *(part.area for part in parts if part.area < least_m2)]
        self.plain_m2 += plain_cells * cell_m**2
        self.small += len(lost)
        self.small_m2 += sum(lost)
        if inset.is_empty and plain_cells > 0:
            self.small, self.small_m2 = self.small + 1, self.small_m2 + plain_cells * cell_m**2
        if not kept:
            self.classes[place][mask] = CellClass.SMALL
            return
        number, first = len(self.regions), len(self.polygons)
        self.polygons += [_lifted(piece, normal, offset_m, self.options.friction, number) for piece in kept]
        self.taken[place] |= mask
        flat_m2 = sum(area_of(piece) for piece in kept)
        self.flat_m2 += flat_m2
        error_m = self._measure(place, region.label)
        indices = tuple(range(first, len(self.polygons)))
        self.regions.append(
            TerrainRegion(normal, offset_m, region.size * cell_m**2 / rise, flat_m2 / rise, indices, error_m)
        )

    def _pieces(self, inset: Any, place: tuple[slice, slice], least_m2: float) -> tuple[Any, list[Floats]]:
        """Return the parts of an outline in the world, and the convex pieces of those that are large enough."""
        import shapely  # type: ignore[import-untyped]

        parts = shapely.get_parts(self._placed(inset, place))
        return parts, [piece for part in parts if part.area >= least_m2 for piece in _large_pieces(part, least_m2)]

    def _enter_holes(self, pieces: list[Floats]) -> bool:
        """Return whether a cell without data holds a vertex: where pieces were cut, there are new ones."""
        if not pieces or not self.holed:
            return False
        points = np.concatenate(pieces)
        x, y = self.elevation.origin_m
        cell_m, rows = self.elevation.resolution_m, len(self.empty) - 4
        column = np.floor((points[:, 0] - x) / cell_m).astype(np.intp)
        row = rows - 1 - np.floor((points[:, 1] - y) / cell_m).astype(np.intp)
        return bool(self.empty[row + 2, column + 2].any())

    def _extent(self, place: tuple[slice, slice]) -> tuple[float, float, float, float]:
        """Return the least and largest column and row of the scan, margin off, as positions in a place of the map."""
        from surefoot.world.outlines import taken_off

        off = max(taken_off(self.options.margin_m / self.elevation.resolution_m), _INSIDE_CELLS) - 0.5
        rows, columns = self.found.labels.shape
        top, left = place[0].start, place[1].start
        return off - left, off - top, columns - 1 - off - left, rows - 1 - off - top

    def _measure(self, place: tuple[slice, slice], label: int) -> float:
        """Return the largest distance of the ground from the plane, and remember the largest of all regions."""
        from surefoot.world._plane_kernels import largest_misses

        heights, found = self.elevation.height_m, self.found
        (top, left), (rows, columns) = (one.start for one in place), (one.stop - one.start for one in place)
        plane = found.planes[label]
        mean, single = largest_misses(heights, found.labels, found.misses_m, label, plane, top, left, rows, columns)
        self.error_m, self.cell_error_m = max(self.error_m, mean), max(self.cell_error_m, single)
        return float(mean)

    def _plane(self, label: int) -> tuple[tuple[float, float, float], float]:
        """Return unit normal and offset of a region's plane in the world."""
        a, b, d = self.found.planes[label]
        cell_m = self.elevation.resolution_m
        slope = np.array([b / cell_m, -d / cell_m])
        x, y = self.elevation.place_m(np.zeros(1), np.zeros(1))[0]
        level = a - slope[0] * x - slope[1] * y
        scale = 1 / math.sqrt(1 + float(slope @ slope))
        return (-float(slope[0]) * scale, -float(slope[1]) * scale, scale), float(level) * scale

    def _placed(self, shape: Any, place: tuple[slice, slice]) -> Any:
        """Return a shape in (column, row) coordinates of a place of the map in world coordinates, seen from above."""
        import shapely

        def moved(points: Floats) -> Floats:
            return self.elevation.place_m(points[:, 0] + place[1].start, points[:, 1] + place[0].start)

        return shapely.transform(shape, moved)

    def terrain(self, begin: float) -> Terrain:
        """Return what was collected."""
        from surefoot.world.narrow_things import find_narrow_things

        options, cell_m = self.options, self.elevation.resolution_m
        widest_m = 2 * options.margin_m + 2 * cell_m
        narrow, covered = find_narrow_things(
            self.elevation, self.taken, self.classes == CellClass.STEEP, self.found.noise_m, widest_m
        )
        self.classes[covered] = CellClass.NARROW
        if options.keep_narrow:
            self.polygons += [strip for thing in narrow if (strip := _strip(thing, options)) is not None]
        known = int(self.elevation.known.sum())
        ground = int((self.taken & self.elevation.known).sum())
        self.classes.setflags(write=False)
        return Terrain(
            polygons=tuple(self.polygons),
            regions=tuple(self.regions),
            narrow=narrow,
            area_m2=sum(polygon.area_m2 for polygon in self.polygons),
            kept_share=self.flat_m2 / self.plain_m2 if self.plain_m2 else 0.0,
            ground_share=ground / known,
            max_plane_error_m=self.error_m,
            max_cell_error_m=self.cell_error_m,
            pieces_per_region=sum(len(region.polygons) for region in self.regions) / max(len(self.regions), 1),
            noise_m=self.found.noise_m,
            time_s=time.perf_counter() - begin,
            warnings=(*self.elevation.notes, *self._warnings(narrow)),
            classes=self.classes,
        )

    def _warnings(self, narrow: tuple[NarrowThing, ...]) -> list[str]:
        options, cell_m, found = self.options, self.elevation.resolution_m, self.found
        said = []
        if not self.polygons:
            said.append("no ground is large, even and flat enough to stand on")
        if narrow:
            longest = narrow[0]
            what = "kept as strips 1 cm wide" if options.keep_narrow else "no polygons; --keep-narrow makes them so"
            said.append(
                f"{_counted(len(narrow), 'narrow raised thing')}, up to {longest.length_m:.2f} m long and "
                f"{longest.width_m:.3f} m wide, narrower than foot margins and two cells: {what}"
            )
        if cell_m > 0.03:
            said.append(f"cells of {cell_m:g} m show nothing narrower than that: 3 cm bars would be lost")
        if self.small:
            said.append(left_out(self.small, self.small_m2, options.min_area_m2))
        if found.bridged.any():
            count = int(found.bridged.sum())
            taken = "were taken for dropouts" if count > 1 else "was taken for a dropout"
            said.append(f"{_counted(count, 'cell')} without data inside regions {taken}")
        if found.noise_m > 0.015:
            said.append(
                f"the ground is rough or noisy: {found.noise_m * 1000:.0f} mm; edges are uncertain, "
                "and a larger --max-roughness may keep more"
            )
        if options.margin_m < 0.5 * cell_m:
            said.append(
                f"the margin of {options.margin_m:g} m is below half a cell: edges are known to half a cell only"
            )
        return said


def _large_pieces(part: Any, least_m2: float) -> list[Floats]:
    """Return the convex pieces of a part; where all are too small but most of it is one, only that."""
    from surefoot.world.convex_core import convex_core
    from surefoot.world.convex_pieces import area_of, convex_pieces

    pieces = convex_pieces(part)
    if pieces and area_of(pieces[0]) < least_m2:
        core = convex_core(part)
        if len(core) >= 3 and area_of(core) >= least_m2:
            return [core]
    return pieces


def left_out(count: int, area_m2: float, least_m2: float) -> str:
    """Return the warning about pieces that are too small to be polygons."""
    return f"{_counted(count, 'piece')} below {least_m2:g} m2 left out, {area_m2:.3g} m2 together"


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"


def _lifted(
    piece: Floats, normal: tuple[float, float, float], offset_m: float, friction: float, region: int
) -> TerrainPolygon:
    """Return a polygon on a plane, from its outline seen from above."""
    z = (offset_m - normal[0] * piece[:, 0] - normal[1] * piece[:, 1]) / normal[2]
    vertices = np.column_stack((piece, z))
    vertices.setflags(write=False)
    return TerrainPolygon(vertices, friction, region, normal, offset_m)


def _strip(thing: NarrowThing, options: SegmentOptions) -> TerrainPolygon | None:
    """Return a strip 1 cm wide along the centre line of a narrow thing, the margin taken off its ends."""
    start, end = np.array(thing.start_m), np.array(thing.end_m)
    along = end - start
    run_m = float(np.hypot(along[0], along[1]))
    back = (options.margin_m - 0.5 * thing.width_m if options.margin_m > 0 else 0.0) / max(run_m, 1e-9)
    back = min(max(back, 0.0), 0.4)
    if run_m < 0.02 or abs(along[2]) > math.tan(math.radians(options.max_slope_deg)) * run_m:
        return None
    start, end = start + back * along, end - back * along
    side = 0.005 * np.array([-along[1], along[0]]) / run_m
    outline = np.array([start[:2] - side, end[:2] - side, end[:2] + side, start[:2] + side])
    rise = along[2] / run_m**2
    gradient = rise * along[:2]
    scale = 1 / math.sqrt(1 + float(gradient @ gradient))
    normal = (-float(gradient[0]) * scale, -float(gradient[1]) * scale, scale)
    offset_m = float(np.dot(normal, start))
    return _lifted(outline, normal, offset_m, options.friction, -1)

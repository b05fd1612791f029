"""Splits an elevation map into planar regions that a foot may stand on, and says of every other cell why not.

The order of work: fit a plane to the window around every cell, grow planar regions from the middle of even ground, then
give cells at edges (where windows mix two surfaces) to the region whose plane they lie on, and dropouts to
the region around them. Wide windows come first, because they see through noise; narrow ones then find what is too small
for them.

Source: our own; the limits are of the kind that elevation_mapping_cupy's plane segmentation has (slope, plane error).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.world.elevation import ElevationMap

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Labels = NDArray[np.int32]


_SURE_CELLS = 16
"""So many cells give a better plane than the windows that a region grew from."""


class CellClass(IntEnum):
    """What a cell of the map is."""

    NO_DATA = 0
    STEPPABLE = 1
    STEEP = 2
    ROUGH = 3
    SMALL = 4
    NARROW = 5


@dataclass(frozen=True, slots=True)
class SegmentOptions:
    """Limits of the segmentation.

    Attributes:
        margin_m: how far polygons keep from the edges of their region; the radius of the foot.
        max_slope_deg: steepest ground.
        max_error_m: largest distance of the (locally averaged) ground from a polygon's plane.
        max_roughness_m: largest root mean square distance of measured heights from the plane of their window.
        min_area_m2: smallest polygon worth keeping.
        fill_m: dropouts up to this width are bridged (at least single cells, unless it is 0); wider holes stay.
        window_m: side of the window that planes are fitted to.
        friction: written into every polygon.
        keep_narrow: whether narrow raised things become polygons 1 cm wide along their centre line.
    """

    margin_m: float = 0.02
    max_slope_deg: float = 30.0
    max_error_m: float = 0.02
    max_roughness_m: float = 0.015
    min_area_m2: float = 0.002
    fill_m: float = 0.03
    window_m: float = 0.10
    friction: float = 0.6
    keep_narrow: bool = False

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            low, high = _RANGES.get(item.name, (0.0, 1.0))
            if not low <= value <= high:
                raise InputError(f"has to lie between {low:g} and {high:g}, not {value:g}", key=item.name)


_RANGES = {
    "margin_m": (0.0, 1.0),
    "max_slope_deg": (1.0, 60.0),
    "max_error_m": (0.002, 0.2),
    "max_roughness_m": (0.002, 0.2),
    "min_area_m2": (1e-6, 10.0),
    "window_m": (0.01, 1.0),
    "friction": (0.0, 10.0),
}


@dataclass(frozen=True, slots=True, eq=False)
class Segmentation:
    """Planar regions of an elevation map.

    Attributes:
        labels: (rows, columns), 0 where there is no region, else 1 .. n.
        planes: (n + 1, 3) of ``z = a + b column + d row``; row 0 is not used.
        classes: (rows, columns) of ``CellClass``.
        bridged: cells of regions that hold no data: dropouts of the sensor.
        holes: cells without data that are no dropouts.
        misses_m: (rows, columns) distance of the ground from its region's plane, averaged over 3 x 3 of its cells.
        noise_m: estimated standard deviation of the measured heights.
    """

    labels: Labels
    planes: Floats
    classes: NDArray[np.uint8]
    bridged: Flags
    holes: Flags
    misses_m: Floats
    noise_m: float

    @property
    def regions(self) -> int:
        """How many regions there are."""
        return len(self.planes) - 1


def segment(elevation: ElevationMap, options: SegmentOptions) -> Segmentation:
    """Return the planar regions of an elevation map.

    Args:
        elevation: the heights.
        options: the limits.
    """
    from surefoot.world import _plane_kernels as kernels

    cell_m = elevation.resolution_m
    heights = elevation.height_m.copy()
    dropouts = find_dropouts(heights, cell_m, options.fill_m)
    wide = min(max(1, round(options.window_m / (2 * cell_m) - 1e-9)), 3)
    fits = {half: kernels.fit_windows(heights, half) for half in {1, wide}}
    noise_m = _noise(fits[wide][3])
    strict_m = min(options.max_roughness_m, max(0.004, 1.6 * noise_m))
    passes = [(1, strict_m), (wide, options.max_roughness_m)]
    if wide > 1 and noise_m > 0.002:
        passes.insert(0, (wide, strict_m))
    state = _State(heights, dropouts, fits, options, cell_m, noise_m)
    for half, roughness_m in passes:
        state.grow(half, roughness_m)
    return state.finished()


class _State:
    """The labels while regions are being found; it lives within one call of ``segment``."""

    def __init__(
        self,
        heights: Floats,
        dropouts: Flags,
        fits: dict[int, tuple[Floats, Floats, Floats, Floats]],
        options: SegmentOptions,
        cell_m: float,
        noise_m: float,
    ) -> None:
        self.heights, self.dropouts, self.fits, self.options = heights, dropouts, fits, options
        self.cell_m, self.noise_m = cell_m, noise_m
        self.labels: Labels = np.zeros(heights.shape, np.int32)
        self.planes: Floats = np.zeros((1, 3))
        self.known: Flags = ~np.isnan(heights)
        self.least = max(4, round(options.min_area_m2 / cell_m**2))

    def grow(self, half: int, roughness_m: float) -> None:
        """Find regions among the cells that belong to none, with windows of one size."""
        from scipy import ndimage

        from surefoot.world import _plane_kernels as kernels

        smooth, b, d, rms = self.fits[half]
        slope = math.tan(math.radians(self.options.max_slope_deg))
        with np.errstate(invalid="ignore"):
            core = (self.labels == 0) & (rms <= roughness_m) & (np.hypot(b, d) <= slope * self.cell_m)
        depth = ndimage.distance_transform_edt(np.pad(core, 1))[1:-1, 1:-1]
        seeds = np.flatnonzero(core)
        seeds = seeds[np.argsort(-depth.ravel()[seeds], kind="stable")]
        count = (2 * half + 1) ** 2
        tolerance_m = 0.5 * self.options.max_error_m + 2 * self.noise_m / math.sqrt(count)
        lever = sum(k * k for k in range(-half, half + 1)) * (2 * half + 1)
        bend = 0.15 * self.cell_m + 3 * self.noise_m / math.sqrt(lever)
        found, _ = kernels.grow_regions(
            smooth, b, d, core, seeds.astype(np.int32), tolerance_m, bend, max(self.least // 4, 3), 1
        )
        self._settle(found, smooth, half)

    def _settle(self, found: Labels, smooth: Floats, half: int) -> None:
        """Let new regions claim the cells at their edges, solid ones first, and keep those that are large enough."""
        from scipy import ndimage

        from surefoot.world import _plane_kernels as kernels

        if not found.any():
            return
        depth = ndimage.distance_transform_edt(np.pad(_inside(found), 1))[1:-1, 1:-1]
        solid = np.asarray(ndimage.maximum(depth, found, np.arange(found.max() + 1))) >= 2
        solid[0] = False
        planes = kernels.region_planes(smooth, found, int(found.max()) + 1)
        claims = np.where(solid[found], found, 0).astype(np.int32)
        claims, planes = self._claimed(claims, planes, half + 2)
        rest = np.where((claims == 0) & (found > 0), found, claims).astype(np.int32)
        self._keep(*self._claimed(rest, planes, half + 2))

    def _claimed(self, labels: Labels, planes: Floats, rounds: int) -> tuple[Labels, Floats]:
        """Let regions claim cells around them, ring by ring, and fit their planes to what they have."""
        from surefoot.world import _plane_kernels as kernels

        free = self.labels == 0
        error_m = self.options.max_error_m
        near_m = min(max(3 * self.noise_m, 0.5 * error_m), 1.5 * error_m)
        for _ in range(rounds):
            labels = kernels.claim_edges(self.heights, labels, planes, self.known & free, near_m, 1, 1)
            enough = np.bincount(labels.ravel(), minlength=len(planes)) >= _SURE_CELLS
            planes = np.where(enough[:, None], kernels.region_planes(self.heights, labels, len(planes)), planes)
        open_ = (self.known | self.dropouts) & free
        labels = kernels.settle_rivals(self.heights, labels, planes, 2.5 * self.noise_m)
        labels = kernels.claim_edges(self.heights, labels, planes, open_, near_m, 3, 4)
        far_m = max(error_m, 4.5 * self.noise_m)
        return kernels.claim_edges(self.heights, labels, planes, open_, far_m, 3, 5), planes

    def _keep(self, found: Labels, planes: Floats) -> None:
        """Take over regions, in connected parts that are large enough and that the margin leaves something of."""
        from scipy import ndimage
        from skimage.measure import label as connected

        parts = connected(found, background=0, connectivity=1)  # type: ignore[no-untyped-call]
        sizes = np.bincount(parts.ravel())
        depth = ndimage.distance_transform_edt(np.pad(_inside(parts), 1))[1:-1, 1:-1]
        widest = np.asarray(ndimage.maximum(depth, parts, np.arange(len(sizes)))) * self.cell_m
        # A cell of depth k is k - 1/2 cells away from the edge.
        good = (sizes >= self.least) & (widest > self.options.margin_m - 0.5 * self.cell_m)
        good[0] = False
        owner = np.zeros(len(sizes), np.int64)
        owner[parts.ravel()] = found.ravel()
        number = np.cumsum(good) * good
        self.labels = np.where(good[parts], number[parts] + len(self.planes) - 1, self.labels).astype(np.int32)
        self.planes = np.vstack((self.planes, planes[owner[good]]))

    def finished(self) -> Segmentation:
        """Fit the planes again, give back what is too far from them, and say of every cell what it is."""
        from surefoot.world import _plane_kernels as kernels

        planes = kernels.region_planes(self.heights, self.labels, len(self.planes))
        apart = self.heights - surface(self.labels, planes)
        misses = kernels.own_means(apart, self.labels, 1)
        with np.errstate(invalid="ignore"):
            far = np.abs(misses) > self.options.max_error_m
            far |= np.abs(apart) > max(2 * self.options.max_error_m, 5 * self.noise_m)
        self.labels = np.where(far, 0, self.labels).astype(np.int32)
        misses = np.where(self.labels > 0, misses, np.nan)
        bridged = self.dropouts & (self.labels > 0)
        holes = ~self.known & ~self.dropouts
        return Segmentation(self.labels, planes, self._classes(), bridged, holes, misses, self.noise_m)

    def _classes(self) -> NDArray[np.uint8]:

        _, b, d, rms = self.fits[1]
        slope = math.tan(math.radians(self.options.max_slope_deg))
        with np.errstate(invalid="ignore"):
            steep = np.hypot(b, d) > slope * self.cell_m
            even = ~steep & (rms <= self.options.max_roughness_m)
        classes = np.full(self.labels.shape, CellClass.ROUGH, np.uint8)
        classes[steep] = CellClass.STEEP
        classes[even] = CellClass.SMALL
        classes[~self.known] = CellClass.NO_DATA
        classes[self.labels > 0] = CellClass.STEPPABLE
        return classes


def surface(labels: Labels, planes: Floats) -> Floats:
    """Return the height of every cell's own plane; meaningless where the label is 0."""
    rows, columns = np.indices(labels.shape)
    plane = planes[labels]
    height: Floats = plane[..., 0] + plane[..., 1] * columns + plane[..., 2] * rows
    return height


def find_dropouts(height_m: Floats, cell_m: float, fill_m: float) -> Flags:
    """Return the cells without data that are no holes but dropouts of the sensor.

    A dropout is a group of empty cells (joined by sides) that nowhere holds a square wider than ``fill_m`` (single
    cells always count as narrow, unless it is 0) and that is not longer than five cells or 10 cm.
    """
    from scipy import ndimage
    from skimage.measure import label as connected

    empty = np.isnan(height_m)
    if fill_m <= 0 or not empty.any():
        return np.zeros_like(empty)
    width = max(1, math.floor(fill_m / cell_m + 1e-6))
    square = np.ones((width + 1, width + 1), np.bool_)
    holes = ndimage.binary_opening(np.pad(empty, width + 1, constant_values=True), square)
    thin = empty & ~holes[width + 1 : -width - 1, width + 1 : -width - 1]
    parts = connected(thin, connectivity=1)  # type: ignore[no-untyped-call]
    longest = max(5, round(0.1 / cell_m))
    short = np.array([False] + [_extent(place) <= longest for place in ndimage.find_objects(parts)])
    dropouts: Flags = short[parts] & thin
    return dropouts


def _extent(place: tuple[slice, slice]) -> int:
    return max(int(place[0].stop - place[0].start), int(place[1].stop - place[1].start))


def _inside(labels: Labels) -> Flags:
    """Return the cells whose four neighbours carry the same label."""
    framed = np.pad(labels, 1)
    middle = framed[1:-1, 1:-1]
    same = middle > 0
    for other in (framed[:-2, 1:-1], framed[2:, 1:-1], framed[1:-1, :-2], framed[1:-1, 2:]):
        same = same & (other == middle)
    return same


def _noise(rms: Floats) -> float:
    """Return the typical residual of a window: most windows of a scan lie on even ground."""
    known = rms[~np.isnan(rms)]
    return float(np.quantile(known, 0.35)) if known.size else 0.0

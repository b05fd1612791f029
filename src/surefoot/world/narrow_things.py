"""Raised things that are too narrow for a region: bars, edges of boards, posts. They are reported, not lost silently.

A white top-hat (the heights minus their opening) keeps exactly what is higher than its surroundings and narrower than
the opening's square; what of that belongs to no polygon is grouped and measured along its main axis.

Source: Serra, "Image Analysis and Mathematical Morphology" (top-hat).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.world.elevation import ElevationMap

Flags = NDArray[np.bool_]
_LEAST_RISE_M = 0.03
_LEAST_LENGTH_M = 0.08
_LEAST_ON_LINE = 0.9


@dataclass(frozen=True, slots=True)
class NarrowThing:
    """A raised thing on which a foot would stand on its centre line only.

    Attributes:
        start_m: one end of its centre line, on top.
        end_m: the other end.
        width_m: how wide it is on average, to within a cell.
        length_m: how long it is.
        rise_m: how far it stands out of its surroundings.
    """

    start_m: tuple[float, float, float]
    end_m: tuple[float, float, float]
    width_m: float
    length_m: float
    rise_m: float


def find_narrow_things(
    elevation: ElevationMap, taken: Flags, steep: Flags, noise_m: float, widest_m: float
) -> tuple[tuple[NarrowThing, ...], Flags]:
    """Return the narrow raised things outside polygons, longest first, and the cells that they cover.

    Args:
        elevation: the heights.
        taken: cells of regions that became polygons.
        steep: cells on slopes; at the border of the map they are the slope's end, not a thing of their own.
        noise_m: of the heights.
        widest_m: things up to this width count as narrow.
    """
    from scipy import ndimage
    from skimage.measure import label as connected

    cell_m, heights = elevation.resolution_m, elevation.height_m
    side = 2 * max(1, math.ceil(widest_m / (2 * cell_m))) + 1
    lowest = float(np.nanmin(heights)) - 10.0
    filled = np.where(np.isnan(heights), lowest, heights)
    inner = (slice(side, -side), slice(side, -side))
    slope_goes_on = np.pad(filled, side, mode="reflect", reflect_type="odd")
    rise = filled - ndimage.grey_opening(slope_goes_on, size=(side, side))[inner]
    nothing_beyond = np.pad(filled, side, constant_values=lowest)
    rise = np.where(steep, rise, filled - ndimage.grey_opening(nothing_beyond, size=(side, side))[inner])
    raised = (rise > max(_LEAST_RISE_M, 6 * noise_m)) & ~taken & ~np.isnan(heights)
    parts = connected(raised, connectivity=2)  # type: ignore[no-untyped-call]
    covered = np.zeros_like(raised)
    found = []
    for number, place in enumerate(ndimage.find_objects(parts), 1):
        mask = parts[place] == number
        if mask.sum() * cell_m < _LEAST_LENGTH_M:
            continue
        thing = _measured(elevation, mask, place, rise[place])
        straight = thing.length_m >= _LEAST_LENGTH_M and thing.length_m >= 2 * thing.width_m
        if straight and _lies_on(thing, elevation, mask, place):
            found.append(thing)
            covered[place] |= mask
    return tuple(sorted(found, key=lambda thing: -thing.length_m)), covered


def _measured(
    elevation: ElevationMap, mask: Flags, place: tuple[slice, slice], rise: NDArray[np.float64]
) -> NarrowThing:
    rows, columns = np.nonzero(mask)
    cell_m = elevation.resolution_m
    heights = elevation.height_m[place][mask]
    points = elevation.place_m(
        (columns + place[1].start).astype(np.float64), (rows + place[0].start).astype(np.float64)
    )
    middle = points.mean(axis=0)
    _, axes = np.linalg.eigh(np.cov((points - middle).T) if len(points) > 1 else np.eye(2))
    axis = axes[:, -1]
    along = (points - middle) @ axis
    length_m = float(np.ptp(along)) + cell_m
    slope, level = np.polyfit(along, heights, 1) if np.ptp(along) > cell_m else (0.0, float(heights.mean()))
    ends = []
    for at in (float(along.min()), float(along.max())):
        x, y = middle + at * axis
        ends.append((float(x), float(y), float(level + slope * at)))
    lift = rise[mask]
    return NarrowThing(
        ends[0],
        ends[1],
        len(points) * cell_m**2 / length_m,
        length_m,
        float(np.median(lift[lift < 5.0]) if (lift < 5.0).any() else lift.min()),
    )


def _lies_on(thing: NarrowThing, elevation: ElevationMap, mask: Flags, place: tuple[slice, slice]) -> bool:
    """Return whether the centre line lies on the thing: that of a mesh or of a bent thing leads through the air."""
    count = max(2, math.ceil(2 * thing.length_m / elevation.resolution_m))
    line = np.linspace(thing.start_m[:2], thing.end_m[:2], count)
    east, north = ((line - elevation.origin_m) // elevation.resolution_m).astype(np.int64).T
    rows, columns = elevation.height_m.shape[0] - 1 - north - place[0].start, east - place[1].start
    inside = (rows >= 0) & (rows < mask.shape[0]) & (columns >= 0) & (columns < mask.shape[1])
    on = mask[rows[inside], columns[inside]].sum() / count
    return bool(on >= _LEAST_ON_LINE)

"""Terrain polygons: convex, planar pieces of ground that a foot may stand on, and what a whole terrain of them is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.world.narrow_things import NarrowThing

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class TerrainPolygon:
    """A convex, planar piece of ground; the foot margin is taken off already.

    Attributes:
        vertices_m: (n, 3) in order, counter-clockwise seen from above; read-only.
        friction: friction coefficient.
        region: which region it is a piece of, from 0; -1 for the centre line of a narrow thing.
        normal: unit normal of its plane, pointing up.
        offset_m: ``normal . p = offset_m`` for its points.
    """

    vertices_m: Floats
    friction: float
    region: int
    normal: tuple[float, float, float]
    offset_m: float

    @property
    def area_m2(self) -> float:
        """Its area, measured in its plane."""
        x, y = self.vertices_m[:, 0], self.vertices_m[:, 1]
        return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / self.normal[2]


@dataclass(frozen=True, slots=True)
class TerrainRegion:
    """A planar region of the scan, before the margin.

    Attributes:
        normal: unit normal, pointing up.
        offset_m: of the plane.
        area_m2: of its cells, measured in the plane.
        kept_m2: area of its polygons.
        polygons: indices of its polygons.
        max_error_m: largest distance of the ground from the plane, of means over 3 x 3 cells.
    """

    normal: tuple[float, float, float]
    offset_m: float
    area_m2: float
    kept_m2: float
    polygons: tuple[int, ...]
    max_error_m: float


@dataclass(frozen=True, slots=True, eq=False)
class Terrain:
    """What a scan was turned into.

    Attributes:
        polygons: largest region first.
        regions: those that polygons come from.
        narrow: raised things that are too narrow for a region.
        area_m2: of all polygons, in their planes.
        kept_share: area of the polygons over the area that the margin leaves of the regions, both seen from above.
        ground_share: area of the regions over the area with data.
        max_plane_error_m: largest distance of the ground below polygons from their planes, of means over 3 x 3 cells.
        max_cell_error_m: the same of single measured cells: noise included.
        pieces_per_region: polygons per region.
        noise_m: estimated noise of the heights.
        time_s: how long it took, without reading.
        warnings: what a user should know, a sentence each.
        classes: (rows, columns) of CellClass; None for polygons that come from no scan.
    """

    polygons: tuple[TerrainPolygon, ...]
    regions: tuple[TerrainRegion, ...]
    narrow: tuple[NarrowThing, ...]
    area_m2: float
    kept_share: float
    ground_share: float
    max_plane_error_m: float
    max_cell_error_m: float
    pieces_per_region: float
    noise_m: float
    time_s: float
    warnings: tuple[str, ...]
    classes: NDArray[np.uint8] | None = None

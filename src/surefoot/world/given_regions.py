"""Terrain polygons from planar regions that another program has segmented."""

from __future__ import annotations

import math
import time
from typing import Any

import numpy as np
import shapely  # type: ignore[import-untyped]

from surefoot.errors import InputError
from surefoot.world.convex_pieces import area_of, convex_pieces
from surefoot.world.planar_regions import PlanarRegion
from surefoot.world.scanned_terrain import left_out
from surefoot.world.segmentation import SegmentOptions
from surefoot.world.terrain_polygons import Terrain, TerrainPolygon, TerrainRegion


def terrain_of_regions(regions: tuple[PlanarRegion, ...], options: SegmentOptions | None = None) -> Terrain:
    """Return the steppable polygons of planar regions that another program has segmented.

    Regions steeper than the limit are left out and reported; the margin is taken off, the rest is split into
    convex pieces.

    Raises:
        InputError: an outline encloses no area.
    """
    options = options or SegmentOptions()
    begin = time.perf_counter()
    polygons: list[TerrainPolygon] = []
    kept: list[TerrainRegion] = []
    steep, small, small_m2, plain_m2 = 0, 0, 0.0, 0.0
    for number, region in enumerate(regions):
        normal = region.rotation[:, 2] * (1.0 if region.rotation[2, 2] >= 0 else -1.0)
        if normal[2] < math.cos(math.radians(options.max_slope_deg)):
            steep += 1
            continue
        outline = _outline(region, number)
        inset = shapely.buffer(outline, -options.margin_m, join_style="mitre", mitre_limit=3.0)
        plain_m2 += float(inset.area)
        pieces = [piece for part in shapely.get_parts(inset) for piece in convex_pieces(part, 0.0)]
        large = [piece for piece in pieces if area_of(piece) >= options.min_area_m2]
        small += len(pieces) - len(large)
        small_m2 += sum(map(area_of, pieces)) - sum(map(area_of, large))
        if large:
            first = len(polygons)
            polygons += [_placed(piece, region, normal, options.friction, len(kept)) for piece in large]
            indices = tuple(range(first, len(polygons)))
            kept.append(
                TerrainRegion(
                    _triple(normal),
                    float(normal @ region.position_m),
                    float(outline.area),
                    sum(map(area_of, large)),
                    indices,
                    0.0,
                )
            )
    area_m2 = sum(polygon.area_m2 for polygon in polygons)
    said = [f"{steep} regions are steeper than {options.max_slope_deg:g} degrees and were left out"] if steep else []
    if small:
        said.append(left_out(small, small_m2, options.min_area_m2))
    if not polygons:
        said.append("no region is large and flat enough to stand on")
    return Terrain(
        polygons=tuple(polygons),
        regions=tuple(kept),
        narrow=(),
        area_m2=area_m2,
        kept_share=area_m2 / plain_m2 if plain_m2 else 0.0,
        ground_share=len(kept) / len(regions),
        max_plane_error_m=0.0,
        max_cell_error_m=0.0,
        pieces_per_region=len(polygons) / max(len(kept), 1),
        noise_m=0.0,
        time_s=time.perf_counter() - begin,
        warnings=tuple(said),
    )


def _outline(region: PlanarRegion, number: int) -> Any:
    outer = shapely.make_valid(shapely.polygons(region.outer_m))
    holes = [shapely.make_valid(shapely.polygons(hole)) for hole in region.holes_m]
    outline = shapely.difference(outer, shapely.union_all(holes)) if holes else outer
    if outline.area <= 0:
        raise InputError("has a boundary that encloses no area", key=f"region {number}")
    return outline


def _placed(piece: Any, region: PlanarRegion, normal: Any, friction: float, number: int) -> TerrainPolygon:
    vertices = region.position_m + piece @ region.rotation[:, :2].T
    if region.rotation[2, 2] < 0:
        vertices = vertices[::-1].copy()
    vertices.setflags(write=False)
    return TerrainPolygon(vertices, friction, number, _triple(normal), float(normal @ region.position_m))


def _triple(vector: Any) -> tuple[float, float, float]:
    x, y, z = np.asarray(vector, np.float64).tolist()
    return x, y, z

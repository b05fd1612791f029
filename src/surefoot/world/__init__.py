"""Maps, coarse grids, visibility and heights; elevation maps and the terrain polygons in them.

Names are imported when they are first used, so that planning on a map does not load the segmentation of terrain.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from surefoot.world.elevation import ElevationMap, elevation_map
    from surefoot.world.elevation_readers import read_elevation
    from surefoot.world.floors import Floor
    from surefoot.world.given_regions import terrain_of_regions
    from surefoot.world.grid import CoarseGrid, Rectangle, make_grid
    from surefoot.world.heights import HeightMap, Profile, Stairs, make_heights
    from surefoot.world.occupancy import OccupancyMap, read_occupancy_map
    from surefoot.world.scanned_terrain import segment_terrain
    from surefoot.world.segmentation import CellClass, SegmentOptions
    from surefoot.world.terrain_polygons import Terrain, TerrainPolygon
    from surefoot.world.visibility import visible_pairs

__all__ = [
    "CellClass",
    "CoarseGrid",
    "ElevationMap",
    "Floor",
    "HeightMap",
    "OccupancyMap",
    "Profile",
    "Rectangle",
    "SegmentOptions",
    "Stairs",
    "Terrain",
    "TerrainPolygon",
    "elevation_map",
    "make_grid",
    "make_heights",
    "read_elevation",
    "read_occupancy_map",
    "segment_terrain",
    "terrain_of_regions",
    "visible_pairs",
]

_HOMES = {
    "CellClass": "segmentation",
    "CoarseGrid": "grid",
    "ElevationMap": "elevation",
    "Floor": "floors",
    "HeightMap": "heights",
    "OccupancyMap": "occupancy",
    "Profile": "heights",
    "Rectangle": "grid",
    "SegmentOptions": "segmentation",
    "Stairs": "heights",
    "Terrain": "terrain_polygons",
    "TerrainPolygon": "terrain_polygons",
    "elevation_map": "elevation",
    "make_grid": "grid",
    "make_heights": "heights",
    "read_elevation": "elevation_readers",
    "read_occupancy_map": "occupancy",
    "segment_terrain": "scanned_terrain",
    "terrain_of_regions": "given_regions",
    "visible_pairs": "visibility",
}


def __getattr__(name: str) -> Any:
    """Import a public name from its module."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)

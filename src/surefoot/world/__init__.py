"""Maps, coarse grids, visibility and heights; elevation maps and the terrain polygons in them."""

from __future__ import annotations

from surefoot.world.elevation import ElevationMap, elevation_map, read_elevation
from surefoot.world.floors import Floor
from surefoot.world.grid import CoarseGrid, Rectangle, make_grid
from surefoot.world.heights import HeightMap, Profile, Stairs, make_heights
from surefoot.world.occupancy import OccupancyMap, read_occupancy_map
from surefoot.world.segmentation import CellClass, SegmentOptions
from surefoot.world.terrain_polygons import Terrain, TerrainPolygon, segment_terrain, terrain_of_regions
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

"""Maps, coarse grids, visibility and heights."""

from __future__ import annotations

from surefoot.world.floors import Floor
from surefoot.world.grid import CoarseGrid, Rectangle, make_grid
from surefoot.world.heights import HeightMap, Profile, Stairs, make_heights
from surefoot.world.occupancy import OccupancyMap, read_occupancy_map
from surefoot.world.visibility import visible_pairs

__all__ = [
    "CoarseGrid",
    "Floor",
    "HeightMap",
    "OccupancyMap",
    "Profile",
    "Rectangle",
    "Stairs",
    "make_grid",
    "make_heights",
    "read_occupancy_map",
    "visible_pairs",
]

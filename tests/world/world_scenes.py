"""Maps and grids that the tests of this room share."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from surefoot.world import CoarseGrid, OccupancyMap, make_grid

SHARED = Path(__file__).parents[3] / "shared" / "data"
SCENES = Path(__file__).parents[2] / "scenes"

CELL_M = 2.70351
TWO_ROOMS = """
    ############
    ####..##...#
    ####.......#
    #......#...#
    #..##..#...#
    #......#####
    ############
"""


def signs(drawing: str) -> NDArray[np.bool_]:
    """Return where a drawing has '#', one entry per character."""
    return np.array([[sign == "#" for sign in row] for row in drawing.split()])


def map_of(
    occupied: NDArray[np.bool_],
    *,
    unknown: NDArray[np.bool_] | None = None,
    resolution_m: float = 1.0,
    origin_m: tuple[float, float] = (0.0, 0.0),
    yaw_rad: float = 0.0,
) -> OccupancyMap:
    """Return a map without a file."""
    blank = np.zeros(occupied.shape, np.bool_) if unknown is None else unknown
    return OccupancyMap(occupied, blank, resolution_m, origin_m, yaw_rad, Path("room.yaml"), Path("room.pgm"))


def map_like(occupancy: OccupancyMap, occupied: NDArray[np.bool_]) -> OccupancyMap:
    """Return a map in the same place with other pixels."""
    return replace(occupancy, occupied=occupied, unknown=np.zeros_like(occupied))


def grid_of(drawing: str, cell_size_m: float = 1.0) -> CoarseGrid:
    """Return a grid with one cell per character of a drawing, its south-western corner at the world's origin."""
    return make_grid(map_of(signs(drawing), resolution_m=cell_size_m), cell_size_m=cell_size_m)

"""Where the cells of a plan lie in the world, and how high their floors are."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from surefoot.frames import Cell
from surefoot.missions.scenario.scene import scenario_heights
from surefoot.viewer.sources.plans import PlanSource
from surefoot.world import CoarseGrid, HeightMap


def points_m(grid: CoarseGrid, places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return world points, given in cells east and south of the grid's north-western corner."""
    west, north = grid.north_west_m
    in_grid = np.stack((west + places[..., 0] * grid.cell_size_m, north - places[..., 1] * grid.cell_size_m), axis=-1)
    return grid.to_world(in_grid)


def centre_m(plan: PlanSource, cell: Cell) -> tuple[float, float]:
    """Return the centre of a cell in the world."""
    x, y = points_m(plan.grid, np.array([cell.column + 0.5, cell.row + 0.5]))
    return float(x), float(y)


def heights_of(source: PlanSource) -> HeightMap:
    """Return the heights of a plan's grid."""
    return scenario_heights(source.scenario, source.grid, int(source.document["walking"]["fine_cells"]))


def floor_m(heights: HeightMap, cell: Cell) -> float:
    """Return the height of a cell's floor; of a stairs cell, half way up."""
    profile = heights.profile(cell)
    return float(heights.base_m[cell.row, cell.column]) + (0.0 if profile is None else profile.gain_m / 2)

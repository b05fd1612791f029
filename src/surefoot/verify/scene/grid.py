"""The coarse grid over a map and its blocked cells, transcribed from rules.md 1."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.verify.values import Rectangle
from surefoot.world.occupancy import OccupancyMap

TOLERANCE_M = 1e-6
SLACK_CELLS = 0.01
MOST_CELLS = 1_000_000


@dataclass(frozen=True, slots=True)
class GridFrame:
    """Where the coarse cells lie.

    Attributes:
        cell_size_m: side of a cell.
        origin_m: world position of the grid frame's origin.
        rotation_rad: how far the grid frame is turned, counter-clockwise.
        rows: number of rows, counted from the north.
        columns: number of columns, counted from the west.
        north_west_m: north-western corner of cell (0, 0) in the grid frame.
    """

    cell_size_m: float
    origin_m: tuple[float, float]
    rotation_rad: float
    rows: int
    columns: int
    north_west_m: tuple[float, float]

    def to_grid(self, points_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return world points (..., 2) in the grid frame."""
        return _turned(points_m - np.asarray(self.origin_m), -self.rotation_rad)

    def rectangle(self, corners_m: Rectangle) -> Rectangle:
        """Return west, south, east, north of a rectangle in the grid frame, from opposite corners in the world."""
        first, second = self.to_grid(np.array(corners_m).reshape(2, 2))
        low, high = np.minimum(first, second), np.maximum(first, second)
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])

    def square(self, row: int, column: int) -> Rectangle:
        """Return west, south, east, north of a cell in the grid frame."""
        west = self.north_west_m[0] + column * self.cell_size_m
        north = self.north_west_m[1] - row * self.cell_size_m
        return west, north - self.cell_size_m, west + self.cell_size_m, north

    def holds(self, cell: tuple[int, int], point_m: tuple[float, float]) -> bool:
        """Return whether a world point lies in the closed square of a cell."""
        x, y = self.to_grid(np.array(point_m))
        west, south, east, north = self.square(*cell)
        return bool(west - TOLERANCE_M <= x <= east + TOLERANCE_M and south - TOLERANCE_M <= y <= north + TOLERANCE_M)

    def wholly_inside(self, corners_m: Rectangle) -> NDArray[np.bool_]:
        """Return which cells lie in a rectangle up to one per cent of their size."""
        west, south, east, north = self.rectangle(corners_m)
        x, y = self._centers()
        reach = self.cell_size_m * (0.5 - SLACK_CELLS)
        return ((x - reach >= west) & (x + reach <= east))[None, :] & ((y - reach >= south) & (y + reach <= north))[
            :, None
        ]

    def centered_in(self, corners_m: Rectangle) -> NDArray[np.bool_]:
        """Return which cells have their centre in a rectangle."""
        west, south, east, north = self.rectangle(corners_m)
        x, y = self._centers()
        slack = TOLERANCE_M
        return ((x >= west - slack) & (x <= east + slack))[None, :] & ((y >= south - slack) & (y <= north + slack))[
            :, None
        ]

    def _centers(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return x of the columns' and y of the rows' centres."""
        x = self.north_west_m[0] + (np.arange(self.columns) + 0.5) * self.cell_size_m
        y = self.north_west_m[1] - (np.arange(self.rows) + 0.5) * self.cell_size_m
        return x.astype(np.float64), y.astype(np.float64)


def lay_grid(
    floor: OccupancyMap, cell_size_m: float, origin_m: tuple[float, float], rotation_rad: float
) -> tuple[GridFrame, NDArray[np.bool_]]:
    """Lay the grid over a map.

    Returns:
        The frame, and (rows, columns) whether a cell lies wholly on the map's picture.
    """
    height, width = floor.occupied.shape
    corners = np.array([(0, 0), (width, 0), (width, height), (0, height)], float) * floor.resolution_m
    world = _turned(corners, floor.yaw_rad) + np.asarray(floor.origin_m)
    seen = _turned(world - np.asarray(origin_m), -rotation_rad)
    low = np.floor(seen.min(axis=0) / cell_size_m).astype(np.int64) - 1
    high = np.ceil(seen.max(axis=0) / cell_size_m).astype(np.int64) + 1
    if float(np.prod((high - low).astype(float))) > MOST_CELLS:
        raise InputError(f"gives more than {MOST_CELLS} cells on this map", key="grid.cell_size_m")
    east, north = np.meshgrid(np.arange(low[0], high[0]), np.arange(low[1], high[1]), indexing="ij")
    whole = np.ones(east.shape, bool)
    frame = GridFrame(cell_size_m, origin_m, rotation_rad, 0, 0, (0.0, 0.0))
    for step_x, step_y in ((0, 0), (1, 0), (1, 1), (0, 1)):
        corner = np.stack([east + step_x, north + step_y], axis=-1) * cell_size_m
        x, y = np.moveaxis(_in_picture(floor, frame, corner), -1, 0)
        whole &= (x >= -TOLERANCE_M) & (x <= width * floor.resolution_m + TOLERANCE_M)
        whole &= (y >= -TOLERANCE_M) & (y <= height * floor.resolution_m + TOLERANCE_M)
    if not whole.any():
        raise InputError("no cell lies wholly on the map", key="grid.cell_size_m")
    columns, rows = np.nonzero(whole.any(axis=1))[0], np.nonzero(whole.any(axis=0))[0]
    on_map = whole[columns[0] : columns[-1] + 1, rows[0] : rows[-1] + 1].T[::-1]
    corner_m = ((low[0] + columns[0]) * cell_size_m, (low[1] + rows[-1] + 1) * cell_size_m)
    north_west_m = (float(corner_m[0]), float(corner_m[1]))
    return GridFrame(cell_size_m, origin_m, rotation_rad, len(on_map), on_map.shape[1], north_west_m), on_map


def free_cells(
    floor: OccupancyMap, frame: GridFrame, on_map: NDArray[np.bool_], unknown_blocked: bool, inflation_m: float
) -> NDArray[np.bool_]:
    """Return (rows, columns) which cells are free: wholly on the map, no point in inflated occupied space."""
    solid = floor.occupied | floor.unknown if unknown_blocked else floor.occupied
    free = on_map.copy()
    for row, column in np.argwhere(on_map):
        free[row, column] = not _meets(floor, frame, solid, int(row), int(column), inflation_m)
    return free


def _meets(
    floor: OccupancyMap, frame: GridFrame, solid: NDArray[np.bool_], row: int, column: int, inflation_m: float
) -> bool:
    """Return whether a cell's interior meets a solid pixel, or comes nearer to one than the inflation."""
    west, south, east, north = frame.square(row, column)
    center = _in_picture(floor, frame, np.array([(west + east) / 2, (south + north) / 2]))
    side, pixel = frame.cell_size_m / 2, floor.resolution_m / 2
    angle = frame.rotation_rad - floor.yaw_rad
    spread = abs(math.cos(angle)) + abs(math.sin(angle))
    near = _solid_near(floor, solid, center, side * spread + inflation_m) - center
    if not len(near):
        return False
    own = np.abs(_turned(near, -angle))
    if bool((own.max(axis=1) <= side - TOLERANCE_M).any()):
        return True
    depth_cell = side + pixel * spread - own.max(axis=1)
    depth_pixel = pixel + side * spread - np.abs(near).max(axis=1)
    depth = np.minimum(depth_cell, depth_pixel)
    if bool((depth > TOLERANCE_M).any()):
        return True
    if inflation_m <= TOLERANCE_M:
        return False
    return bool((_gaps(near, angle, side, pixel) < inflation_m - TOLERANCE_M).any())


def _solid_near(
    floor: OccupancyMap, solid: NDArray[np.bool_], center: NDArray[np.float64], reach_m: float
) -> NDArray[np.float64]:
    """Return the centres of the solid pixels around a point, in the picture's frame."""
    height, width = solid.shape
    size = floor.resolution_m
    low = np.floor((center - reach_m) / size).astype(np.int64) - 1
    high = np.ceil((center + reach_m) / size).astype(np.int64) + 1
    first_row, last_row = max(0, height - int(high[1])), max(0, height - int(low[1]))
    first_column, last_column = max(0, int(low[0])), max(0, min(width, int(high[0])))
    found = np.argwhere(solid[first_row:last_row, first_column:last_column])
    x = (found[:, 1] + first_column + 0.5) * size
    y = (height - (found[:, 0] + first_row) - 0.5) * size
    return np.stack([x, y], axis=-1)


def _gaps(near: NDArray[np.float64], angle: float, side: float, pixel: float) -> NDArray[np.float64]:
    """Return the distances of a turned square at the origin and disjoint pixels: corner to square, both ways."""
    signs = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float)
    pixel_corners = _turned(near[:, None, :] + signs * pixel, -angle)
    cell_corners = _turned(signs * side, angle)[None, :, :] - near[:, None, :]
    one = np.hypot(*np.moveaxis(np.maximum(np.abs(pixel_corners) - side, 0), -1, 0))
    other = np.hypot(*np.moveaxis(np.maximum(np.abs(cell_corners) - pixel, 0), -1, 0))
    gaps: NDArray[np.float64] = np.minimum(one.min(axis=1), other.min(axis=1))
    return gaps


def _in_picture(floor: OccupancyMap, frame: GridFrame, points_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points of the grid frame in metres from the picture's lower-left corner, along its sides."""
    world = _turned(points_m, frame.rotation_rad) + np.asarray(frame.origin_m)
    return _turned(world - np.asarray(floor.origin_m), -floor.yaw_rad)


def _turned(points: NDArray[np.float64], angle_rad: float) -> NDArray[np.float64]:
    """Return points (..., 2) turned counter-clockwise; quarter turns are exact."""
    quarters = round(angle_rad / (math.pi / 2))
    if abs(angle_rad - quarters * math.pi / 2) < 1e-12:
        cosine, sine = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[quarters % 4]
    else:
        cosine, sine = math.cos(angle_rad), math.sin(angle_rad)
    x, y = points[..., 0], points[..., 1]
    return np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=-1)


def disc_is_free(floor: OccupancyMap, solid: NDArray[np.bool_], point_m: tuple[float, float], radius_m: float) -> bool:
    """Return whether a disc in the world lies on the map and meets no solid pixel; touching is no meeting."""
    height, width = solid.shape
    center = _turned(np.array(point_m) - np.asarray(floor.origin_m), -floor.yaw_rad)
    size_m = np.array([width, height]) * floor.resolution_m
    if bool((center < radius_m - TOLERANCE_M).any() or (center > size_m - radius_m + TOLERANCE_M).any()):
        return False
    near = np.abs(_solid_near(floor, solid, center, radius_m) - center)
    gaps = np.hypot(*np.maximum(near - floor.resolution_m / 2, 0).T)
    return not bool((gaps < radius_m - TOLERANCE_M).any())

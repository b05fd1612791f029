"""The coarse grid over an occupancy map (docs/rules.md, section 1)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from surefoot.errors import InputError
from surefoot.frames import Cell
from surefoot.world.meeting import meets
from surefoot.world.occupancy import OccupancyMap

Rectangle = tuple[float, float, float, float]
"""Two opposite corners x0, y0, x1, y1 in world metres; the sides are parallel to the grid."""

TOLERANCE_M = 1e-6
INSIDE_SHARE = 0.01
"""How much of a cell's side a rectangle may miss and still be said to reach its border."""

UNKNOWN_CHOICES = ("blocked", "free")
_MAX_CELLS = 1_000_000
_CELL_SIZE_M = (0.01, 1e4)
_FARTHEST_M = 1e8


@dataclass(frozen=True, slots=True, eq=False)
class CoarseGrid:
    """Square cells over a map; some are free, the others are blocked.

    The grid frame is the world shifted to ``origin_m`` and turned by ``rotation_rad``; cell corners lie on multiples of
    the cell size in it. Row 0 is the northernmost row of that frame and column 0 the westernmost column.

    Attributes:
        cell_size_m: side of a cell.
        origin_m: world position of the grid frame's origin.
        rotation_rad: yaw of the grid frame in the world.
        rows: number of rows.
        columns: number of columns.
        north_west_m: position in the grid frame of the north-western corner of cell (0, 0).
        free: (rows, columns), read-only.
    """

    cell_size_m: float
    origin_m: tuple[float, float]
    rotation_rad: float
    rows: int
    columns: int
    north_west_m: tuple[float, float]
    free: NDArray[np.bool_]

    def index(self, cell: Cell) -> int:
        """Return the number of a cell, counted row by row."""
        return cell.row * self.columns + cell.column

    def cell(self, index: int) -> Cell:
        """Return the cell with a number."""
        return Cell(*divmod(index, self.columns))

    def has(self, cell: Cell) -> bool:
        """Return whether a cell lies on the grid."""
        return 0 <= cell.row < self.rows and 0 <= cell.column < self.columns

    def is_free(self, cell: Cell) -> bool:
        """Return whether a cell lies on the grid and is free."""
        return self.has(cell) and bool(self.free[cell.row, cell.column])

    def free_cells(self) -> tuple[Cell, ...]:
        """Return all free cells by ascending number."""
        return tuple(Cell(int(row), int(column)) for row, column in np.argwhere(self.free))

    def to_grid(self, points_world_m: ArrayLike) -> NDArray[np.float64]:
        """Return points, shape (..., 2), of the world in the grid frame."""
        return np.asarray((np.asarray(points_world_m, np.float64) - self.origin_m) @ _turn(self.rotation_rad))

    def to_world(self, points_grid_m: ArrayLike) -> NDArray[np.float64]:
        """Return points, shape (..., 2), of the grid frame in the world."""
        return np.asarray(np.asarray(points_grid_m, np.float64) @ _turn(self.rotation_rad).T + self.origin_m)

    def cell_at(self, point_world_m: tuple[float, float]) -> Cell | None:
        """Return the cell that holds a point, None off the grid; a cell owns its northern and western borders."""
        across, down = self.place(point_world_m)
        if not (0 <= across < self.columns and 0 <= down < self.rows):
            return None
        return Cell(int(down), int(across))

    def place(self, point_world_m: tuple[float, float]) -> tuple[float, float]:
        """Return how many cells a point lies east and south of the grid's north-western corner."""
        x, y = self.to_grid(point_world_m)
        west, north = self.north_west_m
        return float(x - west) / self.cell_size_m, float(north - y) / self.cell_size_m

    def center_m(self, cell: Cell) -> tuple[float, float]:
        """Return the world position of a cell's centre."""
        return self._point_m(cell.row + 0.5, cell.column + 0.5)

    def corner_m(self, cell: Cell) -> tuple[float, float]:
        """Return the world position of a cell's north-western corner."""
        return self._point_m(cell.row, cell.column)

    def bounds(self, rectangle_world_m: Rectangle) -> Rectangle:
        """Return a rectangle in cells from the north-western corner: west, north, east, south."""
        x0, y0, x1, y1 = rectangle_world_m
        (a, b), (c, d) = self.place((x0, y0)), self.place((x1, y1))
        return min(a, c), min(b, d), max(a, c), max(b, d)

    def wholly_inside(self, rectangle_world_m: Rectangle) -> frozenset[Cell]:
        """Return the cells whose square lies in a rectangle up to 1 % of the cell size, free or not."""
        west, north, east, south = self.bounds(rectangle_world_m)
        rows = self._whole(north - INSIDE_SHARE, south + INSIDE_SHARE - 1, self.rows)
        columns = self._whole(west - INSIDE_SHARE, east + INSIDE_SHARE - 1, self.columns)
        return frozenset(Cell(row, column) for row in rows for column in columns)

    def centered_in(self, rectangle_world_m: Rectangle) -> frozenset[Cell]:
        """Return the cells whose centre lies in a rectangle or on its edge, free or not."""
        west, north, east, south = self.bounds(rectangle_world_m)
        slack = TOLERANCE_M / self.cell_size_m
        rows = self._whole(north - 0.5 - slack, south - 0.5 + slack, self.rows)
        columns = self._whole(west - 0.5 - slack, east - 0.5 + slack, self.columns)
        return frozenset(Cell(row, column) for row in rows for column in columns)

    def _point_m(self, down: float, across: float) -> tuple[float, float]:
        """Return the world position of a point given in cells from the north-western corner."""
        west, north = self.north_west_m
        x, y = self.to_world((west + across * self.cell_size_m, north - down * self.cell_size_m))
        return float(x), float(y)

    @staticmethod
    def _whole(least: float, most: float, count: int) -> range:
        """Return the whole numbers between two bounds that are at least 0 and less than a count."""
        return range(math.ceil(min(max(least, 0), count)), math.floor(max(min(most, count - 1), -1)) + 1)


def make_grid(
    occupancy: OccupancyMap,
    *,
    cell_size_m: float,
    origin_m: tuple[float, float] = (0.0, 0.0),
    rotation_rad: float = 0.0,
    unknown: str = "blocked",
    inflation_m: float = 0.0,
) -> CoarseGrid:
    """Lay coarse cells over a map and decide which of them are free.

    A cell is blocked when it is not wholly on the picture, when its interior meets an occupied pixel, or when an
    occupied pixel is nearer to it than the inflation (Euclidean distance between the two squares). Touching is no
    meeting, and all comparisons have a tolerance of 1e-6 m. The test is exact for every rotation.

    Args:
        occupancy: the map.
        cell_size_m: side of a cell.
        origin_m: a world position where cell corners meet; the cells reach from there in all directions.
        rotation_rad: yaw of the cells in the world.
        unknown: whether unknown pixels are "blocked" or "free".
        inflation_m: how far from a cell occupied pixels block it.

    Returns:
        The smallest grid that holds every cell wholly on the picture.

    Raises:
        InputError: a value is out of its range, or no cell lies wholly on the picture.

    Source: docs/rules.md, section 1.
    """
    _check(cell_size_m, origin_m, rotation_rad, unknown, inflation_m)
    angle_rad = rotation_rad - occupancy.yaw_rad
    whole, west, north = _whole_cells(occupancy, cell_size_m, origin_m, rotation_rad)
    rows, columns = whole.shape
    solid = occupancy.occupied | occupancy.unknown if unknown == "blocked" else occupancy.occupied
    down, across = np.nonzero(whole)
    centers_m = np.stack(((west + across + 0.5) * cell_size_m, (north - down - 0.5) * cell_size_m), axis=1)
    pixels = _to_picture(occupancy, origin_m, rotation_rad, centers_m)
    free = np.zeros((rows, columns), np.bool_)
    free[down, across] = ~meets(
        solid,
        pixels,
        half_side=(cell_size_m / 2 - TOLERANCE_M) / occupancy.resolution_m,
        angle_rad=-angle_rad,
        reach=inflation_m / occupancy.resolution_m,
    )
    free.setflags(write=False)
    origin = float(origin_m[0]), float(origin_m[1])
    corner = float(west * cell_size_m), float(north * cell_size_m)
    return CoarseGrid(float(cell_size_m), origin, float(rotation_rad), rows, columns, corner, free)


def _whole_cells(
    occupancy: OccupancyMap, cell_size_m: float, origin_m: tuple[float, float], rotation_rad: float
) -> tuple[NDArray[np.bool_], int, int]:
    """Return which cells of the smallest rectangle are wholly on the picture, and its lattice column and row line."""
    pixel_rows, pixel_columns = occupancy.occupied.shape
    slack = TOLERANCE_M / occupancy.resolution_m
    corners = np.array([[0, 0], [pixel_columns, 0], [0, pixel_rows], [pixel_columns, pixel_rows]], np.float64)
    corners_cells = _from_picture(occupancy, origin_m, rotation_rad, corners) / cell_size_m
    west, south = (int(bound) for bound in np.floor(corners_cells.min(axis=0)) - 1)
    east, north = (int(bound) for bound in np.ceil(corners_cells.max(axis=0)) + 1)
    if (east - west) * (north - south) > _MAX_CELLS:
        raise InputError(
            f"cells of {cell_size_m:g} m are more than {_MAX_CELLS // 10**6} million on this map; choose larger ones",
            key="grid.cell_size_m",
        )
    lattice = np.stack(np.meshgrid(np.arange(west, east + 1), np.arange(north, south - 1, -1)), axis=2)
    points = _to_picture(occupancy, origin_m, rotation_rad, lattice.astype(np.float64) * cell_size_m)
    on = np.all((points >= -slack) & (points <= np.array([pixel_columns, pixel_rows]) + slack), axis=2)
    whole = on[:-1, :-1] & on[1:, :-1] & on[:-1, 1:] & on[1:, 1:]
    if not whole.any():
        size_m = pixel_columns * occupancy.resolution_m, pixel_rows * occupancy.resolution_m
        raise InputError(
            f"no cell of {cell_size_m:g} m lies wholly on the map {occupancy.path.name} "
            f"of {size_m[0]:g} m x {size_m[1]:g} m; choose smaller cells or another origin",
            key="grid.cell_size_m",
        )
    down, across = np.flatnonzero(whole.any(axis=1)), np.flatnonzero(whole.any(axis=0))
    part = whole[down[0] : down[-1] + 1, across[0] : across[-1] + 1]
    return part, west + int(across[0]), north - int(down[0])


def _to_picture(
    occupancy: OccupancyMap, origin_m: tuple[float, float], rotation_rad: float, points_grid_m: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return points of the grid frame in pixels: to the right of and down from the picture's upper-left corner."""
    shift = np.subtract(origin_m, occupancy.origin_m) @ _turn(occupancy.yaw_rad)
    points_m = points_grid_m @ _turn(rotation_rad - occupancy.yaw_rad).T + shift
    right, up = points_m[..., 0] / occupancy.resolution_m, points_m[..., 1] / occupancy.resolution_m
    return np.stack((right, occupancy.occupied.shape[0] - up), axis=-1)


def _from_picture(
    occupancy: OccupancyMap, origin_m: tuple[float, float], rotation_rad: float, points: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return points given in pixels (right, down) in the grid frame; undoes `_to_picture`."""
    up = occupancy.occupied.shape[0] - points[..., 1]
    points_m = np.stack((points[..., 0], up), axis=-1) * occupancy.resolution_m
    shift = np.subtract(origin_m, occupancy.origin_m) @ _turn(occupancy.yaw_rad)
    return np.asarray((points_m - shift) @ _turn(rotation_rad - occupancy.yaw_rad))


def _turn(angle_rad: float) -> NDArray[np.float64]:
    """Return the matrix that turns column vectors counter-clockwise, exact for quarter turns."""
    quarters = angle_rad / (math.pi / 2)
    if abs(quarters - round(quarters)) < 1e-12:
        cos, sin = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[round(quarters) % 4]
    else:
        cos, sin = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[cos, -sin], [sin, cos]], np.float64)


def _check(
    cell_size_m: float, origin_m: tuple[float, float], rotation_rad: float, unknown: str, inflation_m: float
) -> None:
    """Refuse values that no grid can have."""
    least, most = _CELL_SIZE_M
    if not least <= cell_size_m <= most:
        raise InputError(f"has to be from {least:g} to {most:g} m, not {cell_size_m!r}", key="grid.cell_size_m")
    if len(origin_m) != 2 or not all(abs(value) <= _FARTHEST_M for value in origin_m):
        raise InputError(f"has to be two numbers of at most {_FARTHEST_M:g} m, not {origin_m!r}", key="grid.origin_m")
    if not math.isfinite(rotation_rad):
        raise InputError(f"has to be a finite angle, not {rotation_rad!r}", key="grid.rotation_rad")
    if unknown not in UNKNOWN_CHOICES:
        raise InputError(f"has to be one of {', '.join(UNKNOWN_CHOICES)}, not {unknown!r}", key="grid.unknown")
    if not 0 <= inflation_m <= _FARTHEST_M:
        raise InputError(f"the inflation has to be finite and not negative, not {inflation_m!r}")

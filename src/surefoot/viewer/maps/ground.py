"""The map under a picture: pixels, coarse cells, coordinates."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import ListedColormap
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from matplotlib.transforms import Affine2D
from numpy.typing import NDArray

from surefoot.frames import Cell
from surefoot.viewer.sources.cells import points_m
from surefoot.viewer.style import BLOCKED, UNKNOWN, WALL
from surefoot.world import CoarseGrid, OccupancyMap

_PIXEL_COLOURS = ListedColormap(["#ffffff00", UNKNOWN, WALL])
_MARGIN = 0.5
_SAMPLES = np.linspace(0.04, 0.96, 12)


def fill_cells(axes: Axes, grid: CoarseGrid, cells: Iterable[Cell], **looks: Any) -> None:
    """Colour cells."""
    corners = ((0, 0), (1, 0), (1, 1), (0, 1))
    squares = np.array([[(cell.column + x, cell.row + y) for x, y in corners] for cell in cells], np.float64)
    if squares.size:
        axes.add_collection(PolyCollection(list(points_m(grid, squares)), **looks))


def draw_pixels(axes: Axes, occupancy: OccupancyMap) -> None:
    """Draw what is occupied and what is unknown; what is free stays transparent."""
    classes = np.where(occupancy.occupied, 2, np.where(occupancy.unknown, 1, 0))
    rows, columns = classes.shape
    placed = Affine2D().rotate(occupancy.yaw_rad).translate(*occupancy.origin_m)
    axes.imshow(
        classes,
        extent=(0.0, columns * occupancy.resolution_m, 0.0, rows * occupancy.resolution_m),
        cmap=_PIXEL_COLOURS,
        vmin=0,
        vmax=2,
        interpolation="nearest",
        transform=placed + axes.transData,
        zorder=1,
    )


def draw_blocked(axes: Axes, grid: CoarseGrid) -> None:
    """Shade the cells that the robot never enters."""
    blocked = [Cell(int(row), int(column)) for row, column in np.argwhere(~grid.free)]
    fill_cells(axes, grid, blocked, facecolor=BLOCKED, edgecolor="#a8a8a8", hatch="////", linewidth=0, zorder=0.5)


def ground_keys(grid: CoarseGrid, occupancy: OccupancyMap, *, whole: bool = False) -> list[Patch]:
    """Return what a legend says about the ground: only what there is."""
    west, north, east, south = _window(grid, whole=whole)
    keys = []
    places = np.argwhere(~grid.free[north:south, west:east]) + np.array([north, west])
    if any(_shows(grid, occupancy, int(row), int(column)) for row, column in places):
        keys.append(Patch(facecolor=BLOCKED, edgecolor="#a8a8a8", hatch="////", lw=0, label="blocked cell"))
    if occupancy.occupied.any():
        keys.append(Patch(facecolor=WALL, label="occupied"))
    if occupancy.unknown.any():
        keys.append(Patch(facecolor=UNKNOWN, label="unknown"))
    return keys


def _shows(grid: CoarseGrid, occupancy: OccupancyMap, row: int, column: int) -> bool:
    """Return whether some of a cell is not covered by occupied and unknown pixels, by samples."""
    across, down = np.meshgrid(column + _SAMPLES, row + _SAMPLES)
    points = points_m(grid, np.stack((across, down), axis=-1).reshape(-1, 2))
    in_picture = Affine2D().rotate(occupancy.yaw_rad).translate(*occupancy.origin_m).inverted().transform(points)
    east, north = np.floor(in_picture / occupancy.resolution_m).astype(int).T
    rows, columns = occupancy.occupied.shape
    on_map = (east >= 0) & (east < columns) & (north >= 0) & (north < rows)
    covered = (occupancy.occupied | occupancy.unknown)[rows - 1 - north[on_map], east[on_map]]
    return not (on_map.all() and covered.all())


def draw_lines(axes: Axes, grid: CoarseGrid) -> None:
    """Draw the borders of the cells."""
    across = [[(0, row), (grid.columns, row)] for row in range(grid.rows + 1)]
    down = [[(column, 0), (column, grid.rows)] for column in range(grid.columns + 1)]
    lines = points_m(grid, np.array(across + down, np.float64))
    axes.add_collection(LineCollection(list(lines), colors="#8a8a8a", linewidths=0.5, zorder=2))


def number_cells(axes: Axes, grid: CoarseGrid, *, whole: bool = False) -> None:
    """Write rows and columns along the northern and western borders of what is shown."""
    west, north, east, south = _window(grid, whole=whole)
    step = max(1, round(max(grid.rows, grid.columns) / 24))
    looks: dict[str, Any] = {
        "ha": "center",
        "va": "center",
        "fontsize": 7,
        "color": "#444444",
        "zorder": 6,
        "clip_on": True,
        "path_effects": [withStroke(linewidth=2.2, foreground="white")],
    }
    for row in range(north, south, step):
        x, y = points_m(grid, np.array([west - 0.3, row + 0.5]))
        axes.text(x, y, f"r{row}", **looks)
    for column in range(west, east, step):
        x, y = points_m(grid, np.array([column + 0.5, north - 0.3]))
        axes.text(x, y, f"c{column}", **looks)


def frame(axes: Axes, grid: CoarseGrid, *, margin: float = _MARGIN, labels: bool = True, whole: bool = False) -> None:
    """Show the free cells and those next to them, or the whole grid, with a margin (in cells), in metres of the map."""
    points = points_m(grid, _box(grid, margin, whole=whole))
    axes.set_aspect("equal")
    axes.set_xlim(points[:, 0].min(), points[:, 0].max())
    axes.set_ylim(points[:, 1].min(), points[:, 1].max())
    if labels:
        axes.set_xlabel("x [m]")
        axes.set_ylabel("y [m]")
    else:
        axes.set_xticks([])
        axes.set_yticks([])


def size_in(grid: CoarseGrid, *, most: float, margin: float = _MARGIN, whole: bool = False) -> tuple[float, float]:
    """Return width and height in inches of a panel that shows the grid, its longer side as given."""
    spans = np.ptp(points_m(grid, _box(grid, margin, whole=whole)), axis=0)
    width, height = most * spans / spans.max()
    return float(width), float(height)


def _window(grid: CoarseGrid, *, whole: bool) -> tuple[int, int, int, int]:
    """Return west, north, east, south of what is shown, in cells."""
    rows, columns = np.flatnonzero(grid.free.any(axis=1)), np.flatnonzero(grid.free.any(axis=0))
    if whole or not rows.size:
        return 0, 0, grid.columns, grid.rows
    west, north = max(0, int(columns[0]) - 1), max(0, int(rows[0]) - 1)
    return west, north, min(grid.columns, int(columns[-1]) + 2), min(grid.rows, int(rows[-1]) + 2)


def _box(grid: CoarseGrid, margin: float, *, whole: bool) -> NDArray[np.float64]:
    """Return the corners of what is shown, in cells from the grid's north-western corner."""
    west, north, east, south = _window(grid, whole=whole)
    low_x, low_y, high_x, high_y = west - margin, north - margin, east + margin, south + margin
    return np.array([(low_x, low_y), (high_x, low_y), (high_x, high_y), (low_x, high_y)])

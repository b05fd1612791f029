"""Raised floors and flights of stairs on a map."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke

from surefoot.frames import Direction
from surefoot.missions.scenario.file import Scenario
from surefoot.viewer import style
from surefoot.viewer.sources.cells import points_m
from surefoot.world import CoarseGrid, Rectangle


def draw_levels(axes: Axes, grid: CoarseGrid, scenario: Scenario) -> list[Any]:
    """Draw floors with their heights and stairs with an arrow that points up; return what the legend says."""
    heights = scenario.heights
    for floor in heights.floors:
        for area in floor.rectangles_m:
            _draw_border(axes, grid, area)
        _write_height(axes, grid, max(floor.rectangles_m, key=lambda area: _size(grid, area)), floor.height_m)
    for stairs in heights.stairs:
        _draw_border(axes, grid, stairs.rectangle_m)
        _draw_risers(axes, grid, stairs)
    if not heights.floors and not heights.stairs:
        return []
    return [Patch(facecolor="none", edgecolor=style.BLUE, lw=1.6, label="raised floor, stairs (arrow: up)")]


def _draw_border(axes: Axes, grid: CoarseGrid, area: Rectangle) -> None:
    corners = _corners(grid, area)
    axes.add_collection(PolyCollection([corners], facecolors="none", edgecolors=style.BLUE, lw=1.6, zorder=3))


def _write_height(axes: Axes, grid: CoarseGrid, area: Rectangle, height_m: float) -> None:
    looks: dict[str, Any] = {"fontsize": 8, "color": style.BLUE, "ha": "right", "va": "bottom", "zorder": 9}
    outline = [withStroke(linewidth=2.0, foreground="white")]
    corner = _corners(grid, area)[2]
    axes.annotate(f"{height_m:g} m", corner, (-3, 3), textcoords="offset points", path_effects=outline, **looks)


def _size(grid: CoarseGrid, area: Rectangle) -> float:
    west, north, east, south = grid.bounds(area)
    return float((east - west) * (south - north))


def _corners(grid: CoarseGrid, area: Rectangle) -> Any:
    west, north, east, south = grid.bounds(area)
    return points_m(grid, np.array([(west, north), (west, south), (east, south), (east, north)]))


def _draw_risers(axes: Axes, grid: CoarseGrid, stairs: Any) -> None:
    """Draw the risers of a flight of stairs, and an arrow that points up."""
    west, north, east, south = grid.bounds(stairs.rectangle_m)
    up = Direction[stairs.up.upper()]
    rows, columns = up.offset
    for riser in range(stairs.risers):
        along = (stairs.first_riser_m + riser * stairs.tread_m) / grid.cell_size_m
        if columns:
            x = west + along if columns > 0 else east - along
            line = [(x, north), (x, south)]
        else:
            y = south - along if rows < 0 else north + along
            line = [(west, y), (east, y)]
        points = points_m(grid, np.array(line))
        axes.plot(points[:, 0], points[:, 1], color=style.BLUE, lw=0.6, zorder=3)
    middle = np.array([(west + east) / 2, (north + south) / 2])
    reach = 0.4 * np.array([columns * (east - west), rows * (south - north)])
    tail, tip = points_m(grid, np.array([middle - reach, middle + reach]))
    outline = [withStroke(linewidth=4.0, foreground="white")]
    looks: dict[str, Any] = {"arrowstyle": "-|>", "color": style.BLUE, "lw": 1.6, "path_effects": outline}
    axes.annotate("", tip, tail, arrowprops=looks, zorder=9)

"""Pictures of terrain: the elevation with the polygons over it, and what every cell is."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from surefoot.viewer import style
from surefoot.world import CellClass, ElevationMap, SegmentOptions, Terrain

_LOOKS = {
    CellClass.NO_DATA: ("white", "no data"),
    CellClass.STEPPABLE: (style.GREEN, "steppable"),
    CellClass.STEEP: (style.VERMILION, "too steep: edges, walls"),
    CellClass.ROUGH: (style.ORANGE, "too rough or uneven"),
    CellClass.SMALL: (style.SKY, "even, but too small"),
    CellClass.NARROW: (style.PURPLE, "cells of a narrow raised thing"),
}


def draw_terrain(
    terrain: Terrain,
    scan: ElevationMap | None,
    path: Path,
    *,
    title: str = "terrain",
    options: SegmentOptions | None = None,
) -> Path:
    """Draw the polygons over the elevation and, beside it, the class of every cell.

    Args:
        terrain: what to draw.
        scan: the elevation that it was made from; None when there is none.
        path: of the PNG file.
        title: the name of the scan.
        options: limits, to name beside what they keep out; None: they are not known.
    """
    west, south, east, north = _bounds(terrain, scan)
    panels = 1 if scan is None else 2
    width, height = east - west, north - south
    scale = min(6.5 / max(width, 1e-6), 7.0 / max(height, 1e-6))
    side_by_side = panels == 1 or width <= 2.2 * height
    across, down = (panels, 1) if side_by_side else (1, panels)
    size = (max(scale * width * across + 1.6 * across, 7.0), scale * height * down + 0.9 * down + 0.9)
    with style.pictured(path, *size) as figure:
        axes = figure.subplots(down, across, squeeze=False).ravel()
        _draw_heights(figure, axes[0], terrain, scan, title)
        if scan is not None and terrain.classes is not None:
            _draw_classes(axes[1], terrain, scan)
        for panel in axes:
            panel.set_xlim(west, east)
            panel.set_ylim(south, north)
            panel.set_aspect("equal")
            panel.set_xlabel("x [m]")
            panel.set_ylabel("y [m]")
        style.legend_outside(figure, _legend(terrain, scan, options), columns=4)
    return path


def _draw_heights(figure: Figure, axes: Axes, terrain: Terrain, scan: ElevationMap | None, title: str) -> None:
    outlines = [polygon.vertices_m[:, :2] for polygon in terrain.polygons]
    if scan is not None:
        known = scan.height_m[scan.known]
        low, high = np.quantile(known, [0.002, 0.998])
        image = axes.imshow(
            np.ma.masked_invalid(scan.height_m),
            cmap="Greys_r",
            extent=_extent(scan),
            vmin=float(low) - 0.35 * float(high - low) - 1e-3,
            vmax=float(high) + 1e-3,
            interpolation="nearest",
        )
        axes.set_facecolor("#f3e9ef")
        figure.colorbar(image, ax=axes, label="height [m]", shrink=0.8)
    colours = [(style.BLUE, style.GREEN, style.SKY, style.YELLOW)[polygon.region % 4] for polygon in terrain.polygons]
    axes.add_collection(
        PolyCollection(outlines, facecolors=colours, edgecolors=style.BLUE, alpha=0.45, linewidths=0.0, zorder=2)
    )
    axes.add_collection(PolyCollection(outlines, facecolors="none", edgecolors=style.BLUE, linewidths=0.7, zorder=3))
    _draw_narrow(axes, terrain)
    count = f"{len(outlines)} polygon{'' if len(outlines) == 1 else 's'}"
    axes.set_title(f"{title}: {count}, {terrain.area_m2:.2f} m²")


def _draw_narrow(axes: Axes, terrain: Terrain) -> None:
    lines = [(thing.start_m[:2], thing.end_m[:2]) for thing in terrain.narrow]
    axes.add_collection(LineCollection(lines, colors=style.PURPLE, linewidths=1.6, zorder=4))


def _draw_classes(axes: Axes, terrain: Terrain, scan: ElevationMap) -> None:
    colours = ListedColormap([_LOOKS[CellClass(k)][0] for k in range(len(_LOOKS))])
    axes.imshow(
        np.asarray(terrain.classes),
        cmap=colours,
        vmin=-0.5,
        vmax=len(_LOOKS) - 0.5,
        extent=_extent(scan),
        interpolation="nearest",
    )
    known = max(int(scan.known.sum()), 1)
    steppable = int((np.asarray(terrain.classes) == CellClass.STEPPABLE).sum())
    axes.set_title(f"cells of {scan.resolution_m:g} m: {steppable / known:.0%} of those with data are steppable")


def _limits(options: SegmentOptions | None) -> dict[CellClass, str]:
    """Return what decides that a cell is not steppable."""
    if options is None:
        return {}
    rough, error = 1000 * options.max_roughness_m, 1000 * options.max_error_m
    return {
        CellClass.STEEP: f" (over {options.max_slope_deg:g}° in 3 x 3 cells)",
        CellClass.ROUGH: f" (over {rough:g} mm about its plane, or {error:g} mm off)",
        CellClass.SMALL: f" (under {1e4 * options.min_area_m2:g} cm² without margins)",
    }


def _legend(terrain: Terrain, scan: ElevationMap | None, options: SegmentOptions | None) -> list[Any]:
    handles: list[Any] = [Patch(facecolor=style.BLUE, alpha=0.45, edgecolor=style.BLUE, label="polygon (margin off)")]
    if terrain.narrow:
        handles.append(Line2D([], [], color=style.PURPLE, lw=1.6, label="narrow raised thing: its centre line"))
    if scan is not None and terrain.classes is not None:
        there, limits = np.unique(np.asarray(terrain.classes)), _limits(options)
        handles += [
            Patch(facecolor=colour, edgecolor="#999999", lw=0.5, label=label + limits.get(kind, ""))
            for kind, (colour, label) in _LOOKS.items()
            if int(kind) in there
        ]
    return handles


def _extent(scan: ElevationMap) -> tuple[float, float, float, float]:
    (x, y), (width, height) = scan.origin_m, scan.size_m
    return x, x + width, y, y + height


def _bounds(terrain: Terrain, scan: ElevationMap | None) -> tuple[float, float, float, float]:
    """Return west, south, east and north of what is drawn."""
    if scan is not None:
        west, east, south, north = _extent(scan)
        return west, south, east, north
    if not terrain.polygons:
        return 0.0, 0.0, 1.0, 1.0
    points = np.vstack([polygon.vertices_m[:, :2] for polygon in terrain.polygons])
    (west, south), (east, north) = points.min(axis=0) - 0.1, points.max(axis=0) + 0.1
    return float(west), float(south), float(east), float(north)

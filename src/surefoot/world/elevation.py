"""Elevation maps: heights on a square grid, with holes where nothing was measured."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError

MAX_CELLS = 25_000_000
RESOLUTION_M = (1e-3, 10.0)
_FARTHEST_M = 1e5


@dataclass(frozen=True, slots=True, eq=False)
class ElevationMap:
    """Heights on a square grid.

    Attributes:
        height_m: (rows, columns), read-only; row 0 is the north (largest y), column 0 the west (smallest x); NaN where
            there is no data.
        resolution_m: side of a cell.
        origin_m: world position of the south-western corner of the south-western cell.
        source: the file.
        reading: how the file was read, with every value used: what is needed to read it again.
        notes: what a user should know about the data.
    """

    height_m: NDArray[np.float64]
    resolution_m: float
    origin_m: tuple[float, float] = (0.0, 0.0)
    source: Path | None = None
    reading: Mapping[str, object] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    @property
    def known(self) -> NDArray[np.bool_]:
        """Which cells hold a height."""
        return np.isfinite(self.height_m)

    @property
    def size_m(self) -> tuple[float, float]:
        """Extent from west to east and from south to north."""
        rows, columns = self.height_m.shape
        return columns * self.resolution_m, rows * self.resolution_m

    def place_m(self, columns: NDArray[np.float64], rows: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return world positions (n, 2) of grid positions, where whole numbers are the centres of cells."""
        height = self.height_m.shape[0]
        x = self.origin_m[0] + (columns + 0.5) * self.resolution_m
        y = self.origin_m[1] + (height - rows - 0.5) * self.resolution_m
        return np.column_stack((x, y))


def elevation_map(
    height_m: NDArray[np.floating] | NDArray[np.integer],
    resolution_m: float,
    origin_m: tuple[float, float] = (0.0, 0.0),
    *,
    source: Path | None = None,
    reading: Mapping[str, object] | None = None,
    notes: tuple[str, ...] = (),
) -> ElevationMap:
    """Return an elevation map from an array of heights, after checking that it can be used.

    Args:
        height_m: (rows, columns), row 0 in the north; what is not finite is a hole.
        resolution_m: side of a cell.
        origin_m: south-western corner.
        source: the file it comes from.
        reading: how it was read.
        notes: what a user should know.

    Raises:
        InputError: no cell holds a height, or a number is out of range.
    """
    check_resolution(resolution_m, source)
    heights = np.array(height_m, np.float64)
    if heights.ndim != 2:
        raise InputError(f"heights have to be a table of rows and columns, not of shape {heights.shape}", source=source)
    if heights.size == 0:
        raise InputError("holds no cells; at least one height is needed", source=source)
    if heights.size > MAX_CELLS:
        raise InputError(f"has {heights.size} cells; at most {MAX_CELLS} are allowed", source=source)
    if not all(map(math.isfinite, origin_m)) or max(map(abs, origin_m)) > _FARTHEST_M:
        raise InputError(f"the origin has to be two finite numbers in metres, not {origin_m}", source=source)
    heights[~np.isfinite(heights)] = np.nan
    if np.isnan(heights).all():
        raise InputError("holds no height at all: every cell is empty (NaN, infinite or transparent)", source=source)
    if float(np.nanmax(np.abs(heights))) > _FARTHEST_M:
        raise InputError(f"holds a height beyond {_FARTHEST_M:g} m; heights are metres", source=source)
    heights.setflags(write=False)
    origin = (float(origin_m[0]), float(origin_m[1]))
    return ElevationMap(heights, float(resolution_m), origin, source, dict(reading or {}), notes)


def check_resolution(resolution_m: float, source: Path | None) -> None:
    """Raise InputError unless a resolution can be one."""
    least, most = RESOLUTION_M
    if not least <= resolution_m <= most:
        raise InputError(
            f"has to be metres per cell, from {least:g} to {most:g}, not {resolution_m:g}",
            source=source,
            key="resolution",
        )

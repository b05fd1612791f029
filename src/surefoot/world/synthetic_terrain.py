"""Scans with known truth: stairs and stepping stones, seen with noise and dropouts. For tests and benchmarks."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from surefoot.world.elevation import ElevationMap, elevation_map

Floats = NDArray[np.float64]
Height = Callable[[Floats, Floats], Floats]
Outline = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class SyntheticTerrain:
    """A terrain that is known exactly, and a scan of it.

    Attributes:
        elevation: the scan.
        height_m: the true height at positions (x, y); NaN over holes.
        tops_m: outlines (n, 2) of the true planar surfaces a foot may stand on, all convex.
    """

    elevation: ElevationMap
    height_m: Height
    tops_m: tuple[Outline, ...]


def stairs(
    *,
    steps: int = 8,
    tread_m: float = 0.30,
    riser_m: float = 0.15,
    width_m: float = 2.0,
    cell_m: float = 0.02,
    noise_m: float = 0.01,
    missing: float = 0.0,
    seed: int = 0,
    yaw_rad: float = 0.0,
) -> SyntheticTerrain:
    """Return a flight of stairs that rises along x, between two landings of 1 m."""
    edges = np.array([1.0 + k * tread_m for k in range(steps)])
    length_m = 2.0 + (steps - 1) * tread_m
    bounds = [0.0, *edges, length_m]
    tops = [_box(low, 0.0, high, width_m) for low, high in pairwise(bounds)]

    def height(x: Floats, y: Floats) -> Floats:
        inside = (x >= 0) & (x < length_m) & (y >= 0) & (y < width_m)
        return np.where(inside, riser_m * np.searchsorted(edges, x, side="right"), np.nan)

    return _scanned(height, tops, (length_m, width_m), cell_m, noise_m, missing, seed, yaw_rad)


def stones(
    *,
    rows: int = 4,
    columns: int = 8,
    stone_m: float = 0.20,
    gap_m: float = 0.05,
    top_m: float = 0.12,
    floor: bool = True,
    height_spread_m: float = 0.0,
    cell_m: float = 0.02,
    noise_m: float = 0.01,
    missing: float = 0.0,
    seed: int = 0,
    yaw_rad: float = 0.0,
) -> SyntheticTerrain:
    """Return square stepping stones between two strips of 0.6 m, over a floor 12 cm below or over nothing."""
    pitch = stone_m + gap_m
    length_m, width_m = 1.2 + columns * pitch + gap_m, rows * pitch + gap_m
    chance = np.random.default_rng(seed + 1000)
    tops = [_box(0.0, 0.0, 0.6, width_m), _box(length_m - 0.6, 0.0, length_m, width_m)]
    heights = [top_m, top_m]
    for row in range(rows):
        for column in range(columns):
            x, y = 0.6 + gap_m + column * pitch, gap_m + row * pitch
            tops.append(_box(x, y, x + stone_m, y + stone_m))
            heights.append(top_m + float(chance.uniform(-height_spread_m, height_spread_m)))

    def height(x: Floats, y: Floats) -> Floats:
        inside = (x >= 0) & (x < length_m) & (y >= 0) & (y < width_m)
        out = np.where(inside, 0.0 if floor else np.nan, np.nan)
        for top, level in zip(tops, heights, strict=True):
            (west, south), (east, north) = top[0], top[2]
            out = np.where((x >= west) & (x < east) & (y >= south) & (y < north), level, out)
        return out

    return _scanned(height, tops, (length_m, width_m), cell_m, noise_m, missing, seed, yaw_rad)


def _box(west: float, south: float, east: float, north: float) -> Outline:
    return np.array([(west, south), (east, south), (east, north), (west, north)])


def _scanned(
    height: Height,
    tops: list[Outline],
    size_m: tuple[float, float],
    cell_m: float,
    noise_m: float,
    missing: float,
    seed: int,
    yaw_rad: float,
) -> SyntheticTerrain:
    """Turn a terrain about the origin and sample it at the centres of cells, with noise and dropouts."""
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    turn = np.array([[cos, -sin], [sin, cos]])
    corners = _box(0.0, 0.0, *size_m) @ turn.T
    low = np.floor(corners.min(axis=0) / cell_m - 2) * cell_m
    columns, rows = (math.ceil(side / cell_m) + 2 for side in corners.max(axis=0) - low)
    x = low[0] + (np.arange(columns) + 0.5) * cell_m
    y = low[1] + (rows - np.arange(rows) - 0.5) * cell_m

    def turned(x: Floats, y: Floats) -> Floats:
        return height(cos * x + sin * y, cos * y - sin * x)

    clean = turned(*np.meshgrid(x, y))
    chance = np.random.default_rng(seed)
    seen = clean + chance.normal(0.0, noise_m, clean.shape) if noise_m else clean.copy()
    seen[chance.random(clean.shape) < missing] = np.nan
    scan = elevation_map(seen, cell_m, (float(low[0]), float(low[1])))
    return SyntheticTerrain(scan, turned, tuple(top @ turn.T for top in tops))

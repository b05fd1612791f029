"""The map in three dimensions: walls, floors and stairs as triangles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from surefoot.frames import Cell, Direction
from surefoot.viewer.sources.cells import floor_m, points_m
from surefoot.viewer.sources.plans import PlanSource
from surefoot.world import CoarseGrid, HeightMap, OccupancyMap

Array = NDArray[np.float64]

WALL_M = 1.0
_BELOW_M = 0.05
_CORNERS = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """Triangles: vertices (n, 3) in the world, faces (m, 3)."""

    vertices_m: Array
    faces: NDArray[np.uint32]


def walls(occupancy: OccupancyMap, height_m: float = WALL_M) -> Solid:
    """Return the occupied pixels as boxes; neighbours in a row, and equal rows, are one box."""
    rows = occupancy.occupied.shape[0]
    boxes = []
    for (left, right), (top, bottom) in _rectangles(occupancy.occupied):
        flat = np.array([(left, rows - bottom), (right, rows - bottom), (right, rows - top), (left, rows - top)])
        boxes.append((_placed(occupancy, flat * occupancy.resolution_m), 0.0, height_m))
    return _prisms(boxes)


def floors(source: PlanSource, heights: HeightMap) -> Solid:
    """Return the free cells as slabs at the height of their floor; treads of stairs each for itself."""
    grid = source.grid
    slabs = []
    for row, column in np.argwhere(grid.free):
        cell = Cell(int(row), int(column))
        for part, top_m in _tops(heights, cell):
            slabs.append((points_m(grid, np.array([column, row]) + part), min(0.0, top_m) - _BELOW_M, top_m))
    return _prisms(slabs)


def cell_tiles(grid: CoarseGrid, heights: HeightMap, cells: NDArray[np.int64], above_m: float, inset: float) -> Solid:
    """Return thin squares just above the floors of cells, given as rows and columns."""
    tiles = []
    square = inset + (1 - 2 * inset) * _CORNERS
    for row, column in cells:
        top_m = floor_m(heights, Cell(int(row), int(column))) + above_m
        tiles.append((points_m(grid, np.array([column, row]) + square), top_m - 0.01, top_m))
    return _prisms(tiles)


def borders(source: PlanSource, heights: HeightMap) -> Array:
    """Return the sides of the free cells without stairs, just above their floors, shape (n, 2, 3)."""
    raised = np.array([0.0, 0.0, 0.004])
    lines = []
    for row, column in np.argwhere(source.grid.free):
        cell = Cell(int(row), int(column))
        if heights.profile(cell) is not None:
            continue
        flat = points_m(source.grid, np.array([column, row]) + _CORNERS)
        height_m = np.full((4, 1), floor_m(heights, cell))
        corners = np.concatenate([flat, height_m], axis=1) + raised
        lines.append(np.stack([corners, np.roll(corners, -1, axis=0)], axis=1))
    return np.concatenate(lines) if lines else np.zeros((0, 2, 3))


def _tops(heights: HeightMap, cell: Cell) -> list[tuple[Array, float]]:
    """Return parts of a cell, as corners in cells from its north-west, with their heights."""
    base_m, profile = float(heights.base_m[cell.row, cell.column]), heights.profile(cell)
    if profile is None:
        return [(_CORNERS.astype(np.float64), base_m)]
    levels = np.array(profile.heights_m)
    starts = np.concatenate([[0], np.flatnonzero(np.diff(levels)) + 1, [len(levels)]])
    return [
        (_slice(profile.up, first / len(levels), last / len(levels)), base_m + float(levels[first]))
        for first, last in pairwise(starts)
    ]


def _slice(up: Direction, begin: float, end: float) -> Array:
    """Return the corners of the part of a unit cell between two shares of the way up."""
    low, high = {
        Direction.EAST: ((begin, 0.0), (end, 1.0)),
        Direction.WEST: ((1 - end, 0.0), (1 - begin, 1.0)),
        Direction.NORTH: ((0.0, 1 - end), (1.0, 1 - begin)),
        Direction.SOUTH: ((0.0, begin), (1.0, end)),
    }[up]
    corners: Array = np.array(low) + _CORNERS * (np.array(high) - np.array(low))
    return corners


def _rectangles(mask: NDArray[np.bool_]) -> list[tuple[tuple[int, int], tuple[int, int]]]:
    """Return rectangles ((left, right), (top, bottom)) of pixels that cover a mask once."""
    found: list[tuple[tuple[int, int], tuple[int, int]]] = []
    growing: dict[tuple[int, int], int] = {}
    for row in range(mask.shape[0] + 1):
        line = mask[row] if row < mask.shape[0] else np.zeros(mask.shape[1], np.bool_)
        edges = np.flatnonzero(np.diff(np.concatenate([[False], line, [False]]).astype(np.int8)))
        runs = {(int(left), int(right)) for left, right in edges.reshape(-1, 2)}
        ended = [run for run in growing if run not in runs]
        found.extend((run, (growing.pop(run), row)) for run in ended)
        for run in runs:
            growing.setdefault(run, row)
    return found


def _placed(occupancy: OccupancyMap, points: Array) -> Array:
    c, s = np.cos(occupancy.yaw_rad), np.sin(occupancy.yaw_rad)
    turned: Array = points @ np.array([[c, s], [-s, c]]) + np.array(occupancy.origin_m[:2])
    return turned


def _prisms(parts: list[tuple[Array, float, float]]) -> Solid:
    """Return upright prisms over quadrilaterals, from a height to another."""
    side = [(a, (a + 1) % 4) for a in range(4)]
    one = [(0, 2, 1), (0, 3, 2), (4, 5, 6), (4, 6, 7)]
    one += [face for a, b in side for face in ((a, b, b + 4), (a, b + 4, a + 4))]
    vertices = np.zeros((8 * len(parts), 3))
    for number, (corners, low_m, high_m) in enumerate(parts):
        ordered = corners if _counter_clockwise(corners) else corners[::-1]
        vertices[8 * number : 8 * number + 8, :2] = np.tile(ordered, (2, 1))
        vertices[8 * number : 8 * number + 4, 2] = low_m
        vertices[8 * number + 4 : 8 * number + 8, 2] = high_m
    faces = (np.array(one)[None] + 8 * np.arange(len(parts))[:, None, None]).reshape(-1, 3)
    return Solid(vertices, faces.astype(np.uint32))


def slab(vertices_m: Array, thickness_m: float | Array) -> Solid:
    """Return a convex polygon, corners (n, 3), with some thickness below it, one for all corners or one for each."""
    count = len(vertices_m)
    below = np.zeros_like(vertices_m)
    below[:, 2] = thickness_m
    vertices = np.concatenate([vertices_m, vertices_m - below])
    top = [(0, k, k + 1) for k in range(1, count - 1)]
    bottom = [(count, count + k + 1, count + k) for k in range(1, count - 1)]
    sides = [
        face
        for a, b in ((k, (k + 1) % count) for k in range(count))
        for face in ((a, a + count, b), (b, a + count, b + count))
    ]
    return Solid(vertices, np.array([*top, *bottom, *sides], dtype=np.uint32))


def together(solids: Sequence[Solid]) -> Solid:
    """Return solids as one."""
    begins = np.cumsum([0, *(len(one.vertices_m) for one in solids)])
    faces = [one.faces + begin for one, begin in zip(solids, begins[:-1], strict=True)]
    return Solid(np.concatenate([one.vertices_m for one in solids]), np.concatenate(faces).astype(np.uint32))


def _counter_clockwise(corners: Array) -> bool:
    (ax, ay), (bx, by), (cx, cy) = corners[:3]
    return bool((bx - ax) * (cy - by) - (by - ay) * (cx - bx) > 0)

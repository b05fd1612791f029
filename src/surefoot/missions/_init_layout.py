"""Where to lay a grid over a map, and where on it a mission can start: for `surefoot scenario init`."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from itertools import pairwise, product

from surefoot.frames import Cell, Direction
from surefoot.world import CoarseGrid, OccupancyMap, Rectangle, make_grid

_LEAST_SHIFTS = 6
_PIXELS_LOOKED_AT = 500_000_000
_DECIMALS = 7

Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Layout:
    """A grid with places on it.

    Attributes:
        grid: the coarse grid; its origin is rounded as it will be written.
        loops: the free cells from which a robot that makes no U-turn can go on for ever, one connected set.
        start: where the robot starts.
        heading: the way it faces there, toward the first goal.
        goals: two cells far apart.
        obstacle: a cell far from the start, None when there is no room.
    """

    grid: CoarseGrid
    loops: frozenset[Cell]
    start: Cell
    heading: Direction
    goals: tuple[Cell, Cell]
    obstacle: Cell | None


def best_grid(occupancy: OccupancyMap, cell_size_m: float, inflation_m: float, most_shifts: int = 60) -> CoarseGrid:
    """Return the grid, among evenly spaced shifts, with the most cells on loops, and then the most free cells.

    The cells are parallel to the map's picture, and their corners lie on corners of pixels.

    Args:
        occupancy: the map.
        cell_size_m: side of a coarse cell.
        inflation_m: how far from a cell occupied pixels block it.
        most_shifts: bound on the shifts along each axis; large maps get fewer.
    """
    c, s = math.cos(occupancy.yaw_rad), math.sin(occupancy.yaw_rad)
    best: tuple[tuple[int, int], CoarseGrid] | None = None
    steps_m = _shifts_m(occupancy, cell_size_m, most_shifts)
    for x, y in product(steps_m, steps_m):
        origin = (
            round(occupancy.origin_m[0] + c * x - s * y, _DECIMALS),
            round(occupancy.origin_m[1] + s * x + c * y, _DECIMALS),
        )
        grid = make_grid(
            occupancy,
            cell_size_m=cell_size_m,
            origin_m=origin,
            rotation_rad=occupancy.yaw_rad,
            inflation_m=inflation_m,
        )
        score = len(looping_cells(grid)), int(grid.free.sum())
        if best is None or score > best[0]:
            best = score, grid
    assert best is not None
    return best[1]


def _shifts_m(occupancy: OccupancyMap, cell_size_m: float, most: int) -> list[float]:
    """Return shifts along an axis: whole pixels, spread over a cell, as many as the size of the map allows."""
    pixels = cell_size_m / occupancy.resolution_m
    count = min(most, max(_LEAST_SHIFTS, math.isqrt(_PIXELS_LOOKED_AT // occupancy.occupied.size)))
    count = max(1, min(count, math.floor(pixels + 1e-6)))
    return [round(k * pixels / count) * occupancy.resolution_m for k in range(count)]


def looping_cells(grid: CoarseGrid) -> frozenset[Cell]:
    """Return the largest connected set of free cells without dead ends, which are cut off again and again."""
    left = set(grid.free_cells())
    ends = [cell for cell in left if len(_beside(cell, left)) <= 1]
    while ends:
        left.difference_update(ends)
        ends = [cell for cell in left if len(_beside(cell, left)) <= 1]
    return max(_components(left), key=len, default=frozenset())


def lay_out(grid: CoarseGrid, loops: frozenset[Cell]) -> Layout:
    """Place start, goals and an obstacle on the cells of loops.

    The goals are as far apart as a double sweep finds; the start is far from both, and the obstacle far from the start.
    """
    first = _farthest(distances(min(loops), loops))
    from_first = distances(first, loops)
    second = _farthest(from_first)
    from_second = distances(second, loops)
    rest = [cell for cell in sorted(loops) if cell not in (first, second)]
    start = max(rest, key=lambda cell: min(from_first[cell], from_second[cell]))
    if from_first[start] > from_second[start]:
        first, second, from_first = second, first, from_second
    heading = min(
        (way for way in Direction if start.neighbour(way) in loops), key=lambda way: from_first[start.neighbour(way)]
    )
    from_start = distances(start, loops)
    room = [cell for cell in rest if from_start[cell] > 2]
    obstacle = max(room, key=lambda cell: from_start[cell], default=None)
    return Layout(grid, loops, start, heading, (first, second), obstacle)


def distances(source: Cell, cells: Collection[Cell]) -> dict[Cell, int]:
    """Return the number of moves from a cell to every cell that can be reached inside a set."""
    found = {source: 0}
    queue = deque([source])
    while queue:
        cell = queue.popleft()
        for near in _beside(cell, cells):
            if near not in found:
                found[near] = found[cell] + 1
                queue.append(near)
    return found


def square(grid: CoarseGrid, cell: Cell) -> Rectangle:
    """Return a cell as two opposite corners in the world, rounded as it will be written."""
    corners = (*grid.corner_m(cell), *grid.corner_m(Cell(cell.row + 1, cell.column + 1)))
    x0, y0, x1, y1 = (round(value, _DECIMALS) for value in corners)
    return x0, y0, x1, y1


def quarters(grid: CoarseGrid, cells: Iterable[Cell]) -> tuple[Rectangle, ...]:
    """Return rectangles that cut the bounding box of cells into up to six parts of about the same size."""
    cells = tuple(cells)
    rows, columns = [cell.row for cell in cells], [cell.column for cell in cells]
    wide = max(columns) - min(columns) >= max(rows) - min(rows)
    row_cuts = _cuts(min(rows), max(rows) + 1, 2 if wide else 3)
    column_cuts = _cuts(min(columns), max(columns) + 1, 3 if wide else 2)
    rectangles = []
    for north, south in row_cuts:
        for west, east in column_cuts:
            if any(north <= cell.row < south and west <= cell.column < east for cell in cells):
                first, last = square(grid, Cell(north, west)), square(grid, Cell(south - 1, east - 1))
                rectangles.append((first[0], first[1], last[2], last[3]))
    return tuple(rectangles)


def _cuts(low: int, high: int, parts: int) -> list[tuple[int, int]]:
    bounds = sorted({low + round(part * (high - low) / parts) for part in range(parts + 1)})
    return list(pairwise(bounds))


def _beside(cell: Cell, cells: Collection[Cell]) -> list[Cell]:
    return [near for way in Direction if (near := cell.neighbour(way)) in cells]


def _components(cells: set[Cell]) -> list[frozenset[Cell]]:
    left, parts = set(cells), []
    while left:
        part = frozenset(distances(min(left), left))
        left -= part
        parts.append(part)
    return parts


def _farthest(found: dict[Cell, int]) -> Cell:
    return max(sorted(found), key=lambda cell: found[cell])

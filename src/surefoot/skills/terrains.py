"""Seeded terrains for every scene of the paper: stepping stones with 4 and 8 classes, rebar with 7 and 14, a zig-zag.

Source: Zhou et al. 2025, IX-B (what the scenes hold) and IX-F (the zig-zag); all numbers that the paper leaves open are
drawn or set here, see docs/skills.md, "Terrain".
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from surefoot.errors import InputError
from surefoot.footholds.terrain import polygon
from surefoot.skills.classes import class_set
from surefoot.skills.grid import LocalGrid
from surefoot.skills.ground_pieces import Plate, bar_corners, walkable
from surefoot.skills.patches import Rectangle
from surefoot.skills.quadruped_terrain import Point, QuadrupedTerrain
from surefoot.skills.values import Cell

VOID = "void"
_LEVEL_M = 0.13
"""Height of a step; classes reach to 0.15."""


@dataclass(frozen=True, slots=True)
class Plot:
    """What the generator puts into a cell: a kind of ground and its height."""

    kind: str
    height_m: float = 0.0


def generated(name: str, seed: int, *, grid: tuple[int, int] = (3, 3)) -> QuadrupedTerrain:
    """Return the terrain of a scene and a seed.

    Args:
        name: one of ``SCENES``.
        seed: of all that is drawn; the same seed gives the same terrain.
        grid: rows and columns of local grids.

    Raises:
        InputError: there is no such scene, or the grid has no middle.
    """
    if name not in SCENES:
        raise InputError(f"there is no scene {name!r}; there are: {', '.join(SCENES)}")
    if grid[0] % 2 == 0 or grid[1] % 2 == 0 or min(grid) < 3 or max(grid) > 9:
        raise InputError("a local grid has odd sides from 3 to 9, such as 3 x 3 or 5 x 5", key="grid")
    return SCENES[name](name, seed, grid)


def _unstructured(name: str, seed: int, grid: tuple[int, int], *, rows: int, columns: int) -> QuadrupedTerrain:
    rng = np.random.default_rng([seed, rows])
    steps = "8" in name
    plots: dict[Cell, Plot] = {}
    themes, heights = _themes(rng, rows), _heights(rng, rows) if steps else np.zeros(rows)
    for row in range(rows):
        for column in range(columns):
            plots[row, column] = _drawn(rng, themes[row], float(heights[row]), steps, calm=row in (0, rows - 1))
    return _laid(name, name, seed, grid, (rows, columns), plots, rng)


def _themes(rng: np.random.Generator, rows: int) -> list[str]:
    """Return what most cells of each row are: all kinds in turn, flat at both ends and between gaps."""
    kinds: list[str] = []
    while len(kinds) < rows:
        kinds += [str(kind) for kind in rng.permutation(["dense", "sparse", "gap", "flat"])]
    kinds = kinds[:rows]
    kinds[0] = kinds[-1] = "flat"
    return kinds


def _heights(rng: np.random.Generator, rows: int) -> np.ndarray:
    """Return the height of every row, from the rear on: plateaus that rise and fall by one step."""
    level, found = 0, np.zeros(rows)
    row = rows - 2
    while row >= 1:
        level = int(np.clip(level + rng.choice([-1, 0, 1], p=[0.35, 0.3, 0.35]), -1, 1))
        for _ in range(int(rng.integers(1, 4))):
            if row >= 1:
                found[row] = level * _LEVEL_M
                row -= 1
    return found


def _drawn(rng: np.random.Generator, theme: str, height_m: float, steps: bool, *, calm: bool) -> Plot:
    chance, shift = rng.random(), rng.random()
    kind = str(rng.choice(["flat", "dense", "sparse"]))
    if calm:
        return Plot("flat", height_m)
    if chance < 0.06:
        return Plot(VOID)
    if steps and shift < 0.15:
        height_m += _LEVEL_M * (1 if shift < 0.075 else -1)
    return Plot(theme if chance < 0.75 or theme == "gap" else kind, height_m)


def _zig_zag(name: str, seed: int, grid: tuple[int, int]) -> QuadrupedTerrain:
    rng = np.random.default_rng([seed, 77])
    rows, columns = 11, 7
    plots = {(row, column): Plot(VOID) for row in range(rows) for column in range(columns)}
    row, column, way = rows - 1, int(rng.integers(1, 3)), 1
    plots[row, column] = Plot("flat")
    while row > 0:
        for _ in range(min(int(rng.integers(2, 4)), row)):
            row -= 1
            plots[row, column] = Plot(str(rng.choice(["dense", "sparse"])))
        end = columns - 2 if way > 0 else 1
        while row > 0 and column != end:
            column += way
            plots[row, column] = Plot(str(rng.choice(["dense", "sparse"])))
        way = -way
    plots[0, column] = Plot("flat")
    return _laid(name, "unstructured-4", seed, grid, (rows, columns), plots, rng)


def _laid(
    name: str,
    classes: str,
    seed: int,
    grid: tuple[int, int],
    cells: tuple[int, int],
    plots: dict[Cell, Plot],
    rng: np.random.Generator,
) -> QuadrupedTerrain:
    """Return the terrain of plots: one plate for all flat ground of a height, stones of their own."""
    rules = class_set(classes)
    bare = QuadrupedTerrain(
        f"{name}, seed {seed}", rules.robot, rules, rules.cell_m, grid, (0.0, 0.0), cells, (), rules.margin_m
    )
    openings = rng.uniform(0.24, 0.29, size=cells[0])
    plates: list[Plate] = []
    for cell, plot in plots.items():
        plates += _plates(plot, bare.square_m(cell), float(openings[cell[0]]), rng)
    polygons = tuple(polygon(corners) for corners in walkable(plates, rules.margin_m))
    return with_ends(replace(bare, polygons=polygons))


def with_ends(terrain: QuadrupedTerrain) -> QuadrupedTerrain:
    """Return a terrain with a start and a goal: where the robot can stand, as far behind and ahead as there is."""
    rows = range(terrain.cells[0])
    return replace(terrain, start_m=_end(terrain, reversed(rows)), goal_m=_end(terrain, rows))


def _end(terrain: QuadrupedTerrain, rows: Iterable[int]) -> Point | None:
    middle = terrain.cells[1] // 2
    columns = sorted(range(terrain.cells[1]), key=lambda column: abs(column - middle))
    places = (terrain.centre_m((row, column)) for row in rows for column in columns)
    return next((place for place in places if LocalGrid(terrain, place).standing), None)


def _plates(plot: Plot, square: Rectangle, open_m: float, rng: np.random.Generator) -> list[Plate]:
    if plot.kind == VOID:
        return []
    if plot.kind == "flat":
        return [Plate(square, plot.height_m)]
    if plot.kind == "gap":
        middle = (square.west + square.east) / 2
        near = Rectangle(square.west, square.south, middle - open_m / 2, square.north)
        far = Rectangle(middle + open_m / 2, square.south, square.east, square.north)
        return [Plate(near, plot.height_m), Plate(far, plot.height_m)]
    per_side, size, jitter, yaw = (3, 0.205, 0.008, 0.04) if plot.kind == "dense" else (2, 0.245, 0.015, 0.08)
    return _stones(square, plot.height_m, per_side, size, jitter, yaw, rng)


def _stones(
    square: Rectangle, height_m: float, per_side: int, size_m: float, jitter_m: float, yaw_rad: float,
    rng: np.random.Generator,
) -> list[Plate]:  # fmt: skip
    pitch = (square.east - square.west) / per_side
    found = []
    for i in range(per_side):
        for j in range(per_side):
            x, y = square.west + (i + 0.5) * pitch, square.south + (j + 0.5) * pitch
            dx, dy = rng.uniform(-jitter_m, jitter_m, size=2)
            half = (size_m + rng.uniform(-0.01, 0.005)) / 2
            stone = Rectangle(-half, -half, half, half).moved(x + float(dx), y + float(dy))
            found.append(Plate(stone, height_m, float(rng.uniform(-yaw_rad, yaw_rad))))
    return found


def _rebar(name: str, seed: int, grid: tuple[int, int], *, rows: int, columns: int) -> QuadrupedTerrain:
    """Return a mat whose bars change their spacing every two or three cells, in each direction on its own."""
    rng = np.random.default_rng([seed, columns])
    rules = class_set(name)
    bare = QuadrupedTerrain(
        f"{name}, seed {seed}", rules.robot, rules, rules.cell_m, grid, (0.0, 0.0), (rows, columns), (), rules.margin_m
    )
    side, wide = rules.cell_m, "14" in name
    length, width = rows * side, columns * side
    corners = []
    for low, high in _blocks(rng, columns):
        corners += [bar_corners((x, low * side), (x, high * side), rng) for x in _spaced(rng, length, wide)]
    for low, high in _blocks(rng, rows):
        corners += [bar_corners((low * side, y), (high * side, y), rng) for y in _spaced(rng, width, wide)]
    bars = tuple(polygon(one) for one in corners)
    return with_ends(replace(bare, polygons=bars))


def _blocks(rng: np.random.Generator, count: int) -> list[tuple[int, int]]:
    """Cut a number of cells into blocks of two or three."""
    edges = [0]
    while edges[-1] < count:
        edges.append(min(edges[-1] + int(rng.integers(2, 4)), count))
    return list(pairwise(edges))


def _spaced(rng: np.random.Generator, length: float, wide: bool) -> list[float]:
    """Return places along a length: stretches of one spacing each, of about 1.2 m, some of them empty."""
    places, x = [], float(rng.uniform(0.05, 0.15))
    while x < length - 0.03:
        chance = rng.random()
        low, high = (0.11, 0.145) if chance < 0.15 else (0.15, 0.34)
        if wide and chance > 0.6:
            low, high = 0.36, 0.6
        if rng.random() < 0.15:
            x += float(rng.uniform(0.7, 1.1))
        end = x + float(rng.uniform(0.9, 1.5))
        while x < min(end, length - 0.03):
            places.append(x)
            x += float(rng.uniform(low, high))
    return places


Scene = Callable[[str, int, tuple[int, int]], QuadrupedTerrain]

SCENES: dict[str, Scene] = {
    "unstructured-4": lambda name, seed, grid: _unstructured(name, seed, grid, rows=10, columns=6),
    "unstructured-8": lambda name, seed, grid: _unstructured(name, seed, grid, rows=14, columns=6),
    "rebar-7": lambda name, seed, grid: _rebar(name, seed, grid, rows=8, columns=8),
    "rebar-14": lambda name, seed, grid: _rebar(name, seed, grid, rows=9, columns=8),
    "zig-zag": _zig_zag,
}

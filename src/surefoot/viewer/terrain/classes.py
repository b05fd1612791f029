"""Pictures of a quadruped's terrain: polygons with the class of every cell, all classes, and what physics says."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from textwrap import fill
from typing import Any, Protocol

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgba
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patches import Rectangle as Box

from surefoot.footholds.terrain import Polygon
from surefoot.skills.classes import ClassSet
from surefoot.skills.grid import LocalGrid
from surefoot.skills.obstacles import why_obstacle
from surefoot.skills.patches import class_polygons, class_rectangles
from surefoot.skills.quadruped_terrain import QuadrupedTerrain
from surefoot.skills.values import OBSTACLE, Cell, CheckResult, Direction, Physics
from surefoot.viewer import style

_COLOURS = (style.SKY, style.GREEN, style.YELLOW, style.ORANGE, style.PURPLE, style.VERMILION, style.BLUE)
_PAPER = "#f7f7f7"
_NOTES = 2
_LARGEST_IN = 30.0
_LEAST_WORDED_IN = 0.75
_WORDLESS_IN = 8.0
"""The larger side of a panel whose cells are too many for words: colours and the legend tell the classes."""
_TITLE_LETTERS = 32
Colour = tuple[float, float, float, float]
_ANSWERS = {Physics.INFEASIBLE: ("#d9d9d9", "infeasible"), Physics.UNKNOWN: (style.VERMILION, "unknown")}
_GAIT_COLOURS = (style.GREEN, style.SKY, style.BLUE, style.ORANGE, style.PURPLE)


def draw_quadruped_terrain(terrain: QuadrupedTerrain, path: Path) -> Path:
    """Draw the polygons by height, and beside them the class of every cell as a robot that stands in it sees it.

    The heading points up.

    Args:
        terrain: what to draw.
        path: of the PNG file.
    """
    rows, columns = terrain.cells
    scale, worded = _scale(rows, columns)
    with style.pictured(path, max(1.05 * scale * columns * 2 + 0.8, 7.0), scale * rows + 1.6) as figure:
        left, right = figure.subplots(1, 2)
        handles: list[Any] = [*_draw_polygons(left, terrain.polygons)]
        _draw_labels(right, terrain)
        if worded:
            _write_labels(right, terrain, scale)
        for axes in (left, right):
            _lattice(axes, terrain)
        handles += _draw_ends(left, terrain)
        count = len(terrain.polygons)
        left.set_title(fill(f"{terrain.name}: {count} polygon{'' if count == 1 else 's'}", _TITLE_LETTERS))
        right.set_title(fill(f"classes ({terrain.classes.name}), seen from each cell itself", _TITLE_LETTERS))
        colours = class_colours(terrain.classes)
        shown = {label for label, *_ in _labels(terrain)}
        handles += [
            Patch(facecolor=colours[name], edgecolor="#888888", label=name) for name in colours if name in shown
        ]
        style.legend_outside(figure, handles, columns=8)
    return path


def _scale(rows: int, columns: int) -> tuple[float, bool]:
    """Return the side of a cell [in], and whether words in it can be read."""
    scale = min(1.0, _LARGEST_IN / max(rows, 2 * columns))
    return (scale, True) if scale >= _LEAST_WORDED_IN else (_WORDLESS_IN / max(rows, columns), False)


def class_colours(classes: ClassSet) -> dict[str, Colour]:
    """Return a colour for every class of a set, and for the obstacle."""
    count = len(_COLOURS)
    named = {name: _mixed(_COLOURS[k % count], "white", 0.5 * (k >= count)) for k, name in enumerate(classes.names)}
    return {**named, OBSTACLE: to_rgba(style.BLOCKED)}


def _mixed(first: str, second: str, share: float) -> Colour:
    r, g, b, a = np.array(to_rgba(first)) * (1 - share) + np.array(to_rgba(second)) * share
    return float(r), float(g), float(b), float(a)


def _draw_polygons(axes: Axes, polygons: Sequence[Polygon]) -> list[Patch]:
    """Draw polygons from above, x up and y to the left, coloured by height; return what the colours mean."""
    heights = [round(float(one.vertices_m[:, 2].mean()), 2) for one in polygons]
    levels = sorted(set(heights))
    low, high = min(levels, default=0.0), max(levels, default=0.0)
    shades = {h: _mixed(style.BLUE, style.YELLOW, 0.3 if high == low else (h - low) / (high - low)) for h in levels}
    outlines = [np.column_stack((-one.vertices_m[:, 1], one.vertices_m[:, 0])) for one in polygons]
    faces = [shades[height] for height in heights]
    axes.add_collection(PolyCollection(outlines, facecolors=faces, edgecolors=style.WALL, linewidths=0.4, zorder=2))
    shown = levels if len(levels) <= 8 else [low, high]
    return [Patch(facecolor=shades[h], edgecolor=style.WALL, label=f"ground at {h:+.2f} m") for h in shown]


def _draw_ends(axes: Axes, terrain: QuadrupedTerrain) -> list[Line2D]:
    """Draw start and goal, which may be in one place; return what the marks mean."""
    marks: list[Line2D] = []
    looks: dict[str, Any] = {"markeredgecolor": style.BLACK, "linestyle": "none"}
    for place, name, marker, size, colour in (
        (terrain.start_m, "start", "s", 11, style.BLACK),
        (terrain.goal_m, "goal", "*", 13, style.YELLOW),
    ):
        if place is not None:
            marks += axes.plot(
                -place[1], place[0], marker, ms=size, color=colour, label=name, zorder=5 + len(marks), **looks
            )
    return marks


def _labels(terrain: QuadrupedTerrain) -> list[tuple[str, float, float]]:
    rows, columns = terrain.cells
    half_rows, half_columns = terrain.grid[0] // 2, terrain.grid[1] // 2
    found = []
    for cell in ((r, c) for r in range(rows) for c in range(columns)):
        x, y = terrain.centre_m(cell)
        found.append((LocalGrid(terrain, (x, y)).labels[half_rows][half_columns], x, y))
    return found


def _draw_labels(axes: Axes, terrain: QuadrupedTerrain) -> None:
    """Draw every cell in the colour of its class."""
    side, colours = terrain.cell_m, class_colours(terrain.classes)
    for label, x, y in _labels(terrain):
        axes.add_patch(Box((-y - side / 2, x - side / 2), side, side, facecolor=colours[label], edgecolor="white"))


def _write_labels(axes: Axes, terrain: QuadrupedTerrain, scale: float) -> None:
    """Write the class into every cell, with the height of its ground; of obstacles, with the measures that decide."""
    side = terrain.cell_m
    for label, x, y in _labels(terrain):
        words = label.replace("-", "\n").replace(" ", "\n")
        axes.text(-y, x + side * 0.08, words, fontsize=6.5 * scale, ha="center", va="center")
    for cell in terrain.measured:
        x, y = terrain.centre_m(cell)
        looks: dict[str, Any] = {"fontsize": 5.2 * scale, "ha": "center", "va": "center"}
        for number, text in enumerate(_notes(terrain, cell)[:_NOTES]):
            axes.text(-y, x - side * (0.22 + 0.13 * number), text, **looks)


def _notes(terrain: QuadrupedTerrain, cell: Cell) -> list[str]:
    """Return what is told of a cell besides its class: height of its ground, or what makes it an obstacle."""
    why = why_obstacle(terrain, cell)
    if not why:
        return [f"{terrain.measured[cell].height_m:+.2f} m"]
    parts = [(one.measure.partition("_"), one) for one in why]
    return [f"{name} {one.stands_for or f'{round(one.value, 3):g} {unit}'}".rstrip() for (name, _, unit), one in parts]


def _lattice(axes: Axes, terrain: QuadrupedTerrain) -> None:
    (x, y), (rows, columns), side = terrain.origin_m, terrain.cells, terrain.cell_m
    for r in range(rows + 1):
        axes.plot([-y - columns * side, -y], [x + r * side] * 2, color="#aaaaaa", lw=0.4, zorder=1)
    for c in range(columns + 1):
        axes.plot([-y - c * side] * 2, [x, x + rows * side], color="#aaaaaa", lw=0.4, zorder=1)
    axes.set_xlim(-y - columns * side - 0.1, -y + 0.1)
    axes.set_ylim(x - 0.1, x + rows * side + 0.1)
    axes.set_aspect("equal")
    axes.set_ylabel("x, ahead [m]")
    axes.set_xlabel("-y, to the right [m]")


def draw_classes(classes: ClassSet, path: Path) -> Path:
    """Draw the worst case of every class of a set: one cell each, and where in it a foot may stand.

    Args:
        classes: the set.
        path: of the PNG file.
    """
    across = min(len(classes.classes), 4 if len(classes.classes) <= 8 else 7)
    down = math.ceil(len(classes.classes) / across)
    with style.pictured(path, 1.9 * across + 0.4, 2.25 * down + 0.9) as figure:
        panels = figure.subplots(down, across, squeeze=False).ravel()
        for axes in panels:
            axes.set_axis_off()
        for axes, one in zip(panels, classes.classes.values(), strict=False):
            _draw_class(axes, classes, one.name)
        style.title(figure, f"{classes.name}: worst cases, cells of {classes.cell_m:g} m, the robot faces up")
        handles = [
            Patch(facecolor=style.SKY, label="ground"),
            Patch(facecolor=style.BLUE, label=f"where a foot may stand: {classes.margin_m:g} m off its edges"),
        ]
        style.legend_outside(figure, handles, columns=2)
    return path


def _draw_class(axes: Axes, classes: ClassSet, name: str) -> None:
    ground, side = classes.classes[name].ground, classes.cell_m
    half = side / 2
    axes.add_patch(Box((-half, -half), side, side, facecolor=_PAPER, edgecolor="#888888", lw=0.8))
    for one in class_rectangles(ground, side):
        axes.add_patch(
            Box(
                (-one.north, one.west),
                one.north - one.south,
                one.east - one.west,
                facecolor=style.SKY,
                edgecolor=style.WALL,
                lw=0.5,
            )
        )
    outlines = [
        np.column_stack((-one.vertices_m[:, 1], one.vertices_m[:, 0]))
        for one in class_polygons(ground, side, classes.margin_m, np.zeros(3))
    ]
    axes.add_collection(PolyCollection(outlines, facecolors=style.BLUE, alpha=0.55, linewidths=0.0, zorder=3))
    axes.set_xlim(-half * 1.05, half * 1.05)
    axes.set_ylim(-half * 1.05, half * 1.05)
    axes.set_aspect("equal")
    height = f" ({ground.height_m:+.2f} m)" if ground.height_m else ""
    axes.set_title(f"{name}{height}", fontsize=8.5)


class NamedClasses(Protocol):
    """Terrain classes, as far as tables of primitives need them."""

    @property
    def name(self) -> str:
        """Return the name of the set."""

    @property
    def names(self) -> Sequence[str]:
        """Return the names of the classes, in their order."""


def draw_physics(classes: NamedClasses, results: Sequence[CheckResult], path: Path) -> Path:
    """Draw which gait takes the robot from which class to which, one panel for each direction.

    Args:
        classes: the set.
        results: of any primitives; the others stay blank.
        path: of the PNG file.
    """
    names = classes.names
    gaits = sorted({one.gait for one in results if one.verdict is Physics.FEASIBLE})
    colours = {gait: _GAIT_COLOURS[k % len(_GAIT_COLOURS)] for k, gait in enumerate(gaits)}
    size = 1.4 + 0.3 * len(names)
    with style.pictured(path, 2 * size + 1.2, 2 * size + 1.4) as figure:
        panels = figure.subplots(2, 2).ravel()
        for axes, direction in zip(panels, Direction, strict=True):
            for one in results:
                if one.primitive.direction is direction:
                    _mark(axes, names, one, colours)
            _name_axes(axes, names, direction)
        handles = [Patch(facecolor=colours[gait], label=gait) for gait in gaits]
        there = {one.verdict for one in results}
        handles += [Patch(facecolor=c, label=word) for verdict, (c, word) in _ANSWERS.items() if verdict in there]
        if len(results) < len(panels) * len(names) ** 2:
            handles.append(Patch(facecolor="white", edgecolor="#888888", label="not asked"))
        count = sum(one.verdict is Physics.FEASIBLE for one in results)
        style.title(figure, f"{classes.name}: {count} of {len(results)} primitives feasible")
        style.legend_outside(figure, handles, columns=6)
    return path


def _mark(axes: Axes, names: Sequence[str], result: CheckResult, colours: Mapping[str, str]) -> None:
    column, row = names.index(result.primitive.next), names.index(result.primitive.here)
    feasible = result.verdict is Physics.FEASIBLE
    colour = colours[result.gait] if feasible else _ANSWERS[result.verdict][0]
    axes.add_patch(Box((column - 0.46, row - 0.46), 0.92, 0.92, facecolor=colour))


def _name_axes(axes: Axes, names: Sequence[str], direction: Direction) -> None:
    axes.set_xticks(range(len(names)), names, rotation=90)
    axes.set_yticks(range(len(names)), names)
    axes.set_xlim(-0.6, len(names) - 0.4)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.set_aspect("equal")
    axes.set_title(direction.value)
    axes.set_xlabel("to")
    axes.set_ylabel("from")

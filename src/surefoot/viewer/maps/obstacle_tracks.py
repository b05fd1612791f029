"""Where obstacles went, on a map: each in a colour and a dash of its own, along the cells that it crossed."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from surefoot.frames import Cell, Direction
from surefoot.viewer import style
from surefoot.viewer.maps.marks import mark_obstacle
from surefoot.viewer.sources.cells import points_m
from surefoot.world import CoarseGrid

_LOOKS: tuple[tuple[str, Any], ...] = (
    (style.OBSTACLE, "-"),
    ("#5e3c99", (0, (5, 1.5))),
    ("#a6611a", (0, (1.5, 1.2))),
    ("#525252", (0, (6, 1.5, 1.5, 1.5))),
)
_JUMP: dict[str, Any] = {"linestyle": ":", "lw": 1.0}
_APART = 0.1
"""Between the tracks of two obstacles, in cells."""


def colour_of(number: int) -> str:
    """Return the colour of an obstacle."""
    return _LOOKS[number % len(_LOOKS)][0]


def way(grid: CoarseGrid, begin: Cell, end: Cell, moves: int) -> tuple[Cell, ...] | None:
    """Return free cells from one to another, neighbours one after the other; None if that takes more moves."""
    before: dict[Cell, Cell | None] = {begin: None}
    queue = deque([(begin, 0)])
    while queue and end not in before:
        cell, made = queue.popleft()
        near = [cell.neighbour(one) for one in Direction] if made < moves else []
        for following in near:
            if grid.is_free(following) and following not in before:
                before[following] = cell
                queue.append((following, made + 1))
    if end not in before:
        return None
    cells, at = list[Cell](), before[end]
    while at is not None:
        cells.append(at)
        at = before[at]
    return (*reversed(cells), end)


def draw_tracks(axes: Axes, grid: CoarseGrid, tracks: Sequence[Sequence[Cell]], speeds: Sequence[int]) -> list[Line2D]:
    """Draw where obstacles went; return what a legend says about it.

    A jump that no moves explain is dotted; it broke an assumption.

    Args:
        axes: of the map.
        grid: of the cells.
        tracks: the cells of every obstacle, turn by turn.
        speeds: how many moves each of them makes in a turn at most.
    """
    keys: list[Line2D] = []
    jumped = False
    for number, (cells, speed) in enumerate(zip(tracks, speeds, strict=True)):
        colour, dash = _LOOKS[number % len(_LOOKS)]
        aside = _APART * (number - (len(tracks) - 1) / 2)
        for begin, end in pairwise(cells):
            through = way(grid, begin, end, speed)
            looks = {"linestyle": dash, "lw": 1.5} if through else _JUMP
            jumped |= through is None
            x, y = _centres(grid, through or (begin, end), aside).T
            axes.plot(x, y, color=colour, alpha=0.85, solid_joinstyle="round", zorder=4.5, **looks)
        start = tuple(_centres(grid, cells[:1], aside)[0])
        several = len(tracks) > 1
        mark_numbered(axes, (start[0], start[1]), number if several else None, size=9)
        name = f"obstacle {number}" if several else "obstacle"
        keys.append(
            Line2D([], [], color=colour, linestyle=dash, lw=1.5, marker="o", label=f"{name}, from its start on")
        )
    if jumped:
        keys.append(Line2D([], [], color=style.BOUND, label="a jump, which breaks an assumption", **_JUMP))
    return keys


def mark_numbered(axes: Axes, at_m: tuple[float, float], number: int | None, *, size: float) -> None:
    """Draw an obstacle in its colour, with its number if it has one."""
    mark_obstacle(axes, at_m, size=size, colour=colour_of(number or 0))
    if number is not None:
        looks: dict[str, Any] = {"path_effects": [withStroke(linewidth=2.5, foreground="white")]}
        axes.annotate(
            str(number), at_m, (0.55 * size, -0.95 * size), textcoords="offset points", fontsize=8.5,
            fontweight="bold", color=colour_of(number), zorder=12, **looks,
        )  # fmt: skip


def _centres(grid: CoarseGrid, cells: Sequence[Cell], aside: float) -> NDArray[np.float64]:
    places = np.array([(cell.column + 0.5 + aside, cell.row + 0.5 + aside) for cell in cells], np.float64)
    return points_m(grid, places)

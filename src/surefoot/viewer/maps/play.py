"""A plan at work: where its strategy leads the robot, to every goal and back to the first, a colour for each leg."""

from __future__ import annotations

from itertools import groupby, pairwise
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from surefoot.frames import Cell
from surefoot.missions.biped.coarse_play import Play, coarse_play
from surefoot.missions.scenario.scene import read_biped_scene
from surefoot.viewer import style
from surefoot.viewer.maps.ground import draw_blocked, draw_lines, draw_pixels, frame, ground_keys, size_in
from surefoot.viewer.maps.levels import draw_levels
from surefoot.viewer.maps.marks import goal_key, mark_goals, mark_robot, robot_key
from surefoot.viewer.maps.obstacle_tracks import draw_tracks
from surefoot.viewer.sources.cells import points_m
from surefoot.viewer.sources.plans import PlanSource, strategy_of

_SEED = 0
_ASIDE = 0.17
"""How far to the right of the middle of the cells a way is drawn, so that ways to and fro do not cover each other."""
_LEGS = (style.BLUE, style.VERMILION, "#8c6d00", style.SKY, style.GREEN)
_EVERY = 5


def draw_play(source: PlanSource, path: Path) -> Path:
    """Play the strategy of a plan against obstacles that move at random, and draw the play.

    Args:
        source: the plan.
        path: of the PNG file.
    """
    scene = read_biped_scene(source.folder / str(source.document["scenario"]["path"]))
    play, grid = coarse_play(scene, strategy_of(source), _SEED), source.grid
    width, height = size_in(grid, most=9.5)
    with style.pictured(path, max(width + 0.8, 6.0), height + 1.5) as figure:
        axes = figure.add_subplot()
        draw_pixels(axes, source.occupancy)
        draw_blocked(axes, grid)
        draw_lines(axes, grid)
        handles = draw_levels(axes, grid, source.scenario)
        handles += _draw_obstacles(axes, source, play)
        handles += _draw_legs(axes, source, play)
        mark_goals(axes, map(grid.center_m, source.cells("goals")), size=13)
        frame(axes, grid)
        ended = "to every goal and back to the first" if play.finished else "not every goal was reached"
        title = f"a play of {source.folder.name}/: {len(play.turns)} turns, {ended}; obstacles at random, seed {_SEED}"
        style.title(figure, title)
        keys = [robot_key("start, its heading", colour=style.BLACK), goal_key()]
        style.legend_outside(figure, [*keys, *ground_keys(grid, source.occupancy), *handles], columns=4)
    return path


def _draw_obstacles(axes: Axes, source: PlanSource, play: Play) -> list[Any]:
    tracks = list(zip(*(turn.obstacles for turn in play.turns), strict=False))
    return list(draw_tracks(axes, source.grid, tracks, [one.speed_cells for one in source.scenario.obstacles]))


def _draw_legs(axes: Axes, source: PlanSource, play: Play) -> list[Any]:
    """Draw the way to every goal, the turns, and where the robot waits; return what the legend says about it."""
    handles: list[Any] = []
    places = _places(source, play)
    numbered = list(enumerate(play.turns))
    for number, (goal, leg) in enumerate(groupby(numbered, lambda one: one[1].goal)):
        turns = list(leg)
        colour = _LEGS[number % len(_LEGS)]
        for at, _ in turns:
            axes.plot(*places[at : at + 2].T, color=colour, lw=2.2, zorder=6, solid_capstyle="round")
        _draw_waits(axes, source, [turn.cell for _, turn in turns if turn.order.waits], colour)
        first, last = turns[0][0], turns[-1][0]
        span = f"turn {first}" if first == last else f"turns {first} to {last}"
        label = f"{span}: to goal {goal}"
        handles.append(Line2D([], [], color=colour, lw=2.2, label=label))
    looks: dict[str, Any] = {"path_effects": [withStroke(linewidth=2.2, foreground="white")], "zorder": 12}
    for at in range(_EVERY, len(play.turns), _EVERY):
        if not play.turns[at].order.waits:
            axes.annotate(str(at), tuple(places[at]), (3, 3), textcoords="offset points", fontsize=7, **looks)
    if any(turn.order.waits for turn in play.turns):
        looks = {"ls": "", "marker": "o", "mfc": "white", "mec": style.BLACK, "ms": 9}
        handles.append(Line2D([], [], label="waits, for so many turns", **looks))
    if play.turns:
        yaw_rad = play.turns[0].heading.yaw_rad + source.grid.rotation_rad
        mark_robot(axes, source.grid.center_m(play.turns[0].cell), yaw_rad, colour=style.BLACK, size=20)
    return handles


def _draw_waits(axes: Axes, source: PlanSource, cells: list[Cell], colour: str) -> None:
    """Draw how long the robot waits in cells."""
    for cell in set(cells):
        x, y = source.grid.center_m(cell)
        axes.plot(x, y, "o", ms=12, mfc="white", mec=colour, mew=1.5, zorder=10)
        axes.text(x, y, str(cells.count(cell)), fontsize=7, ha="center", va="center", zorder=11)


def _places(source: PlanSource, play: Play) -> NDArray[np.float64]:
    """Return the points of the way, shape (turns + 1, 2): on the right of the moves that lead there and away."""
    cells = [*(turn.cell for turn in play.turns), play.end]
    moves = [np.array([b.column - a.column, b.row - a.row], np.float64) for a, b in pairwise(cells)]
    points = []
    for number, cell in enumerate(cells):
        around = [_right(move) for move in moves[max(0, number - 1) : number + 1] if move.any()]
        aside = np.clip(np.sum(around, axis=0), -1, 1) if around else np.zeros(2)
        points.append(np.array([cell.column + 0.5, cell.row + 0.5]) + _ASIDE * aside)
    return points_m(source.grid, np.array(points).reshape(-1, 2))


def _right(move: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a move, in columns and rows downwards, turned to the right."""
    return np.array([-move[1], move[0]])

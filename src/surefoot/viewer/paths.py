"""The map with the walked path, waypoints and feet (as in Shamsah et al., T-RO 2023, Figs. 14 and 15)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from surefoot.frames import Cell, Direction
from surefoot.missions.run_log import Run, Step
from surefoot.viewer import style
from surefoot.viewer.ground import draw_blocked, draw_lines, draw_pixels, frame, number_cells, size_in
from surefoot.viewer.marks import mark_goals, mark_robot
from surefoot.viewer.motion import com_path_m
from surefoot.viewer.sources import RunSource


def draw_path(source: RunSource, path: Path) -> Path:
    """Draw where the robot walked."""
    run, plan, grid = source.run, source.plan, source.plan.grid
    width, height = size_in(grid, most=10.5)
    with style.pictured(path, width + 0.8, height + 1.4) as figure:
        axes = figure.add_subplot()
        draw_pixels(axes, plan.occupancy)
        draw_blocked(axes, grid)
        draw_lines(axes, grid)
        number_cells(axes, grid)
        _draw_feet(axes, run.steps, plan.document.get("robot", {}))
        _draw_com(axes, run.steps)
        _draw_start(axes, source)
        unsafe = _draw_unsafe(axes, run)
        mark_goals(axes, map(grid.center_m, plan.cells("goals")), size=13)
        frame(axes, grid)
        seconds = run.end.time_s if run.end else run.steps[-1].time_s if run.steps else 0.0
        axes.set_title(
            f"{len(run.steps)} walking steps in {seconds:.0f} s, obstacles {run.header.policy}, seed {run.header.seed}"
        )
        style.legend_outside(figure, [*_legend(), *unsafe], columns=4)
    return path


def _draw_start(axes: Axes, source: RunSource) -> None:
    """Draw where the robot stood at first, and which way it faced."""
    steps, turns, grid = source.run.steps, source.run.turns, source.plan.grid
    if steps:
        at_m, yaw_rad = steps[0].waypoint_m[:2], steps[0].yaw_rad - steps[0].heading_change_rad
        mark_robot(axes, at_m, yaw_rad, colour=style.BLACK, size=12)
    elif turns:
        yaw_rad = Direction[turns[0].heading.upper()].yaw_rad + grid.rotation_rad
        mark_robot(axes, grid.center_m(Cell(*turns[0].cell)), yaw_rad, colour=style.BLACK, size=12)


def _draw_unsafe(axes: Axes, run: Run) -> list[Any]:
    """Draw where the robot stopped because no step was safe; return what the legend says about it."""
    looks: dict[str, Any] = {"marker": "X", "ms": 11, "color": style.RIGHT, "mec": "white", "ls": ""}
    if not run.unsafe or not run.steps:
        return []
    axes.plot(*run.steps[-1].next_waypoint_m[:2], zorder=12, **looks)
    return [Line2D([], [], label="stopped: no step was safe", **looks)]


def _draw_com(axes: Axes, steps: Iterable[Step]) -> None:
    lines = [com_path_m(step) for step in steps]
    axes.add_collection(LineCollection(lines, colors=style.BLACK, linewidths=0.9, zorder=5))
    if lines:
        waypoints = np.array([step.waypoint_m[:2] for step in steps])
        axes.plot(waypoints[:, 0], waypoints[:, 1], ".", ms=2.2, color="#777777", zorder=4)


def _draw_feet(axes: Axes, steps: Sequence[Step], robot: dict[str, Any]) -> None:
    """Draw every footprint where the foot stood, turned as the step that put it down."""
    half = robot.get("foot_half_length_m", 0.1), robot.get("foot_half_width_m", 0.05)
    prints: dict[str, list[NDArray[np.float64]]] = {"left": [], "right": []}
    for step in steps[:1]:
        prints[step.stance].append(footprint(step.foot_m, step.yaw_rad - step.heading_change_rad, half))
    for step in steps:
        side = "right" if step.stance == "left" else "left"
        prints[side].append(footprint(step.next_foot_m, step.yaw_rad, half))
    for side, colour in (("left", style.LEFT), ("right", style.RIGHT)):
        axes.add_collection(PolyCollection(prints[side], facecolors=colour, alpha=0.55, edgecolors="none", zorder=3))


def footprint(center_m: Sequence[float], yaw_rad: float, half_m: tuple[float, float]) -> NDArray[np.float64]:
    """Return the corners of a foot's sole, shape (4, 2)."""
    along = np.array([math.cos(yaw_rad), math.sin(yaw_rad)]) * half_m[0]
    aside = np.array([-math.sin(yaw_rad), math.cos(yaw_rad)]) * half_m[1]
    corners = np.array([along + aside, along - aside, -along - aside, aside - along])
    return np.asarray(corners + np.asarray(center_m[:2], np.float64))


def _legend() -> list[Any]:
    return [
        Line2D([], [], color=style.BLACK, lw=1.2, label="centre of mass"),
        Line2D([], [], ls="", marker=".", ms=5, color="#777777", label="waypoint"),
        Patch(facecolor=style.LEFT, alpha=0.55, label="left foot"),
        Patch(facecolor=style.RIGHT, alpha=0.55, label="right foot"),
        Line2D([], [], ls="", marker=(3, 0, -90), ms=9, color=style.BLACK, label="start"),
        Line2D([], [], ls="", marker="*", ms=11, color=style.GOAL, label="goals, in order"),
        Patch(facecolor=style.BLOCKED, edgecolor="#999999", hatch="////", lw=0, alpha=0.6, label="blocked cell"),
        Patch(facecolor=style.WALL, label="occupied"),
    ]

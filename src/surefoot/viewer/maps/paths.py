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
from matplotlib.patches import Patch, Rectangle
from numpy.typing import NDArray

from surefoot.frames import Cell, Direction
from surefoot.missions.biped.run_log import Run, Step
from surefoot.viewer import style
from surefoot.viewer.maps.ground import draw_blocked, draw_lines, draw_pixels, frame, ground_keys, number_cells, size_in
from surefoot.viewer.maps.levels import draw_levels
from surefoot.viewer.maps.marks import goal_key, mark_goals, mark_robot, robot_key
from surefoot.viewer.maps.obstacle_tracks import draw_tracks
from surefoot.viewer.sources.com_paths import com_path_m
from surefoot.viewer.sources.plans import RunSource
from surefoot.viewer.sources.steps import turn_stretch

_CLOSE_IN = 3.6
_WINDOW = "#7a4a00"


def draw_path(source: RunSource, path: Path) -> Path:
    """Draw where the robot walked, and a stretch of it so large that the feet can be told apart."""
    run, grid = source.run, source.plan.grid
    close = close_stretch(run.steps)
    width, height = size_in(grid, most=10.5)
    width, height = max(width, 1.5), max(height, _CLOSE_IN if close else 1.5)
    with style.pictured(path, max(4.5, width + 0.8 + (_CLOSE_IN + 0.5 if close else 0)), height + 1.6) as figure:
        if close:
            axes, beside = figure.subplots(1, 2, width_ratios=(width, _CLOSE_IN))
            _draw_close(beside, source, close)
            _draw_window(axes, beside)
        else:
            axes = figure.add_subplot()
        more = _draw_map(axes, source)
        seconds = run.end.time_s if run.end else run.steps[-1].time_s if run.steps else 0.0
        walked = f"{len(run.steps)} walking steps in {seconds:.0f} s"
        style.title(figure, f"{walked}, obstacles {run.header.policy}, seed {run.header.seed}")
        style.legend_outside(figure, [*_legend(), *ground_keys(grid, source.plan.occupancy), *more], columns=4)
    return path


def close_stretch(steps: Sequence[Step]) -> tuple[Step, ...]:
    """Return the steps to show close up: the first turn with some steps around it, or the middle of the run."""
    turn = turn_stretch(steps)
    if not turn:
        return tuple(steps[max(0, len(steps) // 2 - 5) : len(steps) // 2 + 5])
    return tuple(steps[max(0, turn[0].step - 2) : turn[-1].step + 3])


def _draw_map(axes: Axes, source: RunSource) -> list[Any]:
    """Draw the whole run; return what the legend says about what not every run has."""
    run, plan, grid = source.run, source.plan, source.plan.grid
    draw_pixels(axes, plan.occupancy)
    draw_blocked(axes, grid)
    draw_lines(axes, grid)
    number_cells(axes, grid)
    more = draw_levels(axes, grid, plan.scenario)
    _draw_feet(axes, run.steps, plan.document.get("robot", {}))
    _draw_com(axes, run.steps)
    more += _draw_obstacles(axes, source)
    _draw_start(axes, source)
    more += _draw_unsafe(axes, run) + _draw_broken(axes, source)
    mark_goals(axes, map(grid.center_m, plan.cells("goals")), size=13)
    frame(axes, grid)
    return more


def _draw_close(axes: Axes, source: RunSource, steps: Sequence[Step]) -> None:
    """Draw a few steps on a square of the map."""
    draw_pixels(axes, source.plan.occupancy)
    draw_blocked(axes, source.plan.grid)
    draw_lines(axes, source.plan.grid)
    draw_levels(axes, source.plan.grid, source.plan.scenario)
    _draw_feet(axes, steps, source.plan.document.get("robot", {}))
    _draw_com(axes, steps)
    feet = np.array([foot[:2] for step in steps for foot in (step.foot_m, step.next_foot_m)])
    middle, half = (feet.min(axis=0) + feet.max(axis=0)) / 2, float(np.ptp(feet, axis=0).max()) / 2 + 0.35
    axes.set_aspect("equal")
    axes.set_xlim(middle[0] - half, middle[0] + half)
    axes.set_ylim(middle[1] - half, middle[1] + half)
    axes.set_title(f"close up: steps {steps[0].step} to {steps[-1].step}")
    axes.spines[:].set_edgecolor(_WINDOW)
    axes.spines[:].set_linewidth(1.6)


def _draw_window(axes: Axes, beside: Axes) -> None:
    """Draw on the map what the panel beside it shows."""
    (west, east), (south, north) = beside.get_xlim(), beside.get_ylim()
    box = Rectangle((west, south), east - west, north - south, fill=False, edgecolor=_WINDOW, lw=1.4, zorder=7)
    axes.add_patch(box)


def _draw_obstacles(axes: Axes, source: RunSource) -> list[Any]:
    """Draw which cells the obstacles visited; return what the legend says about it."""
    tracks = [[Cell(*cell) for cell in cells] for cells in zip(*(t.obstacles for t in source.run.turns), strict=False)]
    speeds = [obstacle.speed_cells for obstacle in source.plan.scenario.obstacles]
    return list(draw_tracks(axes, source.plan.grid, tracks, speeds))


def _draw_start(axes: Axes, source: RunSource) -> None:
    """Draw where the robot stood at first, and which way it faced."""
    steps, turns, grid = source.run.steps, source.run.turns, source.plan.grid
    if steps:
        at_m, yaw_rad = steps[0].waypoint_m[:2], steps[0].yaw_rad - steps[0].heading_change_rad
        mark_robot(axes, at_m, yaw_rad, colour=style.BLACK, size=18)
    elif turns:
        yaw_rad = Direction[turns[0].heading.upper()].yaw_rad + grid.rotation_rad
        mark_robot(axes, grid.center_m(Cell(*turns[0].cell)), yaw_rad, colour=style.BLACK, size=18)


def _draw_unsafe(axes: Axes, run: Run) -> list[Any]:
    """Draw where the robot fell, or stopped because no step was safe; return what the legend says about it."""
    looks: dict[str, Any] = {"marker": "X", "ms": 11, "color": style.RIGHT, "mec": "white", "ls": ""}
    if not (run.unsafe or run.falls) or not run.steps:
        return []
    axes.plot(*run.steps[-1].next_waypoint_m[:2], zorder=12, **looks)
    return [Line2D([], [], label="fell after a push" if run.falls else "stopped: no step was safe", **looks)]


def _draw_broken(axes: Axes, source: RunSource) -> list[Any]:
    """Draw where the robot saw assumptions broken, and planned again; return what the legend says about it."""
    run, grid = source.run, source.plan.grid
    looks: dict[str, Any] = {"ls": "", "ms": 8, "mec": "white", "mew": 0.8}
    legend: list[Any] = []
    for marker, colour, share, label, numbers in (
        ("D", style.ORANGE, 0.22, "decision: assumption seen broken", {broken.turn for broken in run.violations}),
        ("P", style.BLUE, -0.22, "decision: planned again", {replan.turn for replan in run.replans}),
    ):
        shown = sorted(number for number in numbers if number < len(run.turns))
        for number in shown:
            x, y = grid.center_m(Cell(*run.turns[number].cell))
            place = x, y + share * grid.cell_size_m
            axes.plot(*place, marker=marker, color=colour, zorder=12, **looks)
            axes.annotate(
                str(number), place, (7, -3), textcoords="offset points", fontsize=7.5, color=colour, zorder=12
            )
        if shown:
            legend.append(Line2D([], [], marker=marker, color=colour, label=label, **looks))
    return legend


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
        robot_key("start, its heading", colour=style.BLACK),
        goal_key(),
    ]

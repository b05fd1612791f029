"""Foot and waypoint distances, step durations and apex speeds over the steps of a run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from surefoot.missions.biped.run_log import Step
from surefoot.viewer import style
from surefoot.viewer.sources.com_paths import turned
from surefoot.viewer.sources.plans import RunSource

Values = NDArray[np.float64]

_STOP: dict[str, Any] = {"ls": "", "marker": "s", "ms": 4.5, "mfc": "white", "mec": style.RIGHT, "mew": 1.1}
_START: dict[str, Any] = {"ls": "", "marker": "^", "ms": 5.5, "mfc": "white", "mec": style.LEFT, "mew": 1.1}


def draw_keyframes(source: RunSource, path: Path) -> Path:
    """Draw dy1, dy2, their sum with its bound, step durations and apex speeds."""
    steps, walking = source.run.steps, source.plan.document.get("walking", {})
    with style.pictured(path, 10.0, 9.2) as figure:
        panels = figure.subplots(5, 1, sharex=True)
        for axes in panels:
            style.light_grid(axes)
            _shade_turns(axes, steps)
        _draw_sideways(panels[:3], steps, walking)
        _draw_durations(panels[3], steps)
        _draw_speeds(panels[4], steps, walking)
        panels[-1].set_xlabel("walking step")
        panels[-1].set_xlim(-0.5, len(steps) - 0.5)
        figure.align_ylabels(panels)
        style.legend_outside(figure, _legend(steps), columns=4)
    return path


def _draw_sideways(panels: Sequence[Axes], steps: Sequence[Step], walking: dict[str, Any]) -> None:
    dy1 = np.array([step.dy1_m for step in steps])
    dy2 = np.array([step.dy2_m for step in steps])
    titles = (
        r"$\Delta y_1$ [m]" + "\napex $-$ waypoint",
        r"$\Delta y_2$ [m]" + "\nfoot $-$ apex",
        r"$\Delta y_1+\Delta y_2$ [m]" + "\nfoot $-$ waypoint",
    )
    for axes, values, title in zip(panels, (dy1, dy2, dy1 + dy2), titles, strict=True):
        axes.axhline(0.0, color="#bbbbbb", lw=0.8, zorder=1)
        _draw_by_foot(axes, steps, values)
        axes.set_ylabel(title)
    bound = walking.get("safety_distance_m")
    if bound is not None:
        for side in (-1, 1):
            panels[2].axhline(side * bound, color=style.PURPLE, lw=1.4, ls="-.", zorder=2)
        reach = 1.2 * max(bound, float(np.abs(dy1 + dy2).max()))
        panels[2].set_ylim(-reach, reach)


def _draw_by_foot(axes: Axes, steps: Sequence[Step], values: Values) -> None:
    """Draw one point per step in the colour of the foot that it put down."""
    numbers = np.arange(len(steps))
    for stance, colour in (("right", style.LEFT), ("left", style.RIGHT)):
        chosen = np.array([step.stance == stance for step in steps])
        axes.plot(numbers[chosen], values[chosen], ".", ms=_marker(steps), color=colour, zorder=4)


def _draw_durations(axes: Axes, steps: Sequence[Step]) -> None:
    numbers = np.arange(len(steps))
    first = np.array([step.first_half_s for step in steps])
    second = np.array([step.second_half_s for step in steps])
    axes.bar(numbers, first, width=1.0, color=style.SKY, linewidth=0, zorder=2)
    axes.bar(numbers, second, width=1.0, bottom=first, color=style.YELLOW, linewidth=0, zorder=2)
    axes.set_ylabel("duration [s]")


def _draw_speeds(axes: Axes, steps: Sequence[Step], walking: dict[str, Any]) -> None:
    low, high = walking.get("apex_speed_mps", (0.0, 0.0))
    axes.axhspan(low, high, facecolor=style.GREEN, alpha=0.10, zorder=0)
    axes.axhline(walking.get("switch_speed_max_mps", np.nan), color=style.PURPLE, lw=1.4, ls="-.", zorder=2)
    axes.axhline(walking.get("steering_speed_max_mps", np.nan), color=style.GREEN, lw=1.0, ls="--", zorder=2)
    numbers = np.arange(len(steps))
    ends = np.array([step.rest_s is not None for step in steps])
    speeds = np.array([step.next_apex_speed_mps for step in steps])
    switch = [float(turned(step, np.array(step.switch_velocity_mps))[0]) for step in steps]
    axes.plot(numbers, switch, "x", ms=max(3.0, 0.6 * _marker(steps)), mew=0.7, color=style.BOUND, zorder=3)
    axes.plot(numbers[~ends], speeds[~ends], ".", ms=_marker(steps), color=style.BLACK, zorder=4)
    axes.plot(numbers[ends], speeds[ends], **_STOP, zorder=5)
    starts = [(number, step.apex_speed_mps) for number, step in enumerate(steps) if step.rise_s is not None]
    axes.plot(*np.array(starts, np.float64).reshape(-1, 2).T, **_START, zorder=5)
    axes.set_ylim(0.0, None)
    axes.set_ylabel("speed [m/s]")


def _shade_turns(axes: Axes, steps: Sequence[Step]) -> None:
    for number, step in enumerate(steps):
        if step.heading_change_rad:
            axes.axvspan(number - 0.5, number + 0.5, facecolor="#ececec", linewidth=0, zorder=0)


def _marker(steps: Sequence[Step]) -> float:
    return float(np.clip(900 / max(1, len(steps)), 2.5, 7.0))


def _legend(steps: Sequence[Step]) -> list[Any]:
    special = (
        (_STOP, "apex of a stop step", any(step.rest_s is not None for step in steps)),
        (_START, "apex that a start step begins at", any(step.rise_s is not None for step in steps)),
    )
    return [
        Line2D([], [], ls="", marker=".", ms=8, color=style.LEFT, label="left foot put down"),
        Line2D([], [], ls="", marker=".", ms=8, color=style.RIGHT, label="right foot put down"),
        Line2D([], [], color=style.PURPLE, lw=1.4, ls="-.", label="safety bound"),
        Patch(facecolor="#ececec", label="turn step"),
        Patch(facecolor=style.SKY, label="first half of the step"),
        Patch(facecolor=style.YELLOW, label="second half"),
        Line2D([], [], ls="", marker=".", ms=8, color=style.BLACK, label="apex speed (band: allowed, dashed: turning)"),
        Line2D([], [], ls="", marker="x", ms=5, color=style.BOUND, label="speed at the switch"),
        *(Line2D([], [], **looks, label=label) for looks, label, here in special if here),
    ]

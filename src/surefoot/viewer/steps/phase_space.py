"""Sagittal phase space with switches and safety bounds (as in Shamsah et al., T-RO 2023, Figs. 4 and 6)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from textwrap import wrap
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from surefoot.missions.biped.run_log import Run, Step
from surefoot.viewer import style
from surefoot.viewer.sources.com_paths import halves, local, turned
from surefoot.viewer.sources.plans import RunSource
from surefoot.viewer.sources.steps import straight_stretch, stretch_before_stop, turn_stretch


def draw_phase_space(source: RunSource, path: Path) -> Path:
    """Draw the sagittal phase space of a straight stretch, of a turn and of the steps before a stop, if there are."""
    stretches = [(title, steps) for title, steps in _stretches(source.run) if steps]
    walking = source.plan.document.get("walking", {})
    with style.pictured(path, 9.0, 3.3 * len(stretches) + 0.9) as figure:
        panels = figure.subplots(len(stretches), 1, squeeze=False).ravel()
        for letter, axes, (title, steps) in zip("abc", panels, stretches, strict=False):
            _draw_stretch(axes, steps, walking)
            text = f"({letter}) {title}, steps {steps[0].step} to {steps[-1].step}"
            axes.set_title("\n".join(wrap(text, 110)), loc="left")
        panels[-1].set_xlabel("position along the heading, summed over the steps [m]")
        turning = any(step.heading_change_rad for _, steps in stretches for step in steps)
        style.legend_outside(figure, _legend(turning=turning), columns=4)
    return path


def _stretches(run: Run) -> Iterator[tuple[str, Sequence[Step]]]:
    """Yield what to show, each with its title."""
    yield "straight walking", straight_stretch(run.steps)
    yield "a turn, every step in the frame of its own heading", turn_stretch(run.steps)
    if run.unsafe:
        yield f"before no step was safe ({run.unsafe[0].reason})", stretch_before_stop(run)


def _draw_stretch(axes: Axes, steps: Sequence[Step], walking: Mapping[str, Any]) -> None:
    style.light_grid(axes)
    at_m, top_mps = 0.0, 1.25 * max(np.hypot(*step.switch_velocity_mps) for step in steps)
    top_mps = max(top_mps, 1.12 * walking.get("switch_speed_max_mps", 0.0))
    begin_m, end_m, before_m = 0.0, 0.0, None
    for number, step in enumerate(steps):
        _draw_asymptotes(axes, step, at_m, top_mps, new_frame=number == 0 or step.heading_change_rad != 0)
        span = _draw_step(axes, step, at_m, before_m)
        begin_m, end_m, before_m = min(begin_m, span[0]), max(end_m, span[1]), span[1]
        at_m += step.length_m
    margin_m = 0.12
    axes.set_xlim(begin_m - margin_m, end_m + margin_m)
    axes.set_ylim(0.0, top_mps)
    axes.set_ylabel("speed along the heading [m/s]")
    _draw_bounds(axes, walking)


def _draw_step(axes: Axes, step: Step, at_m: float, before_m: float | None) -> tuple[float, float]:
    """Draw both halves of a step, its apexes and its switch; return its first and last position.

    Args:
        axes: the panel.
        step: the step.
        at_m: position of its waypoint.
        before_m: where its first apex stands already, as the last of the step before; None for the first step.
    """
    before, after = halves(step, 40)
    colours = (style.LEFT, style.RIGHT) if step.stance == "left" else (style.RIGHT, style.LEFT)
    for (points, speeds), colour in zip((before, after), colours, strict=True):
        axes.plot(local(step, points)[:, 0] + at_m, turned(step, speeds)[:, 0], color=colour, lw=1.8, zorder=4)
    first = float(local(step, before[0])[0, 0]) + at_m
    last = float(local(step, after[0])[-1, 0]) + at_m
    _draw_first_apex(axes, step, first, before_m)
    speed = float(turned(step, np.array(step.switch_velocity_mps))[0])
    switch = float(local(step, np.array(step.switch_m))[0]) + at_m
    axes.plot(switch, speed, "s", ms=5.5, mfc="white", mec=style.BLACK, mew=1.1, zorder=6)
    axes.plot(last, float(turned(step, np.array(step.next_velocity_mps))[0]), "o", ms=5, color=style.BLACK, zorder=6)
    return first, last


def _draw_first_apex(axes: Axes, step: Step, position_m: float, before_m: float | None) -> None:
    """Draw the apex that a step begins at, and how turning the frame moves it and lowers its speed."""
    along = float(turned(step, np.array(step.velocity_mps))[0])
    speed = float(np.hypot(*step.velocity_mps))
    if before_m is None:
        before_m = position_m
        axes.plot(position_m, speed, "o", ms=5, color=style.BLACK, zorder=6)
    if step.heading_change_rad:
        axes.plot([before_m, position_m], [speed, along], ":", color=style.BLACK, lw=1.0, zorder=5)
        axes.plot(position_m, along, "o", ms=5, mfc="white", mec=style.BLACK, zorder=7)


def _draw_asymptotes(axes: Axes, step: Step, at_m: float, top_mps: float, *, new_frame: bool) -> None:
    """Shade below the asymptotes +-omega (x - x_foot): an orbit that falls below them never gets over the foot."""
    feet = [step.foot_m] if new_frame else []
    for foot in (*feet, step.next_foot_m):
        place = float(local(step, np.array(foot[:2]))[0]) + at_m
        reach = top_mps / step.omega_radps
        for side in (-1, 1):
            axes.plot([place, place + side * reach], [0, top_mps], color=style.BOUND, lw=0.7, ls=(0, (4, 3)), zorder=2)
        axes.plot(place, 0.0, marker="^", ms=7, color=style.BOUND, clip_on=False, zorder=7)


def _draw_bounds(axes: Axes, walking: Mapping[str, Any]) -> None:
    low, high = walking.get("apex_speed_mps", (0.0, 0.0))
    axes.axhspan(low, high, facecolor=style.GREEN, alpha=0.10, zorder=1)
    axes.axhline(walking.get("switch_speed_max_mps", np.nan), color=style.PURPLE, lw=1.4, ls="-.", zorder=3)
    axes.axhline(walking.get("steering_speed_max_mps", np.nan), color=style.GREEN, lw=1.0, ls="--", zorder=3)


def _legend(*, turning: bool) -> list[Any]:
    turned_apex = [
        Line2D(
            [], [], ls=":", lw=1.0, marker="o", mfc="white", color=style.BLACK, label="same apex, in the new heading"
        ),
    ]
    return [
        Line2D([], [], color=style.LEFT, lw=2, label="orbit about the left foot"),
        Line2D([], [], color=style.RIGHT, lw=2, label="orbit about the right foot"),
        Line2D([], [], ls="", marker="o", color=style.BLACK, label="apex"),
        *(turned_apex if turning else []),
        Line2D([], [], ls="", marker="s", mfc="white", mec=style.BLACK, label="switch of the stance foot"),
        Line2D(
            [],
            [],
            color=style.BOUND,
            lw=0.9,
            ls=(0, (4, 3)),
            marker="^",
            label=r"asymptotes $\pm\omega\,(x-x_{foot})$, foot",
        ),
        Patch(facecolor=style.GREEN, alpha=0.2, label="allowed apex speed"),
        Line2D([], [], color=style.GREEN, lw=1.0, ls="--", label="its cap at turn steps"),
        Line2D([], [], color=style.PURPLE, lw=1.4, ls="-.", label=r"greatest switch speed $v_{max}$"),
    ]

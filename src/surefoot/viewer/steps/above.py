"""A step of a run from above: feet, centre of mass and waypoints, with the steps before and after it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from surefoot.missions.biped.run_log import Step
from surefoot.viewer import style
from surefoot.viewer.maps.paths import footprint
from surefoot.viewer.sources.com_paths import com_path_m, local

_AROUND = 2
_HALF_M = (0.1, 0.05)
_HUES = {"left": style.LEFT, "right": style.RIGHT}


def draw_above(axes: Axes, steps: Sequence[Step], number: int, robot: dict[str, Any]) -> list[Patch | Line2D]:
    """Draw a step and the two before and after it in the step's frame; return what the legend says about it.

    Args:
        axes: to draw on.
        steps: of the run.
        number: of the step.
        robot: sizes of its foot, as in plan.json.
    """
    step = steps[number]
    style.light_grid(axes)
    for other in steps[max(0, number - _AROUND) : number + _AROUND + 1]:
        here = other.step == number
        path = local(step, com_path_m(other))
        axes.plot(path[:, 0], path[:, 1], color=style.BLACK, lw=2.0 if here else 0.8, alpha=1.0 if here else 0.6)
        _draw_foot(axes, step, other, robot, strong=here)
    _draw_foot_before(axes, step, robot)
    places = local(step, np.array([step.waypoint_m[:2], step.next_waypoint_m[:2]]))
    axes.plot(places[:, 0], places[:, 1], "x", color=style.BOUND, ms=7, mew=1.8, zorder=6)
    axes.annotate(
        "", tuple(places[1]), tuple(places[0]), arrowprops={"arrowstyle": "->", "color": style.BOUND, "lw": 1.0}
    )
    _frame(axes)
    return [
        Line2D([], [], ls="", marker="x", ms=7, mew=1.8, color=style.BOUND, label="waypoints of the step"),
        Patch(facecolor=style.LEFT, alpha=0.55, label="left foot"),
        Patch(facecolor=style.RIGHT, alpha=0.55, label="right foot"),
    ]


def _draw_foot(axes: Axes, frame: Step, other: Step, robot: dict[str, Any], *, strong: bool) -> None:
    """Draw the foot that a step puts down."""
    side = "right" if other.stance == "left" else "left"
    _add(axes, frame, other.next_foot_m, other.yaw_rad, side, robot, strong=strong)


def _draw_foot_before(axes: Axes, step: Step, robot: dict[str, Any]) -> None:
    """Draw the foot that carries the robot when a step begins."""
    yaw_rad = step.yaw_rad - step.heading_change_rad
    _add(axes, step, step.foot_m, yaw_rad, step.stance, robot, strong=True)


def _add(
    axes: Axes,
    frame: Step,
    at_m: tuple[float, float, float],
    yaw_rad: float,
    side: str,
    robot: dict[str, Any],
    *,
    strong: bool,
) -> None:
    half = robot.get("foot_half_length_m", _HALF_M[0]), robot.get("foot_half_width_m", _HALF_M[1])
    corners = local(frame, footprint(at_m, yaw_rad, half))
    looks: dict[str, Any] = {"alpha": 0.75 if strong else 0.25, "edgecolors": "none", "zorder": 3}
    axes.add_collection(PolyCollection([corners], facecolors=_HUES[side], **looks))


def _frame(axes: Axes) -> None:
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.08)
    axes.autoscale_view()
    axes.set_xlabel("ahead, from the waypoint [m]")
    axes.set_ylabel("to the left [m]")
    axes.set_title("(b) from above, with two steps before and after", loc="left")

"""Marks that several pictures share: the robot, goals, obstacles."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke

from surefoot.viewer import style

Place = tuple[float, float]


def mark_robot(axes: Axes, at_m: Place, yaw_rad: float, *, colour: str, size: float) -> None:
    """Draw a triangle that points where the robot faces."""
    triangle = (3, 0, math.degrees(yaw_rad) - 90)
    axes.plot(*at_m, marker=triangle, ms=size, color=colour, mec="white", mew=0.8, zorder=10)


def mark_goals(axes: Axes, places_m: Iterable[Place], *, size: float) -> None:
    """Draw goals as stars with their numbers, counted from 1."""
    outline = [withStroke(linewidth=2.5, foreground="white")]
    bold: dict[str, Any] = {"fontsize": 9, "fontweight": "bold", "color": "#00523b", "path_effects": outline}
    for number, place in enumerate(places_m, 1):
        axes.plot(*place, marker="*", ms=size, color=style.GOAL, mec="white", mew=0.8, zorder=8)
        axes.annotate(str(number), place, (0.35 * size, 0.3 * size), textcoords="offset points", zorder=11, **bold)


def mark_obstacle(axes: Axes, at_m: Place, *, size: float, seen: bool = True) -> None:
    """Draw an obstacle as a disc, hollow when the robot does not see it."""
    face = style.OBSTACLE if seen else "white"
    axes.plot(*at_m, "o", ms=size, mfc=face, mec=style.OBSTACLE, mew=2.0, zorder=9)

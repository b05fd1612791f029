"""Marks that several pictures share: the robot, goals, obstacles."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.path import Path as Outline
from matplotlib.patheffects import withStroke

from surefoot.viewer import style

Place = tuple[float, float]

_ARROW = ((1.0, 0.0), (0.42, 0.42), (0.42, 0.14), (0.0, 0.14), (0.0, -0.14), (0.42, -0.14), (0.42, -0.42), (1.0, 0.0))
"""An arrow from the origin along the first axis, of length 1."""


def mark_robot(axes: Axes, at_m: Place, yaw_rad: float, *, colour: str, size: float) -> None:
    """Draw an arrow from where the robot stands to where it faces, its length in points."""
    arrow = _arrow(yaw_rad)
    axes.plot(*at_m, marker=arrow, ms=2 * size * _reach(arrow), color=colour, mec="white", mew=0.8, zorder=10)
    axes.plot(*at_m, "o", ms=0.42 * size, color=colour, mew=0, zorder=10)


def robot_key(label: str, *, colour: str) -> Line2D:
    """Return what a legend says about the robot's arrow."""
    return Line2D([], [], ls="", marker=_arrow(0.0, 0.5), ms=14, mec="white", mew=0.4, color=colour, label=label)


def _arrow(yaw_rad: float, back: float = 0.0) -> Outline:
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    return Outline([(c * (x - back) - s * y, s * (x - back) + c * y) for x, y in _ARROW], closed=True)


def _reach(outline: Outline) -> float:
    """Return what matplotlib scales a marker's outline by, so that the length can be kept at all angles."""
    return float(np.abs(outline.vertices).max())


def mark_goals(axes: Axes, places_m: Iterable[Place], *, size: float) -> None:
    """Draw goals as stars with their numbers, counted from 0; goals at one place share a star."""
    numbers: dict[Place, list[int]] = {}
    for number, place in enumerate(places_m):
        numbers.setdefault((float(place[0]), float(place[1])), []).append(number)
    outline = [withStroke(linewidth=2.5, foreground="white")]
    bold: dict[str, Any] = {"fontsize": 9, "fontweight": "bold", "color": "#00523b", "path_effects": outline}
    for place, here in numbers.items():
        axes.plot(*place, marker="*", ms=size, color=style.GOAL, mec="white", mew=0.8, zorder=11)
        text = ", ".join(map(str, here))
        axes.annotate(text, place, (0.35 * size, 0.3 * size), textcoords="offset points", zorder=12, **bold)


def goal_key() -> Line2D:
    """Return what a legend says about goals."""
    return Line2D([], [], ls="", marker="*", ms=12, color=style.GOAL, label="goals, in order from 0")


def mark_obstacle(axes: Axes, at_m: Place, *, size: float, seen: bool = True, colour: str = style.OBSTACLE) -> None:
    """Draw an obstacle as a disc, hollow when the robot does not see it."""
    face = colour if seen else "white"
    axes.plot(*at_m, "o", ms=size, mfc=face, mec=colour, mew=2.0, zorder=9)

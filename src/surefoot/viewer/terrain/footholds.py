"""Pictures and animations of foothold plans."""

from __future__ import annotations

from pathlib import Path
from textwrap import shorten
from typing import Any

import numpy as np
from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from surefoot.errors import InputError
from surefoot.viewer import style
from surefoot.viewer.sources.foothold_motion import read_foothold_plan
from surefoot.viewer.style import FOOT_COLOURS, FOOT_LABELS

_FORCE_WIDTHS = (3.6, 3.6, 1.4, 1.4)
"""Feet on a diagonal often carry the same: those drawn first show beneath the others."""
_NEWTONS_PER_METRE = 600.0
_FRAMES_PER_SECOND = 20


def draw_plan(document: dict[str, Any], path: Path) -> None:
    """Draw a plan: from above, from the side, height of the feet and vertical forces over time.

    Args:
        document: a plan file's object; without a motion only the terrain and the poses are drawn.
        path: of the PNG file.
    """
    with style.pictured(path, 9.0, 7.0) as figure:
        rows = figure.subplots(
            3 if document["motion"] else 2, 1, height_ratios=[2.2, 1.2, 1.2][: 3 if document["motion"] else 2]
        )
        above, side = rows[0], rows[1]
        _terrain(above, side, document["values"])
        _poses(above, side, document["values"])
        above.set_title(_title(document["answer"]))
        if document["motion"]:
            _paths(above, side, document)
            _forces(rows[2], document)
        handles: list[Any] = [
            Line2D([], [], color=colour, lw=1.5, marker="o", label=name)
            for colour, name in zip(FOOT_COLOURS, FOOT_LABELS, strict=True)
        ]
        handles.append(Line2D([], [], color=style.BLACK, lw=1.5, label="base"))
        style.legend_outside(figure, handles, columns=5)


def _title(answer: dict[str, Any]) -> str:
    if answer["verdict"] != "feasible":
        why = answer["explanation"]["text"] if answer["explanation"] else answer["limit"] or ""
        return shorten(f"{answer['verdict']}: {why}", 110, placeholder=" ...")
    gap = "no bound" if answer["gap"] is None else f"gap {answer['gap']:.1e}"
    return f"feasible, objective {answer['objective']:.1f}, {gap}"


def _terrain(above: Axes, side: Axes, values: dict[str, Any]) -> None:
    polygons = [np.array(one["vertices_m"]) for one in values["polygons"]]
    looks: dict[str, Any] = {"facecolors": style.BLOCKED, "edgecolors": style.WALL, "lw": 0.8, "zorder": 1}
    above.add_collection(PolyCollection([one[:, :2] for one in polygons], **looks))
    for one in polygons:
        closed = np.concatenate([one, one[:1]])
        side.plot(closed[:, 0], closed[:, 2], color=style.WALL, lw=1.5, zorder=1)
    above.set_aspect("equal")
    above.autoscale_view()
    for axes, label in ((above, "y [m]"), (side, "z [m]")):
        style.light_grid(axes)
        axes.set_ylabel(label)
    side.set_xlabel("x [m]")


def _poses(above: Axes, side: Axes, values: dict[str, Any]) -> None:
    for key, marker in (("start", "s"), ("goal", "*")):
        x, y, z = values[key]["position_m"]
        above.plot(x, y, marker, color=style.BLACK, ms=8, zorder=6)
        side.plot(x, z, marker, color=style.BLACK, ms=8, zorder=6)


def _paths(above: Axes, side: Axes, document: dict[str, Any]) -> None:
    motion = document["motion"]
    base, feet = np.array(motion["base_m"]), np.array(motion["feet_m"])
    above.plot(base[:, 0], base[:, 1], color=style.BLACK, lw=1.5, zorder=5)
    side.plot(base[:, 0], base[:, 2], color=style.BLACK, lw=1.5, zorder=5)
    for foot, colour in enumerate(FOOT_COLOURS):
        path = feet[:, foot]
        stands = np.array([feet[0, foot], *(feet[s["touch"], foot] for s in motion["footsteps"] if s["foot"] == foot)])
        for axes, vertical in ((above, 1), (side, 2)):
            axes.plot(path[:, 0], path[:, vertical], color=colour, lw=1.0, zorder=4)
            axes.plot(stands[:, 0], stands[:, vertical], "o", color=colour, ms=5, zorder=5)


def _forces(axes: Axes, document: dict[str, Any]) -> None:
    forces = np.array(document["motion"]["forces_n"])
    times = np.arange(len(forces)) * document["values"]["step_s"]
    for (foot, colour), width in zip(enumerate(FOOT_COLOURS), _FORCE_WIDTHS, strict=True):
        axes.step(times, forces[:, foot, 2], color=colour, lw=width, where="post")
    style.light_grid(axes)
    axes.set_xlabel("time [s]")
    axes.set_ylabel("vertical force [N]")


def animate_plan(plan: Path, output: Path) -> int:
    """Animate a plan file from above and from the side, with the forces.

    Args:
        plan: a plan file with a motion.
        output: of the GIF.

    Returns:
        How many frames it has.

    Raises:
        InputError: the file is no foothold plan, or holds no motion.
    """
    document = read_foothold_plan(plan)
    motion = document["motion"]
    step_s = float(document["values"]["step_s"])
    stride = max(1, round(1 / (_FRAMES_PER_SECOND * step_s)))
    samples = list(range(0, len(motion["base_m"]), stride))
    figure = Figure(figsize=(8, 5.5), layout="constrained", dpi=80)
    FigureCanvasAgg(figure)
    above, side = figure.subplots(2, 1, height_ratios=[1.6, 1])
    base, feet, forces = (np.array(motion[name]) for name in ("base_m", "feet_m", "forces_n"))

    def draw(sample: int) -> list[Any]:
        for axes in (above, side):
            axes.clear()
        _terrain(above, side, document["values"])
        _poses(above, side, document["values"])
        above.set_title(f"t = {sample * step_s:.2f} s")
        side.set_xlim(above.get_xlim())
        side.set_ylim(float(feet[..., 2].min()) - 0.05, float(base[:, 2].max()) + 0.15)
        _snapshot(above, side, base[sample], feet[sample], forces[sample])
        return []

    try:
        output.parent.mkdir(parents=True, exist_ok=True)
        FuncAnimation(figure, draw, frames=samples).save(
            output, writer=PillowWriter(fps=round(1 / (step_s * stride)), metadata={"artist": "surefoot"})
        )
    except OSError as problem:
        raise InputError(f"cannot be written: {problem.strerror}", source=output) from problem
    return len(samples)


def _snapshot(above: Axes, side: Axes, base: Any, feet: Any, forces: Any) -> None:
    for foot, colour in enumerate(FOOT_COLOURS):
        loaded = float(forces[foot, 2]) > 1e-9
        for axes, vertical in ((above, 1), (side, 2)):
            ends = np.array([base, feet[foot]])
            axes.plot(ends[:, 0], ends[:, vertical], color=colour, lw=1.0, alpha=0.6, zorder=4)
            axes.plot(*feet[foot, [0, vertical]], "o" if loaded else "^", color=colour, ms=7, zorder=6)
        tip = feet[foot] + forces[foot] / _NEWTONS_PER_METRE
        side.plot([feet[foot, 0], tip[0]], [feet[foot, 2], tip[2]], color=colour, lw=2.5, zorder=5)
    above.plot(base[0], base[1], "s", color=style.BLACK, ms=9, zorder=7)
    side.plot(base[0], base[2], "s", color=style.BLACK, ms=9, zorder=7)

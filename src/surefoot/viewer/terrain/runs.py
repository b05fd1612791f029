"""Pictures of a quadruped's run: the map with classes, way points, footholds and the base; and the two timelines."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patches import Rectangle as Box

from surefoot.documents import read_json_object
from surefoot.errors import InputError
from surefoot.missions.quadruped.events import Happening
from surefoot.missions.quadruped.world import World
from surefoot.skills import QuadrupedTerrain, read_terrain
from surefoot.skills.patches import Rectangle
from surefoot.viewer import style
from surefoot.viewer.sources.foothold_motion import records_of
from surefoot.viewer.sources.ground import cell_m, request_m
from surefoot.viewer.style import FOOT_COLOURS, FOOT_LABELS
from surefoot.viewer.terrain.classes import class_colours

_LARGEST_BYTES = 64_000_000
_INCHES_PER_M = 1.15
_TURNS = (style.SKY, style.YELLOW, style.GREEN, style.ORANGE)
_LEAST = 500
"""The planning of a motion is drawn at least as wide as this part of the mission."""


def draw_quadruped_run(run_dir: Path, out: Path) -> tuple[Path, ...]:
    """Draw a run: ``map.png``, and ``timeline.png`` if the robot walked.

    Raises:
        InputError: the log, its terrain, or a plan cannot be read.
    """
    path = run_dir / "run.jsonl"
    records = [record for _, record in records_of(path)]
    try:
        pictures = [_draw_map(run_dir, records, out / "map.png")]
        segments = [one for one in records if one["record"] == "segment"]
        if segments:
            seen_s = [one["seen_s"] for one in records if one["record"] == "event"]
            pictures.append(draw_timeline(segments, out / "timeline.png", seen_s))
    except (ValueError, KeyError, TypeError, IndexError) as problem:
        raise InputError(f"is no whole log of a quadruped's run ({problem})", source=path) from problem
    return tuple(pictures)


def _draw_map(run_dir: Path, records: list[dict[str, Any]], path: Path) -> Path:
    terrain = _world(run_dir, records).terrain
    width, height = inches(terrain)
    with style.pictured(path, max(width + 1.2, 5.0), height + 1.6) as figure:
        handles = draw_map(figure.subplots(), run_dir, records)
        end = records[-1] if records[-1]["record"] == "end" else None
        count = sum(one["record"] == "segment" for one in records)
        reached = "interrupted" if end is None else "goal reached" if end["reached"] else "goal not reached"
        style.title(figure, f"{terrain.name}: {reached}, {count} segments")
        style.legend_outside(figure, handles, columns=4)
    return path


def inches(terrain: QuadrupedTerrain) -> tuple[float, float]:
    """Return width and height of a map in a picture."""
    rows, columns = terrain.cells
    return _INCHES_PER_M * columns * terrain.cell_m, _INCHES_PER_M * rows * terrain.cell_m


def draw_map(axes: Axes, run_dir: Path, records: list[dict[str, Any]]) -> list[Any]:
    """Draw classes, ground, what happened, motions and way points of a run; return what the marks mean."""
    world = _world(run_dir, records)
    classes = _draw_classes(axes, world)
    _draw_ground(axes, world)
    handles = _draw_events(axes, records)
    _draw_motions(axes, run_dir, records)
    _draw_requests(axes, records)
    _frame(axes, world)
    return [*classes, *handles, *_handles()]


def _world(run_dir: Path, records: list[dict[str, Any]]) -> World:
    """Return the world at the end of a run."""
    header = records[0]
    source = (run_dir / header["terrain"]["path"]).resolve()
    world = World(read_terrain(source, classes=header["classes"]))
    for one in records:
        if one["record"] == "event":
            world = _after(world, one["event"])
    return world


def _after(world: World, event: dict[str, Any]) -> World:
    for what in (Happening.OBSTACLE, Happening.HOLE):
        if what.value in event:
            (west, south), (east, north) = event[what.value]
            area = Rectangle(west, south, east, north)
            return world.with_obstacle(area) if what is Happening.OBSTACLE else world.without_ground(area)
    return world


def _draw_classes(axes: Axes, world: World) -> list[Patch]:
    """Colour every cell by its class, seen from itself; return what the colours mean."""
    terrain, colours = world.terrain, class_colours(world.terrain.classes)
    shown: dict[str, None] = {}
    for row in range(terrain.cells[0]):
        for column in range(terrain.cells[1]):
            state = world.state((row, column))
            label = "obstacle" if state is None else state.label(state.centre)
            shown[label] = None
            square = terrain.square_m((row, column))
            axes.add_patch(
                Box(
                    (-square.north, square.west), terrain.cell_m, terrain.cell_m,
                    facecolor=colours[label], alpha=0.35, edgecolor="white", lw=0.8, zorder=1,
                )
            )  # fmt: skip
    return [Patch(facecolor=colours[label], alpha=0.35, label=label) for label in shown]


def _draw_ground(axes: Axes, world: World) -> None:
    outlines = [np.column_stack((-one.vertices_m[:, 1], one.vertices_m[:, 0])) for one in world.terrain.polygons]
    heights = np.array([one.vertices_m[:, 2].mean() for one in world.terrain.polygons])
    span = max(float(np.ptp(heights)), 1e-9)
    faces = [(0.62 + 0.3 * share,) * 3 for share in (heights - heights.min()) / span]
    axes.add_collection(PolyCollection(outlines, facecolors=faces, edgecolors=style.WALL, linewidths=0.3, zorder=2))


def _draw_events(axes: Axes, records: list[dict[str, Any]]) -> list[Any]:
    handles: list[Any] = []
    looks = {
        Happening.OBSTACLE: (style.OBSTACLE, "obstacle that appeared"),
        Happening.HOLE: ("white", "ground that went"),
    }
    for record in (one for one in records if one["record"] == "event"):
        for what, (colour, label) in looks.items():
            if what.value in record["event"]:
                (west, south), (east, north) = record["event"][what.value]
                look: dict[str, Any] = {"facecolor": colour, "edgecolor": style.BLACK, "hatch": "///", "zorder": 3}
                axes.add_patch(Box((-north, west), north - south, east - west, **look))
                handles.append(Patch(facecolor=colour, edgecolor=style.BLACK, hatch="///", label=label))
        if record["stands"] is not None:
            x, y, _ = record["stands"]["base_m"]
            axes.plot(-y, x, "X", color=style.VERMILION, ms=9, zorder=8)
            handles.append(Line2D([], [], color=style.VERMILION, marker="X", lw=0, label="pushed to here"))
    for record in (one for one in records if one["record"] == "failed"):
        (row, column), (after_row, after_column) = record["cells"]
        header = records[0]
        places = [cell_m(header, (row, column)), cell_m(header, (after_row, after_column))]
        x, y = np.mean(places, axis=0)
        axes.plot(-y, x, "x", color=style.VERMILION, ms=8, mew=2, zorder=8)
    if any(one["record"] == "failed" for one in records):
        handles.append(Line2D([], [], color=style.VERMILION, marker="x", lw=0, mew=2, label="program failed"))
    return list({one.get_label(): one for one in handles}.values())


def _draw_motions(axes: Axes, run_dir: Path, records: list[dict[str, Any]]) -> None:
    for record in (one for one in records if one["record"] == "segment"):
        file = run_dir / record["plan"]["path"]
        motion = read_json_object(file, _LARGEST_BYTES)["motion"]
        base, feet = np.array(motion["base_m"]), np.array(motion["feet_m"])
        axes.plot(-base[:, 1], base[:, 0], color=style.BLACK, lw=1.6, zorder=6)
        axes.plot(-base[-1, 1], base[-1, 0], "o", color=style.BLACK, ms=3, zorder=6)
        for foot, colour in enumerate(FOOT_COLOURS):
            places = np.array(
                [feet[s["touch"], foot] for s in motion["footsteps"] if s["foot"] == foot] or feet[:1, foot]
            )
            axes.plot(-places[:, 1], places[:, 0], "o", color=colour, ms=3.2, mec="white", mew=0.4, zorder=7)


def _draw_requests(axes: Axes, records: list[dict[str, Any]]) -> None:
    header = records[0]
    for record in (one for one in records if one["record"] == "request"):
        x, y = request_m(header, record)
        made = record["source"] != "library"
        axes.plot(-y, x, "D", ms=8, mfc="none", mec=style.VERMILION if made else style.BLUE, mew=1.4, zorder=5)
    x, y = header["goal"]["place_m"]
    axes.plot(-y, x, "*", color=style.GOAL, mec=style.BLACK, ms=15, zorder=9)
    x, y, _ = header["start"]["base_m"]
    axes.plot(-y, x, "s", color=style.BLACK, ms=8, zorder=9)


def _frame(axes: Axes, world: World) -> None:
    terrain = world.terrain
    (x, y), (rows, columns) = terrain.origin_m, terrain.cells
    axes.set_xlim(-y - columns * terrain.cell_m - 0.05, -y + 0.05)
    axes.set_ylim(x - 0.05, x + rows * terrain.cell_m + 0.05)
    axes.set_aspect("equal")
    axes.set_xlabel("-y, to the right [m]")
    axes.set_ylabel("x, ahead [m]")


def _handles() -> list[Any]:
    feet = [
        Line2D([], [], color=colour, marker="o", lw=0, ms=4, label=f"{label} foot")
        for colour, label in zip(FOOT_COLOURS, FOOT_LABELS, strict=True)
    ]
    return [
        Line2D([], [], color=style.BLACK, lw=1.6, marker="o", ms=3, label="base, ends of segments"),
        Line2D([], [], mec=style.BLUE, mfc="none", marker="D", lw=0, label="way point, strategy of the library"),
        Line2D([], [], mec=style.VERMILION, mfc="none", marker="D", lw=0, label="way point, strategy made on the way"),
        Line2D([], [], color=style.BLACK, marker="s", lw=0, label="start"),
        Line2D([], [], color=style.GOAL, mec=style.BLACK, marker="*", lw=0, ms=10, label="goal"),
        *feet,
    ]


def draw_timeline(segments: list[dict[str, Any]], path: Path, seen_s: Sequence[float] = ()) -> Path:
    """Draw when motions are planned and when they are walked (Zhou et al. 2025, Fig. 6).

    Args:
        segments: records of the run log.
        path: of the PNG file.
        seen_s: when the planner saw that something had happened.
    """
    end_s = segments[-1]["end_s"]
    idle_s = sum(one["idle_s"] for one in segments)
    with style.pictured(path, 9.0, 2.6) as figure:
        axes = figure.subplots()
        for number, one in enumerate(segments):
            look: dict[str, Any] = {"facecolors": _TURNS[number % len(_TURNS)], "edgecolor": style.WALL, "lw": 0.4}
            walked, planned = one["end_s"] - one["start_s"], one["sent_s"] - one["plan_start_s"]
            axes.broken_barh([(one["plan_start_s"], max(planned, end_s / _LEAST))], (1.1, 0.8), **look)
            axes.broken_barh([(one["start_s"], walked)], (0.1, 0.8), **look)
            axes.text(one["start_s"] + walked / 2, 0.5, str(one["number"]), ha="center", va="center", fontsize=7)
            if one["idle_s"] > 0:
                waiting = (one["start_s"] - one["idle_s"], one["idle_s"])
                axes.broken_barh([waiting], (0.1, 0.8), facecolors=style.VERMILION, edgecolor=style.WALL, lw=0.4)
        for moment in seen_s:
            axes.axvline(moment, color=style.BLACK, ls=":", lw=1.2)
        axes.set_yticks([0.5, 1.5], ["walked", "planned"])
        axes.set_ylim(0, 2)
        axes.set_xlim(0, end_s)
        axes.set_xlabel("time of the mission [s]")
        axes.set_title(f"when motions are planned and walked; idle {idle_s:.2f} s")
        axes.spines[["top", "right"]].set_visible(False)
        style.legend_outside(figure, _timeline_handles(waits=idle_s > 0, events=bool(seen_s)), columns=3)
    return path


def _timeline_handles(*, waits: bool, events: bool) -> list[Any]:
    handles: list[Any] = [Patch(facecolor=_TURNS[0], edgecolor=style.WALL, label="a motion; same colour: the same one")]
    if waits:
        handles.append(Patch(facecolor=style.VERMILION, edgecolor=style.WALL, label="stands, waiting for the planner"))
    if events:
        handles.append(Line2D([], [], color=style.BLACK, ls=":", lw=1.2, label="something that happened is seen"))
    return handles

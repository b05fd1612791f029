"""Pictures of a campaign: an obstacle that appears, the nearest foothold beside a mission, and turned ground."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from surefoot.missions.bench.campaign import Campaign
from surefoot.missions.bench.detours import Detour, records
from surefoot.missions.bench.quadruped import Measured
from surefoot.missions.bench.straight import WIDEST_M, Steps, Straight, by_heuristic
from surefoot.missions.bench.tables import TurnedRow, turned_rows
from surefoot.skills import QuadrupedTerrain, read_terrain
from surefoot.viewer import style
from surefoot.viewer.terrain.runs import draw_map, inches

_BESIDE_M = 1e-6
_STRIP = 0.4
"""Share of the map's width that is drawn about the straight way."""


def draw_ways(campaign: Campaign, found: Measured, folder: Path) -> list[Path]:
    """Draw what there is to be drawn: ``detour.png``, ``nearest.png`` and ``turned.png``.

    Of all maps on which the robot went another way, the first is drawn, and the one with about the distance that was
    asked for on which the nearest foothold fails at its lowest speed.
    """
    folder.mkdir(parents=True, exist_ok=True)
    detours = [one for one in found.detours if one.ended.reached and one.ended.transitions > one.segments_before]
    ways = [one for one in found.straight if one.thinned and one.bent and one.ended.reached]
    pictures = [draw_detour(campaign, one, folder / "detour.png") for one in detours[:1]]
    best = sorted(ways, key=lambda one: (one.heuristic[0].steps.sound, abs(one.widest_m - WIDEST_M)))
    pictures += [draw_nearest_way(campaign, one, folder / "nearest.png") for one in best[:1]]
    return [*pictures, *([draw_turned(turned_rows(found.turned), folder / "turned.png")] if found.turned else [])]


def draw_detour(campaign: Campaign, detour: Detour, path: Path) -> Path:
    """Draw a mission without and with an obstacle that appears (Zhou et al. 2025, Fig. 14)."""
    place = campaign.place(detour.scene, detour.seed)
    width, height = inches(read_terrain(place / "terrain.yaml"))
    with style.pictured(path, 2 * width + 1.4, height + 2.0) as figure:
        panels = figure.subplots(1, 2)
        handles: dict[str, Any] = {}
        for axes, name, what in zip(panels, ("run", "detour"), ("without", "with"), strict=True):
            said = records(place / name)
            handles |= {one.get_label(): one for one in draw_map(axes, place / name, said)}
            count = sum(one["record"] == "segment" for one in said)
            axes.set_title(f"{what} the obstacle: {count} segments")
        made = "" if detour.first_ms is None else f"; another strategy in {detour.first_ms:.2g} ms"
        style.title(figure, f"{detour.scene}, seed {detour.seed}: an obstacle appears on the way{made}")
        style.legend_outside(figure, list(handles.values()), columns=5)
    return path


def draw_nearest_way(campaign: Campaign, way: Straight, path: Path) -> Path:
    """Draw the nearest footholds straight ahead beside a mission's way (Zhou et al. 2025, Fig. 15)."""
    place = campaign.place(way.scene, way.seed)
    terrain = read_terrain(place / ("thinned.yaml" if way.thinned else "straight.yaml"))
    slow, fast = (one for one in way.heuristic if one.gait == way.heuristic[0].gait)
    width, height = inches(terrain)
    with style.pictured(path, (1 + 2 * _STRIP) * width + 1.6, height + 2.2) as figure:
        panels = figure.subplots(1, 3, width_ratios=[1, _STRIP, _STRIP])
        run = place / ("thinned" if way.thinned else "straight")
        handles = draw_map(panels[0], run, records(run))
        taken = ", bars taken away" if way.thinned else ""
        panels[0].set_title(f"{way.scene}, seed {way.seed}{taken}: mission\n{_judged(way.ours)}", fontsize=8.5)
        for axes, one in zip(panels[1:], (slow, fast), strict=True):
            draw_map(axes, run, [record for record in records(run) if record["record"] in ("header", "event")])
            _draw_footholds(axes, terrain, one.gait, one.speed_mps)
            axes.set_title(f"nearest, {one.speed_mps:g} m/s\n{_judged(one.steps)}", fontsize=8.5)
            axes.set_ylabel("")
        style.legend_outside(figure, [*handles, *_foothold_handles()], columns=4)
    return path


def _judged(steps: Steps) -> str:
    return f"of {steps.footholds}: {steps.out_of_reach} out of reach, {steps.off_polygon} beside"


def _draw_footholds(axes: Axes, terrain: QuadrupedTerrain, gait: str, speed_mps: float) -> None:
    footholds = by_heuristic(terrain, gait, speed_mps)
    middle, side = -float(np.mean([one.wished_m[1] for one in footholds])), _STRIP * np.ptp(axes.get_xlim()) / 2
    axes.set_xlim(middle - side, middle + side)
    for one in footholds:
        out, beside = one.beyond_reach_m > _BESIDE_M, one.off_polygon_m > _BESIDE_M
        colour = style.VERMILION if out else style.BLUE
        axes.plot(*np.array([one.chosen_m, one.landed_m])[:, 1::-1].T * [[-1], [1]], color=colour, lw=0.8, zorder=8)
        axes.plot(-one.landed_m[1], one.landed_m[0], "x" if beside else "o", color=colour, ms=4.5, zorder=9)


def _foothold_handles() -> list[Line2D]:
    def mark(marker: str, colour: str, label: str) -> Line2D:
        return Line2D([], [], color=colour, marker=marker, lw=0, ms=5, label=label)

    return [
        mark("o", style.BLUE, "nearest foothold, in reach"),
        mark("o", style.VERMILION, "out of reach at touch-down or lift-off"),
        mark("x", style.VERMILION, "beside the bars: the reach ends before"),
    ]


def draw_turned(rows: Sequence[TurnedRow], path: Path) -> Path:
    """Draw the solve times of transitions against the angle of the ground (Zhou et al. 2025, Table IV)."""
    scenes = list(dict.fromkeys(row.scene for row in rows))
    colours = dict(zip(scenes, (style.GREEN, style.SKY, style.ORANGE, style.PURPLE), strict=False))
    with style.pictured(path, 5.6, 3.4) as figure:
        axes = figure.subplots()
        for place, scene in enumerate(scenes):
            for row in (one for one in rows if one.scene == scene and one.mean_ms is not None):
                x = row.angle_deg + 0.9 * (place - (len(scenes) - 1) / 2)
                axes.bar(x, row.mean_ms or 0.0, 0.8, color=colours[scene], zorder=2)
                axes.plot([x, x], [row.least_ms or 0.0, row.most_ms or 0.0], color=style.BLACK, lw=0.9, zorder=3)
        axes.set_xticks(sorted({row.angle_deg for row in rows}))
        axes.set_xlabel("ground turned by [degrees]")
        axes.set_ylabel("online program, CPU [ms]")
        style.light_grid(axes)
        handles = [Line2D([], [], color=colours[scene], lw=6, label=scene) for scene in scenes]
        line = Line2D([], [], color=style.BLACK, lw=0.9, label="least to most")
        style.legend_outside(figure, [*handles, line], columns=5)
    return path

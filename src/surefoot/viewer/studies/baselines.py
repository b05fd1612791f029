"""Pictures of the two baselines: planning time against the horizon, and footholds of the heuristic on bars."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from surefoot.footholds.baselines import WAY_M, CertifiedRow, HorizonRow, NearestRow, nearest_on_bars
from surefoot.footholds.fields import bars_with_gap
from surefoot.viewer import style

_COLOURS = (style.SKY, style.ORANGE, style.GREEN, style.VERMILION)


def draw_horizons(rows: Sequence[HorizonRow], path: Path) -> Path:
    """Draw the CPU time of planning against the horizon, whole (Zhou et al. 2025, Fig. 9) and in segments."""
    fields = list(dict.fromkeys(row.field for row in rows))
    with style.pictured(path, 7.0, 3.6) as figure:
        axes = figure.subplots(1, 2, sharey=True)
        for panel, name, label in ((axes[0], "whole_ms", "one program"), (axes[1], "segments_ms", "segments of 2-3 s")):
            for place, (field, colour) in enumerate(zip(fields, _COLOURS, strict=False)):
                mine = [row for row in rows if row.field == field]
                x = np.array([row.horizon_s for row in mine]) + 0.16 * (place - 1.5)
                times = [getattr(row, name) for row in mine]
                panel.bar(x, [np.median(one) for one in times], 0.15, color=colour, zorder=2)
                for at, values in zip(x, times, strict=True):
                    panel.plot([at] * len(values), values, "o", color=style.BLACK, ms=1.8, alpha=0.5, zorder=3)
            panel.set_yscale("log")
            panel.set_xlabel("horizon [s]")
            panel.set_title(label)
            style.light_grid(panel)
        axes[0].set_ylabel("CPU time [ms]")
        handles = [
            Line2D([], [], color=colour, lw=6, label=field) for field, colour in zip(fields, _COLOURS, strict=False)
        ]
        handles.append(Line2D([], [], color=style.BLACK, ls="", marker="o", ms=3, label="one seed"))
        style.legend_outside(figure, handles, columns=5)
    return path


def draw_nearest(heuristic: Sequence[NearestRow], certified: Sequence[CertifiedRow], path: Path, seed: int = 0) -> Path:
    """Draw the heuristic's footholds on bars with the widest gap, and shares against the widest gap."""
    fast = max(row.speed_mps for row in heuristic)
    with style.pictured(path, 7.0, 5.0) as figure:
        above, below = figure.subplots(2, 1, height_ratios=[1.2, 1])
        _draw_footholds(above, max(row.widest_m for row in heuristic), fast, seed)
        for speed, colour in ((row.speed_mps, colour) for row, colour in zip(heuristic, _COLOURS[:2], strict=False)):
            mine = [row for row in heuristic if row.speed_mps == speed]
            x = [row.widest_m for row in mine]
            below.plot(x, [row.beyond_reach for row in mine], "o-", color=colour, label=f"out of reach, {speed:g} m/s")
            below.plot(x, [row.off_polygon for row in mine], "s--", color=colour, label=f"beside a bar, {speed:g} m/s")
        seeds = [row.crossed + row.refused + row.unknown for row in certified]
        shares = [row.crossed / count for row, count in zip(certified, seeds, strict=True)]
        x = [row.widest_m for row in certified]
        below.plot(x, shares, "^-", color=style.GREEN, label="ways that certified segments cross")
        below.set_xlabel("widest distance between bars [m]")
        below.set_ylabel("share")
        below.set_ylim(-0.03, 1.05)
        style.light_grid(below)
        style.legend_outside(figure, below.get_legend_handles_labels()[0], columns=3)
    return path


def _draw_footholds(axes: Axes, widest_m: float, speed_mps: float, seed: int) -> None:
    for one in bars_with_gap(WAY_M, widest_m, seed):
        axes.fill(*one.vertices_m[:, :2].T, color=style.BLOCKED, ec=style.WALL, lw=0.5, zorder=1)
    for foothold in nearest_on_bars(widest_m, speed_mps, seed):
        beside = foothold.off_polygon_m > 1e-6
        axes.plot(*np.array([foothold.wished_m, foothold.chosen_m])[:, :2].T, color=style.UNKNOWN, lw=0.8, zorder=2)
        axes.plot(*foothold.landed_m[:2], "x" if beside else "o", color=style.VERMILION if beside else style.BLUE, ms=5)
    axes.set_title(f"nearest footholds at {speed_mps:g} m/s: circles land on a bar, crosses beside it")
    axes.set_aspect("equal")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")

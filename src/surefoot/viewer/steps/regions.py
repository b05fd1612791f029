"""Controllable regions in the phase plane, and how pushes end.

As in Shamsah et al., T-RO 2023, Figs. 7 and 11, and Warnke et al., Figs. 3 and 5.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from surefoot.reach.barriers import barrier_region
from surefoot.reach.ensembles import Law, PushMap, push_map, random_starts
from surefoot.reach.lattice import Cells, Lattice
from surefoot.reach.parameters import Reading
from surefoot.reach.simulation import Push, Trace, simulate
from surefoot.reach.synthesis import Region
from surefoot.reach.winning_sets import InitialWinningSet, KeyframeStep, initial_winning_set
from surefoot.viewer import style

FIRST, SECOND, GUARD, TARGET, TUBE = style.GREEN, style.YELLOW, style.BLUE, style.VERMILION, style.PURPLE


def draw_all(region: Region, folder: Path) -> tuple[Path, ...]:
    """Draw a region, pushed steps in it, pushed steps in a row, its push map and the initial winning sets."""
    rng = np.random.default_rng(0)
    traces = _pushed(region, 15, rng)
    walk = _walk(region, 4, rng)
    sizes = tuple(float(size) for size in np.linspace(-0.5, 0.5, 41))
    sets = [initial_winning_set(KeyframeStep(v, height_change_m=-0.2)) for v in (0.5, 0.6, 0.7)]
    return (
        draw_region(region, folder / "region.png"),
        draw_region(region, folder / "transitions.png", traces, f"{len(traces)} pushed steps that succeed"),
        draw_walk([region] * len(walk), walk, folder / "walk.png"),
        draw_push_map([push_map(region, sizes, law=law) for law in Law], folder / "pushes.png"),
        draw_winning_set(sets[0], folder / "winning_set.png"),
        draw_winning_sets(sets, folder / "winning_sets.png"),
    )


def _pushed(region: Region, count: int, rng: np.random.Generator) -> list[Trace]:
    """Return simulated steps from random starts with a random push each, those that succeed."""
    traces: list[Trace] = []
    for number, (x, v) in enumerate(random_starts(region, 4 * count, rng)):
        push = Push(float(rng.uniform(0.1, 0.2)), float(rng.uniform(-0.1, 0.1)))
        trace = simulate(region, x, v, (push,), seed=number)
        if trace.succeeded and len(traces) < count:
            traces.append(trace)
    return traces


def _walk(region: Region, steps: int, rng: np.random.Generator) -> list[Trace]:
    """Return steps in a row, each begun where the last one ended and pushed as far as the region allows."""
    x, v, traces = 0.0, float(np.mean(region.transition.apex_velocity_mps)), list[Trace]()
    for number in range(steps):
        for size in (0.12, 0.08, 0.04, 0.0):
            push = Push(float(rng.uniform(0.08, 0.2)), size * (-1) ** number)
            trace = simulate(region, x, v, (push,), seed=number)
            if trace.succeeded:
                break
        traces.append(trace)
        x, v = trace.positions_m[-1] - region.transition.step_length_m, trace.velocities_mps[-1]
        if not trace.succeeded:
            break
    return traces


def draw_region(region: Region, path: Path, traces: Sequence[Trace] = (), title: str | None = None) -> Path:
    """Draw the regions of a step, and steps that were simulated in them (Figs. 7 and 11a)."""
    low, high = region.transition.apex_velocity_mps
    name = f"step of {region.transition.step_length_m:g} m to {low:g}-{high:g} m/s"
    with style.pictured(path, 7.6, 5.2) as figure:
        axes = figure.add_subplot()
        _axes(axes, title or f"{name}: where it surely succeeds")
        _sets(axes, region, 0.0)
        _curves(axes, region)
        _traces(axes, traces, 0.0)
        _limits(axes, region.cells, 0.0)
        style.legend_outside(figure, _legend(region, bool(traces)), columns=3)
    return path


def draw_walk(regions: Sequence[Region], traces: Sequence[Trace], path: Path) -> Path:
    """Draw the regions of steps in a row, and a walk through them (Fig. 11b)."""
    with style.pictured(path, 10.5, 4.8) as figure:
        axes = figure.add_subplot()
        _axes(axes, "regions of steps in a row, and a pushed walk through them")
        at = 0.0
        for region in regions:
            _sets(axes, region, at)
            at += region.transition.step_length_m
        at = 0.0
        for region, trace in zip(regions, traces, strict=False):
            _traces(axes, [trace], at)
            at += region.transition.step_length_m
        axes.set_xlim(-0.06, at + 0.03)
        axes.set_ylim(0.0, regions[0].settings.grid.fastest_mps + 0.05)
        style.legend_outside(figure, _legend(None, bool(traces)), columns=5)
    return path


def draw_winning_set(found: InitialWinningSet, path: Path) -> Path:
    """Draw margin sets, winning set and the initial winning set of a keyframe transition (Warnke et al., Fig. 3)."""
    with style.pictured(path, 7.6, 4.6) as figure:
        axes = figure.add_subplot()
        step = found.step
        _axes(axes, f"apex velocity {step.apex_velocity_mps:g} m/s, height change {step.height_change_m:g} m")
        for cells, colour, alpha in (
            (found.winning | found.winning_second, style.YELLOW, 0.55),
            (found.initial, style.BLUE, 0.9),
            (found.shared, style.GREEN, 1.0),
            (found.final, style.VERMILION, 0.6),
        ):
            _paint(axes, found.cells, cells, colour, alpha, 0.0)
        _limits(axes, found.cells, 0.0)
        handles = [
            Patch(facecolor=style.YELLOW, alpha=0.55, label="winning set"),
            Patch(facecolor=style.BLUE, label="initial margin set (where not winning)"),
            Patch(facecolor=style.GREEN, label=f"initial winning set, {found.size} cells"),
            Patch(facecolor=style.VERMILION, alpha=0.6, label="final margin set"),
        ]
        style.legend_outside(figure, handles, columns=2)
    return path


def draw_winning_sets(found: Sequence[InitialWinningSet], path: Path) -> Path:
    """Draw the initial winning sets of several apex velocities (Warnke et al., Fig. 5)."""
    colours = (style.GREEN, style.BLUE, style.ORANGE, style.PURPLE)
    with style.pictured(path, 5.6, 5.2) as figure:
        axes = figure.add_subplot()
        _axes(axes, "initial winning sets shrink as the apex velocity grows")
        handles = []
        for one, colour in zip(found, colours, strict=False):
            _paint(axes, one.cells, one.shared, colour, 0.75, 0.0)
            label = f"{one.step.apex_velocity_mps:g} m/s: {one.size} cells"
            handles.append(Patch(facecolor=colour, alpha=0.75, label=label))
        x0, x1 = found[0].cells.x_edges()
        used = np.any([one.shared.any(axis=1) for one in found], axis=0)
        axes.set_xlim(x0[used].min() - 0.01, x1[used].max() + 0.01)
        speeds = [one.step.apex_velocity_mps for one in found]
        axes.set_ylim(min(speeds) - 0.12, max(speeds) + 0.12)
        style.legend_outside(figure, handles, columns=3)
    return path


def draw_push_map(maps: Sequence[PushMap], path: Path) -> Path:
    """Draw which share of pushed steps succeeds, by size and instant of the push, one panel per law."""
    with style.pictured(path, 4.6 * len(maps) + 0.8, 4.4) as figure:
        panels = figure.subplots(1, len(maps), sharey=True, squeeze=False)[0]
        mesh = None
        for axes, one in zip(panels, maps, strict=True):
            mesh = axes.pcolormesh(one.instants_s, one.sizes_mps, one.percent, cmap="cividis", vmin=0, vmax=100)
            lines = axes.contour(
                one.instants_s, one.sizes_mps, one.percent, levels=[50, 95], colors=["white", style.BLACK]
            )
            axes.clabel(lines, fmt="%g %%", fontsize=8)
            axes.set_title(f"law: {one.law.value}")
            axes.set_xlabel("instant of the push [s]")
        panels[0].set_ylabel("velocity jump [m/s]")
        if mesh is not None:
            figure.colorbar(mesh, ax=list(panels), label="steps that succeed [%]")
    return path


def _axes(axes: Axes, title: str) -> None:
    style.light_grid(axes)
    axes.set_title(title, loc="left")
    axes.set_xlabel("CoM position along the heading [m]")
    axes.set_ylabel("CoM velocity [m/s]")


def _sets(axes: Axes, region: Region, at_m: float) -> None:
    """Paint the four sets of a step; where they overlap the later one is on top."""
    _paint(axes, region.cells, region.second.won, SECOND, 0.65, at_m)
    _paint(axes, region.cells, region.first.won, FIRST, 0.5, at_m)
    _paint(axes, region.cells, region.first.target, GUARD, 0.85, at_m)
    _paint(axes, region.cells, region.second.target, TARGET, 0.9, at_m)
    axes.plot(at_m + region.first.foot_m, 0.0, "*", ms=13, color=FIRST, mec="white", clip_on=False, zorder=9)
    axes.plot(at_m + region.second.foot_m, 0.0, "*", ms=13, color=style.ORANGE, mec="white", clip_on=False, zorder=9)


def _paint(axes: Axes, lattice: Lattice, cells: Cells, colour: str, alpha: float, at_m: float) -> None:
    x0, x1 = lattice.x_edges()
    v0, v1 = lattice.v_edges()
    extent = (at_m + x0[0], at_m + x1[-1], v0[0], v1[-1])
    shown = np.ma.masked_where(~cells.T, np.ones(cells.T.shape))
    axes.imshow(
        shown,
        origin="lower",
        extent=extent,
        aspect="auto",
        interpolation="nearest",
        cmap=ListedColormap([colour]),
        alpha=alpha,
        zorder=2,
    )


def _curves(axes: Axes, region: Region) -> None:
    """Draw the guard's tangent manifolds and, where there are any, the barrier curves."""
    tube, foot = region.settings.guard, region.first.foot_m
    x = np.linspace(region.cells.x0_m, region.cells.x_edges()[1][-1], 400)
    for speed in (tube.slowest_mps, tube.fastest_mps):
        axes.plot(x, np.hypot(speed, tube.omega_radps * (x - foot)), color=TUBE, lw=1.0, ls="--", zorder=4)
    if region.settings.disturbance.reading is Reading.JUMP:
        return
    outer = barrier_region(region.transition, region.settings)
    inner = x[x <= region.transition.step_length_m]
    for low, high in (outer.first_half(inner), outer.second_half(inner)):
        there = low <= high
        for edge in (low, high):
            axes.plot(inner, np.where(there, edge, np.nan), color=style.BOUND, lw=0.9, zorder=4)


def _traces(axes: Axes, traces: Sequence[Trace], at_m: float) -> None:
    for trace in traces:
        colour = style.BLACK if trace.succeeded else TARGET
        axes.plot(at_m + np.array(trace.positions_m), trace.velocities_mps, color=colour, lw=0.9, zorder=6)
        axes.plot(at_m + trace.positions_m[0], trace.velocities_mps[0], "o", ms=3, color=colour, zorder=7)
        if trace.switch is not None:
            k = trace.switch
            axes.plot(
                at_m + trace.positions_m[k], trace.velocities_mps[k], "s", ms=4, mfc="white", mec=style.BLACK, zorder=7
            )


def _limits(axes: Axes, lattice: Lattice, at_m: float) -> None:
    x0, x1 = lattice.x_edges()
    axes.set_xlim(at_m + x0[0] - 0.01, at_m + x1[-1] + 0.01)
    axes.set_ylim(0.0, lattice.v_edges()[1][-1] + 0.05)


def _legend(region: Region | None, traced: bool) -> list[Any]:
    counts = {} if region is None else {name: f", {count} cells" for name, count in region.counts.items()}
    handles: list[Any] = [
        Patch(facecolor=FIRST, alpha=0.5, label="first half's region" + counts.get("fhws", "")),
        Patch(facecolor=SECOND, alpha=0.65, label="second half's region" + counts.get("shws", "")),
        Patch(facecolor=GUARD, alpha=0.85, label="guard" + counts.get("guard", "")),
        Patch(facecolor=TARGET, alpha=0.9, label="target" + counts.get("target", "")),
        *(_curve_handles() if region is not None else []),
        Line2D([], [], ls="", marker="*", ms=10, color=FIRST, label="foot of the first half"),
        Line2D([], [], ls="", marker="*", ms=10, color=style.ORANGE, label="foot of the second half"),
    ]
    if traced:
        handles.append(Line2D([], [], color=style.BLACK, lw=0.9, label="simulated steps"))
        handles.append(Line2D([], [], ls="", marker="s", mfc="white", mec=style.BLACK, label="switch of the foot"))
    return handles


def _curve_handles() -> list[Any]:
    return [
        Line2D([], [], color=TUBE, lw=1.0, ls="--", label="tangent manifolds"),
        Line2D([], [], color=style.BOUND, lw=0.9, label="barrier curves (outer bound)"),
    ]

"""One step of a run and what may come of it: its phase plane with a push, and the action game around it.

As in Shamsah et al., T-RO 2023, Fig. 12 (a) and (c).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from surefoot.errors import InputError
from surefoot.missions.biped.run_log import Run, Step
from surefoot.missions.plans.reader import BipedPlan, read_plan
from surefoot.missions.pushes.motion import step_controller
from surefoot.missions.pushes.step import transition
from surefoot.missions.scenario.scene import read_biped_scene
from surefoot.navigation import Action, FineState, Moved, apply_action, deviations, displace_action
from surefoot.viewer import style
from surefoot.viewer.sources.com_paths import arcs, local, turned
from surefoot.viewer.sources.plans import RunSource, read_run_source
from surefoot.viewer.steps.above import draw_above

COLOURS = {
    "nominal": style.VERMILION,
    "forward": style.BLUE,
    "backward": style.ORANGE,
    "left": style.GREEN,
    "right": style.PURPLE,
}
_AHEAD = 4
_LABEL_EVERY_M = 0.035
_Edge = tuple[str, str, Moved, bool]
"""An outcome: its name, its flag, where it leads, and whether it was walked."""
_MODES = ("standing", "walking", "ready", "left A", "right A", "left B", "right B")


def draw_step(run_dir: Path, number: int, out: Path) -> tuple[Path, ...]:
    """Draw a step of a run: its phase plane and the fragment of the action strategy around it.

    Args:
        run_dir: the folder of the run.
        number: of the step, counted from 0.
        out: the folder for the picture.

    Raises:
        InputError: if the run has no such step, or cannot be read.
    """
    source = read_run_source(run_dir)
    steps = source.run.steps
    if not 0 <= number < len(steps):
        raise InputError(_no_step(source.run, number), source=source.run.path)
    step, path = steps[number], out / f"step_{number}.png"
    with style.pictured(path, 15.0, 5.6) as figure:
        phase, above, automaton = figure.subplots(1, 3, width_ratios=(1.0, 0.85, 1.15))
        drawn = _draw_phase(phase, step)
        drawn += draw_above(above, steps, number, source.plan.document.get("robot", {}))
        drawn += _draw_automaton(automaton, step, source)
        pushed = "not pushed"
        if step.push is not None:
            jump = step.push.jump_mps
            pushed = f"pushed by {jump[0]:+.2f} m/s ahead and {jump[1]:+.2f} m/s left, recovered by the "
            pushed += "region's law" if step.push.recovery == "region" else "placement of a foot"
        style.title(figure, f"Step {number}: {pushed}; outcome {step.transition}")
        style.legend_outside(figure, drawn, columns=7)
    return (path,)


def _no_step(run: Run, number: int) -> str:
    """Return why a step cannot be drawn: the robot fell in it, or the run is shorter."""
    walked = f"the steps that were walked are 0 to {len(run.steps) - 1}" if run.steps else "no step was walked"
    for fall in run.falls:
        if fall.step == number:
            ahead, left = fall.push.jump_mps
            push = f"a push of {ahead:+.2f} m/s ahead and {left:+.2f} m/s left, {-fall.margin_mps:.2f} m/s too large"
            return f"step {number} was not completed: the robot fell in it after {push} ({fall.reason}); {walked}"
    return f"has no step {number}; {walked}"


def _draw_phase(axes: Axes, step: Step) -> list[Patch | Line2D]:
    """Draw the sagittal phase plane of a step, with the omegas of a push; return what the legend has to say."""
    style.light_grid(axes)
    legend = _draw_region(axes, step)
    labelled_m = -np.inf
    for positions, speeds, omega in arcs(step):
        x, v = local(step, positions)[:, 0], turned(step, speeds)[:, 0]
        axes.plot(x, v, color=style.BLACK, lw=2.0, zorder=4)
        middle = len(x) // 2
        if omega is not None and x[middle] > labelled_m + _LABEL_EVERY_M:
            labelled_m = x[middle]
            axes.annotate(f"{omega:.2f}", (x[middle], v[middle]), (0, 5), textcoords="offset points", fontsize=6.5)
    for foot, label in ((step.foot_m, "stance foot"), (step.next_foot_m, "next foot")):
        place = float(local(step, np.array(foot[:2]))[0])
        axes.plot(place, 0.0, "^", ms=9, color=style.BOUND, clip_on=False, zorder=6)
        axes.annotate(label, (place, 0.0), (0, 9), textcoords="offset points", ha="center", fontsize=7.5)
    if step.push is not None:
        place = float(local(step, np.array(step.push.planned.next_foot_m[:2]))[0])
        axes.plot(place, 0.0, "^", ms=9, mfc="none", mec=style.BOUND, clip_on=False, zorder=6)
    switch = float(local(step, np.array(step.switch_m))[0]), float(turned(step, np.array(step.switch_velocity_mps))[0])
    axes.plot(*switch, "s", ms=6, mfc="white", mec=style.BLACK, zorder=7)
    axes.set_xlabel("position along the heading, from the waypoint [m]")
    axes.set_ylabel("speed along the heading [m/s]")
    axes.set_title("(a) phase plane; numbers are omegas [rad/s]" if step.push else "(a) phase plane", loc="left")
    axes.set_ylim(0.0, max(1.15, axes.get_ylim()[1]))
    return [
        *legend,
        Line2D([], [], color=style.BLACK, lw=2, label="CoM"),
        Line2D([], [], ls="", marker="s", mfc="white", mec=style.BLACK, label="switch"),
        *([Line2D([], [], ls="", marker="^", mfc="none", mec=style.BOUND, label="planned foot")] if step.push else []),
    ]


def _draw_region(axes: Axes, step: Step) -> list[Patch | Line2D]:
    """Draw the robust controllable region that the law of a pushed step relied on."""
    if step.push is None or step.push.window_mps is None:
        return []
    start, foot, following = (
        float(local(step, np.array(place[:2]))[0]) for place in (step.com_m, step.foot_m, step.push.planned.next_foot_m)
    )
    region = step_controller(following - start, foot - start, step.push.window_mps).region
    cells = region.cells
    legend: list[Patch | Line2D] = []
    (left, right), (low, high) = cells.x_edges(), cells.v_edges()
    x, v = np.append(left, right[-1]) + start, np.append(low, high[-1])
    layers = (
        (region.first.won, style.GREEN, "first half"),
        (region.second.won, style.YELLOW, "second half"),
        (region.first.target, style.SKY, "guard"),
        (region.second.target, style.VERMILION, "target"),
    )
    for won, colour, label in layers:
        shown = np.ma.masked_equal(won.T.astype(float), 0.0)
        axes.pcolormesh(x, v, shown, cmap=ListedColormap([colour]), alpha=0.35, rasterized=True, zorder=1)
        legend.append(Patch(facecolor=colour, alpha=0.35, label=label))
    return legend


def _draw_automaton(axes: Axes, step: Step, source: RunSource) -> list[Line2D]:
    """Draw the state before a step, its action, and where the outcomes lead; return what the legend says about it."""
    plan = read_plan(source.plan.folder, read_biped_scene(source.plan.folder / _scenario(source)))
    fine = step.fine
    state = FineState(fine.row, fine.column, fine.heading, fine.stance, fine.mode, fine.context)
    edges = _edges(plan, state, step)
    axes.set_axis_off()
    axes.set_xlim(0.0, 1.0)
    axes.set_title("(c) the action strategy around the step", loc="left")
    begin = f"{_named(plan, state)}\naction: {_action(plan, step.action)}"
    if len(edges) == 1:
        _draw_chain(axes, plan, begin, edges[0])
    else:
        _draw_fan(axes, plan, begin, edges)
    flags = {flag for _, flag, _, _ in edges}
    return [Line2D([], [], color=colour, lw=1.8, label=flag) for flag, colour in COLOURS.items() if flag in flags]


def _draw_fan(axes: Axes, plan: BipedPlan, begin: str, edges: list[_Edge]) -> None:
    """Draw the outcomes below one another; the one that was walked is bold."""
    axes.set_ylim(-0.5, len(edges) - 0.5)
    middle = 0.5 * (len(edges) - 1)
    _box(axes, 0.13, middle, begin, style.BLACK, bold=True)
    for number, (label, flag, moved, taken) in enumerate(edges):
        _arrow(axes, (0.25, middle), (0.71, number), COLOURS[flag], bold=taken)
        place = middle + 0.7 * (number - middle)
        ground = {"facecolor": "white", "edgecolor": "none", "pad": 1.0}
        axes.text(0.57, place, label, fontsize=7, color=COLOURS[flag], ha="center", va="center", bbox=ground, zorder=6)
        _box(axes, 0.83, number, _reached(plan, moved), COLOURS[flag], bold=taken)


def _draw_chain(axes: Axes, plan: BipedPlan, begin: str, edge: _Edge) -> None:
    """Draw the only outcome, and where the strategy goes from there while every step goes as planned."""
    label, flag, moved, _ = edge
    chain = [moved]
    while len(chain) < _AHEAD and not chain[-1].achieved:
        action = plan.action.actions.get(chain[-1].state)
        if action is None:
            break
        chain.append(apply_action(plan.rules.tables, chain[-1].state, action, 0, 0))
    axes.set_ylim(len(chain) + 0.5, -0.5)
    _box(axes, 0.5, 0, begin, style.BLACK, bold=True)
    for number, reached in enumerate(chain, 1):
        _arrow(axes, (0.5, number - 0.68), (0.5, number - 0.34), COLOURS[flag], bold=number == 1)
        said = label if number == 1 else "(+0, +0), as planned"
        axes.text(0.53, number - 0.5, said, fontsize=7, color=COLOURS[flag], va="center")
        _box(axes, 0.5, number, _reached(plan, reached), COLOURS[flag], bold=number == 1)


def _arrow(axes: Axes, begin: tuple[float, float], end: tuple[float, float], colour: str, *, bold: bool) -> None:
    look = {"arrowstyle": "-|>", "color": colour, "lw": 2.6 if bold else 1.0, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", end, begin, arrowprops=look)


def _reached(plan: BipedPlan, moved: Moved) -> str:
    """Return the text of a state that an outcome leads to: where it is, and what the strategy does there."""
    answer = plan.action.actions.get(moved.state)
    after = "order achieved" if moved.achieved else "no answer" if answer is None else _action(plan, answer)
    return f"{_named(plan, moved.state)}\n{after}"


def _edges(plan: BipedPlan, state: FineState, step: Step) -> list[_Edge]:
    """Return the outcomes of a step's action: label, flag, where it leads, and whether it was the one taken."""
    tables, yaw = plan.rules.tables, step.yaw_rad
    most, found = deviations(tables, state, step.action), []
    taken = step.outcome.sagittal, step.outcome.lateral
    for e in range(-most.sagittal, most.sagittal + 1):
        for aside in range(-most.lateral, most.lateral + 1):
            walked = (e, aside) == taken and step.moved_cells == (0, 0)
            moved = apply_action(tables, state, step.action, e, aside)
            found.append((f"({e:+d}, {aside:+d})", transition((e, aside), (0, 0), yaw), moved, walked))
    if step.moved_cells != (0, 0):
        put_off = step.push is not None and step.push.put_off
        displaced = displace_action(tables, state, step.action, taken, step.moved_cells, put_off=put_off)
        if displaced is not None:
            label = f"entered anew, rows {step.moved_cells[0]:+d}, columns {step.moved_cells[1]:+d}"
            found.append((label, step.transition, displaced, True))
    return found


def _scenario(source: RunSource) -> str:
    return str(source.plan.document["scenario"]["path"])


def _named(plan: BipedPlan, state: FineState) -> str:
    """Say where a state is and which way it heads: degrees from the grid's north, clockwise."""
    degrees, foot = 90 * state.heading / plan.rules.tables.turn_steps, "left" if state.stance == 0 else "right"
    return f"cell ({state.row}, {state.column}), {degrees:g}\u00b0\n{foot} stance, {_MODES[state.mode]}"


def _action(plan: BipedPlan, action: int) -> str:
    if action >= Action.STRAIGHT:
        return f"straight, {plan.rules.tables.length[action]} cells"
    return Action(action).name.lower().replace("_", "-")


def _box(axes: Axes, x: float, y: float, text: str, colour: str, *, bold: bool) -> None:
    look = {"boxstyle": "round,pad=0.35", "facecolor": "white", "edgecolor": colour, "linewidth": 2.4 if bold else 1.0}
    axes.text(x, y, text, fontsize=7, ha="center", va="center", bbox=look, zorder=5)

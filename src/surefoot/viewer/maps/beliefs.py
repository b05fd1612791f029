"""What the robot sees and believes at a few moments (as in Shamsah et al., T-RO 2023, Fig. 10)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from surefoot.frames import Cell, Direction
from surefoot.missions.biped.monitor import VIOLATIONS
from surefoot.missions.biped.run_log import Turn
from surefoot.viewer import style
from surefoot.viewer.maps.ground import draw_lines, fill_cells, frame, size_in
from surefoot.viewer.maps.marks import goal_key, mark_goals, mark_obstacle, mark_robot, robot_key
from surefoot.viewer.sources.cells import points_m
from surefoot.viewer.sources.plans import RunSource
from surefoot.world import visible_pairs

PANELS = 6

_BROKEN: dict[str, Any] = {"ls": "", "marker": "D", "ms": 15, "mfc": "none", "mec": style.VERMILION, "mew": 2.0}


def chosen_turns(turns: Sequence[Turn], panels: int = PANELS, broken: Sequence[int] = ()) -> tuple[int, ...]:
    """Return which turns to show: the longest time that an obstacle was hidden, with the turns before and after it.

    When nothing ever hid, the turns are spread evenly; where assumptions were seen broken, the first such turn and
    those around it are shown.

    Args:
        turns: of the run.
        panels: how many to show.
        broken: turns at which an assumption was seen broken, ascending.
    """
    if broken and broken[0] < len(turns):
        first = max(0, min(broken[0] - panels // 2 + 1, len(turns) - panels))
        return tuple(range(first, min(first + panels, len(turns))))
    first, last = _longest_hidden(turns)
    if first == last:
        spread = np.linspace(0, len(turns) - 1, min(panels, len(turns)))
    else:
        low, high = max(0, first - 1), min(len(turns) - 1, last)
        spread = np.concatenate(([low], np.linspace(first, last - 1, panels - 2), [high]))
    shown = {int(turn) for turn in np.round(spread)}
    spare = [turn for turn in range(min(shown), len(turns)) if turn not in shown]
    return tuple(sorted(shown | set(spare[: max(0, panels - len(shown))])))


def draw_beliefs(source: RunSource, path: Path) -> Path:
    """Draw the belief at a few moments, one small map each."""
    turns, grid = source.run.turns, source.plan.grid
    chosen = chosen_turns(turns, broken=[one.turn for one in source.run.violations])
    columns = 2 if grid.columns > 1.4 * grid.rows else 3
    rows = math.ceil(len(chosen) / columns)
    width, height = size_in(grid, most=5.2 if columns == 2 else 3.8, margin=0.05)
    sees = visible_pairs(grid, source.plan.scenario.sensor.range_m, source.plan.scenario.navigation.corners)
    with style.pictured(path, columns * (width + 0.15) + 0.2, rows * (height + 0.35) + 1.0) as figure:
        panels = figure.subplots(rows, columns, squeeze=False).ravel()
        for axes, number in zip(panels, chosen, strict=False):
            _draw_turn(axes, source, number, sees)
        for axes in panels[len(chosen) :]:
            axes.set_visible(False)
        broken = {one.turn for one in source.run.violations}
        style.legend_outside(figure, _legend(broken=bool(broken.intersection(chosen))), columns=4)
    return path


def _longest_hidden(turns: Sequence[Turn]) -> tuple[int, int]:
    """Return the longest stretch of turns, first and one past the last, in which something was hidden."""
    best, begin = (0, 0), 0
    for number, turn in enumerate(turns):
        if not any(turn.hidden):
            begin = number + 1
        elif number + 1 - begin > best[1] - best[0]:
            best = begin, number + 1
    return best


def _draw_turn(axes: Axes, source: RunSource, number: int, sees: NDArray[np.bool_]) -> None:
    grid, turns = source.plan.grid, source.run.turns
    turn = turns[number]
    post = source.plan.scenario.navigation.view == "post" or number == 0
    view = Cell(*(turn if post else turns[number - 1]).cell)
    seen = sees[grid.index(view)].reshape(grid.free.shape)
    hidden = {Cell(*cell) for kind in turn.hidden for cell in kind}
    in_view = {cell for kind in turn.visible for cell in kind}
    unseen = [Cell(int(r), int(c)) for r, c in np.argwhere(grid.free & ~seen) if Cell(int(r), int(c)) not in hidden]
    blocked = [Cell(int(r), int(c)) for r, c in np.argwhere(~grid.free)]
    fill_cells(axes, grid, blocked, facecolor=style.WALL, edgecolor="none", zorder=1)
    fill_cells(axes, grid, unseen, facecolor=style.UNSEEN, edgecolor="none", zorder=1)
    fill_cells(axes, grid, hidden, facecolor=style.BELIEF, edgecolor="#8a5f00", hatch="...", linewidth=0, zorder=1)
    draw_lines(axes, grid)
    goals = [(cell.column + 0.76, cell.row + 0.28) for cell in source.plan.cells("goals")]
    mark_goals(axes, [(x, y) for x, y in points_m(grid, np.array(goals, np.float64).reshape(-1, 2))], size=10)
    for cell in turn.obstacles:
        mark_obstacle(axes, grid.center_m(Cell(*cell)), size=9, seen=cell in in_view)
    yaw_rad = Direction[turn.heading.upper()].yaw_rad + grid.rotation_rad
    mark_robot(axes, grid.center_m(Cell(*turn.cell)), yaw_rad, colour=style.BLUE, size=15)
    broken = _mark_broken(axes, source, number)
    axes.set_title(f"turn {turn.turn}, {turn.time_s:.0f} s: {turn.order}{broken}", fontsize=9)
    frame(axes, grid, margin=0.05, labels=False)


def _mark_broken(axes: Axes, source: RunSource, number: int) -> str:
    """Mark where an assumption was seen broken before a turn; return what its title says about it, and of plans."""
    said = ""
    for one in source.run.violations:
        if one.turn == number:
            place = Cell(*(one.cell or source.run.turns[number].cell))
            axes.plot(*source.plan.grid.center_m(place), zorder=12, **_BROKEN)
            said = f"\nan obstacle {VIOLATIONS[one.violation]}"
    if any(one.turn == number for one in source.run.replans):
        said += "\nplanned again"
    return said


def _legend(*, broken: bool) -> list[Any]:
    return [
        *([Line2D([], [], label="assumption seen broken here", **{**_BROKEN, "ms": 9})] if broken else []),
        robot_key("robot, its heading", colour=style.BLUE),
        Line2D([], [], ls="", marker="o", ms=8, mfc=style.OBSTACLE, mec=style.OBSTACLE, label="obstacle, seen"),
        Line2D(
            [], [], ls="", marker="o", ms=8, mfc="white", mec=style.OBSTACLE, mew=2.2, label="obstacle, hidden (truth)"
        ),
        goal_key(),
        Patch(facecolor=style.BELIEF, edgecolor="#8a5f00", hatch="...", lw=0, label="belief: it may be here"),
        Patch(facecolor=style.UNSEEN, label="out of view, known to be empty"),
        Patch(facecolor="white", edgecolor="#8a8a8a", label="in view"),
        Patch(facecolor=style.WALL, label="blocked"),
    ]

"""What a strategy does for everything that the robot may know of the obstacles, in one robot state."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from surefoot.errors import InputError
from surefoot.frames import Cell, Direction
from surefoot.navigation import NavigationStrategy, ObstacleState, Order
from surefoot.viewer import style
from surefoot.viewer.maps.ground import draw_lines, fill_cells, frame, size_in
from surefoot.viewer.maps.marks import goal_key, mark_goals, mark_obstacle, mark_robot, robot_key
from surefoot.viewer.sources.cells import points_m
from surefoot.viewer.sources.plans import PlanSource, read_plan_source, strategy_of
from surefoot.world import visible_pairs

MOST_PANELS = 30
_COLUMNS = 5


@dataclass(frozen=True, slots=True)
class Asked:
    """The robot state that is asked about.

    Attributes:
        cell: the robot's cell.
        heading: its heading; None for the one with the most decisions.
        goal: index of the goal that it pursues; None for the one with the most decisions.
    """

    cell: Cell
    heading: Direction | None = None
    goal: int | None = None


@dataclass(frozen=True, slots=True)
class _Answer:
    """What is known of the obstacles, and the order for it."""

    state: ObstacleState
    order: Order


def draw_answers(plan_dir: Path, asked: Asked, out: Path) -> tuple[Path, ...]:
    """Draw the orders of a strategy in one robot state, a small map for each state of the obstacles.

    Args:
        plan_dir: the folder of the plan.
        asked: the robot state.
        out: the folder for the picture.

    Raises:
        InputError: if the plan has no decision there.
    """
    source = read_plan_source(plan_dir)
    strategy = strategy_of(source)
    heading, goal = _most_asked(source, strategy, asked)
    answers = _answers(source, strategy, asked.cell, heading, goal)
    row, column = asked.cell
    path = out / f"answers_r{row}_c{column}_{heading.name.lower()}_goal{goal}.png"
    return (_draw(source, strategy, asked.cell, heading, goal, answers, path),)


def _most_asked(source: PlanSource, strategy: NavigationStrategy, asked: Asked) -> tuple[Direction, int]:
    """Return the heading and the goal with the most decisions among those that fit what is asked."""
    here = strategy.cell == (source.grid.index(asked.cell) if source.grid.has(asked.cell) else -1)
    pairs = np.stack([strategy.heading[here].astype(np.int64), strategy.goal[here].astype(np.int64)], axis=1)
    found, counts = np.unique(pairs, axis=0, return_counts=True)
    fits = [
        (int(count), int(heading), int(goal))
        for (heading, goal), count in zip(found, counts, strict=True)
        if asked.heading in (None, heading) and asked.goal in (None, goal)
    ]
    if fits:
        _, heading, goal = max(fits)
        return Direction(heading), goal
    if len(found):
        named = ", ".join(f"heading {Direction(h).name.lower()} with goal {g}" for h, g in found.tolist())
        raise InputError(f"the strategy decides in {tuple(asked.cell)} only with: {named}", key="cell")
    cells = sorted({tuple(source.grid.cell(cell)) for cell in strategy.cell.tolist()})
    raise InputError(f"the strategy never comes to {tuple(asked.cell)}; it decides in {cells}", key="cell")


def _answers(
    source: PlanSource, strategy: NavigationStrategy, cell: Cell, heading: Direction, goal: int
) -> list[_Answer]:
    """Return the decisions in a robot state, those with hidden obstacles first, small beliefs first."""
    rows = np.flatnonzero(
        (strategy.cell == source.grid.index(cell)) & (strategy.heading == heading) & (strategy.goal == goal)
    )
    answers = [_Answer(strategy.states[strategy.state[row]], Order.of(int(strategy.order[row]))) for row in rows]

    def rank(answer: _Answer) -> tuple[bool, int, tuple[tuple[int, ...], ...]]:
        hidden = sum(mask.bit_count() for mask in answer.state.hidden)
        return not hidden, hidden, answer.state.visible

    return sorted(answers, key=rank)


def _draw(
    source: PlanSource,
    strategy: NavigationStrategy,
    cell: Cell,
    heading: Direction,
    goal: int,
    answers: list[_Answer],
    path: Path,
) -> Path:
    shown = answers[:MOST_PANELS]
    columns = min(_COLUMNS, len(shown))
    rows = math.ceil(len(shown) / columns)
    width, height = size_in(source.grid, most=2.6, margin=0.05)
    with style.pictured(path, max(columns * (width + 0.12) + 0.2, 6.0), rows * (height + 0.3) + 1.3) as figure:
        panels = figure.subplots(rows, columns, squeeze=False).ravel()
        for axes, answer in zip(panels, shown, strict=False):
            _draw_answer(axes, source, strategy, cell, heading, answer)
        for axes in panels[len(shown) :]:
            axes.set_visible(False)
        count = f"{len(shown)} of {len(answers)}" if len(shown) < len(answers) else f"{len(answers)}"
        style.title(
            figure,
            f"the strategy in {tuple(cell)}, heading {heading.name.lower()}, on the way to goal {goal}: "
            f"{count} states of the obstacles",
        )
        style.legend_outside(figure, _legend(), columns=4)
    return path


def _draw_answer(
    axes: Axes, source: PlanSource, strategy: NavigationStrategy, cell: Cell, heading: Direction, answer: _Answer
) -> None:
    grid, scenario, state = source.grid, source.scenario, answer.state
    seen = visible_pairs(grid, scenario.sensor.range_m, scenario.navigation.corners)[grid.index(cell)]
    places = [Cell(int(row), int(column)) for row, column in np.ndindex(grid.free.shape)]
    masks = [strategy.domain[bit] for mask in state.hidden for bit in range(mask.bit_length()) if mask >> bit & 1]
    hidden = {grid.cell(index) for index in masks}
    unseen = [place for place in places if grid.is_free(place) and not seen[grid.index(place)]]
    walls = [place for place in places if not grid.is_free(place)]
    fill_cells(axes, grid, walls, facecolor=style.WALL, edgecolor="none", zorder=1)
    fill_cells(axes, grid, set(unseen) - hidden, facecolor=style.UNSEEN, edgecolor="none", zorder=1)
    fill_cells(axes, grid, hidden, facecolor=style.BELIEF, edgecolor="#8a5f00", hatch="...", linewidth=0, zorder=1)
    draw_lines(axes, grid)
    goals = [(place.column + 0.76, place.row + 0.28) for place in source.cells("goals")]
    mark_goals(axes, [(x, y) for x, y in points_m(grid, np.array(goals, np.float64).reshape(-1, 2))], size=7)
    for visible in state.visible:
        for index in visible:
            mark_obstacle(axes, grid.center_m(grid.cell(index)), size=6)
    colour = style.RIGHT if answer.order.waits else style.BLUE
    yaw_rad = answer.order.direction.yaw_rad + grid.rotation_rad
    mark_robot(axes, grid.center_m(cell), yaw_rad, colour=colour, size=12)
    axes.set_title(str(answer.order), fontsize=8, color=colour)
    frame(axes, grid, margin=0.05, labels=False)


def _legend() -> list[Any]:
    return [
        robot_key("robot: the move it is ordered", colour=style.BLUE),
        robot_key("robot: the move it waits for", colour=style.RIGHT),
        Line2D([], [], ls="", marker="o", ms=7, mfc=style.OBSTACLE, mec=style.OBSTACLE, label="obstacle, seen"),
        goal_key(),
        Patch(facecolor=style.BELIEF, edgecolor="#8a5f00", hatch="...", lw=0, label="belief: one may be here"),
        Patch(facecolor=style.UNSEEN, label="out of view, known to be empty"),
        Patch(facecolor="white", edgecolor="#8a8a8a", label="in view"),
        Patch(facecolor=style.WALL, label="blocked"),
    ]

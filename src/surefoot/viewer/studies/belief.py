"""With and without belief: where the robot goes in simulated turns, or that it has no strategy (seed Fig. 16)."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from surefoot.missions.scenario.scene import BipedScene
from surefoot.navigation import BeliefAnswer
from surefoot.viewer import style
from surefoot.viewer.maps.ground import draw_blocked, draw_lines, draw_pixels, fill_cells, frame, size_in
from surefoot.viewer.maps.marks import goal_key, mark_goals, mark_obstacle, mark_robot, robot_key

BELIEFS = {
    "regions": "with belief: regions",
    "exact": "with belief: exact sets",
    "single": "without: one region, narrowed by what is seen",
    "unnarrowed": "without: one region, never narrowed",
}
READINGS = {"natural": "the scenario's rules", "paper": "the paper's reading"}


def draw_belief_study(scene: BipedScene, answers: tuple[BeliefAnswer, ...], out: Path) -> tuple[Path, ...]:
    """Draw one picture for every reading, a panel for every kind of belief.

    Args:
        scene: the scene.
        answers: of ``navigation.belief_study``.
        out: the folder for the pictures.
    """
    return tuple(
        _draw_reading(scene, [one for one in answers if one.reading == reading], out / f"belief_{reading}.png")
        for reading in dict.fromkeys(one.reading for one in answers)
    )


def _draw_reading(scene: BipedScene, answers: list[BeliefAnswer], path: Path) -> Path:
    width, height = size_in(scene.grid, most=5.0)
    with style.pictured(path, len(answers) * (width + 0.5), height + 1.7) as figure:
        for axes, answer in zip(figure.subplots(1, len(answers), squeeze=False)[0], answers, strict=True):
            _draw_answer(axes, scene, answer)
        played = next((one.throughput.turns for one in answers if one.throughput is not None), 0)
        how = f"; shade: share of {played:,} turns against random obstacles" if played else ""
        style.title(figure, f"{scene.path.name}, {READINGS[answers[0].reading]}{how}")
        keys = [
            robot_key("start, its heading", colour=style.BLACK),
            goal_key(),
            Line2D([], [], ls="", marker="o", ms=8, color=style.OBSTACLE, label="obstacle at the start"),
            Patch(facecolor=style.BLUE, alpha=0.7, label="where the robot spends its turns"),
        ]
        style.legend_outside(figure, keys, columns=4)
    return path


def _draw_answer(axes: Axes, scene: BipedScene, answer: BeliefAnswer) -> None:
    grid, problem = scene.grid, scene.problem
    draw_pixels(axes, scene.occupancy)
    draw_blocked(axes, grid)
    if answer.throughput is not None:
        _shade(axes, scene, answer.throughput.path)
    draw_lines(axes, grid)
    here = grid.cell(problem.start)
    mark_robot(axes, grid.center_m(here), problem.heading.yaw_rad + grid.rotation_rad, colour=style.BLACK, size=16)
    mark_goals(axes, [grid.center_m(grid.cell(goal)) for goal in problem.goals], size=12)
    for obstacle in problem.obstacles:
        mark_obstacle(axes, grid.center_m(grid.cell(obstacle.start)), size=8)
    frame(axes, grid)
    axes.set_title(f"{BELIEFS[answer.belief]}\n{_verdict(answer)}")


def _shade(axes: Axes, scene: BipedScene, path: tuple[int, ...]) -> None:
    """Colour cells by how long the robot is there; the busiest is darkest."""
    turns = Counter(path)
    colours = mpl.colormaps["Blues"]
    for cell, count in turns.items():
        shade = colours(0.15 + 0.75 * count / max(turns.values()))
        fill_cells(axes, scene.grid, [scene.grid.cell(cell)], facecolor=shade, edgecolor="none", zorder=0.6)


def _verdict(answer: BeliefAnswer) -> str:
    if answer.realizable is None:
        return "UNKNOWN: a limit was reached"
    if answer.throughput is None:
        return "NOT realizable"
    return f"realizable, {answer.throughput.visits:,} goal visits"

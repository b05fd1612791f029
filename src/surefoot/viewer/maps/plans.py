"""The grid of a plan or of a scenario: start, goals, where obstacles may be, belief regions, stairs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from surefoot.frames import Cell, Direction
from surefoot.missions.scenario.file import Scenario, read_scenario
from surefoot.viewer import style
from surefoot.viewer.maps.ground import (
    draw_blocked,
    draw_lines,
    draw_pixels,
    fill_cells,
    frame,
    ground_keys,
    number_cells,
    size_in,
)
from surefoot.viewer.maps.levels import draw_levels
from surefoot.viewer.maps.marks import goal_key, mark_goals, mark_robot, robot_key
from surefoot.viewer.maps.obstacle_tracks import colour_of, mark_numbered
from surefoot.viewer.sources.plans import read_plan_source
from surefoot.world import CoarseGrid, OccupancyMap, make_grid, read_occupancy_map


@dataclass(frozen=True, slots=True)
class Layout:
    """What the picture shows.

    Attributes:
        scenario: places, regions and heights.
        occupancy: the map's pixels.
        grid: the coarse grid.
        start_m: where the robot stands at first.
        forbidden: free cells that no obstacle ever enters.
        title: above the picture.
        whole: whether the whole grid is shown, or only what is near free cells.
    """

    scenario: Scenario
    occupancy: OccupancyMap
    grid: CoarseGrid
    start_m: tuple[float, float]
    forbidden: frozenset[Cell]
    title: str
    whole: bool = False


def draw_plan(plan_dir: Path, out: Path) -> tuple[Path, ...]:
    """Draw the grid that a plan was made on."""
    source = read_plan_source(plan_dir)
    start = source.cells("start", "cell")
    obstacles = range(len(source.scenario.obstacles))
    domain = frozenset(cell for number in obstacles for cell in source.cells("obstacles", number, "domain"))
    layout = Layout(
        scenario=source.scenario,
        occupancy=source.occupancy,
        grid=source.grid,
        start_m=source.grid.center_m(start[0]) if start else source.scenario.start.position_m,
        forbidden=frozenset(source.grid.free_cells()) - domain if domain else frozenset(),
        title=f"plan in {source.folder.name}/",
    )
    pictures = (draw_layout(layout, out / "plan.png"),)
    if not (plan_dir / "navigation.npz").is_file():
        return pictures
    from surefoot.viewer.maps.play import draw_play

    return (*pictures, draw_play(source, out / "play.png"))


def draw_scenario(scenario_path: Path, out: Path) -> tuple[Path, ...]:
    """Draw a scenario on its map, even where its places are not right yet."""
    scenario = read_scenario(scenario_path)
    occupancy = read_occupancy_map(scenario.map_path, scenario.map_resolution_m)
    grid = _grid(scenario, occupancy)
    barred = [
        {cell for area in obstacle.forbidden for cell in grid.wholly_inside(area.rectangle_m) if grid.is_free(cell)}
        for obstacle in scenario.obstacles
    ]
    layout = Layout(
        scenario=scenario,
        occupancy=occupancy,
        grid=grid,
        start_m=scenario.start.position_m,
        forbidden=frozenset(set.intersection(*barred) if barred else ()),
        title=scenario_path.name,
        whole=True,
    )
    return (draw_layout(layout, out / f"{scenario_path.stem}.png"),)


def draw_layout(layout: Layout, path: Path) -> Path:
    """Draw a scenario's grid with all that is placed on it."""
    width, height = size_in(layout.grid, most=9.5, whole=layout.whole)
    with style.pictured(path, max(width + 0.8, 6.0), height + 1.5) as figure:
        _draw(figure, layout)
    return path


def _grid(scenario: Scenario, occupancy: OccupancyMap) -> CoarseGrid:
    from surefoot.missions.scenario.scene import inflation_m
    from surefoot.robots import biped
    from surefoot.walking import walking_parameters

    walking = walking_parameters(scenario.grid.cell_size_m, **scenario.walking.given())
    return make_grid(
        occupancy,
        cell_size_m=scenario.grid.cell_size_m,
        origin_m=scenario.grid.origin_m,
        rotation_rad=scenario.grid.rotation_rad,
        unknown=scenario.grid.unknown,
        inflation_m=inflation_m(walking, biped(scenario.robot)),
    )


def _draw(figure: Figure, layout: Layout) -> None:
    axes, grid, scenario = figure.add_subplot(), layout.grid, layout.scenario
    draw_pixels(axes, layout.occupancy)
    draw_blocked(axes, grid)
    handles = _draw_regions(axes, layout)
    fill_cells(axes, grid, layout.forbidden, facecolor="none", edgecolor=style.OBSTACLE, hatch="xx", lw=0, zorder=0.8)
    draw_lines(axes, grid)
    number_cells(axes, grid, whole=layout.whole)
    handles += draw_levels(axes, grid, scenario)
    _draw_places(axes, layout)
    frame(axes, grid, whole=layout.whole)
    free = int(grid.free.sum())
    style.title(figure, f"{layout.title}: {free} free cells of {grid.cell_size_m:g} m")
    style.legend_outside(figure, [*_legend(layout), *handles], columns=4)


def _draw_regions(axes: Axes, layout: Layout) -> list[Any]:
    """Colour the belief regions; return what the legend says about them."""
    handles: list[Any] = []
    for number, region in enumerate(layout.scenario.belief_regions):
        cells = {cell for area in region.rectangles_m for cell in layout.grid.centered_in(area)}
        colour = style.REGIONS[number % len(style.REGIONS)]
        free = [cell for cell in cells if layout.grid.is_free(cell)]
        fill_cells(axes, layout.grid, free, facecolor=colour, alpha=0.4, edgecolor="none", zorder=0.6)
        handles.append(Patch(facecolor=colour, alpha=0.4, label=f"belief region {number}"))
    return handles


def _draw_places(axes: Axes, layout: Layout) -> None:
    """Draw the start with its heading, the goals with their numbers, and the obstacles."""
    scenario = layout.scenario
    yaw_rad = Direction[scenario.start.heading.upper()].yaw_rad + layout.grid.rotation_rad
    mark_robot(axes, layout.start_m, yaw_rad, colour=style.BLACK, size=20)
    mark_goals(axes, [goal.position_m for goal in scenario.goals], size=14)
    several = len(scenario.obstacles) > 1
    for number, obstacle in enumerate(scenario.obstacles):
        mark_numbered(axes, obstacle.start_m, number if several else None, size=10)


def _legend(layout: Layout) -> list[Any]:
    handles: list[Any] = [
        robot_key("start, its heading", colour=style.BLACK),
        goal_key(),
        *ground_keys(layout.grid, layout.occupancy, whole=layout.whole),
    ]
    several = len(layout.scenario.obstacles) > 1
    for number in range(len(layout.scenario.obstacles)):
        name = f"obstacle {number} at the start" if several else "obstacle at the start"
        handles.append(Line2D([], [], ls="", marker="o", ms=9, color=colour_of(number), label=name))
    if layout.forbidden:
        hatched: dict[str, Any] = {"facecolor": "none", "edgecolor": style.OBSTACLE, "hatch": "xxx", "lw": 0}
        handles.append(Patch(label="no obstacle ever here", **hatched))
    return handles

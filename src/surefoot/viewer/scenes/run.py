"""A biped's run as a scene in three dimensions: map, goals, belief, obstacles, footprints, and the robot that moves."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.frames import Cell
from surefoot.missions.biped.run_log import Step
from surefoot.viewer import style
from surefoot.viewer.browser.page import Cameras, add_solid, arrow_colour, colour
from surefoot.viewer.browser.scenery import light
from surefoot.viewer.browser.solids import borders, floors, walls
from surefoot.viewer.robots.biped_figure import BipedFigure
from surefoot.viewer.robots.bodies import SIMPLE, Chosen
from surefoot.viewer.scenes.belief_tiles import KIND_HUES, BeliefTiles
from surefoot.viewer.sources.cells import centre_m, floor_m, heights_of
from surefoot.viewer.sources.plans import PlanSource, RunSource
from surefoot.viewer.sources.steps import in_world
from surefoot.viewer.sources.timeline import Timeline

_OBSTACLE_M = (0.3, 1.1)
_JUMP_S = 4.0
"""Metres of arrow for a push of 1 m/s."""
_PAPER, _LINES = "#eceae4", "#c3bfb4"


def add_ground(scene: Any, plan: PlanSource) -> None:
    """Draw floors, stairs, walls and goals."""
    heights = heights_of(plan)
    add_solid(scene, "/map/floors", floors(plan, heights), _PAPER, cast_shadow=False)
    scene.add_line_segments(
        "/map/cells", borders(plan, heights), colour(_LINES), thickness=1.0, thickness_units="screen"
    )
    add_solid(scene, "/map/walls", walls(plan.occupancy), style.WALL)
    for number, cell in enumerate(plan.cells("goals")):
        place = (*centre_m(plan, cell), floor_m(heights, cell) + 0.01)
        scene.add_cylinder(f"/goals/{number}", 0.4, 0.02, colour(style.GOAL), position=place, opacity=0.9)
        scene.add_label(f"/goals/{number}/name", f"goal {number}", position=(0, 0, 0.1))


def map_cameras(plan: PlanSource) -> dict[str, dict[str, Any]]:
    """Return places that see the whole map, by name."""
    free = np.argwhere(plan.grid.free)
    corners = [centre_m(plan, Cell(int(row), int(column))) for row, column in (free.min(0), free.max(0))]
    low, high = np.min(corners, axis=0), np.max(corners, axis=0)
    (x, y), size = (low + high) / 2, float(np.linalg.norm(high - low)) + plan.grid.cell_size_m
    return {
        "overview": {"position": [x - 0.25 * size, y - 0.62 * size, 0.62 * size], "look_at": [x, y, 0.0]},
        "from above": {"position": [x, y - 0.01 * size, 1.05 * size], "look_at": [x, y, 0.0]},
    }


class RunScene:
    """Draws a run into a scene, and any moment of it.

    Args:
        scene: of a viser server.
        source: the run.
        times: the run, sampled.
        chosen: the body that is drawn.
    """

    def __init__(
        self,
        scene: Any,
        source: RunSource,
        times: Timeline,
        chosen: Chosen = SIMPLE,
    ) -> None:
        self.scene, self.source, self.times, self.chosen = scene, source, times, chosen
        self.turn, self.text = -1, ""
        self.pushed = 0
        light(scene)
        add_ground(scene, source.plan)
        self.tiles = BeliefTiles(scene, source.plan)
        self.figure = BipedFigure(scene, times, source.run.steps, chosen)
        self.obstacles = [self._obstacle(number) for number in range(times.obstacles_m.shape[1])]
        self.label = scene.add_label("/robot/order", "", anchor="bottom-center", font_screen_scale=1.1)
        self._mark_pushes()

    @property
    def time_s(self) -> NDArray[np.float64]:
        """Return the moments."""
        return self.times.time_s

    def grow(self, source: RunSource, times: Timeline) -> None:
        """Take over a longer log of the same run."""
        self.source, self.times = source, times
        self.figure.grow(times, source.run.steps)
        self._mark_pushes()

    def show(self, frame: int) -> None:
        """Show a moment; only what has changed is sent."""
        self.figure.show(frame)
        self.label.position = self.times.com_m[frame] + np.array([0.0, 0.0, 0.75])
        for node, place in zip(self.obstacles, self.times.obstacles_m[frame], strict=True):
            node.position = place + np.array([0.0, 0.0, _OBSTACLE_M[1] / 2])
        text = self._says(frame)
        if text != self.text:
            self.label.text = self.text = text
        if self.times.turns and self.times.turn[frame] != self.turn:
            self.turn = int(self.times.turn[frame])
            hidden = self.times.turns[self.turn].hidden
            self.tiles.show(frozenset((kind, Cell(*cell)) for kind, cells in enumerate(hidden) for cell in cells))

    def caption(self, frame: int) -> str:
        """Say the step and the order."""
        step = self.source.run.steps[self.times.step[frame]]
        foot = f"from the {step.stance} foot, to {step.next_apex_speed_mps:.2f} m/s"
        remark = self.figure.body.remark(frame)
        return f"Step {step.step}: {self._says(frame)} ({foot})" + (f"; {remark}" if remark else "")

    def notes(self) -> tuple[str, ...]:
        """Say what is drawn otherwise than it was logged."""
        return (*self.chosen.remarks, *self.figure.body.remarks())

    def cameras(self) -> Cameras:
        """Return places to look from, by name."""
        return {
            **map_cameras(self.source.plan),
            "follow": {"follow": "/robot/trunk", "offset": [-2.2, -2.2, 1.4]},
            "from the side": {"follow": "/robot/trunk", "offset": [0.0, -3.0, 0.4]},
        }

    def _says(self, frame: int) -> str:
        """Say what the robot is doing."""
        run, step = self.source.run, self.source.run.steps[self.times.step[frame]]
        turn = self.times.turns[self.times.turn[frame]] if self.times.turns else None
        said = [] if turn is None else [f"{turn.order}, to goal {turn.goal}"]
        if step.push is not None and self.times.time_s[frame] >= step.time_s + step.push.time_s:
            said.append(f"pushed by {np.hypot(*step.push.jump_mps):.2f} m/s")
        if frame == self.times.frames - 1:
            said += [f"falls: {fall.reason}" for fall in run.falls]
            said += [f"stops: {unsafe.reason}" for unsafe in run.unsafe]
        return ", ".join(said)

    def _mark_pushes(self) -> None:
        """Draw an arrow where and whither the robot was pushed, for the steps that have none yet."""
        steps = self.source.run.steps
        for step in steps[self.pushed :]:
            if step.push is not None:
                begin = self._com_at(step, step.push.time_s)
                jump_mps = np.array([*in_world(step.yaw_rad, step.push.jump_mps), 0.0])
                arrow = np.array([[begin, begin + _JUMP_S * jump_mps]])
                self.scene.add_arrows(f"/pushes/{step.step}", arrow, arrow_colour(style.VERMILION))
        self.pushed = len(steps)

    def _com_at(self, step: Step, time_s: float) -> NDArray[np.float64]:
        at = np.searchsorted(self.times.time_s, step.time_s + time_s)
        place: NDArray[np.float64] = self.times.com_m[min(int(at), self.times.frames - 1)]
        return place

    def _obstacle(self, number: int) -> Any:
        radius_m, height_m = _OBSTACLE_M
        kind = next(k for k, members in enumerate(self.source.run.header.kinds) if number in members)
        hue = KIND_HUES[kind % len(KIND_HUES)][0]
        return self.scene.add_cylinder(f"/obstacles/{number}", radius_m, height_m, colour(hue))

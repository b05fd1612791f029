"""A biped's run as a scene in three dimensions: map, goals, belief, obstacles, footprints, and the robot that moves."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.frames import Cell
from surefoot.missions.run_log import Turn
from surefoot.viewer import style
from surefoot.viewer.body import TRUNK_M, biped_parts, weight_pose
from surefoot.viewer.page import add_solid, colour
from surefoot.viewer.solids import cell_tiles, floor_m, floors, heights_of, walls
from surefoot.viewer.sources import RunSource
from surefoot.viewer.timeline import Timeline, centre_m

_LEG_M, _FOOT_M = 0.035, (0.22, 0.09, 0.03)
_HUES = {"left": style.LEFT, "right": style.RIGHT}
_OBSTACLE_M = (0.3, 1.1)
_FORCE_M, _CONE_M = 0.6, 0.25
_PAPER = "#eceae4"


class RunScene:
    """Draws a run into a scene, and any moment of it.

    Args:
        scene: of a viser server.
        source: the run.
        times: the run, sampled.
    """

    def __init__(self, scene: Any, source: RunSource, times: Timeline) -> None:
        self.scene, self.source, self.times = scene, source, times
        self.heights = heights_of(source.plan)
        self.turn, self.foot = -1, (0.0, 0.0, 0.0)
        self.believed: frozenset[Cell] = frozenset()
        scene.set_up_direction("+z")
        scene.configure_default_lights(cast_shadow=False)
        self._add_ground()
        self._add_footprints()
        self.tiles: dict[Cell, Any] = {}
        self._add_robot()
        self.obstacles = [self._obstacle(number) for number in range(times.obstacles_m.shape[1])]
        self.label = scene.add_label("/robot/order", "", anchor="bottom-center", font_screen_scale=1.1)

    def show(self, frame: int) -> None:
        """Show a moment; only what has changed is sent."""
        for name, part in self.poses.items():
            node = self.parts[name]
            node.position, node.wxyz = part.position_m[frame], part.wxyz[frame]
        self._show_stance(frame)
        self.label.position = self.times.com_m[frame] + np.array([0.0, 0.0, 0.75])
        for node, place in zip(self.obstacles, self.times.obstacles_m[frame], strict=True):
            node.position = (*place, node.position[2])
        if self.times.turn[frame] != self.turn:
            self.turn = int(self.times.turn[frame])
            self._show_turn(self.times.turns[self.turn])

    def cameras(self) -> dict[str, dict[str, Any]]:
        """Return places to look from, by name."""
        grid = self.source.plan.grid
        free = np.argwhere(grid.free)
        corners = [centre_m(self.source, Cell(int(row), int(column))) for row, column in (free.min(0), free.max(0))]
        low, high = np.min(corners, axis=0), np.max(corners, axis=0)
        (x, y), size = (low + high) / 2, float(np.linalg.norm(high - low)) + grid.cell_size_m
        return {
            "overview": {"position": [x - 0.25 * size, y - 0.62 * size, 0.62 * size], "look_at": [x, y, 0.0]},
            "from above": {"position": [x, y - 0.01 * size, 1.05 * size], "look_at": [x, y, 0.0]},
            "follow": {"follow": "/robot/trunk", "offset": [-2.2, -2.2, 1.4]},
            "from the side": {"follow": "/robot/trunk", "offset": [0.0, -3.0, 0.4]},
        }

    def _add_ground(self) -> None:
        plan = self.source.plan
        add_solid(self.scene, "/map/floors", floors(plan, self.heights), _PAPER, cast_shadow=False)
        add_solid(self.scene, "/map/walls", walls(plan.occupancy), style.WALL)
        for number, cell in enumerate(plan.cells("goals")):
            x, y = centre_m(self.source, cell)
            z = floor_m(self.heights, cell)
            self.scene.add_cylinder(
                f"/goals/{number}", 0.4, 0.02, colour(style.GOAL), position=(x, y, z + 0.01), opacity=0.9
            )
            self.scene.add_label(f"/goals/{number}/name", f"goal {number + 1}", position=(0, 0, 0.1))

    def _add_footprints(self) -> None:
        for name in ("left", "right"):
            steps = [step for step in self.source.run.steps if step.stance != name]
            points = np.array([step.next_foot_m for step in steps])
            if len(points):
                self.scene.add_point_cloud(
                    f"/footprints/{name}",
                    points + np.array([0.0, 0.0, 0.01]),
                    colour(_HUES[name]),
                    point_size=0.06,
                    precision="float32",
                )

    def _add_robot(self) -> None:
        times = self.times
        self.poses, link_m = biped_parts(times.com_m, times.yaw_rad, times.left_foot_m, times.right_foot_m)
        add = self.scene
        self.parts: dict[str, Any] = {"trunk": add.add_box("/robot/trunk", colour("#3b3f46"), TRUNK_M)}
        for name, hue in _HUES.items():
            for link in ("thigh", "shank"):
                self.parts[f"{name}/{link}"] = add.add_cylinder(f"/robot/{name}/{link}", _LEG_M, link_m, colour(hue))
            self.parts[f"{name}/foot"] = add.add_box(f"/robot/{name}/foot", colour(hue), _FOOT_M)
        self.stance_m = self._stances()
        self.poses["force"] = weight_pose(self.stance_m, times.com_m, _FORCE_M)
        self.parts["force"] = add.add_cylinder("/contact/force", 0.015, _FORCE_M, colour(style.GREEN))
        self.cone = add.add_mesh_simple("/contact/cone", *_cone(0.6), color=colour(style.GREEN), opacity=0.25)

    def _show_stance(self, frame: int) -> None:
        """Show the friction cone under the foot that carries the robot."""
        place = tuple(self.stance_m[frame])
        if place != self.foot:
            self.cone.position = self.foot = place

    def _stances(self) -> NDArray[np.float64]:
        """Return where the foot stands that carries the robot, at every moment."""
        steps = self.source.run.steps
        switch_s = np.array([step.time_s + step.first_half_s for step in steps])[self.times.step]
        before, after = (np.array([getattr(step, name) for step in steps]) for name in ("foot_m", "next_foot_m"))
        early = (self.times.time_s < switch_s)[:, None]
        places: NDArray[np.float64] = np.where(early, before[self.times.step], after[self.times.step])
        return places

    def _obstacle(self, number: int) -> Any:
        radius_m, height_m = _OBSTACLE_M
        first = self.times.obstacles_m[0, number]
        return self.scene.add_cylinder(
            f"/obstacles/{number}", radius_m, height_m, colour(style.OBSTACLE), position=(*first, height_m / 2)
        )

    def _show_turn(self, turn: Turn) -> None:
        believed = frozenset(Cell(*cell) for kind in turn.hidden for cell in kind)
        for cell in self.believed - believed:
            self.tiles[cell].visible = False
        for cell in believed - self.believed:
            if cell not in self.tiles:
                self.tiles[cell] = self._tile(cell)
            self.tiles[cell].visible = True
        self.believed = believed
        self.label.text = f"{turn.order}, to goal {turn.goal + 1}"

    def _tile(self, cell: Cell) -> Any:
        solid = cell_tiles(self.source.plan.grid, self.heights, np.array([cell]), 0.02, 0.06)
        return add_solid(
            self.scene, f"/belief/{cell.row}_{cell.column}", solid, style.BELIEF, opacity=0.55, cast_shadow=False
        )


def _cone(friction: float) -> tuple[Any, Any]:
    """Return a cone that opens upwards with the slope of a friction coefficient."""
    turns = np.linspace(0.0, 2 * np.pi, 24, endpoint=False)
    rim = np.stack([friction * np.cos(turns), friction * np.sin(turns), np.ones(24)], axis=1) * _CONE_M
    vertices = np.concatenate([[[0.0, 0.0, 0.0]], rim]).astype(np.float32)
    faces = np.array([(0, 1 + (k + 1) % 24, 1 + k) for k in range(24)], dtype=np.uint32)
    return vertices, faces

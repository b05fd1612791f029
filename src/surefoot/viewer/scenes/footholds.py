"""A quadruped's motion as a scene in three dimensions: terrain, footholds, the robot, forces, friction cones."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.viewer import style
from surefoot.viewer.browser.page import Cameras, add_solid, colour
from surefoot.viewer.browser.scenery import light
from surefoot.viewer.browser.solids import slab
from surefoot.viewer.robots.biped_figure import friction_cone
from surefoot.viewer.robots.bodies import SIMPLE, Chosen
from surefoot.viewer.robots.quadruped_figure import FEET, FOOT_M, quadruped_figure
from surefoot.viewer.robots.simple import between
from surefoot.viewer.scenes.ground import GroundScene
from surefoot.viewer.sources.foothold_motion import FootholdMotion
from surefoot.viewer.sources.ground import RunGround
from surefoot.viewer.style import FOOT_COLOURS, FOOT_LABELS

Array = NDArray[np.float64]

_FORCE_M_PER_N, _CONE_M = 1 / 300.0, 0.08
_LOADED_N = 1e-6
_SLAB_M, _LABEL_M = 0.04, 0.24


class FootholdScene:
    """Draws a motion of a quadruped into a scene, and any sample of it.

    Args:
        scene: of a viser server.
        motion: of a foothold plan, or of a run.
        chosen: the body that is drawn.
        ground: of the whole run; None draws the polygons that the motion knows.
    """

    def __init__(
        self,
        scene: Any,
        motion: FootholdMotion,
        chosen: Chosen = SIMPLE,
        ground: RunGround | None = None,
    ) -> None:
        self.scene, self.motion, self.chosen = scene, motion, chosen
        self.polygons, self.marked, self.text = 0, [0] * len(FEET), ""
        light(scene)
        self.ground = None if ground is None else GroundScene(scene, ground)
        if self.ground is None:
            self._add_ground()
            scene.add_icosphere("/goal", 0.03, colour(style.GOAL), position=motion.goal_m, opacity=0.7)
            scene.add_label("/goal/name", "goal", position=(0.0, 0.0, 0.05))
        self._add_footholds()
        self.figure = quadruped_figure(scene, motion, chosen)
        self.label = scene.add_label("/skill", "", anchor="bottom-center")
        self._add_contacts()

    @property
    def time_s(self) -> Array:
        """Return the moments of the samples."""
        return self.motion.time_s

    def grow(self, motion: FootholdMotion, ground: RunGround | None = None) -> None:
        """Take over a longer motion of the same run: what is drawn stays, and what is new is added.

        Args:
            motion: of the longer log.
            ground: of the longer log, if the scene has one.
        """
        self.motion = motion
        if self.ground is None:
            self._add_ground()
        elif ground is not None:
            self.ground.grow(ground)
        self._add_footholds()
        self.figure.grow(motion)

    def show(self, frame: int) -> None:
        """Show a sample."""
        self.figure.show(frame)
        if self.ground is not None:
            self.ground.show(float(self.time_s[frame]))
        self.label.position = self.motion.base_m[frame] + np.array([0.0, 0.0, _LABEL_M])
        skill = self.motion.words[frame].partition(" (")[0]
        if skill != self.text:
            self.label.text = self.text = skill
        for foot in range(4):
            self._show_contact(frame, foot)

    def _show_contact(self, frame: int, foot: int) -> None:
        """Show the force of a foot that carries the robot, and its cone."""
        force_n, place = self.motion.forces_n[frame, foot], self.motion.feet_m[frame, foot]
        loaded = float(np.linalg.norm(force_n)) > _LOADED_N
        arrow, cone = self.arrows[foot], self.cones[foot]
        if arrow.visible != loaded:
            arrow.visible = cone.visible = loaded
        if loaded:
            arrow.position, arrow.wxyz = place, between(np.zeros((1, 3)), force_n[None]).wxyz[0]
            arrow.scale = max(float(np.linalg.norm(force_n)) * _FORCE_M_PER_N, 1e-3)
            self._set_cone(cone, place)

    def caption(self, frame: int) -> str:
        """Say which feet carry the robot, and with how much."""
        loads_n = self.motion.forces_n[frame, :, 2]
        carried = [
            f"{label} {load_n:.0f} N" for label, load_n in zip(FOOT_LABELS, loads_n, strict=True) if load_n > _LOADED_N
        ]
        word = self.motion.words[frame] or f"sample {frame}"
        said = f"{word[:1].upper()}{word[1:]}: {', '.join(carried) or 'flight'}"
        remark = self.figure.remark(frame)
        return f"{said}; {remark}" if remark else said

    def notes(self) -> tuple[str, ...]:
        """Say what is drawn otherwise than it was planned."""
        return (*self.chosen.remarks, *self.figure.remarks())

    def cameras(self) -> Cameras:
        """Return places to look from, by name."""
        points = np.concatenate([*self.motion.polygons_m, self.motion.base_m])
        low, high = points.min(axis=0), points.max(axis=0)
        if self.ground is not None:
            low, high = np.minimum(low, self.ground.low_m), np.maximum(high, self.ground.high_m)
        x, y, z = (float(one) for one in (low + high) / 2)
        size = max(float(high[0] - low[0]), 1.6 * float(high[1] - low[1]), 1.2)
        return {
            "overview": {"position": [x - 0.24 * size, y - 0.53 * size, z + 0.36 * size], "look_at": [x, y, z]},
            "from above": {"position": [x, y - 0.01, z + 0.66 * size], "look_at": [x, y, z]},
            "from the side": {"position": [x, y - 0.62 * size, z + 0.06 * size], "look_at": [x, y, z]},
            "follow": {"follow": "/robot/trunk", "offset": [-0.9, -0.9, 0.5]},
        }

    def _add_ground(self) -> None:
        """Draw the polygons that are not drawn yet."""
        for number, vertices_m in list(enumerate(self.motion.polygons_m))[self.polygons :]:
            add_solid(self.scene, f"/terrain/{number}", slab(vertices_m, _SLAB_M), "#d8d4ca", cast_shadow=False)
        self.polygons = len(self.motion.polygons_m)

    def _add_footholds(self) -> None:
        """Mark where every foot stands before and after each of its swings, as far as it is not marked yet."""
        for foot, (name, hue, places_m) in enumerate(zip(FEET, FOOT_COLOURS, self.motion.footholds_m, strict=True)):
            for number, place in list(enumerate(places_m))[self.marked[foot] :]:
                node, looks = f"/footholds/{name}/{number}", {"position": tuple(place), "cast_shadow": False}
                self.scene.add_cylinder(node, FOOT_M, 0.004, colour(hue), **looks)
            self.marked[foot] = len(places_m)

    def _add_contacts(self) -> None:
        """Add an arrow of 1 m for every force, to be scaled, and a cone with a slope of 1."""
        up = np.array([[[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]])
        shape: dict[str, Any] = {"shaft_radius": 0.05, "head_radius": 0.12, "head_length": 0.25}
        self.arrows = [self.scene.add_arrows(f"/forces/{name}", up, colour(style.BLACK), **shape) for name in FEET]
        vertices, faces = friction_cone(1.0, _CONE_M)
        looks: dict[str, Any] = {"color": colour(style.GREEN), "opacity": 0.3}
        self.cones = [self.scene.add_mesh_simple(f"/cones/{name}", vertices, faces, **looks) for name in FEET]

    def _set_cone(self, cone: Any, foot_m: Array) -> None:
        """Put a cone under a foot, with the slope and along the normal of the polygon that it stands on."""
        if tuple(cone.position) != tuple(foot_m):
            polygon = _polygon_below(self.motion.polygons_m, foot_m)
            mu, normal = self.motion.friction[polygon], _normal(self.motion.polygons_m[polygon])
            cone.position, cone.wxyz = foot_m, between(np.zeros((1, 3)), normal[None]).wxyz[0]
            cone.scale = (mu, mu, 1.0)


def _normal(vertices_m: Array) -> Array:
    """Return the unit normal of a polygon, upwards; by Newell's method, since three corners may lie in a line."""
    after = np.roll(vertices_m, -1, axis=0)
    doubled: Array = np.cross(vertices_m, after).sum(axis=0)
    normal: Array = doubled * (1.0 if doubled[2] >= 0 else -1.0) / np.linalg.norm(doubled)
    return normal


def _polygon_below(polygons: Sequence[Array], point_m: Array) -> int:
    """Return the polygon that comes nearest to containing a point."""

    def away_m(vertices_m: Array) -> float:
        edges = np.roll(vertices_m, -1, axis=0) - vertices_m
        turn = 1.0 if np.cross(vertices_m, np.roll(vertices_m, -1, axis=0)).sum(axis=0)[2] >= 0 else -1.0
        outward = turn * np.stack([edges[:, 1], -edges[:, 0]], axis=1)
        outward /= np.linalg.norm(outward, axis=1, keepdims=True)
        outside = float((outward * (point_m[:2] - vertices_m[:, :2])).sum(axis=1).max())
        return max(outside, 0.0) + abs(float(_normal(vertices_m) @ (point_m - vertices_m[0])))

    return int(np.argmin([away_m(one) for one in polygons]))

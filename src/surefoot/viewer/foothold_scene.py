"""A quadruped's motion as a scene in three dimensions: terrain, footholds, the robot, forces, friction cones."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.viewer import style
from surefoot.viewer.biped_figure import friction_cone
from surefoot.viewer.body import between, quadruped_parts
from surefoot.viewer.foothold_motion import FootholdMotion
from surefoot.viewer.footholds import FOOT_COLOURS, FOOT_LABELS
from surefoot.viewer.page import Cameras, add_solid, colour
from surefoot.viewer.solids import Solid

Array = NDArray[np.float64]

FEET = ("front_left", "front_right", "hind_left", "hind_right")
_TRUNK_HEIGHT_M, _LINK_M, _FOOT_M = 0.11, 0.014, 0.022
_FORCE_M_PER_N, _CONE_M = 1 / 300.0, 0.08
_LOADED_N = 1e-6
_SLAB_M = 0.04


class FootholdScene:
    """Draws a motion of a quadruped into a scene, and any sample of it.

    Args:
        scene: of a viser server.
        motion: of a foothold plan, or of a run.
    """

    def __init__(self, scene: Any, motion: FootholdMotion) -> None:
        self.scene, self.motion = scene, motion
        scene.set_up_direction("+z")
        scene.configure_default_lights(cast_shadow=False)
        for number, vertices_m in enumerate(motion.polygons_m):
            add_solid(scene, f"/terrain/{number}", _slab(vertices_m), "#d8d4ca", cast_shadow=False)
        scene.add_icosphere("/goal", 0.03, colour(style.GOAL), position=motion.goal_m, opacity=0.7)
        scene.add_label("/goal/name", "goal", position=(0.0, 0.0, 0.05))
        self._add_footholds()
        self._add_robot()
        self._add_contacts()

    @property
    def time_s(self) -> Array:
        """Return the moments of the samples."""
        return self.motion.time_s

    def show(self, frame: int) -> None:
        """Show a sample."""
        for name, part in self.poses.items():
            self.parts[name].position, self.parts[name].wxyz = part.position_m[frame], part.wxyz[frame]
        for foot in range(4):
            force_n = float(np.linalg.norm(self.motion.forces_n[frame, foot]))
            loaded = force_n > _LOADED_N
            arrow, cone = self.arrows[foot], self.cones[foot]
            arrow.visible = cone.visible = loaded
            if loaded:
                along = between(np.zeros((1, 3)), self.motion.forces_n[frame, foot][None])
                arrow.position, arrow.wxyz = self.motion.feet_m[frame, foot], along.wxyz[0]
                arrow.scale = max(force_n * _FORCE_M_PER_N, 1e-3)
                self._set_cone(cone, self.motion.feet_m[frame, foot])

    def caption(self, frame: int) -> str:
        """Say which feet carry the robot, and with how much."""
        loads_n = self.motion.forces_n[frame, :, 2]
        carried = [
            f"{label} {load_n:.0f} N" for label, load_n in zip(FOOT_LABELS, loads_n, strict=True) if load_n > _LOADED_N
        ]
        word = self.motion.words[frame] or f"sample {frame}"
        return f"{word[:1].upper()}{word[1:]}: {', '.join(carried) or 'flight'}"

    def cameras(self) -> Cameras:
        """Return places to look from, by name."""
        points = np.concatenate([*self.motion.polygons_m, self.motion.base_m])
        low, high = points.min(axis=0), points.max(axis=0)
        x, y, z = (float(one) for one in (low + high) / 2)
        size = float(np.linalg.norm(high - low))
        return {
            "overview": {"position": [x - 0.35 * size, y - 0.75 * size, z + 0.45 * size], "look_at": [x, y, z]},
            "from above": {"position": [x, y - 0.01, z + size], "look_at": [x, y, z]},
            "from the side": {"position": [x, y - 0.95 * size, z + 0.08 * size], "look_at": [x, y, z]},
            "follow": {"follow": "/robot/trunk", "offset": [-0.9, -0.9, 0.5]},
        }

    def _add_footholds(self) -> None:
        """Mark where every foot stands before and after each of its swings."""
        for name, hue, places_m in zip(FEET, FOOT_COLOURS, self.motion.footholds_m, strict=True):
            for number, place in enumerate(places_m):
                node, looks = f"/footholds/{name}/{number}", {"position": tuple(place), "cast_shadow": False}
                self.scene.add_cylinder(node, _FOOT_M, 0.004, colour(hue), **looks)

    def _add_robot(self) -> None:
        motion, add = self.motion, self.scene
        self.poses, link_m = quadruped_parts(motion.base_m, motion.rpy_rad, motion.feet_m, motion.hips_m)
        ahead_m, aside_m, _ = motion.hips_m[0]
        trunk_m = (2 * ahead_m + 0.04, 2 * aside_m - _LINK_M, _TRUNK_HEIGHT_M)
        self.parts: dict[str, Any] = {"trunk": add.add_box("/robot/trunk", colour("#3b3f46"), trunk_m)}
        for foot, name in enumerate(FEET):
            hue = colour(FOOT_COLOURS[foot])
            for link in ("thigh", "shank"):
                self.parts[f"{foot}/{link}"] = add.add_cylinder(f"/robot/{name}/{link}", _LINK_M, link_m, hue)
            self.parts[f"{foot}/foot"] = add.add_icosphere(f"/robot/{name}/foot", _FOOT_M, hue)

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
        polygon = _polygon_below(self.motion.polygons_m, foot_m)
        mu, normal = self.motion.friction[polygon], _normal(self.motion.polygons_m[polygon])
        if tuple(cone.position) != tuple(foot_m):
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


def _slab(vertices_m: Array) -> Solid:
    """Return a convex polygon with some thickness below it."""
    count = len(vertices_m)
    vertices = np.concatenate([vertices_m, vertices_m - np.array([0.0, 0.0, _SLAB_M])])
    top = [(0, k, k + 1) for k in range(1, count - 1)]
    bottom = [(count, count + k + 1, count + k) for k in range(1, count - 1)]
    sides = [
        face
        for a, b in ((k, (k + 1) % count) for k in range(count))
        for face in ((a, a + count, b), (b, a + count, b + count))
    ]
    return Solid(vertices, np.array([*top, *bottom, *sides], dtype=np.uint32))

"""A robot's own meshes in a scene, link hung on link, and any moment of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.viewer.robots.mesh_files import Part
from surefoot.viewer.robots.model import RobotModel, quaternions_of
from surefoot.viewer.robots.simple import Pose

Array = NDArray[np.float64]

TRUNK = "/robot/trunk"
_STILL = 1e-4
"""Metres, or parts of a quaternion: what moves by less is not sent."""


@dataclass(frozen=True, slots=True, eq=False)
class Walk:
    """How a robot with meshes moves.

    Attributes:
        base: pose of the root in the world, n moments.
        links: poses of links in the root's frame, homogeneous, shape (n, 4, 4).
    """

    base: Pose
    links: Mapping[str, Array]


class MeshBody:
    """Draws a robot's meshes into a scene; its root is the node ``/robot/trunk``, links are nodes below it.

    Args:
        scene: of a viser server.
        model: the robot.
        parts: its triangles.
        walk: how it moves.
    """

    def __init__(self, scene: Any, model: RobotModel, parts: tuple[Part, ...], walk: Walk) -> None:
        self.model = model
        self.parents = {joint.child: joint.parent for joint in model.joints}
        self.names = {model.root: TRUNK}
        carrying = self._with_parts({part.link for part in parts}, model.root)
        for joint in model.joints:
            if joint.child in carrying:
                self.names[joint.child] = f"{self.names[joint.parent]}/{joint.child}"
        self.nodes = {link: scene.add_frame(name, show_axes=False) for link, name in self.names.items()}
        for number, part in enumerate(parts):
            red, green, blue = (round(255 * one) for one in part.rgb)
            name = f"{self.names[part.link]}/mesh-{number}"
            scene.add_mesh_simple(name, part.vertices_m, part.faces, color=(red, green, blue))
        self.poses = self._placed(walk)

    def grow(self, walk: Walk) -> None:
        """Take over a longer walk of the same robot."""
        self.poses = self._placed(walk)

    def show(self, frame: int) -> None:
        """Show a moment; only what has moved is sent."""
        for link, pose in self.poses.items():
            node, place, wxyz = self.nodes[link], pose.position_m[frame], pose.wxyz[frame]
            if np.abs(node.position - place).max() > _STILL:
                node.position = place
            if np.abs(node.wxyz - wxyz).max() > _STILL:
                node.wxyz = wxyz

    def _with_parts(self, links: set[str], root: str) -> set[str]:
        """Return links that have triangles, and those that carry them."""
        found = {root}
        for link in links:
            one: str | None = link
            while one is not None and one not in found:
                found.add(one)
                one = self.parents.get(one)
        return found

    def _placed(self, walk: Walk) -> dict[str, Pose]:
        """Return the poses of nodes in the frames of the nodes above them."""
        placed = {self.model.root: walk.base}
        for link in self.names:
            if link != self.model.root:
                pose = np.linalg.inv(walk.links[self.parents[link]]) @ walk.links[link]
                placed[link] = Pose(pose[:, :3, 3], quaternions_of(pose[:, :3, :3]))
        return placed

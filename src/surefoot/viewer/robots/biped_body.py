"""A biped's body in a scene: a simple one, or Cassie's meshes with the joint angles that the feet ask for."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from surefoot.viewer import style
from surefoot.viewer.browser.page import colour
from surefoot.viewer.remarks import out_of_reach, said_of_frame
from surefoot.viewer.robots import cassie
from surefoot.viewer.robots.bodies import Chosen
from surefoot.viewer.robots.headings import headings_rad
from surefoot.viewer.robots.mesh_body import MeshBody, Walk
from surefoot.viewer.robots.mesh_files import parts_of
from surefoot.viewer.robots.model import RobotModel, turn_about
from surefoot.viewer.robots.simple import TRUNK_M, Pose, biped_parts
from surefoot.viewer.rotations import about_z
from surefoot.viewer.sources.timeline import Timeline

Array = NDArray[np.float64]

_LEG_M, _FOOT_M = 0.035, (0.22, 0.09, 0.03)
_HUES = {"left": style.LEFT, "right": style.RIGHT}
_LINKS = tuple(f"{side}/{link}" for side in _HUES for link in ("thigh", "shank"))
_UP = np.array([0.0, 0.0, 1.0])


class BipedBody(Protocol):
    """A body that has been drawn."""

    def grow(self, times: Timeline) -> None:
        """Take over a longer log of the same run."""

    def show(self, frame: int) -> None:
        """Show a moment."""

    def remark(self, frame: int) -> str:
        """Say what is drawn otherwise than it was logged; empty if nothing is."""

    def remarks(self) -> tuple[str, ...]:
        """Say the same of the whole run."""


def biped_body(scene: Any, times: Timeline, chosen: Chosen) -> BipedBody:
    """Draw the body that was chosen."""
    return SimpleBiped(scene, times) if chosen.model is None else MeshedBiped(scene, times, chosen.model)


class SimpleBiped:
    """A trunk above the centre of mass, and legs of two equal links to the feet.

    Args:
        scene: of a viser server.
        times: the run, sampled.
    """

    def __init__(self, scene: Any, times: Timeline) -> None:
        self.parts: dict[str, Any] = {"trunk": scene.add_box("/robot/trunk", colour("#3b3f46"), TRUNK_M)}
        for name in _LINKS:
            hue = _HUES[name.split("/")[0]]
            self.parts[name] = scene.add_cylinder(f"/robot/{name}", _LEG_M, 1.0, colour(hue))
        for side, hue in _HUES.items():
            self.parts[f"{side}/foot"] = scene.add_box(f"/robot/{side}/foot", colour(hue), _FOOT_M)
        self.grow(times)

    def grow(self, times: Timeline) -> None:
        """Take over a longer log of the same run."""
        self.poses, link_m = biped_parts(times.com_m, headings_rad(times), times.left_foot_m, times.right_foot_m)
        for name in _LINKS:
            self.parts[name].height = link_m

    def show(self, frame: int) -> None:
        """Show a moment."""
        for name, part in self.poses.items():
            node = self.parts[name]
            node.position, node.wxyz = part.position_m[frame], part.wxyz[frame]

    def remark(self, frame: int) -> str:
        """Say nothing: the links are as long as the farthest foot needs."""
        return ""

    def remarks(self) -> tuple[str, ...]:
        """Say nothing, for the same reason."""
        return ()


class MeshedBiped:
    """Cassie's meshes: the pelvis at the centre of mass, upright; a leg that cannot reach its foot points to it.

    Args:
        scene: of a viser server.
        times: the run, sampled.
        model: of Cassie.
    """

    def __init__(self, scene: Any, times: Timeline, model: RobotModel) -> None:
        self.model = model
        self.body = MeshBody(scene, model, parts_of(model), self._walk(times))

    def grow(self, times: Timeline) -> None:
        """Take over a longer log of the same run."""
        self.body.grow(self._walk(times))

    def show(self, frame: int) -> None:
        """Show a moment."""
        self.body.show(frame)

    def remark(self, frame: int) -> str:
        """Name the feet that their legs do not reach."""
        return said_of_frame(self.away_m[frame], ("left foot", "right foot"))

    def remarks(self) -> tuple[str, ...]:
        """Say how many feet their legs do not reach, and by how much."""
        return out_of_reach(self.away_m)

    def _walk(self, times: Timeline) -> Walk:
        headings = headings_rad(times)
        feet_m = np.stack([times.left_foot_m, times.right_foot_m], axis=1) - times.com_m[:, None]
        in_root = np.einsum("nji,nkj->nki", turn_about(_UP, headings.trunk_rad), feet_m)
        turned = np.stack([headings.left_rad, headings.right_rad], axis=1) - headings.trunk_rad[:, None]
        ahead = np.stack([np.cos(turned), np.sin(turned), np.zeros_like(turned)], axis=2)
        links, self.away_m = cassie.link_poses(self.model, in_root, ahead)
        return Walk(Pose(times.com_m, about_z(headings.trunk_rad)), links)

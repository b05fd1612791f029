"""A quadruped in a scene: the simple body, or the robot's own meshes with the joint angles that its feet ask for."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from surefoot.robots import quadruped
from surefoot.robots.legs import JOINTS, Legs, legs
from surefoot.viewer.browser.page import colour
from surefoot.viewer.remarks import out_of_reach, said_of_frame
from surefoot.viewer.robots.bodies import Chosen
from surefoot.viewer.robots.mesh_body import MeshBody, Walk
from surefoot.viewer.robots.mesh_files import parts_of
from surefoot.viewer.robots.model import RobotModel
from surefoot.viewer.robots.simple import Pose, quadruped_parts
from surefoot.viewer.rotations import quaternions
from surefoot.viewer.sources.foothold_motion import FootholdMotion
from surefoot.viewer.style import FOOT_COLOURS, FOOT_LABELS

Array = NDArray[np.float64]

FEET = ("front_left", "front_right", "hind_left", "hind_right")
FOOT_M = 0.022
_TRUNK_HEIGHT_M, _LINK_M = 0.11, 0.014


class QuadrupedFigure(Protocol):
    """A robot that has been drawn."""

    def grow(self, motion: FootholdMotion) -> None:
        """Take over a longer motion of the same robot."""

    def show(self, frame: int) -> None:
        """Show a sample."""

    def remark(self, frame: int) -> str:
        """Say what is drawn otherwise than it was planned; empty if nothing is."""

    def remarks(self) -> tuple[str, ...]:
        """Say the same of the whole motion."""


def quadruped_figure(scene: Any, motion: FootholdMotion, chosen: Chosen) -> QuadrupedFigure:
    """Draw the body that was chosen."""
    if chosen.model is None or chosen.wearing is None:
        return SimpleQuadruped(scene, motion)
    return MeshedQuadruped(scene, motion, chosen.model, chosen.wearing)


class SimpleQuadruped:
    """A trunk, and legs of two links from the nominal footholds' corners of the base to the feet.

    Args:
        scene: of a viser server.
        motion: what it does.
    """

    def __init__(self, scene: Any, motion: FootholdMotion) -> None:
        self.poses, link_m = _parts(motion)
        ahead_m, aside_m, _ = motion.hips_m[0]
        trunk_m = (2 * ahead_m + 0.04, 2 * aside_m - _LINK_M, _TRUNK_HEIGHT_M)
        self.parts: dict[str, Any] = {"trunk": scene.add_box("/robot/trunk", colour("#3b3f46"), trunk_m)}
        for foot, name in enumerate(FEET):
            hue = colour(FOOT_COLOURS[foot])
            for link in ("thigh", "shank"):
                self.parts[f"{foot}/{link}"] = scene.add_cylinder(f"/robot/{name}/{link}", _LINK_M, link_m, hue)
            self.parts[f"{foot}/foot"] = scene.add_icosphere(f"/robot/{name}/foot", FOOT_M, hue)

    def grow(self, motion: FootholdMotion) -> None:
        """Take over a longer motion of the same robot."""
        self.poses, link_m = _parts(motion)
        for name, part in self.parts.items():
            if name.endswith(("thigh", "shank")):
                part.height = link_m

    def show(self, frame: int) -> None:
        """Show a sample."""
        for name, part in self.poses.items():
            self.parts[name].position, self.parts[name].wxyz = part.position_m[frame], part.wxyz[frame]

    def remark(self, frame: int) -> str:
        """Say nothing: the links are as long as the farthest foot needs."""
        return ""

    def remarks(self) -> tuple[str, ...]:
        """Say nothing, for the same reason."""
        return ()


class MeshedQuadruped:
    """A robot's own meshes; a leg that cannot reach its foot points to it.

    Args:
        scene: of a viser server.
        motion: what it does.
        model: of the robot ``wearing``.
        wearing: whose meshes and joints these are.
    """

    def __init__(self, scene: Any, motion: FootholdMotion, model: RobotModel, wearing: str) -> None:
        self.model, self.legs = model, self._legs(motion, wearing)
        self.body = MeshBody(scene, model, parts_of(model), self._walk(motion))

    def grow(self, motion: FootholdMotion) -> None:
        """Take over a longer motion of the same robot."""
        self.body.grow(self._walk(motion))

    def show(self, frame: int) -> None:
        """Show a sample."""
        self.body.show(frame)

    def remark(self, frame: int) -> str:
        """Name the feet that their legs do not reach."""
        return said_of_frame(self.away_m[frame], FOOT_LABELS)

    def remarks(self) -> tuple[str, ...]:
        """Say how many feet their legs do not reach, and by how much."""
        return out_of_reach(self.away_m)

    def _walk(self, motion: FootholdMotion) -> Walk:
        angles, self.away_m = motion.joints_rad(self.legs)
        flat = angles.reshape(len(angles), len(JOINTS))
        links = self.model.link_poses({name: flat[:, number] for number, name in enumerate(JOINTS)})
        return Walk(Pose(motion.base_m, quaternions(motion.rpy_rad)), links)

    @staticmethod
    def _legs(motion: FootholdMotion, wearing: str) -> Legs:
        return motion.legs if motion.robot == wearing else legs(quadruped(wearing))


def _parts(motion: FootholdMotion) -> tuple[dict[str, Pose], float]:
    return quadruped_parts(motion.base_m, motion.rpy_rad, motion.feet_m, motion.hips_m)

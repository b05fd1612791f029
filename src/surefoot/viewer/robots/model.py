"""A robot's links, joints and meshes, and where its links are for given joint angles."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Visual:
    """What a link looks like.

    Attributes:
        link: that it belongs to.
        pose: in the link's frame, homogeneous, shape (4, 4).
        mesh: its file; None for a box.
        size: of a box, its sides [m]; of a mesh, its scale along each axis.
        rgb: colour from 0 to 1; None takes the mesh's own.
    """

    link: str
    pose: Array
    mesh: Path | None
    size: tuple[float, float, float]
    rgb: tuple[float, float, float] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Joint:
    """How a link hangs on another one.

    Attributes:
        name: of the joint.
        parent, child: links.
        pose: of the child's frame in the parent's at angle 0, homogeneous, shape (4, 4).
        axis: of the turn in the child's frame, a unit vector; None for a joint that does not move.
    """

    name: str
    parent: str
    child: str
    pose: Array
    axis: Array | None


@dataclass(frozen=True, slots=True, eq=False)
class RobotModel:
    """A tree of links.

    Attributes:
        name: of the robot, as its file has it.
        root: the link that carries the others.
        joints: each after the one that carries its parent.
        visuals: of all links.
    """

    name: str
    root: str
    joints: tuple[Joint, ...]
    visuals: tuple[Visual, ...]

    def link_poses(self, angles_rad: Mapping[str, Array]) -> dict[str, Array]:
        """Return the pose of every link in the frame of the root, homogeneous, shape (n, 4, 4).

        Args:
            angles_rad: of joints by name, shape (n,) each, at least one; those of the others are 0.
        """
        count = len(next(iter(angles_rad.values())))
        poses = {self.root: np.tile(np.eye(4), (count, 1, 1))}
        for joint in self.joints:
            turned = joint_pose(joint, angles_rad.get(joint.name, np.zeros(count)))
            poses[joint.child] = poses[joint.parent] @ turned
        return poses


def joint_pose(joint: Joint, angle_rad: Array) -> Array:
    """Return the pose of a joint's child in its parent's frame, shape (n, 4, 4)."""
    if joint.axis is None:
        return np.tile(joint.pose, (len(angle_rad), 1, 1))
    turned: Array = joint.pose @ homogeneous(turn_about(joint.axis, angle_rad))
    return turned


def turn_about(axis: Array, angle_rad: Array) -> Array:
    """Return the rotations about a unit vector, shape (n, 3, 3).

    Source: Rodrigues' formula.
    """
    x, y, z = axis
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    s, c = np.sin(angle_rad)[:, None, None], np.cos(angle_rad)[:, None, None]
    turns: Array = np.eye(3) + s * across + (1 - c) * (across @ across)
    return turns


def homogeneous(rotation: Array, place_m: Array | None = None) -> Array:
    """Return homogeneous matrices of rotations, shape (..., 3, 3), and places, shape (..., 3); none is the origin."""
    pose = np.zeros((*rotation.shape[:-2], 4, 4))
    pose[..., :3, :3], pose[..., 3, 3] = rotation, 1.0
    if place_m is not None:
        pose[..., :3, 3] = place_m
    return pose


def quaternions_of(rotation: Array) -> Array:
    """Return quaternions wxyz of rotation matrices, shape (n, 3, 3), the real part never negative."""
    from scipy.spatial.transform import Rotation

    wxyz: Array = Rotation.from_matrix(rotation).as_quat(canonical=True, scalar_first=True)
    return wxyz

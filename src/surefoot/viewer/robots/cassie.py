"""Joint angles of Cassie's legs for a pelvis and two feet, by damped least squares."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.viewer.robots.model import Joint, RobotModel, homogeneous, joint_pose

Array = NDArray[np.float64]

SIDES = ("left", "right")

_LIMITS_RAD = {
    "roll-op": (-0.2618, 0.3491),
    "yaw-op": (-0.3840, 0.3840),
    "pitch-op": (-0.8727, 1.3963),
    "knee-op": (-2.07694, 0.13963),
    "foot-op": (-2.4435, -0.6109),
}
"""Of the left leg, from the model's file; the right leg's roll is mirrored."""
_BEGIN_RAD = (0.0, 0.0, 0.4, -0.5, -0.9)
_SOLE_M = (0.0212, 0.0563, 0.0)
_SOLE_AHEAD = (-0.7660, 0.6429, 0.0)
"""Middle of the sole and its direction to the toes in the foot's frame: the longest edge of the foot's mesh."""
_RODS = (("achilles-rod", "hip-pitch", "heel-spring", 0.5012), ("plantar-rod", "foot-crank", "foot", 0.3501))
"""Links that close a loop: each begins where its first carrier holds it, and points to where the second one does."""
_ITERATIONS, _DAMPING, _LARGEST_STEP_RAD, _DIRECTION_M = 40, 1e-6, 0.4, 0.03


@dataclass(frozen=True, slots=True, eq=False)
class _Leg:
    """A chain from the pelvis to the foot; the tarsus bends against the knee by as much, as the Achilles rod has it."""

    joints: tuple[Joint, ...]
    column: tuple[int, ...]
    factor: tuple[float, ...]
    limits: Array


def link_poses(model: RobotModel, feet_m: Array, ahead: Array) -> tuple[dict[str, Array], Array]:
    """Return the poses of Cassie's links in the pelvis's frame, and how far [m] each sole stays from its foot.

    Args:
        model: of Cassie.
        feet_m: middles of the soles in the pelvis's frame, left and right, shape (n, 2, 3).
        ahead: directions of the soles, shape (n, 2, 3).

    Returns:
        Homogeneous matrices by link, shape (n, 4, 4), and distances, shape (n, 2).
    """
    angles: dict[str, Array] = {}
    away_m = np.zeros(feet_m.shape[:2])
    for number, side in enumerate(SIDES):
        found, away_m[:, number] = _solve(_leg(model, side), feet_m[:, number], ahead[:, number])
        angles |= {f"{side}-{name}": found[:, k] for k, name in enumerate(_LIMITS_RAD)}
        angles[f"{side}-shin-tarsus-joint"] = -angles[f"{side}-knee-op"]
        angles[f"{side}-tarsus-crank-joint"] = angles[f"{side}-foot-op"]
    still, poses = model.link_poses({"none": np.zeros(1)}), model.link_poses(angles)
    for side in SIDES:
        for rod, begin, end, length_m in _RODS:
            names = [f"{side}-{part}" for part in (rod, begin, end)]
            poses[names[0]] = _rod(names, length_m, still, poses)
    return poses, away_m


def _leg(model: RobotModel, side: str) -> _Leg:
    by_name = {joint.name: joint for joint in model.joints}
    chain = ("roll-op", "yaw-op", "pitch-op", "knee-op", "knee-shin-joint", "shin-tarsus-joint", "foot-op")
    limits = np.array(list(_LIMITS_RAD.values()))
    if side == "right":
        limits[0] = -limits[0, ::-1]
    return _Leg(
        joints=tuple(by_name[f"{side}-{name}"] for name in chain),
        column=(0, 1, 2, 3, 3, 3, 4),
        factor=(1.0, 1.0, 1.0, 1.0, 0.0, -1.0, 1.0),
        limits=limits,
    )


def _solve(leg: _Leg, foot_m: Array, ahead: Array) -> tuple[Array, Array]:
    """Return five angles of a leg, shape (n, 5), within their limits, and how far the sole stays from its place.

    Gauss and Newton's method with damping; all moments at once.
    """
    angles = np.tile(np.array(_BEGIN_RAD), (len(foot_m), 1))
    for _ in range(_ITERATIONS):
        sole_m, along, jacobian = _forward(leg, angles)
        missing = np.concatenate([foot_m - sole_m, _DIRECTION_M * (ahead - along)], axis=1)
        square = np.einsum("nki,nkj->nij", jacobian, jacobian) + _DAMPING * np.eye(angles.shape[1])
        step = np.linalg.solve(square, np.einsum("nki,nk->ni", jacobian, missing)[..., None])[..., 0]
        step = np.clip(step, -_LARGEST_STEP_RAD, _LARGEST_STEP_RAD)
        angles = np.clip(angles + step, *leg.limits.T)
    return angles, np.linalg.norm(foot_m - _forward(leg, angles)[0], axis=1)


def _forward(leg: _Leg, angles: Array) -> tuple[Array, Array, Array]:
    """Return the sole, its direction, and how both change with the angles, shape (n, 6, 5)."""
    pose = np.tile(np.eye(4), (len(angles), 1, 1))
    axes, origins = [], []
    for joint, column, factor in zip(leg.joints, leg.column, leg.factor, strict=True):
        pose = pose @ joint_pose(joint, factor * angles[:, column])
        axes.append(factor * (pose[:, :3, :3] @ np.asarray(joint.axis)))
        origins.append(pose[:, :3, 3])
    along: Array = pose[:, :3, :3] @ np.array(_SOLE_AHEAD)
    sole_m: Array = pose[:, :3, :3] @ np.array(_SOLE_M) + pose[:, :3, 3]
    jacobian = np.zeros((len(angles), 6, angles.shape[1]))
    for column, axis, origin in zip(leg.column, axes, origins, strict=True):
        jacobian[:, :3, column] += np.cross(axis, sole_m - origin)
        jacobian[:, 3:, column] += _DIRECTION_M * np.cross(axis, along)
    return sole_m, along, jacobian


def _rod(names: Sequence[str], length_m: float, still: dict[str, Array], poses: dict[str, Array]) -> Array:
    """Return the poses of a rod from one link that holds it to another; where they hold it shows at angles of 0."""
    rod, begin, end = names
    tip = still[rod][0] @ np.array([length_m, 0.0, 0.0, 1.0])
    from_m = (poses[begin] @ np.linalg.inv(still[begin][0]) @ still[rod][0][:, 3])[:, :3]
    to_m = (poses[end] @ np.linalg.inv(still[end][0]) @ tip)[:, :3]
    x = (to_m - from_m) / np.linalg.norm(to_m - from_m, axis=1, keepdims=True)
    z = np.cross(x, [0.0, 1.0, 0.0])
    z /= np.linalg.norm(z, axis=1, keepdims=True)
    return homogeneous(np.stack([x, np.cross(z, x), z], axis=2), from_m)

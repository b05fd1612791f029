"""A simple body around a CoM and two feet: a trunk, and legs of two links."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TRUNK_M = (0.22, 0.30, 0.42)
_HIP_ASIDE_M, _HIP_BELOW_M = 0.10, 0.08
_ANKLE_M = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """Where a part is: position and quaternion wxyz, each of shape (n, ...)."""

    position_m: Array
    wxyz: Array


def biped_parts(com_m: Array, yaw_rad: Array, left_m: Array, right_m: Array) -> tuple[dict[str, Pose], float]:
    """Return the poses of trunk, feet and links, and the length of a link.

    Links are as long as the farthest foot needs; the knee bends ahead. Cylinders lie along their own z axis.
    """
    upright = _about_z(yaw_rad)
    parts = {"trunk": Pose(com_m + np.array([0.0, 0.0, 0.5 * TRUNK_M[2] - _HIP_BELOW_M]), upright)}
    legs = {"left": (left_m, 1.0), "right": (right_m, -1.0)}
    ends = {name: _leg_ends(com_m, yaw_rad, foot_m, side) for name, (foot_m, side) in legs.items()}
    link_m = 0.505 * max(float(np.linalg.norm(hip - ankle, axis=1).max()) for hip, ankle in ends.values())
    ahead = np.stack([np.cos(yaw_rad), np.sin(yaw_rad), np.zeros(len(yaw_rad))], axis=1)
    for name, (hip, ankle) in ends.items():
        knee = _knee(hip, ankle, ahead, link_m)
        parts[f"{name}/thigh"] = _between(hip, knee)
        parts[f"{name}/shank"] = _between(knee, ankle)
        parts[f"{name}/foot"] = Pose(legs[name][0], upright)
    return parts, link_m


def _leg_ends(com_m: Array, yaw_rad: Array, foot_m: Array, side: float) -> tuple[Array, Array]:
    """Return hip and ankle."""
    aside = np.stack([-np.sin(yaw_rad), np.cos(yaw_rad), np.zeros(len(yaw_rad))], axis=1)
    hip = com_m + side * _HIP_ASIDE_M * aside - np.array([0.0, 0.0, _HIP_BELOW_M])
    return hip, foot_m + np.array([0.0, 0.0, _ANKLE_M])


def _knee(hip: Array, ankle: Array, ahead: Array, link_m: float) -> Array:
    """Return where two links of the same length meet, bent ahead."""
    down = ankle - hip
    length = np.linalg.norm(down, axis=1, keepdims=True)
    along = down / length
    bend = ahead - (ahead * along).sum(axis=1, keepdims=True) * along
    bend /= np.linalg.norm(bend, axis=1, keepdims=True)
    out: Array = np.sqrt(np.maximum(0.0, link_m**2 - (length / 2) ** 2))
    knee: Array = (hip + ankle) / 2 + out * bend
    return knee


def _between(begin: Array, end: Array) -> Pose:
    """Return the pose of a link from one point to another: the shortest turn of the z axis onto it."""
    along = (end - begin) / np.linalg.norm(end - begin, axis=1, keepdims=True)
    w = 1.0 + along[:, 2]
    wxyz = np.stack([w, -along[:, 1], along[:, 0], np.zeros(len(w))], axis=1)
    wxyz[w < 1e-9] = [0.0, 1.0, 0.0, 0.0]
    return Pose((begin + end) / 2, wxyz / np.linalg.norm(wxyz, axis=1, keepdims=True))


def _about_z(yaw_rad: Array) -> Array:
    half = yaw_rad / 2
    return np.stack([np.cos(half), np.zeros(len(half)), np.zeros(len(half)), np.sin(half)], axis=1)


def weight_pose(foot_m: Array, com_m: Array, length_m: float) -> Pose:
    """Return the pose of a link of a given length that points from a foot to the CoM: the line of the contact force."""
    along = (com_m - foot_m) / np.linalg.norm(com_m - foot_m, axis=1, keepdims=True)
    return _between(foot_m, foot_m + length_m * along)

"""Simple bodies around feet: a trunk, and legs of two links."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.viewer.rotations import about_z, quaternions, rotations

Array = NDArray[np.float64]

TRUNK_M = (0.22, 0.30, 0.42)
_HIP_ASIDE_M, _HIP_BELOW_M = 0.10, 0.08
_ANKLE_M = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """Where a part is: position and quaternion wxyz, each of shape (n, ...)."""

    position_m: Array
    wxyz: Array


@dataclass(frozen=True, slots=True, eq=False)
class Headings:
    """Of trunk and feet of a biped, angles from the x axis of the map, continuous, shape (n,) each."""

    trunk_rad: Array
    left_rad: Array
    right_rad: Array


def biped_parts(com_m: Array, headings: Headings, left_m: Array, right_m: Array) -> tuple[dict[str, Pose], float]:
    """Return the poses of trunk, feet and links, and the length of a link.

    Links are as long as the farthest foot needs; the knee bends ahead. Cylinders lie along their own z axis.
    """
    yaw_rad = headings.trunk_rad
    parts = {"trunk": Pose(com_m + np.array([0.0, 0.0, 0.5 * TRUNK_M[2] - _HIP_BELOW_M]), about_z(yaw_rad))}
    legs = {"left": (left_m, 1.0), "right": (right_m, -1.0)}
    ends = {name: _leg_ends(com_m, yaw_rad, foot_m, side) for name, (foot_m, side) in legs.items()}
    link_m = 0.505 * max(float(np.linalg.norm(hip - ankle, axis=1).max()) for hip, ankle in ends.values())
    ahead = np.stack([np.cos(yaw_rad), np.sin(yaw_rad), np.zeros(len(yaw_rad))], axis=1)
    for name, (hip, ankle) in ends.items():
        knee = knee_m(hip, ankle, ahead, link_m)
        parts[f"{name}/thigh"] = between(hip, knee)
        parts[f"{name}/shank"] = between(knee, ankle)
        parts[f"{name}/foot"] = Pose(legs[name][0], about_z(getattr(headings, f"{name}_rad")))
    return parts, link_m


def _leg_ends(com_m: Array, yaw_rad: Array, foot_m: Array, side: float) -> tuple[Array, Array]:
    """Return hip and ankle."""
    aside = np.stack([-np.sin(yaw_rad), np.cos(yaw_rad), np.zeros(len(yaw_rad))], axis=1)
    hip = com_m + side * _HIP_ASIDE_M * aside - np.array([0.0, 0.0, _HIP_BELOW_M])
    return hip, foot_m + np.array([0.0, 0.0, _ANKLE_M])


def knee_m(hip: Array, ankle: Array, ahead: Array, link_m: float) -> Array:
    """Return where two links of the same length meet, bent in a direction, all of shape (n, 3)."""
    down = ankle - hip
    length = np.linalg.norm(down, axis=1, keepdims=True)
    along = down / length
    bend = ahead - (ahead * along).sum(axis=1, keepdims=True) * along
    bend /= np.linalg.norm(bend, axis=1, keepdims=True)
    out: Array = np.sqrt(np.maximum(0.0, link_m**2 - (length / 2) ** 2))
    knee: Array = (hip + ankle) / 2 + out * bend
    return knee


def between(begin: Array, end: Array) -> Pose:
    """Return the pose of a link from one point to another: the shortest turn of the z axis onto it."""
    along = (end - begin) / np.linalg.norm(end - begin, axis=1, keepdims=True)
    w = 1.0 + along[:, 2]
    wxyz = np.stack([w, -along[:, 1], along[:, 0], np.zeros(len(w))], axis=1)
    wxyz[w < 1e-9] = [0.0, 1.0, 0.0, 0.0]
    return Pose((begin + end) / 2, wxyz / np.linalg.norm(wxyz, axis=1, keepdims=True))


def quadruped_parts(base_m: Array, rpy_rad: Array, feet_m: Array, hips_m: Array) -> tuple[dict[str, Pose], float]:
    """Return the poses of trunk, feet and links of a quadruped, and the length of a link; knees bend back.

    Args:
        base_m: shape (n, 3).
        rpy_rad: roll, pitch and yaw, shape (n, 3).
        feet_m: shape (n, 4, 3).
        hips_m: the upper ends of the legs in the frame of the base, shape (4, 3).
    """
    wxyz, axes = quaternions(rpy_rad), rotations(rpy_rad)
    hips = base_m[:, None] + np.einsum("nij,kj->nki", axes, hips_m)
    link_m = 0.505 * float(np.linalg.norm(hips - feet_m, axis=2).max())
    parts = {"trunk": Pose(base_m, wxyz)}
    for leg in range(4):
        hip, foot = hips[:, leg], feet_m[:, leg]
        knee = knee_m(hip, foot, -axes[:, :, 0], link_m)
        parts[f"{leg}/thigh"], parts[f"{leg}/shank"] = between(hip, knee), between(knee, foot)
        parts[f"{leg}/foot"] = Pose(foot, wxyz)
    return parts, link_m


def weight_pose(foot_m: Array, com_m: Array, length_m: float) -> Pose:
    """Return the pose of a link of a given length that points from a foot to the CoM: the line of the contact force."""
    along = (com_m - foot_m) / np.linalg.norm(com_m - foot_m, axis=1, keepdims=True)
    return between(foot_m, foot_m + length_m * along)

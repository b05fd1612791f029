"""Turns of bodies, as matrices and as quaternions wxyz."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def about_z(yaw_rad: Array) -> Array:
    """Return quaternions wxyz of turns about the z axis, shape (n, 4)."""
    half = yaw_rad / 2
    return np.stack([np.cos(half), np.zeros(len(half)), np.zeros(len(half)), np.sin(half)], axis=1)


def rotations(rpy_rad: Array) -> Array:
    """Return rotation matrices Rz(yaw) Ry(pitch) Rx(roll), shape (n, 3, 3)."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy_rad).T, np.sin(rpy_rad).T
    rows = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def quaternions(rpy_rad: Array) -> Array:
    """Return quaternions wxyz of roll, pitch and yaw, as ``rotations``, shape (n, 4)."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy_rad / 2).T, np.sin(rpy_rad / 2).T
    return np.stack(
        [
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        ],
        axis=1,
    )

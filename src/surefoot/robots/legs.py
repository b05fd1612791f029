"""Joint angles of a quadruped's legs, and where they put its feet; in closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.robots.quadruped import FEET, FOOT_SIGNS, Quadruped, Triple

Array = NDArray[np.float64]

JOINTS = tuple(f"{leg}_{part}_joint" for leg in FEET for part in ("hip", "thigh", "calf"))
"""Names of the joints as in the Go2's model files; leg by leg: abduction, pitch, knee."""

_GO2_HIP_M = (0.1934, 0.0465)
_GO2_FRONT_RAD = ((-1.0472, 1.0472), (-1.5708, 3.4907), (-2.7227, -0.83776))
_GO2_HIND_RAD = ((-1.0472, 1.0472), (-0.5236, 4.5379), (-2.7227, -0.83776))


@dataclass(frozen=True, slots=True, eq=False)
class Legs:
    """The legs of a quadruped: abduction about x, then thigh and shank of one length about y; knees bend back.

    Attributes:
        hips_m: where the axes of abduction and pitch cross, in the base frame, shape (4, 3), in the order of ``FEET``.
        hip_offset_m: sideways offset of the leg from the axis of abduction.
        link_m: length of thigh and shank.
        limits_rad: least and largest angles, shape (4, 3, 2).
        source: where hips and limits come from.
    """

    hips_m: Array
    hip_offset_m: float
    link_m: float
    limits_rad: Array
    source: str

    @property
    def stretch_m(self) -> Array:
        """How far every foot gets from where the axes of its hip cross, shape (4,): with the knee bent least."""
        longest = 2 * self.link_m * np.cos(self.limits_rad[:, 2, 1] / 2)
        stretch: Array = np.hypot(longest, self.hip_offset_m)
        return stretch

    def feet_m(self, joints_rad: Array) -> Array:
        """Return the feet in the base frame, shape (n, 4, 3), of angles of that shape."""
        abduction, pitch, knee = np.moveaxis(joints_rad, -1, 0)
        ahead = -self.link_m * (np.sin(pitch) + np.sin(pitch + knee))
        below = self.link_m * (np.cos(pitch) + np.cos(pitch + knee))
        c, s, aside = np.cos(abduction), np.sin(abduction), self._aside_m()
        feet: Array = self.hips_m + np.stack([ahead, c * aside + s * below, s * aside - c * below], axis=-1)
        return feet

    def joints_rad(self, feet_m: Array) -> tuple[Array, Array]:
        """Return the angles for feet in the base frame, and how far [m] each foot is from where these angles put it.

        A foot that the leg cannot reach has the angles of a leg that points to it, inside the limits.

        Args:
            feet_m: shape (n, 4, 3).

        Returns:
            Angles [rad], shape (n, 4, 3), and distances [m], shape (n, 4); the latter are 0 where the leg reaches.
        """
        x, y, z = np.moveaxis(feet_m - self.hips_m, -1, 0)
        aside = self._aside_m()
        below = np.sqrt(np.maximum(y**2 + z**2 - aside**2, 0.0))
        abduction = _wrapped(np.arctan2(z, y) - np.arctan2(-below, aside))
        length = np.minimum(np.hypot(x, below), 2 * self.link_m)
        low, high = np.moveaxis(self.limits_rad, -1, 0)
        knee = np.clip(-2 * np.arccos(length / (2 * self.link_m)), low[:, 2], high[:, 2])
        pitch = np.arctan2(-x, below) - knee / 2  # of the leg as it is, stretched or not
        angles = np.clip(np.stack([abduction, pitch, knee], axis=-1), low, high)
        away_m: Array = np.linalg.norm(self.feet_m(angles) - feet_m, axis=-1)
        return angles, away_m

    def _aside_m(self) -> Array:
        return self.hip_offset_m * np.array([side for _, side in FOOT_SIGNS], np.float64)


def legs_of(name: str, foot_reference_m: Triple, hip_offset_m: float, link_m: float) -> Legs:
    """Return the legs of a quadruped.

    The Go2's hips and limits are those of its model files. For another robot, nothing else being known of it, the legs
    hang straight down at its nominal footholds, with the Go2's limits.

    Args:
        name: of the robot, as problem files call it.
        foot_reference_m: nominal position of the front left foot in the base frame.
        hip_offset_m: sideways offset of the leg from the axis of abduction.
        link_m: length of thigh and shank.
    """
    ahead, aside = _GO2_HIP_M if name == "go2" else (foot_reference_m[0], foot_reference_m[1] - hip_offset_m)
    source = "the Go2's model files" if name == "go2" else "legs that hang straight down, with the Go2's limits"
    hips = np.array([(x * ahead, y * aside, 0.0) for x, y in FOOT_SIGNS])
    limits = np.array([_GO2_FRONT_RAD if x > 0 else _GO2_HIND_RAD for x, _ in FOOT_SIGNS])
    return Legs(hips, hip_offset_m, link_m, limits, source)


def legs(robot: Quadruped) -> Legs:
    """Return the legs of a quadruped that comes with Surefoot."""
    return legs_of(robot.name, robot.foot_reference_m, robot.hip_offset_m, robot.link_m)


def _wrapped(angle: Array) -> Array:
    turned: Array = np.remainder(angle + math.pi, 2 * math.pi) - math.pi
    return turned

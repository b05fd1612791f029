"""Where trunk and feet of a biped head, from a sampled run: a foot turns while it swings, the trunk goes between."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from surefoot.viewer.robots.simple import Headings
from surefoot.viewer.sources.timeline import Timeline

Array = NDArray[np.float64]

_STILL_M = 1e-6


def headings_rad(times: Timeline) -> Headings:
    """Return the headings at all moments of a run.

    The log has one heading for each step, that of the foot which lands in it. Between two stands a foot turns evenly.
    """
    yaw_rad = np.unwrap(times.yaw_rad)
    left, right = (_of_foot(foot_m, yaw_rad, times.time_s) for foot_m in (times.left_foot_m, times.right_foot_m))
    return Headings((left + right) / 2, left, right)


def _of_foot(foot_m: Array, yaw_rad: Array, time_s: Array) -> Array:
    moved = np.linalg.norm(np.diff(foot_m, axis=0), axis=1) > _STILL_M
    stands = ~np.concatenate([[False], moved]) | ~np.concatenate([moved, [False]])
    landed = stands & ~np.concatenate([[False], stands[:-1]])
    stand = np.cumsum(landed) - 1
    of_stand = yaw_rad[np.flatnonzero(landed)] if landed.any() else yaw_rad[:1]
    if not stands.any():
        return yaw_rad
    heading: Array = np.interp(time_s, time_s[stands], of_stand[stand[stands]])
    return heading

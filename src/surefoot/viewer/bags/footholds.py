"""``surefoot view --mcap`` of a foothold plan or of a quadruped's run: ROS 2 messages."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from surefoot.robots.legs import JOINTS
from surefoot.viewer.bags.ground import add_ground, add_terrain
from surefoot.viewer.bags.ros_messages import (
    ARROW,
    MARKERS,
    Recording,
    header,
    marker,
    path_message,
    recording,
    transforms,
)
from surefoot.viewer.remarks import Say, out_of_reach, silent
from surefoot.viewer.robots.quadruped_figure import FEET
from surefoot.viewer.rotations import quaternions
from surefoot.viewer.sources.foothold_motion import FootholdMotion, read_motion
from surefoot.viewer.sources.ground import read_run_ground
from surefoot.viewer.style import FOOT_COLOURS

Array = NDArray[np.float64]

_M_PER_N = 1 / 300.0
_ARROW_M = (0.012, 0.03, 0.05)


def write_foothold_bag(source: Path, path: Path, say: Say = silent) -> Path:
    """Write a quadruped's motion as an MCAP file, with the times of its samples.

    Topics: ``/terrain``, ``/path`` (base), ``/forces``, ``/tf`` (base and feet), ``/joint_states``; of a run also
    ``/skill``, ``/obstacles``, ``/way_point``, ``/goals``.

    Args:
        source: a plan file with a motion, or the folder of a run.
        path: of the MCAP file.
        say: is told when joints cannot bring the feet where they were planned, or the terrain is not to be had.

    Raises:
        InputError: there is no motion.
        BackendMissing: the packages that write it are not installed.
    """
    motion = read_motion(source)
    ground = read_run_ground(source, say) if source.is_dir() else None
    begin_s = float(motion.time_s[0])
    with recording(path) as bag:
        if ground is None:
            add_terrain(bag, begin_s, motion.polygons_m, len(motion.polygons_m))
        else:
            add_ground(bag, ground, begin_s)
        _add_skills(bag, motion)
        bag.add("/path", "nav_msgs/msg/Path", begin_s, path_message(motion.time_s, motion.base_m))
        _add_samples(bag, motion)
        away_m = _add_joints(bag, motion)
    for remark in out_of_reach(away_m):
        say(remark)
    return path


def _add_joints(bag: Recording, motion: FootholdMotion) -> Array:
    """Write the angles of the joints; return how far every foot is from where they put it."""
    angles, away_m = motion.joints_rad()
    for time_s, positions in zip(motion.time_s.tolist(), angles.reshape(len(angles), -1).tolist(), strict=True):
        state = {"header": {**header(time_s), "frame_id": ""}, "name": list(JOINTS), "position": positions}
        bag.add("/joint_states", "sensor_msgs/msg/JointState", time_s, {**state, "velocity": [], "effort": []})
    return away_m


def _add_skills(bag: Recording, motion: FootholdMotion) -> None:
    """Write what the robot does, whenever that changes."""
    said = ""
    for time_s, word in zip(motion.time_s.tolist(), motion.words, strict=True):
        if word != said:
            bag.add("/skill", "std_msgs/msg/String", time_s, {"data": word})
            said = word


def _add_samples(bag: Recording, motion: FootholdMotion) -> None:
    turned, upright = quaternions(motion.rpy_rad), np.array([1.0, 0.0, 0.0, 0.0])
    for sample, now_s in enumerate(motion.time_s.tolist()):
        feet_m, forces_n = motion.feet_m[sample], motion.forces_n[sample]
        frames = {"base": (motion.base_m[sample], turned[sample])}
        frames |= {name: (feet_m[foot], upright) for foot, name in enumerate(FEET)}
        bag.add("/tf", "tf2_msgs/msg/TFMessage", now_s, transforms(now_s, frames))
        arrows = [
            [foot_m, foot_m + force_n * _M_PER_N] if force_n.any() else []
            for foot_m, force_n in zip(feet_m, forces_n, strict=True)
        ]
        markers = [
            marker(now_s, ("forces", foot), ARROW, FOOT_COLOURS[foot], _ARROW_M, points_m=arrow)
            for foot, arrow in enumerate(arrows)
        ]
        bag.add("/forces", MARKERS, now_s, {"markers": markers})

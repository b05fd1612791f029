"""``surefoot view run/ --mcap``: a run for Foxglove, rosbag2 and whatever else reads ROS 2 messages."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from surefoot.frames import Cell
from surefoot.missions.biped.run_log import Step, Turn
from surefoot.viewer import style
from surefoot.viewer.bags.ros_messages import (
    CUBE,
    CUBE_LIST,
    CYLINDER,
    MARKERS,
    TEXT,
    Message,
    Recording,
    header,
    marker,
    path_message,
    pose,
    recording,
    transforms,
)
from surefoot.viewer.robots.headings import headings_rad
from surefoot.viewer.robots.simple import biped_parts
from surefoot.viewer.scenes.belief_tiles import KIND_HUES
from surefoot.viewer.sources.cells import centre_m, floor_m, heights_of
from surefoot.viewer.sources.plans import PlanSource, RunSource
from surefoot.viewer.sources.timeline import RATE_HZ, Timeline, read_timeline

_FRAMES = {"trunk": "trunk", "left/foot": "left_foot", "right/foot": "right_foot"}
_OBSTACLE_M = (0.6, 0.6, 1.1)


def write_run_bag(run_dir: Path, path: Path, rate_hz: float = RATE_HZ) -> Path:
    """Write a run as an MCAP file of ROS 2 messages, with the times of its log.

    Topics: ``/map``, ``/path`` (CoM), ``/goals``, ``/obstacles``, ``/belief``, ``/footprints``, ``/order``, ``/tf``.

    Args:
        run_dir: the folder of the run.
        path: of the MCAP file.
        rate_hz: of ``/tf`` and ``/obstacles``.

    Raises:
        InputError: the run cannot be read, or holds no step.
        BackendMissing: the packages that write it are not installed.
    """
    source, times = read_timeline(run_dir, rate_hz)
    with recording(path) as bag:
        _add_map(bag, source, times)
        _add_motion(bag, times)
        _add_turns(bag, source)
        for step in source.run.steps:
            landed_s = step.time_s + step.first_half_s
            bag.add("/footprints", MARKERS, landed_s, {"markers": [_footprint(step, landed_s)]})
    return path


def _add_map(bag: Recording, source: RunSource, times: Timeline) -> None:
    """Write what does not change: the map, the goals, and the whole path."""
    begin_s, heights = float(times.time_s[0]), heights_of(source.plan)
    bag.add("/map", "nav_msgs/msg/OccupancyGrid", begin_s, _grid(source.plan, begin_s))
    bag.add("/path", "nav_msgs/msg/Path", begin_s, path_message(times.time_s, times.com_m))
    markers = []
    for number, cell in enumerate(source.plan.cells("goals")):
        place = (*centre_m(source.plan, cell), floor_m(heights, cell) + 0.01)
        markers.append(marker(begin_s, ("goals", number), CYLINDER, style.GOAL, (0.8, 0.8, 0.02), at=place))
        name = marker(begin_s, ("goal names", number), TEXT, style.BLACK, (0, 0, 0.3), at=place, text=f"goal {number}")
        markers.append(name)
    bag.add("/goals", MARKERS, begin_s, {"markers": markers})


def _grid(plan: PlanSource, time_s: float) -> Message:
    """Return the map; its first row is the southern one, as ROS has it."""
    occupancy = plan.occupancy
    values = np.where(occupancy.occupied, 100, np.where(occupancy.unknown, -1, 0)).astype(np.int8)[::-1]
    half = occupancy.yaw_rad / 2
    wxyz = (float(np.cos(half)), 0.0, 0.0, float(np.sin(half)))
    info = {
        "map_load_time": header(time_s)["stamp"],
        "resolution": occupancy.resolution_m,
        "width": values.shape[1],
        "height": values.shape[0],
        "origin": pose((*occupancy.origin_m[:2], 0.0), wxyz),
    }
    return {"header": header(time_s), "info": info, "data": values.ravel().tolist()}


def _add_motion(bag: Recording, times: Timeline) -> None:
    parts, _ = biped_parts(times.com_m, headings_rad(times), times.left_foot_m, times.right_foot_m)
    for frame, time_s in enumerate(times.time_s.tolist()):
        moved = {name: (parts[part].position_m[frame], parts[part].wxyz[frame]) for part, name in _FRAMES.items()}
        bag.add("/tf", "tf2_msgs/msg/TFMessage", time_s, transforms(time_s, moved))
        stand = times.obstacles_m[frame] + np.array([0.0, 0.0, _OBSTACLE_M[2] / 2])
        markers = [
            marker(time_s, ("obstacles", number), CYLINDER, style.OBSTACLE, _OBSTACLE_M, at=place)
            for number, place in enumerate(stand)
        ]
        bag.add("/obstacles", MARKERS, time_s, {"markers": markers})


def _add_turns(bag: Recording, source: RunSource) -> None:
    for turn in source.run.turns:
        bag.add("/order", "std_msgs/msg/String", turn.time_s, {"data": f"{turn.order}, to goal {turn.goal}"})
        bag.add("/belief", MARKERS, turn.time_s, {"markers": _belief(source.plan, turn)})


def _belief(plan: PlanSource, turn: Turn) -> list[Message]:
    """Return the cells where an obstacle of a kind may hide, a marker for each kind."""
    heights, side_m = heights_of(plan), 0.9 * plan.grid.cell_size_m
    markers = []
    for kind, cells in enumerate(turn.hidden):
        places = [(*centre_m(plan, Cell(*cell)), floor_m(heights, Cell(*cell)) + 0.02 * (kind + 1)) for cell in cells]
        hue = KIND_HUES[kind % len(KIND_HUES)][1]
        group, size_m = ("belief", kind), (side_m, side_m, 0.01)
        markers.append(marker(turn.time_s, group, CUBE_LIST, hue, size_m, points_m=places, opacity=0.55))
    return markers


def _footprint(step: Step, time_s: float) -> Message:
    """Return where the swing foot of a step landed."""
    hue = style.LEFT if step.stance == "right" else style.RIGHT
    return marker(time_s, ("footprints", step.step), CUBE, hue, (0.1, 0.1, 0.01), at=step.next_foot_m)

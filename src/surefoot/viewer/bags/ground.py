"""The ground of a quadruped's run as ROS 2 messages: terrain that changes, obstacles, way points, the goal."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from surefoot.viewer import style
from surefoot.viewer.bags.ros_messages import CUBE, CYLINDER, LINE_STRIP, MARKERS, Message, Recording, marker
from surefoot.viewer.sources.ground import OBSTACLE_M, Phase, RunGround

Array = NDArray[np.float64]

_LINE_M, _DISC_M = (0.008, 0.0, 0.0), (0.2, 0.2, 0.012)


def add_terrain(bag: Recording, time_s: float, polygons_m: Sequence[Array], places: int) -> None:
    """Write the outlines of polygons.

    Args:
        bag: that is being written.
        time_s: of the log.
        polygons_m: each (corners, 3).
        places: how many markers there are; those without a polygon are taken away.
    """
    outlines = [[*polygon, polygon[0]] for polygon in polygons_m] + [[] for _ in range(places - len(polygons_m))]
    markers = [
        marker(time_s, ("terrain", number), LINE_STRIP, style.WALL, _LINE_M, points_m=outline)
        for number, outline in enumerate(outlines)
    ]
    bag.add("/terrain", MARKERS, time_s, {"markers": markers})


def add_ground(bag: Recording, ground: RunGround, begin_s: float) -> None:
    """Write the terrain and obstacles of every phase, every way point, and the goal.

    Args:
        bag: that is being written.
        ground: of the run.
        begin_s: of its first sample; nothing is written for an earlier moment.
    """
    places = max(len(phase.polygons_m) for phase in ground.phases)
    for phase in ground.phases:
        now_s = max(begin_s, phase.begin_s)
        add_terrain(bag, now_s, phase.polygons_m, places)
        bag.add("/obstacles", MARKERS, now_s, {"markers": _obstacles(phase, now_s)})
    goal = marker(begin_s, ("goals", 0), CYLINDER, style.GOAL, _DISC_M, at=ground.goal_m)
    bag.add("/goals", MARKERS, begin_s, {"markers": [goal]})
    for one in ground.way_points:
        disc = marker(one.begin_s, ("way_point", 0), CYLINDER, style.BLUE, _DISC_M, at=one.place_m)
        bag.add("/way_point", MARKERS, one.begin_s, {"markers": [disc]})


def _obstacles(phase: Phase, time_s: float) -> list[Message]:
    low_m = min(float(polygon[:, 2].min()) for polygon in phase.polygons_m)
    return [
        marker(
            time_s,
            ("obstacles", number),
            CUBE,
            style.OBSTACLE,
            (box.east - box.west, box.north - box.south, OBSTACLE_M),
            at=((box.west + box.east) / 2, (box.south + box.north) / 2, low_m + OBSTACLE_M / 2),
        )
        for number, box in enumerate(phase.obstacles)
    ]

"""ROS 2 messages as mappings, and a file of them (MCAP) that Foxglove and rosbag2 open; no ROS is needed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.compute import written_whole
from surefoot.errors import BackendMissing
from surefoot.viewer.browser.page import colour

Message = dict[str, Any]
Array = NDArray[np.float64]

FRAME = "map"
MARKERS = "visualization_msgs/msg/MarkerArray"
ARROW, CUBE, CYLINDER, LINE_STRIP, CUBE_LIST, TEXT = 0, 1, 3, 4, 6, 9
"""Shapes of visualization_msgs/Marker."""

_DELETE, _BY_POINTS = 2, (ARROW, LINE_STRIP, CUBE_LIST)
_NS = 1_000_000_000


class Recording:
    """An MCAP file that is being written.

    Args:
        stream: of the file, binary.

    Raises:
        BackendMissing: the packages that write it are not installed.
    """

    def __init__(self, stream: Any) -> None:
        try:
            from mcap_ros2.writer import Writer
        except ImportError as missing:
            raise BackendMissing("mcap-ros2-support", "pip install 'surefoot[view]'") from missing
        from rosbags.typesys import Stores, get_typestore

        self.writer, self.types = Writer(stream), get_typestore(Stores.ROS2_JAZZY)
        self.schemas: dict[str, Any] = {}

    def add(self, topic: str, kind: str, time_s: float, message: Message) -> None:
        """Write a message.

        Args:
            topic: such as ``/tf``.
            kind: its type, such as ``tf2_msgs/msg/TFMessage``.
            time_s: of the log.
            message: its fields; absent ones are zero or empty.
        """
        if kind not in self.schemas:
            text, _ = self.types.generate_msgdef(kind, ros_version=2)
            self.schemas[kind] = self.writer.register_msgdef(kind, text)
        moment_ns = round(time_s * _NS)
        self.writer.write_message(topic, self.schemas[kind], message, log_time=moment_ns, publish_time=moment_ns)


@contextmanager
def recording(path: Path) -> Iterator[Recording]:
    """Yield a recording that appears under its name, whole, when the block ends without an error.

    Args:
        path: of the MCAP file.
    """
    with written_whole(path) as stream:
        one = Recording(stream)
        yield one
        one.writer.finish()  # type: ignore[no-untyped-call]


def header(time_s: float) -> Message:
    """Return a header in the frame of the map."""
    whole, rest_ns = divmod(round(time_s * _NS), _NS)
    return {"stamp": {"sec": whole, "nanosec": rest_ns}, "frame_id": FRAME}


def vector(place: Sequence[float] | Array) -> Message:
    """Return a point or a vector."""
    x, y, z = (float(one) for one in place)
    return {"x": x, "y": y, "z": z}


def rotation(wxyz: Sequence[float] | Array) -> Message:
    """Return a quaternion; ROS writes the real part last."""
    w, x, y, z = (float(one) for one in wxyz)
    return {"x": x, "y": y, "z": z, "w": w}


def pose(place: Sequence[float] | Array, wxyz: Sequence[float] | Array = (1.0, 0.0, 0.0, 0.0)) -> Message:
    """Return a pose."""
    return {"position": vector(place), "orientation": rotation(wxyz)}


def path_message(time_s: Array, places_m: Array) -> Message:
    """Return a path with the moment of every pose."""
    poses = [
        {"header": header(moment), "pose": pose(place)} for moment, place in zip(time_s.tolist(), places_m, strict=True)
    ]
    return {"header": header(float(time_s[0])), "poses": poses}


def transforms(time_s: float, parts: dict[str, tuple[Array, Array]]) -> Message:
    """Return where frames are in the map: position and quaternion wxyz by name."""
    return {
        "transforms": [
            {
                "header": header(time_s),
                "child_frame_id": name,
                "transform": {"translation": vector(place), "rotation": rotation(wxyz)},
            }
            for name, (place, wxyz) in parts.items()
        ]
    }


def marker(
    time_s: float,
    group: tuple[str, int],
    shape: int,
    hue: str,
    size_m: Sequence[float],
    *,
    at: Sequence[float] | Array = (0.0, 0.0, 0.0),
    points_m: Sequence[Sequence[float]] | Array = (),
    opacity: float = 1.0,
    text: str = "",
) -> Message:
    """Return a marker that stays until it is replaced.

    Args:
        time_s: of the log.
        group: namespace and number; a later marker with both the same replaces it.
        shape: such as CYLINDER; a list or an arrow without points takes the earlier marker away.
        hue: ``#rrggbb``.
        size_m: its scale.
        at: where it is.
        points_m: of a list, relative to ``at``.
        opacity: from 0 to 1.
        text: of a text.
    """
    red, green, blue = (part / 255 for part in colour(hue))
    return {
        "header": header(time_s),
        "ns": group[0],
        "id": group[1],
        "type": shape,
        "action": _DELETE if shape in _BY_POINTS and len(points_m) == 0 else 0,
        "pose": pose(at),
        "scale": vector(size_m),
        "color": {"r": red, "g": green, "b": blue, "a": opacity},
        "points": [vector(point) for point in points_m],
        "text": text,
    }

"""Writes small bags with grid maps and planar terrain, as ROS 2 nodes would."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

_INFO = "float64 resolution\nfloat64 length_x\nfloat64 length_y\ngeometry_msgs/Pose pose\n"
_MAP = (
    "std_msgs/Header header\ngrid_map_msgs/GridMapInfo info\nstring[] layers\nstring[] basic_layers\n"
    "std_msgs/Float32MultiArray[] data\nuint16 outer_start_index\nuint16 inner_start_index\n"
)
GRID_MAP = "grid_map_msgs/msg/GridMap"


def typestore() -> Any:
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(_INFO, "grid_map_msgs/msg/GridMapInfo"))
    store.register(get_types_from_msg(_MAP, GRID_MAP))
    return store


def grid_map(
    picture: NDArray[np.float64],
    resolution_m: float,
    centre_m: tuple[float, float] = (0.0, 0.0),
    *,
    start: tuple[int, int] = (0, 0),
    by_rows: bool = False,
    basic: dict[str, NDArray[np.float64]] | None = None,
) -> Any:
    """Return a GridMap message of heights with row 0 in the north, stored as grid_map stores them."""
    store = typestore()
    t = store.types
    layers = {"elevation": picture, **(basic or {})}

    def array(north_up: NDArray[np.float64]) -> Any:
        matrix = np.roll(north_up.T[::-1, :], start, axis=(0, 1)).astype(np.float32)
        rows, columns = matrix.shape
        dim = t["std_msgs/msg/MultiArrayDimension"]
        sizes = [("row_index", rows), ("column_index", columns)]
        order = sizes if by_rows else sizes[::-1]
        dims = [
            dim(label=order[0][0], size=order[0][1], stride=rows * columns),
            dim(label=order[1][0], size=order[1][1], stride=order[1][1]),
        ]
        layout = t["std_msgs/msg/MultiArrayLayout"](dim=dims, data_offset=0)
        return t["std_msgs/msg/Float32MultiArray"](layout=layout, data=matrix.ravel("C" if by_rows else "F").copy())

    point = t["geometry_msgs/msg/Point"](x=centre_m[0], y=centre_m[1], z=0.0)
    turn = t["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=0.0, w=1.0)
    rows, columns = picture.shape
    header = t["std_msgs/msg/Header"](stamp=t["builtin_interfaces/msg/Time"](sec=0, nanosec=0), frame_id="odom")
    info = t["grid_map_msgs/msg/GridMapInfo"](
        resolution=resolution_m,
        length_x=columns * resolution_m,
        length_y=rows * resolution_m,
        pose=t["geometry_msgs/msg/Pose"](position=point, orientation=turn),
    )
    return t[GRID_MAP](
        header=header,
        info=info,
        layers=list(layers),
        basic_layers=list(basic or ()),
        data=[array(layer) for layer in layers.values()],
        outer_start_index=start[0],
        inner_start_index=start[1],
    )


def write_bag(folder: Path, messages: list[Any], *, topic: str = "/elevation_map", mcap: bool = False) -> Path:
    """Write a rosbag2 folder with grid maps on a topic, and a text on another."""
    from rosbags.rosbag2 import StoragePlugin, Writer

    store = typestore()
    plugin = StoragePlugin.MCAP if mcap else StoragePlugin.SQLITE3
    with Writer(folder, version=9, storage_plugin=plugin) as writer:
        talk = writer.add_connection("/chatter", "std_msgs/msg/String", typestore=store)
        word = store.types["std_msgs/msg/String"](data="hello")
        writer.write(talk, 1, store.serialize_cdr(word, "std_msgs/msg/String"))
        if messages:
            maps = writer.add_connection(topic, GRID_MAP, typestore=store)
            for k, message in enumerate(messages):
                writer.write(maps, 2 + k, store.serialize_cdr(message, GRID_MAP))
    return folder

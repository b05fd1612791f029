"""Grid maps (``grid_map_msgs/GridMap``) from ROS bags: rosbag2 folders, MCAP, SQLite and ROS 1 files.

A grid map holds a matrix whose rows run against x and whose columns run against y, stored as a circular buffer: row
``(outer_start_index + i) mod rows`` is the i-th from the largest x. A cell is valid where all basic layers are finite.

Source: ANYbotics grid_map, the documented meaning of its messages.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.world.elevation import MAX_CELLS, ElevationMap, elevation_map

if TYPE_CHECKING:
    from rosbags.highlevel import AnyReader

GRID_MAP = "grid_map_msgs/msg/GridMap"
PLANAR_TERRAIN = "convex_plane_decomposition_msgs/msg/PlanarTerrain"
_LARGEST_BAG_BYTES = 20_000_000_000

_INFO = """float64 resolution
float64 length_x
float64 length_y
geometry_msgs/Pose pose
"""
_MAP = """std_msgs/Header header
grid_map_msgs/GridMapInfo info
string[] layers
string[] basic_layers
std_msgs/Float32MultiArray[] data
uint16 outer_start_index
uint16 inner_start_index
"""


def read_bag_elevation(path: Path, *, layer: str | None, topic: str | None, message: int) -> ElevationMap:
    """Read one grid map of a bag.

    Args:
        path: of the bag.
        layer: which layer holds heights; None means ``elevation``, or the only one.
        topic: which topic; None means the only one with grid maps.
        message: which message of the topic; negative numbers count from the last.

    Raises:
        InputError: the bag cannot be read, or has no such topic, message or layer (those that exist are named).
    """
    with opened_bag(path) as bag:
        chosen = choose_topic(bag, path, topic, (GRID_MAP,))
        found, number = nth_message(bag, path, chosen, message)
        return grid_map_elevation(found, path, layer, {"as": "grid map", "topic": chosen, "message": number})


@contextmanager
def opened_bag(path: Path) -> Iterator[AnyReader]:
    """Open a bag of any kind; whatever its readers raise becomes an InputError."""
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    if not path.exists():
        raise InputError("there is no such bag", source=path)
    if path.is_dir() and not (path / "metadata.yaml").is_file():
        raise InputError("is a folder without metadata.yaml, so no rosbag2 bag", source=path)
    if path.is_file() and path.stat().st_size > _LARGEST_BAG_BYTES:
        raise InputError(f"is larger than {_LARGEST_BAG_BYTES // 10**9} GB", source=path)
    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(_INFO, "grid_map_msgs/msg/GridMapInfo"))
    store.register(get_types_from_msg(_MAP, GRID_MAP))
    try:
        with AnyReader([path], default_typestore=store) as bag:
            yield bag
    except (InputError, MemoryError):
        raise
    except Exception as problem:  # readers of damaged files raise whatever the damage leads them to
        reason = " ".join(str(problem).split())[:200] or type(problem).__name__
        raise InputError(f"is no readable bag ({reason})", source=path) from problem


def choose_topic(bag: AnyReader, path: Path, topic: str | None, kinds: tuple[str, ...]) -> str:
    """Return the topic to read; name those that exist when it cannot be told."""
    there = {connection.topic: connection.msgtype for connection in bag.connections}
    listed = ", ".join(f"{name} ({kind})" for name, kind in sorted(there.items())) or "none"
    if topic is None:
        fitting = sorted(name for name, kind in there.items() if kind in kinds)
        if len(fitting) != 1:
            what = (
                "carries no grid map" if not fitting else f"carries {len(fitting)} topics that fit; choose with --topic"
            )
            raise InputError(f"{what}; its topics are: {listed}", source=path)
        return fitting[0]
    if topic not in there:
        raise InputError(f"has no topic {topic!r}; its topics are: {listed}", source=path, key="topic")
    if there[topic] not in kinds:
        raise InputError(f"{topic} carries {there[topic]}, not {' or '.join(kinds)}", source=path, key="topic")
    return topic


def nth_message(bag: AnyReader, path: Path, topic: str, number: int) -> tuple[Any, int]:
    """Return one message of a topic and its number, counted from 0."""
    connections = [connection for connection in bag.connections if connection.topic == topic]
    count = sum(1 for _ in bag.messages(connections))
    index = number if number >= 0 else count + number
    if not 0 <= index < count:
        raise InputError(f"{topic} has {count} messages, so none with the number {number}", source=path, key="message")
    for k, (connection, _, raw) in enumerate(bag.messages(connections)):
        if k == index:
            return bag.deserialize(raw, connection.msgtype), index
    raise InputError(f"{topic} ends before message {index}", source=path, key="message")


def grid_map_elevation(message: Any, path: Path, layer: str | None, reading: dict[str, object]) -> ElevationMap:
    """Return the heights of a grid map message, unrolled and with the north on top."""
    names = [str(name) for name in message.layers]
    chosen = _layer(names, layer, path)
    info = message.info
    matrix = _matrix(message, names.index(chosen), path)
    valid = np.isfinite(matrix)
    for name in message.basic_layers:
        if name in names and name != chosen:
            other = _matrix(message, names.index(name), path)
            if other.shape == matrix.shape:
                valid &= np.isfinite(other)
    picture = np.where(valid, matrix, np.nan)[::-1, :].T  # rows against y, columns along x
    rows, columns = picture.shape
    cell_m = float(info.resolution)
    centre, turn = info.pose.position, info.pose.orientation
    origin = (float(centre.x) - columns * cell_m / 2, float(centre.y) - rows * cell_m / 2)
    notes = []
    yaw = 2 * math.atan2(turn.z, turn.w)
    if abs(math.sin(yaw / 2)) > 1e-3:
        notes.append(
            f"the grid map's yaw of {yaw:.3f} rad is ignored, as grid_map itself does; polygons are not turned"
        )
    if abs(float(centre.z)) > 1e-9:
        notes.append("the grid map's z position is ignored, as grid_map itself does")
    frame = str(message.header.frame_id if hasattr(message, "header") else info.header.frame_id)
    used = {**reading, "layer": chosen, "resolution_m": cell_m, "frame": frame}
    return elevation_map(picture, cell_m, origin, source=path, reading=used, notes=tuple(notes))


def _layer(names: list[str], layer: str | None, path: Path) -> str:
    if layer is None and "elevation" not in names and len(names) == 1:
        return names[0]
    chosen = "elevation" if layer is None else layer
    if chosen not in names:
        raise InputError(f"has no layer {chosen!r}; there are: {', '.join(names) or 'none'}", source=path, key="layer")
    return chosen


def _matrix(message: Any, index: int, path: Path) -> NDArray[np.float64]:
    """Return a layer as the matrix that grid_map means: row 0 at the largest x, column 0 at the largest y."""
    if index >= len(message.data):
        raise InputError("a grid map has fewer data arrays than layers", source=path)
    array, info = message.data[index], message.info
    cell_m = float(info.resolution)
    if not (math.isfinite(cell_m) and cell_m > 0):
        raise InputError(f"has a grid map of resolution {cell_m:g}; it has to be positive", source=path)
    dims = [(str(dim.label), int(dim.size)) for dim in array.layout.dim]
    by_rows = bool(dims) and dims[0][0] == "row_index"
    if len(dims) == 2:
        rows, columns = (dims[0][1], dims[1][1]) if by_rows else (dims[1][1], dims[0][1])
    else:
        rows, columns = (_cells(length, cell_m, path) for length in (info.length_x, info.length_y))
    values = np.asarray(array.data, np.float64)[int(array.layout.data_offset) :]
    if not 0 < rows * columns <= MAX_CELLS or len(values) < rows * columns:
        raise InputError(
            f"has a grid map of {rows} x {columns} cells with {len(values)} values; that does not fit", source=path
        )
    table = values[: rows * columns].reshape((rows, columns) if by_rows else (columns, rows))
    if not by_rows:
        table = table.T
    start = (int(message.outer_start_index), int(message.inner_start_index))
    if start[0] >= rows or start[1] >= columns:
        what = f"has a grid map of {rows} x {columns} cells whose buffer starts at row {start[0]}, column {start[1]}"
        raise InputError(f"{what}; that does not fit", source=path)
    return np.roll(table, (-start[0], -start[1]), axis=(0, 1))


def _cells(length_m: float, cell_m: float, path: Path) -> int:
    if not (math.isfinite(length_m) and 0 < length_m / cell_m <= MAX_CELLS):
        raise InputError(f"has a grid map with a side of {length_m:g} m", source=path)
    return round(length_m / cell_m)

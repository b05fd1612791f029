"""Reads heights from whatever holds them: the kind of file says which reader."""

from __future__ import annotations

import math
from pathlib import Path

from surefoot.errors import InputError
from surefoot.world import elevation_bags, elevation_files
from surefoot.world.elevation import ElevationMap

PICTURES = (".png", ".pgm", ".bmp", ".ppm")
ARRAYS = (".npy", ".npz")
BAGS = (".mcap", ".db3", ".bag")


def read_elevation(
    path: Path,
    *,
    resolution_m: float | None = None,
    height_range_m: tuple[float, float] | None = None,
    origin_m: tuple[float, float] = (0.0, 0.0),
    layer: str | None = None,
    topic: str | None = None,
    message: int = -1,
    no_data: int | None = None,
) -> ElevationMap:
    """Read heights from a picture, an array file or a bag with grid maps.

    Args:
        path: grey PNG, PGM or BMP; npy or npz; a rosbag2 folder, MCAP, db3 or ROS 1 bag.
        resolution_m: metres per cell, for pictures and arrays.
        height_range_m: heights of black and of white, for pictures and arrays of whole numbers.
        origin_m: south-western corner, for pictures and arrays.
        layer: of a grid map (default ``elevation``), or the name of an array in an npz file.
        topic: of a bag; may be left out when only one carries grid maps.
        message: which message on that topic; negative numbers count from the last.
        no_data: the grey level of a picture that means that nothing was measured.

    Raises:
        InputError: the file cannot be used; one sentence that says why and what is allowed.
    """
    suffix = path.suffix.lower()
    if no_data is not None and suffix not in PICTURES:
        raise InputError("is only allowed for pictures", source=path, key="no-data")
    if path.is_dir() or suffix in BAGS:
        elsewhere = None if origin_m == (0.0, 0.0) else origin_m
        for given, name in ((resolution_m, "resolution"), (height_range_m, "height-range"), (elsewhere, "origin")):
            if given is not None:
                raise InputError("is only allowed for pictures and arrays; a grid map carries its own", key=name)
        return elevation_bags.read_bag_elevation(path, layer=layer, topic=topic, message=message)
    if topic is not None:
        raise InputError("is only allowed for bags", source=path, key="topic")
    if height_range_m is not None:
        _check_range(height_range_m)
    if suffix in ARRAYS:
        return elevation_files.read_array(path, resolution_m, height_range_m, origin_m, layer)
    if suffix in PICTURES:
        if layer is not None:
            raise InputError("is only allowed for bags and npz files", source=path, key="layer")
        return elevation_files.read_picture(path, resolution_m, height_range_m, origin_m, no_data)
    if not path.exists():
        raise InputError("there is no such file", source=path)
    allowed = ", ".join((*PICTURES, *ARRAYS, *BAGS))
    raise InputError(f"is of no known kind; allowed are {allowed} and rosbag2 folders", source=path)


def _check_range(height_range_m: tuple[float, float]) -> None:
    low, high = height_range_m
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        raise InputError(
            f"has to be the heights of black and of white in metres, the lower one first, not {low:g} {high:g}",
            key="height-range",
        )

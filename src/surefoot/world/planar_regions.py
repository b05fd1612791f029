"""Planar regions that another program has segmented, in the layout of convex_plane_decomposition.

Each region is a plane's pose and, in the plane's own coordinates, an outer boundary with holes. Files are YAML (as
``ros2 topic echo`` prints a ``PlanarTerrain``) or JSON; bags carry the message itself.

Source: leggedrobotics convex_plane_decomposition_msgs, PlanarTerrain.msg and what it holds.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from surefoot.errors import InputError

REGION_FILES = (".yaml", ".yml", ".json")
_LIMIT_BYTES = 64_000_000
_LARGEST = 100_000
_TOP = ("planarRegions", "planar_regions", "regions", "planes")
Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class PlanarRegion:
    """A plane with an outline.

    Attributes:
        position_m: origin of the plane's frame in the world.
        rotation: (3, 3), columns are the plane's axes in the world; the third is its normal.
        outer_m: (n, 2) boundary in the plane's frame.
        holes_m: boundaries of holes.
    """

    position_m: Floats
    rotation: Floats
    outer_m: Floats
    holes_m: tuple[Floats, ...] = ()


def read_planar_regions(path: Path, *, topic: str | None = None, message: int = -1) -> tuple[PlanarRegion, ...]:
    """Read planar regions from a YAML or JSON file, or from a bag with PlanarTerrain messages.

    Raises:
        InputError: the file cannot be used; with the key at which it fails.
    """
    if path.suffix.lower() in REGION_FILES and path.is_file():
        return regions_of(_document(path), path)
    from surefoot.world.elevation_bags import PLANAR_TERRAIN, choose_topic, nth_message, opened_bag

    with opened_bag(path) as bag:
        chosen = choose_topic(bag, path, topic, (PLANAR_TERRAIN,))
        found, _ = nth_message(bag, path, chosen, message)
        return regions_of({"planarRegions": [_plain(region) for region in found.planarRegions]}, path)


def carries_planar_regions(path: Path, topic: str | None) -> bool:
    """Return whether a path is a file of planar regions, or a bag whose chosen (or only) fitting topic has them."""
    if path.suffix.lower() in REGION_FILES:
        return True
    from surefoot.world.elevation_bags import GRID_MAP, PLANAR_TERRAIN, opened_bag

    if not (path.is_dir() or path.suffix.lower() in (".mcap", ".db3", ".bag")):
        return False
    with opened_bag(path) as bag:
        there = {connection.topic: connection.msgtype for connection in bag.connections}
    if topic is not None:
        return there.get(topic) == PLANAR_TERRAIN
    return PLANAR_TERRAIN in there.values() and GRID_MAP not in there.values()


def regions_of(document: object, path: Path) -> tuple[PlanarRegion, ...]:
    """Return the regions that a document holds."""
    listed: object = document
    key = ""
    if isinstance(document, Mapping):
        key = next((name for name in _TOP if name in document), "")
        if not key:
            raise InputError(f"holds no planar regions; one of {', '.join(_TOP)} is required", source=path)
        listed = document[key]
    if not isinstance(listed, Sequence) or isinstance(listed, str) or not listed:
        raise InputError("has to be a list with at least one planar region", source=path, key=key or None)
    if len(listed) > _LARGEST:
        raise InputError(f"lists {len(listed)} regions; at most {_LARGEST} are allowed", source=path, key=key or None)
    return tuple(_region(item, f"{key}[{k}]", path) for k, item in enumerate(listed))


def _region(item: object, key: str, path: Path) -> PlanarRegion:
    if not isinstance(item, Mapping):
        raise InputError("has to be a mapping with plane_parameters and boundary", source=path, key=key)
    pose = _part(item, "plane_parameters", key, path)
    position = _coordinates(_part(pose, "position", f"{key}.plane_parameters", path), "xyz", f"{key}.position", path)
    turn = _coordinates(_part(pose, "orientation", f"{key}.plane_parameters", path), "xyzw", f"{key}.orientation", path)
    norm = float(np.linalg.norm(turn))
    if not 0.9 < norm < 1.1:
        raise InputError(f"has to be a unit quaternion, not of length {norm:g}", source=path, key=f"{key}.orientation")
    boundary = _part(item, "boundary", key, path)
    outer = _outline(_part(boundary, "outer_boundary", f"{key}.boundary", path), f"{key}.outer_boundary", path)
    holes = boundary.get("holes") or []
    if not isinstance(holes, Sequence) or isinstance(holes, str):
        raise InputError("has to be a list", source=path, key=f"{key}.boundary.holes")
    inner = tuple(_outline(hole, f"{key}.boundary.holes[{k}]", path) for k, hole in enumerate(holes))
    return PlanarRegion(position, _rotation(turn / norm), outer, inner)


def _part(item: Mapping[str, Any], name: str, key: str, path: Path) -> Mapping[str, Any]:
    value = item.get(name)
    if not isinstance(value, Mapping):
        raise InputError(f"the mapping {name!r} is missing", source=path, key=key)
    return value


def _outline(item: object, key: str, path: Path) -> Floats:
    points = item.get("points") if isinstance(item, Mapping) else item
    if not isinstance(points, Sequence) or isinstance(points, str) or not 3 <= len(points) <= _LARGEST:
        raise InputError("has to hold at least 3 points", source=path, key=key)
    return np.array([_coordinates(point, "xy", f"{key}.points[{k}]", path) for k, point in enumerate(points)])


def _coordinates(item: object, names: str, key: str, path: Path) -> Floats:
    values: list[Any] = []
    if isinstance(item, Mapping):
        values = [item.get(name) for name in names]
    elif isinstance(item, Sequence) and not isinstance(item, str):
        values = list(item)
    good = len(values) == len(names) and all(
        isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value) for value in values
    )
    if not good:
        raise InputError(f"has to be finite numbers {', '.join(names)}", source=path, key=key)
    return np.array(values, np.float64)


def _rotation(turn: Floats) -> Floats:
    x, y, z, w = turn
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def _plain(message: Any) -> dict[str, Any]:
    """Return the parts of a PlanarRegion message that a file would hold."""
    pose, boundary = message.plane_parameters, message.boundary
    return {
        "plane_parameters": {
            "position": {name: float(getattr(pose.position, name)) for name in "xyz"},
            "orientation": {name: float(getattr(pose.orientation, name)) for name in "xyzw"},
        },
        "boundary": {
            "outer_boundary": _points(boundary.outer_boundary),
            "holes": [_points(hole) for hole in boundary.holes],
        },
    }


def _points(polygon: Any) -> dict[str, Any]:
    return {"points": [{"x": float(point.x), "y": float(point.y)} for point in polygon.points]}


def _document(path: Path) -> object:
    """Return the first document of a YAML or JSON file."""
    try:
        if path.stat().st_size > _LIMIT_BYTES:
            raise InputError(f"is larger than {_LIMIT_BYTES // 10**6} MB", source=path)
        text = path.read_text("utf-8")
        if path.suffix.lower() == ".json":
            return json.loads(text)
        loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
        return next((item for item in yaml.load_all(text, Loader=loader) if item is not None), None)
    except yaml.MarkedYAMLError as problem:
        line = problem.problem_mark.line + 1 if problem.problem_mark else None
        raise InputError(f"is no valid YAML: {problem.problem}", source=path, line=line) from problem
    except (OSError, ValueError, yaml.YAMLError, RecursionError) as problem:
        raise InputError("is no readable YAML or JSON file", source=path) from problem

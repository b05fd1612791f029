"""Occupancy maps as ROS map_server writes them, and plain black-and-white pictures."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.world import pictures

MODES = ("trinary", "scale", "raw")
_REQUIRED = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh")
_LIMIT_BYTES = 1_000_000
_FARTHEST_M = 1e8
_RESOLUTION_M = (1e-4, 100.0)

Classify = Callable[[pictures.Strip], tuple[NDArray[np.bool_], NDArray[np.bool_]]]


@dataclass(frozen=True, slots=True, eq=False)
class OccupancyMap:
    """A picture of a floor, placed in the world.

    Attributes:
        occupied: (rows, columns) of pixels; row 0 is the top of the picture, the north when the yaw is 0.
        unknown: (rows, columns), neither occupied nor known to be free.
        resolution_m: side of a pixel.
        origin_m: world position of the lower-left corner of the lower-left pixel.
        yaw_rad: the picture's rotation about that corner, counter-clockwise.
        path: the YAML file, or the picture itself when there is none.
        image_path: the picture.
    """

    occupied: NDArray[np.bool_]
    unknown: NDArray[np.bool_]
    resolution_m: float
    origin_m: tuple[float, float]
    yaw_rad: float
    path: Path
    image_path: Path


def read_occupancy_map(path: Path, resolution_m: float | None = None) -> OccupancyMap:
    """Read a ROS map_server YAML with its picture, or a black-and-white picture alone.

    With YAML, the occupancy of a pixel is ``p = (255 - v) / 255``, or ``v / 255`` with ``negate``, where v is the mean
    of its channels. It is occupied when ``p >= occupied_thresh``, free when ``p <= free_thresh`` and unknown between
    them. The modes: ``trinary`` counts an alpha channel as one more channel of the mean; ``scale`` leaves alpha out of
    it and takes every pixel that is not opaque as unknown (map_server makes a scale of the values between the
    thresholds: to a planner they are unknown); ``raw`` takes v itself as per cent, thresholds apply to v / 100, and
    more than 100 is unknown. A picture without YAML is occupied where it is darker than 128, unknown where its alpha is
    below 128, and its lower-left corner is the origin. Unknown keys of the YAML are ignored unless they look like a
    misspelling of one that is missing.

    Args:
        path: a ``.yaml`` or ``.yml`` file, else a picture (PGM, PNG or BMP).
        resolution_m: metres per pixel, for a picture without YAML only.

    Returns:
        The map, with read-only arrays.

    Raises:
        InputError: the file, its picture or one of its values cannot be used.

    Source: ROS 2 Navigation, package nav2_map_server, the documented meaning of its map files.
    """
    if path.suffix.lower() in (".yaml", ".yml"):
        if resolution_m is not None:
            raise InputError(
                f"is only allowed for a picture without YAML, and {path.name} is YAML", key="map_resolution_m"
            )
        return _read_yaml_map(path)
    if resolution_m is None:
        raise InputError(
            f"is required, because {path.name} is a picture without YAML: metres per pixel", key="map_resolution_m"
        )
    _check_resolution(resolution_m, "map_resolution_m", None, None)
    occupied, unknown = _classified(path, _dark)
    return OccupancyMap(occupied, unknown, float(resolution_m), (0.0, 0.0), 0.0, path, path)


def _read_yaml_map(path: Path) -> OccupancyMap:
    """Return the map that a map_server YAML describes."""
    keys = _Keys(path)
    image = keys.value("image")
    if not isinstance(image, str) or not image.strip() or "\0" in image:
        raise keys.wrong("image", "has to be the path of a picture, relative to this file")
    resolution_m = keys.number("resolution")
    _check_resolution(resolution_m, "resolution", path, keys.lines.get("resolution"))
    x_m, y_m, yaw_rad = keys.origin()
    occupied_from, free_to = keys.number("occupied_thresh"), keys.number("free_thresh")
    if not 0 <= free_to < occupied_from <= 1:
        raise keys.wrong(
            "free_thresh" if 0 <= occupied_from <= 1 else "occupied_thresh",
            "the thresholds have to satisfy 0 <= free_thresh < occupied_thresh <= 1, "
            f"not {free_to:g} and {occupied_from:g}",
        )
    image_path = path.parent / image
    classify = _classifier(keys.mode(), keys.negate(), occupied_from, free_to)
    occupied, unknown = _classified(image_path, classify)
    return OccupancyMap(occupied, unknown, resolution_m, (x_m, y_m), yaw_rad, path, image_path)


def _classified(image_path: Path, classify: Classify) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return which pixels of a picture are occupied and which are unknown."""
    with pictures.opened(image_path) as picture:
        occupied = np.zeros((picture.height, picture.width), np.bool_)
        unknown = np.zeros_like(occupied)
        for strip in pictures.strips(picture):
            occupied[strip.rows], unknown[strip.rows] = classify(strip)
    occupied.setflags(write=False)
    unknown.setflags(write=False)
    return occupied, unknown


def _dark(strip: pictures.Strip) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Classify a plain picture: dark is occupied, transparent is unknown."""
    unknown = np.zeros(strip.colour.shape, np.bool_) if strip.opacity is None else strip.opacity < 128
    return (strip.colour < 128) & ~unknown, unknown


def _classifier(mode: str, negate: bool, occupied_from: float, free_to: float) -> Classify:
    """Return how map_server's modes read a pixel."""

    def classify(strip: pictures.Strip) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        shade, hidden = strip.colour, np.zeros(strip.colour.shape, np.bool_)
        if mode == "trinary" and strip.opacity is not None:
            shade = (3 * shade + strip.opacity) / 4
        if mode == "scale" and strip.opacity is not None:
            hidden = strip.opacity < 255
        if mode == "raw":
            share = np.rint(shade) / 100
            hidden = share > 1
        else:
            share = (shade if negate else 255 - shade) / 255
        occupied = (share >= occupied_from) & ~hidden
        return occupied, hidden | ((share > free_to) & ~occupied)

    return classify


def _check_resolution(resolution_m: float, key: str, source: Path | None, line: int | None) -> None:
    least, most = _RESOLUTION_M
    if not least <= resolution_m <= most:
        raise InputError(
            f"has to be metres per pixel, from {least:g} to {most:g}, not {resolution_m!r}",
            source=source,
            line=line,
            key=key,
        )


class _Keys:
    """The keys of a map_server YAML, with the lines they stand in."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.lines, self.values = _read_mapping(path)
        missing = [key for key in _REQUIRED if key not in self.values]
        if missing:
            found = ", ".join(map(str, self.values)) or "none"
            raise InputError(
                f"the key {missing[0]!r} is missing; required are {', '.join(_REQUIRED)}; found are {found}",
                source=path,
                key=missing[0],
            )
        if "mode" not in self.values and (near := difflib.get_close_matches("mode", map(str, self.values), 1, 0.7)):
            raise self.wrong(near[0], "is no key of a map; 'mode' is probably meant")

    def wrong(self, key: str, message: str) -> InputError:
        """Return the error that a key's value cannot be used."""
        return InputError(message, source=self.path, line=self.lines.get(key), key=key)

    def value(self, key: str) -> object:
        """Return the value of a required key."""
        return self.values[key]

    def number(self, key: str) -> float:
        """Return the finite number at a required key."""
        number = _as_number(self.values[key])
        if number is None:
            raise self.wrong(key, f"has to be a finite number, not {_shown(self.values[key])}")
        return number

    def origin(self) -> tuple[float, float, float]:
        """Return x, y [m] and yaw [rad] of the lower-left pixel."""
        given = self.values["origin"]
        numbers = [_as_number(value) for value in given] if isinstance(given, list) else []
        x, y, yaw = numbers if len(numbers) == 3 else (None, None, None)
        if x is None or y is None or yaw is None or max(abs(x), abs(y), abs(yaw)) > _FARTHEST_M:
            raise self.wrong("origin", "has to be three finite numbers, [x, y, yaw] in metres and radians")
        return x, y, yaw

    def negate(self) -> bool:
        """Return whether white is occupied."""
        given = self.values["negate"]
        if not isinstance(given, int):
            raise self.wrong("negate", f"has to be 0, 1, false or true, not {_shown(given)}")
        return bool(given)

    def mode(self) -> str:
        """Return how pixels are read."""
        given = self.values.get("mode", MODES[0])
        if given not in MODES:
            raise self.wrong("mode", f"has to be one of {', '.join(MODES)}, not {_shown(given)}")
        return str(given)


def _as_number(value: object) -> float | None:
    """Return a finite number; YAML 1.1 reads ``5e-2`` as text, so text is tried too."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    try:
        number = float(value)
    except (ValueError, OverflowError):
        return None
    return number if math.isfinite(number) else None


def _shown(value: object) -> str:
    """Return how a value is quoted in a message; collections are only named, they may be endless."""
    return f"{value!r:.60}" if isinstance(value, bool | int | float | str) else f"a {type(value).__name__}"


def _read_mapping(path: Path) -> tuple[dict[str, int], dict[str, object]]:
    """Return the lines and the values of the keys of a small YAML file."""
    try:
        with path.open("rb") as stream:
            text = stream.read(_LIMIT_BYTES + 1)
    except OSError as problem:
        raise InputError(f"the map cannot be read: {problem.strerror}", source=path) from problem
    if len(text) > _LIMIT_BYTES:
        raise InputError("is too long for a map_server YAML; at most 1 MB is allowed", source=path)
    try:
        loader = yaml.SafeLoader(text)
        try:
            node = loader.get_single_node()
            values = loader.construct_document(node) if isinstance(node, yaml.MappingNode) else None
        finally:
            loader.dispose()
    except yaml.MarkedYAMLError as problem:
        line = problem.problem_mark.line + 1 if problem.problem_mark else None
        raise InputError(f"is no valid YAML: {problem.problem}", source=path, line=line) from problem
    except (yaml.YAMLError, ValueError, RecursionError, OverflowError) as problem:
        raise InputError(f"is no valid YAML: {str(problem).partition(chr(10))[0]}", source=path) from problem
    if not isinstance(node, yaml.MappingNode) or not isinstance(values, dict):
        raise InputError(f"has to hold a mapping with the keys {', '.join(_REQUIRED)}", source=path)
    lines = {key.value: key.start_mark.line + 1 for key, _ in node.value if isinstance(key, yaml.ScalarNode)}
    return lines, values

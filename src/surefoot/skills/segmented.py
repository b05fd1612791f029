"""Reads the terrains that `surefoot terrain segment` makes (docs/formats.md, section 8)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from surefoot.documents import is_format, read_json_object
from surefoot.errors import InputError
from surefoot.footholds.terrain import Polygon, PolygonError, polygon

_LARGEST_BYTES = 64_000_000
_HEAD_BYTES = 400


@dataclass(frozen=True, slots=True)
class Scan:
    """Polygons, and what was taken off their edges; None if the file does not say."""

    polygons: tuple[Polygon, ...]
    margin_m: float | None


def is_segmented(path: Path) -> bool:
    """Return whether a file looks like a segmented terrain: a JSON object of kind ``terrain``."""
    try:
        with path.open("rb") as stream:
            head = stream.read(_HEAD_BYTES).decode("utf-8", "replace")
    except OSError:
        return False
    return head.lstrip().startswith("{") and '"kind":"terrain"' in "".join(head.split())


def read_segmented(path: Path) -> Scan:
    """Read the polygons of a segmented terrain.

    Raises:
        InputError: it cannot be read, is no such file, or a polygon is none.
    """
    document = read_json_object(path, _LARGEST_BYTES, hint="give what `surefoot terrain segment` wrote")
    if document.get("kind") != "terrain" or not is_format(document.get("format")):
        raise InputError("is no terrain of `surefoot terrain segment`, format 1", source=path, key="kind")
    given = document.get("polygons")
    if not isinstance(given, list) or not given:
        raise InputError("holds no polygons: there is nothing to stand on", source=path, key="polygons")
    options = document.get("options")
    margin = options.get("margin_m") if isinstance(options, dict) else None
    if margin is not None and not (isinstance(margin, int | float) and 0 <= margin <= 0.5):
        raise InputError("needs a number from 0 to 0.5", source=path, key="options.margin_m")
    return Scan(tuple(_polygon(path, k, one) for k, one in enumerate(given)), margin)


def _polygon(path: Path, number: int, given: Any) -> Polygon:
    key = f"polygons[{number}]"
    try:
        vertices = [[float(value) for value in vertex] for vertex in given["vertices_m"]]
        friction = float(given["friction"])
    except (TypeError, ValueError, KeyError) as problem:
        raise InputError("needs vertices_m, a list of [x, y, z], and friction", source=path, key=key) from problem
    if any(len(vertex) != 3 or not all(abs(value) < 1e4 for value in vertex) for vertex in vertices):
        raise InputError("needs vertices of three numbers within 10 km", source=path, key=key)
    if not 0 <= friction <= 10:
        raise InputError("needs a friction from 0 to 10", source=path, key=key)
    try:
        return polygon(vertices, friction)
    except PolygonError as problem:
        raise InputError(str(problem), source=path, key=key) from problem

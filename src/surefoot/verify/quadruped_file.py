"""Reads runs of a quadruped, and the ground that they walk on, from docs/formats.md 12, 9 and 8; nothing is trusted."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from surefoot.documents import read_yaml
from surefoot.errors import InputError
from surefoot.verify.artefacts import check_kind, checked_file, parse_json, read_bytes
from surefoot.verify.values import Fields

Array = NDArray[np.float64]
Cell = tuple[int, int]
RECORDS = ("header", "request", "segment", "failed", "event", "violation", "detour", "turned", "end")
_MOST_RECORDS = 100_000


@dataclass(frozen=True, slots=True, eq=False)
class Patch:
    """A polygon of the map that a foot may stand on; its vertices, and its friction."""

    vertices_m: Array
    friction: float

    def miss_m(self, point_m: Array) -> float:
        """Return by how much a point misses the polygon: off its plane, or beyond one of its sides, seen from above."""
        centre = self.vertices_m.mean(axis=0)
        spokes = self.vertices_m - centre
        normal = np.cross(spokes, np.roll(spokes, -1, axis=0)).sum(axis=0)
        normal /= np.linalg.norm(normal)
        off = abs(float(normal @ (point_m - centre)))
        begin = self.vertices_m[:, :2]
        along = np.roll(begin, -1, axis=0) - begin
        to = point_m[:2] - begin
        turn = np.sign(normal[2]) * (along[:, 0] * to[:, 1] - along[:, 1] * to[:, 0])
        beyond = float((-turn / np.maximum(np.linalg.norm(along, axis=1), 1e-12)).max())
        return max(off, beyond)


@dataclass(frozen=True, slots=True, eq=False)
class MapFile:
    """What a terrain file says that a run has to agree with.

    Attributes:
        patches: where feet may stand.
        given: cell size, origin and cells, as far as the file says.
    """

    patches: tuple[Patch, ...]
    given: Fields


@dataclass(frozen=True, slots=True)
class QuadrupedRun:
    """A run log as it was read.

    Attributes:
        folder: of the run.
        header: its first record.
        records: the others.
        library: ``library.json`` of the skills; None where there was none.
    """

    folder: Path
    header: Fields
    records: tuple[Fields, ...]
    library: Fields | None
    ground: MapFile


def read_quadruped_run(folder: Path) -> QuadrupedRun:
    """Read a run folder and check every hash of its inputs.

    Raises:
        InputError: a file is missing, stale, or not what docs/formats.md says.
    """
    path = folder / "run.jsonl"
    lines = list(_lines(path))
    if not lines:
        raise InputError("is empty", source=path)
    header = lines[0]
    if header.text("record") != "header":
        raise header.wrong("record", "has to be header in the first line")
    check_kind(header, "quadruped-run")
    terrain = checked_file(header.mapping("terrain"), folder)
    library = None
    if header.get("library") is not None:
        file = checked_file(header.mapping("library"), folder)
        library = Fields.of(parse_json(read_bytes(file), file), file)
        check_kind(library, "skill-library")
    for record in lines[1:]:
        record.text("record", among=RECORDS[1:])
    return QuadrupedRun(folder, header, tuple(lines[1:]), library, read_map(terrain))


def is_quadruped_run(folder: Path) -> bool:
    """Return whether a run log is that of a quadruped."""
    try:
        with (folder / "run.jsonl").open("rb") as stream:
            return b'"quadruped-run"' in stream.read(400)
    except OSError:
        return False


def _lines(path: Path) -> Iterator[Fields]:
    text = read_bytes(path)
    for number, line in enumerate(text.splitlines(), start=1):
        if number > _MOST_RECORDS:
            raise InputError(f"has more than {_MOST_RECORDS} records", source=path)
        yield Fields.of(parse_json(line, path, number), path, line=number)


def read_map(path: Path) -> MapFile:
    """Read the polygons of a terrain file: YAML or JSON of section 9, or JSON of section 8.

    Raises:
        InputError: it cannot be read, or a polygon is none.
    """
    value = parse_json(read_bytes(path), path) if path.suffix == ".json" else _listed(read_yaml(path).value)
    fields = Fields.of(value, path)
    if fields.text("kind") == "terrain":
        return MapFile(tuple(_patches(fields)), Fields({}, path))
    if fields.text("kind") != "quadruped-terrain":
        raise fields.wrong("kind", "has to be quadruped-terrain or terrain")
    polygons = fields.get("polygons")
    if isinstance(polygons, str):
        named = path.parent / polygons
        return MapFile(tuple(_patches(Fields.of(parse_json(read_bytes(named), named), named))), fields)
    return MapFile(tuple(_patches(fields)), fields)


def _listed(value: object) -> object:
    """Return a value of a YAML file with lists where JSON has them."""
    if isinstance(value, dict):
        return {key: _listed(inner) for key, inner in value.items()}
    return [_listed(inner) for inner in value] if isinstance(value, tuple | list) else value


def _patches(fields: Fields) -> Iterator[Patch]:
    for polygon in fields.mappings("polygons"):
        corners = [Fields({"vertices_m": one}, fields.source, polygon.place) for one in polygon.items("vertices_m")]
        vertices = np.array([corner.numbers("vertices_m", 3) for corner in corners])
        if len(vertices) < 3:
            raise polygon.wrong("vertices_m", "needs at least three vertices")
        yield Patch(vertices, polygon.number("friction", 0.6))

"""Reads the map of a quadruped: polygons, lattice and classes, from docs/formats.md 9 and 8; nothing is trusted."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from surefoot.documents import read_yaml
from surefoot.verify.artefacts import check_kind, parse_json, read_bytes
from surefoot.verify.terrain.class_rules import ClassRules, listed, rules_of, shipped_rules
from surefoot.verify.values import Fields

Array = NDArray[np.float64]
Cell = tuple[int, int]
_RULES = (".yaml", ".yml", ".json")
_SCANNED = "terrain"
_DIRECTIONS = ("forward", "backward", "left", "right")


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
    """A map, with what its file leaves out filled in.

    Attributes:
        patches: where feet may stand.
        rules: the classes of its cells.
        margin_m: what was taken off the edges of the polygons.
        cell_m, grid, origin_m, cells, robot: as in the file, or as docs/formats.md 9 fills them in.
        yaw: whether the robot turns.
        directions: which way it may walk.
        files: what was read beside the file itself.
        given: the file as it stands.
    """

    patches: tuple[Patch, ...]
    rules: ClassRules
    margin_m: float
    cell_m: float
    grid: Cell
    origin_m: tuple[float, float]
    cells: Cell
    robot: str
    yaw: bool
    directions: tuple[str, ...]
    files: tuple[Path, ...]
    given: Fields


def read_map(path: Path, classes: str = "unstructured-8") -> MapFile:
    """Read a terrain file: YAML or JSON of section 9, or JSON of section 8.

    Args:
        path: of the file.
        classes: of a file of section 8, which names none.

    Raises:
        InputError: it cannot be read, or a polygon is none.
    """
    value = parse_json(read_bytes(path), path) if path.suffix == ".json" else listed(read_yaml(path).value)
    fields = Fields.of(value, path)
    if fields.text("kind", among=("quadruped-terrain", _SCANNED)) == _SCANNED:
        fields = Fields({"polygons": path.name, "classes": classes}, path)
    else:
        check_kind(fields, "quadruped-terrain")
    named = fields.text("classes")
    files = [path.parent / named] if named.endswith(_RULES) else []
    rules = next(iter(rules_of(files[0]).values())) if files else shipped_rules(named, path)
    polygons, margin_m = fields, None
    if isinstance(fields.get("polygons"), str):
        scan = path.parent / fields.text("polygons")
        files += [scan] if scan != path else []
        polygons = Fields.of(parse_json(read_bytes(scan), scan), scan)
        options = polygons.mapping("options", optional=True)
        margin_m = options.number("margin_m", least=0.0) if _given(options, "margin_m") else None
    return _laid(fields, tuple(_patches(polygons)), rules, margin_m, tuple(files))


def _laid(
    fields: Fields, patches: tuple[Patch, ...], rules: ClassRules, margin_m: float | None, files: tuple[Path, ...]
) -> MapFile:
    """Fill in what a file leaves out."""
    points = np.concatenate([one.vertices_m[:, :2] for one in patches])
    low, high = points.min(axis=0), points.max(axis=0)
    cell_m = fields.number("cell_m", least=1e-3) if _given(fields, "cell_m") else rules.cell_m
    origin = fields.point("origin_m") if _given(fields, "origin_m") else (float(low[0]), float(low[1]))
    rows, columns = (max(math.ceil((high[k] - origin[k]) / cell_m - 1e-6), 1) for k in (0, 1))
    given = fields.number("margin_m", least=0.0) if _given(fields, "margin_m") else margin_m
    return MapFile(
        patches=patches,
        rules=rules,
        margin_m=rules.margin_m if given is None else given,
        cell_m=cell_m,
        grid=fields.cell("grid") if _given(fields, "grid") else (3, 3),
        origin_m=origin,
        cells=fields.cell("cells") if _given(fields, "cells") else (rows, columns),
        robot=fields.text("robot") if _given(fields, "robot") else rules.robot,
        yaw=_given(fields, "yaw") and fields.flag("yaw"),
        directions=tuple(map(str, fields.items("directions"))) if _given(fields, "directions") else _DIRECTIONS,
        files=files,
        given=fields,
    )


def _given(fields: Fields, key: str) -> bool:
    return fields.values.get(key) is not None


def _patches(fields: Fields) -> Iterator[Patch]:
    for polygon in fields.mappings("polygons"):
        corners = [Fields({"vertices_m": one}, fields.source, polygon.place) for one in polygon.items("vertices_m")]
        vertices = np.array([corner.numbers("vertices_m", 3) for corner in corners])
        if len(vertices) < 3:
            raise polygon.wrong("vertices_m", "needs at least three vertices")
        yield Patch(vertices, polygon.number("friction", 0.6))

"""Files of a quadruped's terrain (formats.md): read with every complaint at once, written whole."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import shapely  # type: ignore[import-untyped]
from pydantic import ValidationError

from surefoot.compute import write_text_whole
from surefoot.documents import Document, FileProblems, Loc, dotted, problems_of, read_yaml
from surefoot.errors import InputError
from surefoot.footholds.terrain import Polygon, PolygonError, polygon
from surefoot.robots.quadruped import quadruped
from surefoot.skills.classes import ClassSet, class_set, read_classes
from surefoot.skills.grid import LocalGrid
from surefoot.skills.quadruped_terrain import Laid, Point, QuadrupedTerrain
from surefoot.skills.segmented import Scan, is_segmented, read_segmented
from surefoot.skills.terrain_blocks import TerrainBlock
from surefoot.skills.values import Direction

KIND, FORMAT = "quadruped-terrain", 1
MOST_POLYGONS = 5000
_APART_M = 0.03
_OVERLAP_M2 = 1e-6
_SHOWN = 10
_DEFAULT_CLASSES = "unstructured-8"


def read_terrain(path: Path, *, classes: str = _DEFAULT_CLASSES) -> QuadrupedTerrain:
    """Read the terrain of a quadruped, or a terrain that `surefoot terrain segment` made.

    Args:
        path: of the file.
        classes: the set of classes for a segmented terrain, which names none.

    Raises:
        InputError: with every problem of the file, one sentence each.
    """
    path = Path(path)
    if is_segmented(path):
        given: dict[str, object] = {"format": 1, "kind": KIND, "name": path.stem, "classes": classes}
        block = TerrainBlock.model_validate({**given, "polygons": path.name})
        return _Reading(path, Document(None, {}, ()), block).terrain()
    document = read_yaml(path)
    if not isinstance(document.value, dict):
        raise InputError("must be a mapping of keys to values, such as `classes: unstructured-8`", source=path, line=1)
    problems = list(document.problems)
    try:
        block = TerrainBlock.model_validate(document.value)
    except ValidationError as refused:
        problems += problems_of(refused, TerrainBlock.model_json_schema(), path, document.lines)
        raise FileProblems(problems) from None
    if problems:
        raise FileProblems(problems)
    return _Reading(path, document, block).terrain()


def terrain_schema() -> dict[str, Any]:
    """Return the JSON Schema of the file."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **TerrainBlock.model_json_schema(),
        "title": "Surefoot terrain of a quadruped, format 1",
    }


def write_terrain(path: Path, terrain: QuadrupedTerrain) -> None:
    """Write a terrain, whole or not at all: YAML with one polygon a line (which is JSON within YAML)."""
    head = {
        "format": FORMAT,
        "kind": KIND,
        "name": terrain.name,
        "robot": terrain.robot,
        "classes": _named(terrain.classes, path),
        "cell_m": terrain.cell_m,
        "grid": terrain.grid,
        "origin_m": terrain.origin_m,
        "cells": terrain.cells,
        "margin_m": terrain.margin_m,
        "requests": terrain.requests,
        "start_m": terrain.start_m,
        "goal_m": terrain.goal_m,
        "yaw": terrain.yaw or None,
        "directions": terrain.directions if terrain.yaw and len(terrain.directions) < len(Direction) else None,
        "laid": None if terrain.laid is None else {k: v for k, v in asdict(terrain.laid).items() if v != ""},
    }
    lines = [f"{key}: {json.dumps(_rounded(value))}" for key, value in head.items() if value is not None]
    lines.append("polygons:")
    given = ({"vertices_m": _rounded(one.vertices_m.tolist()), "friction": one.friction} for one in terrain.polygons)
    lines += [f"- {json.dumps(one)}" for one in given]
    write_text_whole(path, "\n".join(lines) + "\n")


def _named(classes: ClassSet, path: Path) -> str:
    """Return how a file refers to a set of classes: by its name, or by the file of its rules."""
    return classes.name if classes.source is None else os.path.relpath(classes.source.resolve(), path.parent.resolve())


def _rounded(value: Any) -> Any:
    if isinstance(value, list | tuple):
        return [_rounded(one) for one in value]
    return round(value, 9) if isinstance(value, float) else value


class _Reading:
    """What only several keys together tell about a terrain file."""

    def __init__(self, path: Path, document: Document, block: TerrainBlock) -> None:
        self.path, self.lines, self.block = path, document.lines, block
        self.problems: list[InputError] = []

    def complain(self, message: str, *loc: str | int) -> None:
        known: Loc = next((loc[:size] for size in range(len(loc), -1, -1) if loc[:size] in self.lines), ())
        line = self.lines.get(known)
        self.problems.append(InputError(message, source=self.path, line=line, key=dotted(loc) or None))

    def stop(self) -> None:
        if self.problems:
            raise FileProblems(self.problems)

    def terrain(self) -> QuadrupedTerrain:
        block = self.block
        rules, scan = self.classes(), self.polygons()
        self.robot(block.robot)
        rows, columns = block.grid
        if rows % 2 == 0 or columns % 2 == 0:
            self.complain("needs two odd numbers, so that the robot stands in the middle, such as [3, 3]", "grid")
        for number, (row, column) in enumerate(block.requests or ()):
            if not (0 <= row < rows and 0 <= column < columns):
                self.complain(
                    f"[{row}, {column}] lies outside of the grid; allowed are rows 0 to {rows - 1} and columns 0 to "
                    f"{columns - 1}",
                    "requests",
                    number,
                )
        if block.directions is not None and (not block.yaw or len(set(block.directions)) != len(block.directions)):
            message = "is a choice of different directions for a robot that turns: give `yaw: true` too"
            self.complain(message, "directions")
        if rules is None or scan is None:
            raise FileProblems(self.problems)
        self.check_overlaps(scan.polygons)
        self.stop()
        cell_m = block.cell_m or rules.cell_m
        origin, cells = self.extent(scan.polygons, cell_m)
        self.stop()
        margins = (block.margin_m, scan.margin_m, rules.margin_m)
        terrain = QuadrupedTerrain(
            block.name, block.robot or rules.robot, rules, cell_m, block.grid, origin, cells, scan.polygons,
            next(one for one in margins if one is not None), block.requests, block.start_m, block.goal_m, self.path,
            block.yaw, tuple(Direction) if block.directions is None else tuple(map(Direction, block.directions)),
            None if block.laid is None else Laid(**block.laid.model_dump()),
            self.path.parent / block.polygons if isinstance(block.polygons, str) else None,
        )  # fmt: skip
        self.check_places(terrain)
        self.stop()
        return terrain

    def classes(self) -> ClassSet | None:
        name = self.block.classes
        path = self.path.parent / name
        if name.endswith((".yaml", ".yml", ".json")):
            sets = read_classes(path)
            if len(sets) == 1:
                return next(iter(sets.values()))
            self.complain(f"{name} holds {len(sets)} sets of classes; one is allowed here", "classes")
            return None
        try:
            return class_set(name)
        except InputError as problem:
            self.complain(problem.message, "classes")
            return None

    def robot(self, name: str | None) -> None:
        try:
            if name is not None:
                quadruped(name)
        except InputError as problem:
            self.complain(problem.message, "robot")

    def polygons(self) -> Scan | None:
        given = self.block.polygons
        if isinstance(given, str):
            return read_segmented(self.path.parent / given)
        if not given or len(given) > MOST_POLYGONS:
            self.complain(f"needs 1 to {MOST_POLYGONS} polygons, not {len(given)}", "polygons")
            return None
        found: list[Polygon] = []
        for number, one in enumerate(given):
            try:
                found.append(polygon(one.vertices_m, one.friction))
            except PolygonError as problem:
                self.complain(str(problem), "polygons", number, "vertices_m")
        return None if self.problems else Scan(tuple(found), None)

    def check_overlaps(self, polygons: Sequence[Polygon]) -> None:
        """Refuse polygons that lie above each other: nobody could tell where a foot would stand."""
        for a, b, apart in overlaps(polygons)[:_SHOWN]:
            self.complain(
                f"polygons {a} and {b} overlap at heights {apart * 100:.1f} cm apart; only {_APART_M * 100:g} cm, such "
                "as of crossing bars, are allowed",
                "polygons",
                b,
            )

    def extent(self, polygons: Sequence[Polygon], cell_m: float) -> tuple[Point, tuple[int, int]]:
        points = np.concatenate([one.vertices_m[:, :2] for one in polygons])
        low, high = points.min(axis=0), points.max(axis=0)
        origin = self.block.origin_m or (float(low[0]), float(low[1]))
        cells = self.block.cells or tuple(max(math.ceil(float(high[k] - origin[k]) / cell_m - 1e-6), 1) for k in (0, 1))
        if cells[0] * cells[1] > 10_000:
            self.complain(f"the map has {cells[0]} x {cells[1]} cells of {cell_m:g} m; allowed are 10000", "cells")
        return origin, (cells[0], cells[1])

    def check_places(self, terrain: QuadrupedTerrain) -> None:
        for key in ("start_m", "goal_m"):
            place = getattr(terrain, key)
            if place is None:
                continue
            try:
                cell = terrain.cell_at(place)
                if key == "start_m":
                    _ = LocalGrid(terrain, terrain.centre_m(cell)).state
            except InputError as problem:
                self.complain(problem.message, key)


def overlaps(polygons: Sequence[Polygon]) -> list[tuple[int, int, float]]:
    """Return pairs of polygons that overlap seen from above, and how far apart they are, where that is too far."""
    shapes = [shapely.Polygon(one.vertices_m[:, :2]) for one in polygons]
    first, second = shapely.STRtree(shapes).query(shapes, predicate="intersects")
    found = []
    for a, b in sorted(zip(first.tolist(), second.tolist(), strict=True)):
        if a < b:
            common = shapes[a].intersection(shapes[b])
            if common.area > _OVERLAP_M2:
                centre = common.centroid
                apart = abs(_height(polygons[a], centre.x, centre.y) - _height(polygons[b], centre.x, centre.y))
                if apart > _APART_M:
                    found.append((a, b, apart))
    return found


def _height(one: Polygon, x: float, y: float) -> float:
    return float((one.offset - one.normal[0] * x - one.normal[1] * y) / one.normal[2])

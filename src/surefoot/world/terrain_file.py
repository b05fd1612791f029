"""Terrain files (formats.md, kind ``terrain``): polygons, where they come from, and how good they are."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path

from surefoot import __version__
from surefoot.compute import sha256_of, write_text_whole
from surefoot.world.segmentation import SegmentOptions
from surefoot.world.terrain_polygons import Terrain

KIND, FORMAT = "terrain", 1


def write_terrain(
    path: Path, terrain: Terrain, options: SegmentOptions, source: Path, reading: Mapping[str, object]
) -> None:
    """Write a terrain file, whole or not at all.

    Args:
        path: of the file.
        terrain: what to write.
        options: the limits it was made with.
        source: the file or folder it was made from.
        reading: how that was read.
    """
    write_text_whole(path, json.dumps(terrain_document(terrain, options, source, reading, path.parent), indent=1))


def terrain_document(
    terrain: Terrain, options: SegmentOptions, source: Path, reading: Mapping[str, object], folder: Path
) -> dict[str, object]:
    """Return the document of a terrain file that stands in a folder."""
    return {
        "kind": KIND,
        "format": FORMAT,
        "surefoot": __version__,
        "made": datetime.now(UTC).isoformat(timespec="seconds"),
        "input": {
            "path": os.path.relpath(source.resolve(), folder.resolve()),
            "sha256": hash_of_input(source),
            "reading": dict(reading),
        },
        "options": dataclasses.asdict(options),
        "polygons": [
            {"vertices_m": polygon.vertices_m.tolist(), "friction": polygon.friction} for polygon in terrain.polygons
        ],
        "sources": [
            {"region": polygon.region, "normal": list(polygon.normal), "offset_m": polygon.offset_m}
            for polygon in terrain.polygons
        ],
        "regions": [dataclasses.asdict(region) for region in terrain.regions],
        "narrow": [dataclasses.asdict(thing) for thing in terrain.narrow],
        "statistics": statistics(terrain),
    }


def statistics(terrain: Terrain) -> dict[str, object]:
    """Return the measures of a terrain that files and commands show."""
    return {
        "area_m2": terrain.area_m2,
        "kept_share": terrain.kept_share,
        "ground_share": terrain.ground_share,
        "max_plane_error_m": terrain.max_plane_error_m,
        "max_cell_error_m": terrain.max_cell_error_m,
        "regions": len(terrain.regions),
        "pieces_per_region": terrain.pieces_per_region,
        "noise_m": terrain.noise_m,
        "time_s": terrain.time_s,
        "warnings": list(terrain.warnings),
    }


def hash_of_input(source: Path) -> str:
    """Return the SHA-256 of a file; of a folder, that of the lines ``name hash`` of its files in order."""
    if source.is_file():
        return sha256_of(source)
    lines = [f"{item.name} {sha256_of(item)}\n" for item in sorted(source.iterdir()) if item.is_file()]
    return hashlib.sha256("".join(lines).encode()).hexdigest()

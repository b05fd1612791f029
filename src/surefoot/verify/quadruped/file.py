"""Reads runs of a quadruped from docs/formats.md 12; nothing is trusted."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from surefoot.errors import InputError
from surefoot.verify.artefacts import check_kind, checked_file, parse_json, read_bytes, read_fields
from surefoot.verify.terrain.map import MapFile, read_map
from surefoot.verify.values import Fields

RECORDS = ("header", "prepared", "request", "segment", "failed", "event", "withdrawn", "violation", "detour", "end")
_MOST_RECORDS = 100_000


@dataclass(frozen=True, slots=True)
class QuadrupedRun:
    """A run log as it was read.

    Attributes:
        folder: of the run.
        header: its first record.
        records: the others.
        library: ``library.json`` of the skills; None where there was none.
        ground: the map.
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
    named = {checked_file(one, folder).resolve() for one in header.mappings("files", optional=True)}
    library = None
    if header.get("library") is not None:
        file = checked_file(header.mapping("library"), folder)
        library = read_fields(file, "skill-library")
    for record in lines[1:]:
        record.text("record", among=RECORDS[1:])
    ground = read_map(terrain, header.text("classes"))
    missing = [file.name for file in ground.files if file.resolve() not in named]
    if missing:
        raise header.wrong("files", f"has to name {missing[0]}, with its hash: {terrain.name} refers to it")
    return QuadrupedRun(folder, header, tuple(lines[1:]), library, ground)


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

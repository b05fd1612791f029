"""Readers of plan folders, written from formats.md 2; nothing in a file is trusted."""

from __future__ import annotations

import json
import os
import re
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.compute import sha256_of
from surefoot.errors import InputError
from surefoot.verify.values import Fields

LARGEST_JSON_BYTES = 64_000_000
LARGEST_ARRAYS_BYTES = 2_000_000_000
NAVIGATION_ARRAYS = {
    "cell": ("int32", 1),
    "heading": ("int8", 1),
    "visible": ("int32", 2),
    "hidden": ("uint8", 3),
    "goal": ("int16", 1),
    "order": ("int8", 1),
    "domain": ("int32", 1),
}
ACTION_ARRAYS = dict.fromkeys(("row", "column", "heading", "stance", "mode", "context", "action"), ("int16", 1))
Arrays = dict[str, NDArray[Any]]
_TOKENS = re.compile(r'"((?:[^"\\]|\\.)*)"\s*(:)?|-?Infinity|NaN')


@dataclass(frozen=True, slots=True)
class PlanFile:
    """A plan folder as it was read: values of ``plan.json``, and the arrays of its two strategies.

    Attributes:
        path: ``plan.json``.
        fields: its values.
        scenario_path: the scenario that it was made for, with the recorded hash.
        map_path: the map that it was made for, with the recorded hash.
        navigation: arrays of ``navigation.npz``.
        action: arrays of ``action.npz``.
    """

    path: Path
    fields: Fields
    scenario_path: Path
    map_path: Path
    image_path: Path
    navigation: Arrays
    action: Arrays


def read_plan(folder: Path) -> PlanFile:
    """Read a plan folder and check every recorded hash.

    Raises:
        InputError: a file is missing, truncated, stale or of another format.
    """
    path = folder / "plan.json"
    fields = read_fields(path, "biped-plan")
    fields.text("surefoot")
    if not fields.flag("realizable"):
        raise fields.wrong("realizable", "has to be true: an unrealizable scenario leaves no plan behind")
    if not fields.flag("verified"):
        raise fields.wrong("verified", "has to be true: a plan that its maker did not verify is no plan")
    scenario = checked_file(fields.mapping("scenario"), folder)
    places = fields.mapping("map")
    floor = checked_file(places, folder)
    image = checked_file(places, folder, "image_path", "image_sha256")
    files = fields.mapping("files")
    for name in ("navigation.npz", "action.npz"):
        _check_hash(folder / name, files.text(name), files.wrong(name, "does not hash to what plan.json says"))
    return PlanFile(
        path=path,
        fields=fields,
        scenario_path=scenario,
        map_path=floor,
        image_path=image,
        navigation=read_arrays(folder / "navigation.npz", NAVIGATION_ARRAYS, {"domain"}),
        action=read_arrays(folder / "action.npz", ACTION_ARRAYS, set()),
    )


def check_kind(fields: Fields, kind: str) -> None:
    """Refuse an artefact of another kind or format."""
    if fields.get("kind") != kind:
        raise fields.wrong("kind", f"has to be {kind}")
    if fields.get("format") != 1 or type(fields.get("format")) is not int:
        raise fields.wrong("format", "is not known; this version reads format 1, a whole number")


def read_fields(path: Path, kind: str) -> Fields:
    """Return the object of a JSON file of a kind, format 1."""
    fields = Fields.of(parse_json(read_bytes(path), path), path)
    check_kind(fields, kind)
    return fields


def checked_file(fields: Fields, folder: Path, path_key: str = "path", hash_key: str = "sha256") -> Path:
    """Return the file that a mapping names, after comparing its hash."""
    name = fields.text(path_key)
    if Path(name).is_absolute():
        raise fields.wrong(path_key, "has to be relative to the artefact's own folder")
    path = folder / name
    stale = fields.wrong(hash_key, f"does not fit {name}: the artefact was made from another version of that file")
    _check_hash(path, fields.text(hash_key), stale)
    return path


def _check_hash(path: Path, expected: str, stale: InputError) -> None:
    """Raise ``stale`` unless a file has the expected hash."""
    try:
        found = sha256_of(path)
    except (OSError, ValueError) as problem:
        raise InputError("cannot be read", source=os.path.normpath(path)) from problem
    if found != expected:
        raise stale


def read_bytes(path: Path) -> bytes:
    """Return the content of a file of moderate size."""
    try:
        if path.stat().st_size > LARGEST_JSON_BYTES:
            raise InputError(f"is larger than {LARGEST_JSON_BYTES} bytes", source=path)
        return path.read_bytes()
    except (OSError, ValueError) as problem:
        raise InputError("cannot be read", source=path) from problem


def parse_json(text: bytes, path: Path, line: int | None = None) -> object:
    """Return the value of a JSON text; NaN and infinities are no JSON.

    Args:
        text: the text.
        path: the file.
        line: where the text stands, for files of one record a line.
    """
    try:
        return json.loads(text.decode("utf-8"), parse_constant=_no_constant)
    except _NotFiniteError as problem:
        place, key = _not_finite_at(text.decode("utf-8"))
        message = f"holds {problem}, which is no number of JSON; numbers have to be finite"
        raise InputError(message, source=path, line=line or place, key=key) from problem
    except (ValueError, RecursionError) as problem:
        raise InputError("is not whole JSON in UTF-8", source=path, line=line) from problem


class _NotFiniteError(ValueError):
    """NaN, Infinity or -Infinity stands where JSON has a number."""


def _no_constant(name: str) -> object:
    raise _NotFiniteError(name)


def _not_finite_at(text: str) -> tuple[int, str | None]:
    """Return the line of the first NaN or infinity outside of texts, and the last key before it."""
    key, end = None, 0
    for token in _TOKENS.finditer(text):
        end = token.start()
        if not token[0].startswith('"'):
            break
        key = token[1] if token[2] else key
    return text.count("\n", 0, end) + 1, key


def read_arrays(path: Path, shapes: Mapping[str, tuple[str, int]], apart: set[str]) -> Arrays:
    """Return the arrays of an npz file; all but those ``apart`` have one length."""
    try:
        with zipfile.ZipFile(path) as archive:
            size = sum(item.file_size for item in archive.infolist())
        found = _loaded(path, shapes) if size <= LARGEST_ARRAYS_BYTES else {}
    except Exception as problem:  # what numpy and zipfile raise on broken bytes is open-ended
        raise InputError("is not a whole npz file of plain arrays", source=path) from problem
    if size > LARGEST_ARRAYS_BYTES:
        raise InputError(f"unpacks to more than {LARGEST_ARRAYS_BYTES} bytes", source=path)
    for name, (kind, axes) in shapes.items():
        if name not in found or found[name].dtype != np.dtype(kind) or found[name].ndim != axes:
            raise InputError(f"has to be an array of {kind} with {axes} axes", source=path, key=name)
    if len({len(found[name]) for name in shapes if name not in apart}) != 1:
        raise InputError("holds arrays of different lengths", source=path)
    return found


def _loaded(path: Path, shapes: Mapping[str, tuple[str, int]]) -> Arrays:
    """Return those arrays of a file that are asked for."""
    with np.load(path, allow_pickle=False) as archive:
        return {name: archive[name] for name in shapes if name in archive.files}

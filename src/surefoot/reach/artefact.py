"""Saved regions: arrays in an npz file, everything else in the JSON file beside it (docs/formats.md)."""

from __future__ import annotations

import hashlib
import json
import platform
import zipfile
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from surefoot.compute import sha256_of, write_text_whole, written_whole
from surefoot.documents import is_format, read_json_object
from surefoot.errors import InputError
from surefoot.reach.lattice import Lattice, lattice
from surefoot.reach.parameters import Disturbance, GridSpec, GuardTube, OmegaSet, Reading, Settings, Transition
from surefoot.reach.synthesis import HalfStep, Region

KIND, FORMAT = "step-region", 1
LARGEST_JSON_BYTES = 1_000_000
LARGEST_ARRAYS_BYTES = 4_000_000_000
_BITS = ("first_target", "first_won", "second_target", "second_won")
_MASKS = ("first_masks", "second_masks")


def masks_sha256(region: Region) -> str:
    """Return the SHA-256 of the masks: first half, then second half, columns first, little-endian 64-bit words."""
    digest = hashlib.sha256()
    for half in (region.first, region.second):
        digest.update(np.ascontiguousarray(half.masks).astype("<u8").tobytes())
    return digest.hexdigest()


def save_region(region: Region, path: Path) -> tuple[Path, Path]:
    """Write ``NAME.json`` and ``NAME.npz`` for a path with or without one of these endings; return both."""
    document_path, arrays_path = path.with_suffix(".json"), path.with_suffix(".npz")
    arrays: dict[str, Any] = {}
    for name, half in (("first", region.first), ("second", region.second)):
        arrays[f"{name}_masks"] = half.masks
        arrays[f"{name}_target"], arrays[f"{name}_won"] = half.target, half.won
    with written_whole(arrays_path) as stream:
        np.savez_compressed(stream, **arrays)
    write_text_whole(document_path, json.dumps(_document(region, arrays_path), indent=1) + "\n")
    return document_path, arrays_path


def load_region(path: Path) -> Region:
    """Read a saved region (its JSON or its npz file) and check its hashes.

    Raises:
        InputError: a file is missing, truncated, stale or of another version.
    """
    document_path, arrays_path = path.with_suffix(".json"), path.with_suffix(".npz")
    document = read_json_object(document_path, LARGEST_JSON_BYTES)
    if document.get("kind") != KIND:
        raise InputError(f"has to be {KIND}", source=document_path, key="kind")
    if not is_format(document.get("format"), FORMAT):
        raise InputError(f"is not known; this version reads format {FORMAT}", source=document_path, key="format")
    try:
        transition, settings = _inputs(document)
        masks_hash, file_hash = str(document["masks_sha256"]), str(document["arrays"]["sha256"])
        all_masks, time_s, notes = bool(document["all_masks"]), float(document["time_s"]), tuple(document["notes"])
    except InputError as problem:
        raise InputError(problem.message, source=document_path, key=problem.key) from problem
    except (KeyError, TypeError, ValueError) as problem:
        raise InputError("lacks a key of a step region, or holds a wrong value", source=document_path) from problem
    cells = lattice(settings.grid, transition.step_length_m, settings.omegas.words)
    arrays = _read_arrays(arrays_path, file_hash, cells, settings.omegas.words)
    omegas = settings.omegas.values_radps
    second = tuple(w * transition.second_omega_scale for w in omegas)
    halves = [
        HalfStep(foot, values, arrays[f"{name}_target"], arrays[f"{name}_won"], arrays[f"{name}_masks"])
        for name, foot, values in (
            ("first", transition.first_foot_m, omegas),
            ("second", transition.step_length_m, second),
        )
    ]
    region = Region(transition, settings, cells, halves[0], halves[1], all_masks, time_s, notes)
    if masks_sha256(region) != masks_hash:
        raise InputError("does not fit the masks", source=document_path, key="masks_sha256")
    return region


def _document(region: Region, arrays_path: Path) -> dict[str, Any]:
    from surefoot import __version__

    inputs = describe_inputs(region.transition, region.settings)
    return {
        "kind": KIND,
        "format": FORMAT,
        "surefoot": __version__,
        "versions": {"python": platform.python_version(), "numpy": np.__version__},
        **inputs,
        "inputs_sha256": inputs_sha256(region.transition, region.settings),
        "columns": region.cells.columns,
        "rows": region.cells.rows,
        "cells": region.counts,
        "area": region.area,
        "all_masks": region.all_masks,
        "masks_sha256": masks_sha256(region),
        "arrays": {"path": arrays_path.name, "sha256": sha256_of(arrays_path)},
        "time_s": region.time_s,
        "notes": list(region.notes),
    }


def describe_inputs(transition: Transition, settings: Settings) -> dict[str, Any]:
    """Return transition and settings as JSON values."""
    return {"transition": asdict(transition), "settings": asdict(settings)}


def inputs_sha256(transition: Transition, settings: Settings) -> str:
    """Return the SHA-256 of everything that a region depends on."""
    text = json.dumps(describe_inputs(transition, settings), sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def _inputs(document: Mapping[str, Any]) -> tuple[Transition, Settings]:
    given, settings = dict(document["transition"]), dict(document["settings"])
    low, high = given.pop("apex_velocity_mps")
    bound = settings["disturbance"]
    return Transition(apex_velocity_mps=(float(low), float(high)), **given), Settings(
        disturbance=Disturbance(Reading(bound["reading"]), float(bound["first"]), float(bound["second"])),
        tau_s=float(settings["tau_s"]),
        grid=GridSpec(**settings["grid"]),
        omegas=OmegaSet(**settings["omegas"]),
        guard=GuardTube(**settings["guard"]),
        target_half_width_m=float(settings["target_half_width_m"]),
    )


def _read_arrays(path: Path, expected_sha256: str, cells: Lattice, words: int) -> dict[str, Any]:
    try:
        found_sha256 = sha256_of(path)
        with zipfile.ZipFile(path) as archive:
            size = sum(item.file_size for item in archive.infolist())
        if size > LARGEST_ARRAYS_BYTES:
            raise InputError(f"unpacks to more than {LARGEST_ARRAYS_BYTES} bytes", source=path)
        with np.load(path, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in (*_BITS, *_MASKS) if name in archive.files}
    except (OSError, ValueError, zipfile.BadZipFile, EOFError, KeyError, NotImplementedError) as problem:
        raise InputError("is not a whole npz file of plain arrays", source=path) from problem
    if found_sha256 != expected_sha256:
        raise InputError("does not hash to what the JSON file beside it says", source=path)
    for names, kind, shape in ((_BITS, "bool", cells.shape), (_MASKS, "uint64", (*cells.shape, words))):
        for name in names:
            if name not in arrays or arrays[name].dtype != np.dtype(kind) or arrays[name].shape != shape:
                raise InputError(f"has to be an array of {shape} of {kind}", source=path, key=name)
    return arrays

"""Saving and loading transducers (docs/formats.md, section 4)."""

from __future__ import annotations

import json
import os
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from surefoot import __version__
from surefoot.compute import sha256_of, write_text_whole, written_whole
from surefoot.errors import InputError
from surefoot.logic.syntax import Specification, Variable
from surefoot.logic.transducer import Player, Transducer

Semantics = Literal["slugs", "robotics"]
LARGEST_IN_JSON = 400_000
LARGEST_BYTES = 64_000_000
LARGEST_ARRAYS_BYTES = 2_000_000_000
_ARRAYS = ("values", "memory", "first", "successors", "initial")
_OF_ENVIRONMENT = ("moves", "initial_inputs")


@dataclass(frozen=True, slots=True)
class SavedStrategy:
    """A strategy file as it was read.

    Attributes:
        transducer: the strategy.
        specification_path: where its specification was when it was saved.
        specification_sha256: the hash of that file.
        semantics: who picks the initial outputs.
        env_dead_end: whether the system ``wins`` or ``loses`` where the environment has no move.
    """

    transducer: Transducer
    specification_path: Path
    specification_sha256: str
    semantics: str
    env_dead_end: str


def save_strategy(
    path: Path,
    transducer: Transducer,
    specification: Specification,
    *,
    semantics: Semantics = "slugs",
    env_dead_end: Literal["wins", "loses"] = "wins",
) -> tuple[Path, ...]:
    """Save a strategy, its arrays beside it when they are large; return the files that were written.

    Raises:
        InputError: the specification comes from no file, or the place cannot be written.
    """
    if specification.source is None or not specification.sha256:
        raise InputError("a strategy is saved with the hash of its specification's file, and there is no file")
    arrays = {name: getattr(transducer, name) for name in (*_ARRAYS, *_OF_ENVIRONMENT)}
    arrays = {name: array for name, array in arrays.items() if array is not None}
    files: tuple[Path, ...] = (path,)
    if sum(array.size for array in arrays.values()) > LARGEST_IN_JSON:
        beside = path.with_suffix(".npz")
        with written_whole(beside) as stream:
            np.savez_compressed(stream, **arrays)
        kept: object = {"path": beside.name, "sha256": sha256_of(beside)}
        files = (path, beside)
    else:
        kept = {name: array.tolist() for name, array in arrays.items()}
    header = {
        "kind": "gr1-strategy",
        "format": 1,
        "surefoot": __version__,
        "specification": {
            "path": os.path.relpath(specification.source, path.parent),
            "sha256": specification.sha256,
        },
        "player": transducer.player,
        "semantics": semantics,
        "env_dead_end": env_dead_end,
        "inputs": [declared(v) for v in transducer.variables[: transducer.inputs]],
        "outputs": [declared(v) for v in transducer.variables[transducer.inputs :]],
        "arrays": kept,
    }
    write_text_whole(path, json.dumps(header, separators=(",", ":")) + "\n")
    return files


def load_strategy(path: Path) -> SavedStrategy:
    """Read a strategy to play or to export it; ``surefoot verify`` has a reader of its own.

    Raises:
        InputError: the file is missing, too large, or no strategy.
    """
    header = read_header(path, "gr1-strategy")
    try:
        inputs, outputs = (tuple(map(declared_variable, header[side])) for side in ("inputs", "outputs"))
        arrays = read_arrays(path, header["arrays"])
        environment = header["player"] == "environment"
        wanted = _ARRAYS + (_OF_ENVIRONMENT if environment else ())
        whole: dict[str, Any] = {name: _whole(np.asarray(arrays[name])) for name in wanted}
        nodes = len(whole["memory"])
        for name, width in (("values", len(inputs + outputs)), ("moves", len(inputs))):
            if name in whole and whole[name].size == 0:
                whole[name] = whole[name].reshape(nodes, width)
        player: Player = "environment" if environment else "system"
        transducer = Transducer(player=player, variables=inputs + outputs, inputs=len(inputs), **whole)
        _check_indices(transducer)
        place = header["specification"]
        return SavedStrategy(
            transducer,
            path.parent / str(place["path"]),
            str(place["sha256"]),
            str(header["semantics"]),
            str(header["env_dead_end"]),
        )
    except (KeyError, TypeError, ValueError, OverflowError, IndexError) as problem:
        raise InputError(f"is no whole strategy (docs/formats.md, 4): {problem}", source=path) from problem


def read_header(path: Path, kind: str) -> dict[str, Any]:
    """Return the JSON object of a file of some kind, format 1.

    Raises:
        InputError: it is missing, too large, or of another kind.
    """
    try:
        if path.stat().st_size > LARGEST_BYTES:
            raise InputError(f"is larger than {LARGEST_BYTES} bytes", source=path)
        header = json.loads(path.read_bytes())
    except OSError as problem:
        raise InputError(f"cannot be read: {problem.strerror}", source=path) from problem
    except (ValueError, RecursionError) as problem:
        raise InputError("is no JSON; a strategy is written by: surefoot synth SPEC -o FILE", source=path) from problem
    if not isinstance(header, dict) or header.get("kind") != kind or header.get("format") != 1:
        raise InputError(f"is no strategy of kind {kind}, format 1", source=path)
    return header


def read_arrays(path: Path, kept: dict[str, Any]) -> dict[str, Any]:
    """Return the arrays of a strategy: those given, or those of the npz file that is named.

    Raises:
        InputError: the file is missing, another one, too large, or no npz file of plain arrays.
    """
    if "path" not in kept:
        return kept
    beside = path.parent / Path(str(kept["path"])).name
    try:
        if sha256_of(beside) != kept["sha256"]:
            raise InputError("does not hash to what the strategy says", source=beside)
        with zipfile.ZipFile(beside) as archive:
            if sum(item.file_size for item in archive.infolist()) > LARGEST_ARRAYS_BYTES:
                raise InputError(f"unpacks to more than {LARGEST_ARRAYS_BYTES} bytes", source=beside)
        with np.load(beside, allow_pickle=False) as archive:
            return dict(archive)
    except (OSError, ValueError, EOFError, zipfile.BadZipFile, NotImplementedError) as problem:
        raise InputError("is not a whole npz file of plain arrays", source=beside) from problem


def _whole(array: NDArray[Any]) -> NDArray[np.int64]:
    """Return an array as whole numbers; an empty list has no type of its own."""
    return array.astype(np.int64, casting="safe" if array.size else "unsafe")


def _check_indices(transducer: Transducer) -> None:
    """Refuse successors and initial nodes that do not exist."""
    if (np.diff(transducer.first) < 0).any():
        raise ValueError("first falls")
    for name in ("successors", "initial"):
        array = getattr(transducer, name)
        if array.ndim != 1 or (array < 0).any() or (array >= transducer.nodes).any():
            raise ValueError(f"{name} names nodes that do not exist")
    for name, shape in (("moves", (transducer.nodes, transducer.inputs)), ("initial_inputs", (transducer.inputs,))):
        array = getattr(transducer, name)
        if array is not None and array.shape != shape:
            raise ValueError(f"{name} does not fit the inputs")


def declared(variable: Variable) -> dict[str, object]:
    """Return a variable for JSON."""
    if variable.is_boolean:
        return {"name": variable.name}
    return {"name": variable.name, "lower": variable.lower, "upper": variable.upper}


def declared_variable(value: dict[str, Any]) -> Variable:
    """Return the variable that a JSON object declares.

    Raises:
        KeyError, ValueError: it declares none.
    """
    limits = [value.get("lower"), value.get("upper")]
    if not isinstance(value["name"], str) or not all(limit is None or isinstance(limit, int) for limit in limits):
        raise ValueError("a variable has a name and, for an integer, both limits")
    return Variable(value["name"], *limits)

"""What files of strategies share: the header that names the specification, and arrays beside it (formats.md, 4)."""

from __future__ import annotations

import json
import os
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot import __version__
from surefoot.compute import sha256_of, write_text_whole, written_whole
from surefoot.documents import is_format, read_json_object
from surefoot.errors import InputError
from surefoot.logic.syntax import Specification, Variable

LARGEST_BYTES = 64_000_000
LARGEST_ARRAYS_BYTES = 2_000_000_000


@dataclass(frozen=True, slots=True)
class Origin:
    """What a strategy was made for.

    Attributes:
        specification_path: where its specification was when it was saved.
        specification_sha256: the hash of that file.
        semantics: who picks the initial outputs.
        env_dead_end: whether the system ``wins`` or ``loses`` where the environment has no move.
    """

    specification_path: Path
    specification_sha256: str
    semantics: str
    env_dead_end: str


def write_header(
    path: Path, kind: str, specification: Specification, variables: Sequence[Variable], inputs: int, **fields: object
) -> None:
    """Write the JSON object of a strategy.

    Args:
        path: where.
        kind: of the file.
        specification: what the strategy was made for; it comes from a file (see ``named_source``).
        variables: of the strategy, inputs first.
        inputs: how many of these are inputs.
        fields: the rest.
    """
    header = {
        "kind": kind,
        "format": 1,
        "surefoot": __version__,
        "specification": {
            "path": os.path.relpath(named_source(specification), path.parent),
            "sha256": specification.sha256,
        },
        "inputs": [_declared(v) for v in variables[:inputs]],
        "outputs": [_declared(v) for v in variables[inputs:]],
        **fields,
    }
    write_text_whole(path, json.dumps(header, separators=(",", ":")) + "\n")


def named_source(specification: Specification) -> Path:
    """Return the file that a specification comes from.

    Raises:
        InputError: it comes from none.
    """
    if specification.source is None or not specification.sha256:
        raise InputError("a strategy is saved with the hash of its specification's file, and there is no file")
    return specification.source


def write_arrays(path: Path, arrays: dict[str, NDArray[Any]]) -> tuple[Path, dict[str, str]]:
    """Write arrays beside a strategy; return the file and what the header says of it."""
    beside = path.with_suffix(".npz")
    with written_whole(beside) as stream:
        np.savez_compressed(stream, **arrays)  # type: ignore[arg-type]
    return beside, {"path": beside.name, "sha256": sha256_of(beside)}


def read_header(path: Path, kind: str) -> dict[str, Any]:
    """Return the JSON object of a file of some kind, format 1.

    Raises:
        InputError: it is missing, too large, or of another kind.
    """
    header = read_json_object(path, LARGEST_BYTES, hint="a strategy is written by: surefoot synth SPEC -o FILE")
    if header.get("kind") != kind or not is_format(header.get("format")):
        raise InputError(f"is no strategy of kind {kind}, format 1", source=path)
    return header


def read_variables(header: dict[str, Any]) -> tuple[tuple[Variable, ...], int]:
    """Return the variables that a header declares, inputs first, and how many of them are inputs.

    Raises:
        KeyError, TypeError, ValueError: it declares none.
    """
    inputs, outputs = (tuple(map(_declared_variable, header[side])) for side in ("inputs", "outputs"))
    return inputs + outputs, len(inputs)


def read_origin(path: Path, header: dict[str, Any]) -> Origin:
    """Return what a header says that the strategy was made for.

    Raises:
        KeyError, TypeError: it does not say.
    """
    place = header["specification"]
    return Origin(
        path.parent / str(place["path"]), str(place["sha256"]), str(header["semantics"]), str(header["env_dead_end"])
    )


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


def _declared(variable: Variable) -> dict[str, object]:
    """Return a variable for JSON."""
    if variable.is_boolean:
        return {"name": variable.name}
    return {"name": variable.name, "lower": variable.lower, "upper": variable.upper}


def _declared_variable(value: dict[str, Any]) -> Variable:
    """Return the variable that a JSON object declares.

    Raises:
        KeyError, ValueError: it declares none.
    """
    limits = [value.get("lower"), value.get("upper")]
    if not isinstance(value["name"], str) or not all(limit is None or isinstance(limit, int) for limit in limits):
        raise ValueError("a variable has a name and, for an integer, both limits")
    return Variable(value["name"], *limits)

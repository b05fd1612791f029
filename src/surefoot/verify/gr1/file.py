"""Reader of GR(1) strategies, written from formats.md 4; nothing in a file is trusted."""

from __future__ import annotations

import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.logic.readers import read_specification
from surefoot.logic.syntax import Specification
from surefoot.verify.artefacts import (
    LARGEST_ARRAYS_BYTES,
    checked_file,
    read_fields,
)
from surefoot.verify.values import Fields

NO_MOVE = -(2**31)
Ints = NDArray[np.int64]
_SHAPES = {"values": 2, "memory": 1, "first": 1, "successors": 1, "initial": 1, "moves": 2, "initial_inputs": 1}


@dataclass(frozen=True, slots=True, eq=False)
class StrategyFile:
    """A strategy and the specification it was made for.

    Attributes:
        specification: read from its file, whose hash fits.
        player: ``system`` or ``environment``.
        semantics: ``slugs`` or ``robotics``.
        env_dead_end: ``wins`` or ``loses``.
        values: (N, V) one row per node: inputs, then outputs.
        first: (N + 1,) offsets of the successors.
        successors: (E,) nodes.
        initial: (I,) nodes.
        moves: (N, inputs) of the environment; empty for the system.
        initial_inputs: (inputs,) of the environment; empty for the system.
    """

    specification: Specification
    player: str
    semantics: str
    env_dead_end: str
    values: Ints
    first: Ints
    successors: Ints
    initial: Ints
    moves: Ints
    initial_inputs: Ints


def read_strategy(path: Path, specification_path: Path | None = None) -> StrategyFile:
    """Read a strategy and its specification.

    Args:
        path: the JSON file.
        specification_path: where the specification is now; None: where the strategy says.

    Raises:
        InputError: a file is missing, malformed, or the specification is another one.
    """
    fields, specification = opened(path, "gr1-strategy", specification_path)
    player = fields.text("player", among=("system", "environment"))
    names = [name for name in _SHAPES if player == "environment" or name not in ("moves", "initial_inputs")]
    arrays = _arrays(fields, path, names)
    _check_shapes(fields, arrays, specification)
    empty = np.zeros((0, 0), dtype=np.int64)
    return StrategyFile(
        specification=specification,
        player=player,
        semantics=fields.text("semantics", among=("slugs", "robotics")),
        env_dead_end=fields.text("env_dead_end", among=("wins", "loses")),
        values=arrays["values"],
        first=arrays["first"],
        successors=arrays["successors"],
        initial=arrays["initial"],
        moves=arrays.get("moves", empty),
        initial_inputs=arrays.get("initial_inputs", np.zeros(0, dtype=np.int64)),
    )


def opened(path: Path, kind: str, specification_path: Path | None) -> tuple[Fields, Specification]:
    """Return the object of a file of a kind, and the specification that it was made for, whose variables it has."""
    fields = read_fields(path, kind)
    specification = _specification_of(fields, path, specification_path)
    _check_variables(fields, specification)
    return fields, specification


def _specification_of(fields: Fields, path: Path, given: Path | None) -> Specification:
    """Return the specification that a strategy was made for, from where it is now or where the strategy says."""
    place = fields.mapping("specification")
    expected = place.text("sha256")
    if given is None:
        name = place.text("path")
        if not (path.parent / name).is_file():
            raise place.wrong("path", f"names {name}, which is not there; say where it is with --spec")
        given = checked_file(place, path.parent)
    found = read_specification(given)
    if found.sha256 != expected:
        raise InputError(f"is not the specification that {path.name} was made for: the hashes differ", source=given)
    return found


def _check_variables(fields: Fields, specification: Specification) -> None:
    """Refuse a strategy over other variables than those of its specification."""
    for side, variables in (("inputs", specification.inputs), ("outputs", specification.outputs)):
        expected: list[dict[str, object]] = [
            {"name": v.name} if v.is_boolean else {"name": v.name, "lower": v.lower, "upper": v.upper}
            for v in variables
        ]
        if fields.items(side) != expected:
            raise fields.wrong(side, "are not the variables of the specification, in its order")


def _arrays(fields: Fields, path: Path, names: list[str]) -> dict[str, Ints]:
    kept = fields.mapping("arrays")
    if not kept.has("path"):
        listed = Fields.of({name: np.asarray(_listed(kept, name)) for name in names}, path, "arrays")
        return {name: whole_numbers(listed, name, _SHAPES[name]) for name in names}
    inside = arrays_beside(kept, path, names)
    return {name: whole_numbers(inside, name, _SHAPES[name]) for name in names}


def arrays_beside(kept: Fields, path: Path, names: Sequence[str]) -> Fields:
    """Return those arrays of the npz file beside a strategy that are asked for, as they are there.

    Raises:
        InputError: the file is missing, another one than was saved, too large, or no npz file of plain arrays.
    """
    beside = checked_file(kept, path.parent)
    try:
        with zipfile.ZipFile(beside) as archive:
            if sum(item.file_size for item in archive.infolist()) > LARGEST_ARRAYS_BYTES:
                raise InputError(f"unpacks to more than {LARGEST_ARRAYS_BYTES} bytes", source=beside)
        with np.load(beside, allow_pickle=False) as archive:
            found: dict[str, Any] = {name: archive[name] for name in names if name in archive.files}
    except (OSError, ValueError, zipfile.BadZipFile, EOFError, KeyError, NotImplementedError) as problem:
        raise InputError("is not a whole npz file of plain arrays", source=beside) from problem
    return Fields.of(found, beside, "arrays")


def _listed(kept: Fields, name: str) -> list[object]:
    value = kept.get(name)
    try:
        rows = value if isinstance(value, list) else [None]
        array = np.asarray(rows) if rows else np.zeros((0,) * _SHAPES[name], dtype=np.int64)
    except (ValueError, OverflowError) as problem:
        raise kept.wrong(name, "has to be lists of whole numbers, all of one length") from problem
    return array  # type: ignore[return-value]


def whole_numbers(kept: Fields, name: str, axes: int) -> Ints:
    """Return an array of whole numbers with so many axes."""
    value = kept.get(name)
    if not isinstance(value, np.ndarray) or value.ndim != axes:
        raise kept.wrong(name, f"has to be an array with {axes} axes")
    if value.size == 0:
        return np.zeros(value.shape, dtype=np.int64)
    if value.dtype.kind != "i" or (np.abs(value.astype(np.int64)) > 2**40).any():
        raise kept.wrong(name, "has to hold whole numbers")
    return value.astype(np.int64)


def _check_shapes(fields: Fields, arrays: dict[str, Ints], specification: Specification) -> None:
    """Refuse arrays that do not fit together."""
    first, inputs, nodes = arrays["first"], len(specification.inputs), len(arrays["memory"])
    shapes: dict[str, tuple[int, ...]] = {
        "values": (nodes, len(specification.variables)),
        "memory": (nodes,),
        "first": (nodes + 1,),
    }
    shapes |= {"moves": (nodes, inputs), "initial_inputs": (inputs,)}
    for name, shape in shapes.items():
        if name in arrays and arrays[name].size == 0 and 0 in shape:
            arrays[name] = arrays[name].reshape(shape)
        if name in arrays and arrays[name].shape != shape:
            raise fields.wrong(f"arrays.{name}", f"has to have the shape {shape}")
    if first[0] != 0 or first[-1] != len(arrays["successors"]) or (np.diff(first) < 0).any():
        raise fields.wrong("arrays.first", "has to rise from 0 to the number of successors")
    for name in ("successors", "initial"):
        if (arrays[name] < 0).any() or (arrays[name] >= nodes).any():
            raise fields.wrong(f"arrays.{name}", f"has to hold nodes from 0 to {nodes - 1}")

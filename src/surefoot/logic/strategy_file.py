"""Saving and loading transducers (docs/formats.md, section 4)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.logic.saved_file import (
    Origin,
    named_source,
    read_arrays,
    read_header,
    read_origin,
    read_variables,
    write_arrays,
    write_header,
)
from surefoot.logic.syntax import Specification
from surefoot.logic.transducer import EnvDeadEnd, Player, Semantics, Transducer

KIND = "gr1-strategy"
LARGEST_IN_JSON = 400_000
_ARRAYS = ("values", "memory", "first", "successors", "initial")
_OF_ENVIRONMENT = ("moves", "initial_inputs")


@dataclass(frozen=True, slots=True)
class SavedStrategy:
    """A strategy file as it was read.

    Attributes:
        transducer: the strategy.
        origin: what it was made for.
    """

    transducer: Transducer
    origin: Origin


def save_strategy(
    path: Path,
    transducer: Transducer,
    specification: Specification,
    *,
    semantics: Semantics = "slugs",
    env_dead_end: EnvDeadEnd = "wins",
) -> tuple[Path, ...]:
    """Save a strategy, its arrays beside it when they are large; return the files that were written.

    Raises:
        InputError: the specification comes from no file, or the place cannot be written.
    """
    named_source(specification)
    arrays = {name: getattr(transducer, name) for name in (*_ARRAYS, *_OF_ENVIRONMENT)}
    arrays = {name: array for name, array in arrays.items() if array is not None}
    files: tuple[Path, ...] = (path,)
    if sum(array.size for array in arrays.values()) > LARGEST_IN_JSON:
        beside, kept = write_arrays(path, arrays)
        files = (path, beside)
    else:
        kept = {name: array.tolist() for name, array in arrays.items()}
    write_header(
        path,
        KIND,
        specification,
        transducer.variables,
        transducer.inputs,
        player=transducer.player,
        semantics=semantics,
        env_dead_end=env_dead_end,
        arrays=kept,
    )
    return files


def load_strategy(path: Path) -> SavedStrategy:
    """Read a strategy to play or to export it; ``surefoot verify`` has a reader of its own.

    Raises:
        InputError: the file is missing, too large, or no strategy.
    """
    header = read_header(path, KIND)
    try:
        variables, inputs = read_variables(header)
        arrays = read_arrays(path, header["arrays"])
        environment = header["player"] == "environment"
        wanted = _ARRAYS + (_OF_ENVIRONMENT if environment else ())
        whole: dict[str, Any] = {name: _whole(np.asarray(arrays[name])) for name in wanted}
        nodes = len(whole["memory"])
        for name, width in (("values", len(variables)), ("moves", inputs)):
            if name in whole and whole[name].size == 0:
                whole[name] = whole[name].reshape(nodes, width)
        player: Player = "environment" if environment else "system"
        transducer = Transducer(player=player, variables=variables, inputs=inputs, **whole)
        _check_indices(transducer)
        return SavedStrategy(transducer, read_origin(path, header))
    except (KeyError, TypeError, ValueError, OverflowError, IndexError) as problem:
        raise InputError(f"is no whole strategy (docs/formats.md, 4): {problem}", source=path) from problem


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

"""Saving and loading rankings (docs/formats.md, section 4)."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from surefoot import __version__
from surefoot.compute import sha256_of, write_text_whole, written_whole
from surefoot.errors import InputError
from surefoot.logic.ranking import ARRAYS, SINGLE, Ranking
from surefoot.logic.strategy_file import Semantics, declared, declared_variable, read_arrays, read_header
from surefoot.logic.syntax import Specification

KIND = "gr1-ranking"


@dataclass(frozen=True, slots=True)
class SavedRanking:
    """A ranking file as it was read.

    Attributes:
        ranking: the strategy.
        specification_path: where its specification was when it was saved.
        specification_sha256: the hash of that file.
        semantics: who picks the initial outputs.
        env_dead_end: whether the system ``wins`` or ``loses`` where the environment has no move.
    """

    ranking: Ranking
    specification_path: Path
    specification_sha256: str
    semantics: str
    env_dead_end: str


def save_ranking(
    path: Path,
    ranking: Ranking,
    specification: Specification,
    *,
    semantics: Semantics = "slugs",
    env_dead_end: Literal["wins", "loses"] = "wins",
) -> tuple[Path, ...]:
    """Save a ranking, its arrays in an npz file beside it; return the files that were written.

    Raises:
        InputError: the specification comes from no file, or the place cannot be written.
    """
    if specification.source is None or not specification.sha256:
        raise InputError("a strategy is saved with the hash of its specification's file, and there is no file")
    beside = path.with_suffix(".npz")
    with written_whole(beside) as stream:
        np.savez_compressed(stream, **ranking.arrays())
    header = {
        "kind": KIND,
        "format": 1,
        "surefoot": __version__,
        "specification": {
            "path": os.path.relpath(specification.source, path.parent),
            "sha256": specification.sha256,
        },
        "player": "system",
        "semantics": semantics,
        "env_dead_end": env_dead_end,
        "inputs": [declared(v) for v in ranking.variables[: ranking.inputs]],
        "outputs": [declared(v) for v in ranking.variables[ranking.inputs :]],
        "arrays": {"path": beside.name, "sha256": sha256_of(beside)},
    }
    write_text_whole(path, json.dumps(header, separators=(",", ":")) + "\n")
    return path, beside


def load_ranking(path: Path) -> SavedRanking:
    """Read a ranking to play it; ``surefoot verify`` has a reader of its own.

    Raises:
        InputError: the file is missing, too large, or no ranking.
    """
    header = read_header(path, KIND)
    try:
        inputs, outputs = (tuple(map(declared_variable, header[side])) for side in ("inputs", "outputs"))
        found = read_arrays(path, header["arrays"])
        arrays: dict[str, Any] = {name: np.asarray(found[name]).astype(np.int32, casting="safe") for name in ARRAYS}
        arrays |= {name: int(arrays[name]) for name in SINGLE}
        place = header["specification"]
        return SavedRanking(
            Ranking(variables=inputs + outputs, inputs=len(inputs), **arrays),
            path.parent / str(place["path"]),
            str(place["sha256"]),
            str(header["semantics"]),
            str(header["env_dead_end"]),
        )
    except (KeyError, TypeError, ValueError, OverflowError, IndexError) as problem:
        raise InputError(f"is no whole ranking (docs/formats.md, 4): {problem}", source=path) from problem

"""Saving and loading rankings (docs/formats.md, section 4)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from surefoot.errors import InputError
from surefoot.logic.ranking import ARRAYS, SINGLE, Ranking
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
from surefoot.logic.transducer import EnvDeadEnd, Semantics

KIND = "gr1-ranking"


@dataclass(frozen=True, slots=True)
class SavedRanking:
    """A ranking file as it was read.

    Attributes:
        ranking: the strategy.
        origin: what it was made for.
    """

    ranking: Ranking
    origin: Origin


def save_ranking(
    path: Path,
    ranking: Ranking,
    specification: Specification,
    *,
    semantics: Semantics = "slugs",
    env_dead_end: EnvDeadEnd = "wins",
) -> tuple[Path, ...]:
    """Save a ranking, its arrays in an npz file beside it; return the files that were written.

    Raises:
        InputError: the specification comes from no file, or the place cannot be written.
    """
    named_source(specification)
    beside, kept = write_arrays(path, ranking.arrays())
    write_header(
        path,
        KIND,
        specification,
        ranking.variables,
        ranking.inputs,
        player="system",
        semantics=semantics,
        env_dead_end=env_dead_end,
        arrays=kept,
    )
    return path, beside


def load_ranking(path: Path) -> SavedRanking:
    """Read a ranking to play it; ``surefoot verify`` has a reader of its own.

    Raises:
        InputError: the file is missing, too large, or no ranking.
    """
    header = read_header(path, KIND)
    try:
        variables, inputs = read_variables(header)
        found = read_arrays(path, header["arrays"])
        arrays: dict[str, Any] = {name: np.asarray(found[name]).astype(np.int32, casting="safe") for name in ARRAYS}
        arrays |= {name: int(arrays[name]) for name in SINGLE}
        return SavedRanking(Ranking(variables=variables, inputs=inputs, **arrays), read_origin(path, header))
    except (KeyError, TypeError, ValueError, OverflowError, IndexError) as problem:
        raise InputError(f"is no whole ranking (docs/formats.md, 4): {problem}", source=path) from problem

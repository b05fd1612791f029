"""Reader of rankings, written from formats.md 4; nothing in a file is trusted."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from surefoot.logic.syntax import Specification
from surefoot.verify.gr1.file import Ints, arrays_beside, opened, whole_numbers
from surefoot.verify.values import Fields

_SINGLE = ("env_init", "sys_init", "winning")
_COLUMNS = ("order", "variable", "low", "high", "environment", "system", "goals", "justices")
_LAYERS = ("first", "layers", "waits_for")


@dataclass(frozen=True, slots=True, eq=False)
class RankingFile:
    """A ranking and the specification it was made for.

    Attributes:
        specification: read from its file, whose hash fits.
        semantics: ``slugs`` or ``robotics``.
        env_dead_end: ``wins`` or ``loses``.
        arrays: as in the file, int64, with all indices in their ranges.
    """

    specification: Specification
    semantics: str
    env_dead_end: str
    arrays: dict[str, Ints]


def read_ranking(path: Path, specification_path: Path | None = None) -> RankingFile:
    """Read a ranking and its specification.

    Args:
        path: the JSON file.
        specification_path: where the specification is now; None: where the ranking says.

    Raises:
        InputError: a file is missing, malformed, or the specification is another one.
    """
    fields, specification = opened(path, "gr1-ranking", specification_path)
    fields.text("player", among=("system",))
    kept = arrays_beside(fields.mapping("arrays"), path, (*_SINGLE, *_COLUMNS, *_LAYERS))
    arrays = {name: whole_numbers(kept, name, 0 if name in _SINGLE else 1) for name in (*_SINGLE, *_COLUMNS, *_LAYERS)}
    _check_table(kept, arrays, sum(len(variable.bits) for variable in specification.variables))
    _check_indices(kept, arrays)
    return RankingFile(
        specification=specification,
        semantics=fields.text("semantics", among=("slugs", "robotics")),
        env_dead_end=fields.text("env_dead_end", among=("wins", "loses")),
        arrays=arrays,
    )


def _check_table(kept: Fields, arrays: dict[str, Ints], bits: int) -> None:
    """Refuse rows that are no ordered decision diagrams."""
    rows = len(arrays["variable"])
    if not np.array_equal(np.sort(arrays["order"]), np.arange(bits)):
        raise kept.wrong("order", f"has to hold the bits 0 to {bits - 1}, each once")
    if rows < 2:
        raise kept.wrong("variable", "has to begin with two constants")
    variable = arrays["variable"][2:]
    if (variable < 0).any() or (variable >= 2 * bits).any():
        raise kept.wrong("variable", f"has to hold variables from 0 to {2 * bits - 1}, after the two constants")
    level = np.concatenate([[2 * bits, 2 * bits], variable])
    for name in ("low", "high"):
        part = arrays[name][2:]
        if len(part) != len(variable) or (part < 0).any() or (part >= np.arange(2, rows)).any():
            raise kept.wrong(name, "has to name an earlier row in every row")
        if (level[part] <= variable).any():
            raise kept.wrong(name, "has to lead to rows that decide later variables")


def _check_indices(kept: Fields, arrays: dict[str, Ints]) -> None:
    rows, goals, layers = len(arrays["variable"]), len(arrays["goals"]), len(arrays["layers"])
    for name in (*_SINGLE, "environment", "system", "goals", "justices", "layers"):
        if (arrays[name] < 0).any() or (arrays[name] >= rows).any():
            raise kept.wrong(name, f"has to hold rows from 0 to {rows - 1}")
    first = arrays["first"]
    if not goals or len(first) != goals + 1 or first[0] != 0 or first[-1] != layers or (np.diff(first) < 1).any():
        raise kept.wrong("first", "has to rise from 0 to the number of layers, once for every goal")
    waits = arrays["waits_for"]
    if len(waits) != layers or (waits < -1).any() or (waits >= len(arrays["justices"])).any():
        raise kept.wrong("waits_for", "has to hold a justice or -1 for every layer")

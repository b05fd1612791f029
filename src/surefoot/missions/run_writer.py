"""Writes run.jsonl, a record a line, flushed at once (docs/formats.md, section 3)."""

from __future__ import annotations

import json
import os
import re
from dataclasses import fields, is_dataclass
from enum import Enum
from pathlib import Path
from types import TracebackType
from typing import IO, Any

from surefoot.errors import InputError

DRAWN = frozenset({"map.png", "belief.png", "phase_space.png", "keyframes.png", "timeline.png"})
"""Pictures that `surefoot view` puts beside a log."""
_OWN = re.compile(r"replan_[0-9]+\.npz|step_[0-9]+\.png")


class RunWriter:
    """A run log that is being written; what has happened is on disk when the process dies.

    Args:
        folder: the run folder; an older log there is replaced, and what was planned and drawn for it is removed; a
            folder without a log, but with other content, is refused.
    """

    def __init__(self, folder: Path) -> None:
        path = folder / "run.jsonl"
        self.folder = folder
        if folder.exists() and not folder.is_dir():
            raise InputError("is a file; name a folder for the run", source=folder)
        if folder.is_dir() and any(folder.iterdir()) and not path.is_file():
            raise InputError("is a folder with other content; name a new one or one with an older run", source=folder)
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._stream: IO[str] = path.open("w", encoding="utf-8")
            for old in folder.iterdir():
                if old.name in DRAWN or _OWN.fullmatch(old.name):
                    old.unlink()
        except OSError as problem:
            raise InputError(f"cannot be written: {problem.strerror}", source=path) from problem

    def __enter__(self) -> RunWriter:
        """Return itself."""
        return self

    def __exit__(
        self, _kind: type[BaseException] | None, _problem: BaseException | None, _trace: TracebackType | None
    ) -> None:
        """Close the log."""
        self._stream.flush()
        os.fsync(self._stream.fileno())
        self._stream.close()

    def write(self, record: str, **content: Any) -> None:
        """Append one record and flush it."""
        self._stream.write(json.dumps({"record": record, **content}, default=plain, allow_nan=False) + "\n")
        self._stream.flush()


def plain(value: Any) -> Any:
    """Return a value in terms of JSON: enumerations by lower-case name, dataclasses as mappings, arrays as lists."""
    if isinstance(value, Enum):
        return value.name.lower()
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: getattr(value, field.name) for field in fields(value)}
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"cannot write a {type(value).__name__} into a log")

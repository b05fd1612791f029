"""Deadlines, artefacts that are written whole or not at all, and hashes of inputs."""

from __future__ import annotations

import hashlib
import os
import resource
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from surefoot.errors import InputError, LimitExceeded


@dataclass(frozen=True, slots=True)
class Deadline:
    """A point in time after which work is given up.

    Attributes:
        end_s: on the monotonic clock; infinite means no deadline.
    """

    end_s: float = float("inf")

    @classmethod
    def after(cls, seconds: float | None) -> Deadline:
        """Return the deadline that many seconds from now; None means none."""
        return cls() if seconds is None else cls(time.monotonic() + seconds)

    def check(self, work: str) -> None:
        """Raise LimitExceeded, naming the work, once the time is over."""
        if time.monotonic() > self.end_s:
            raise LimitExceeded(f"{work}: the time limit was reached")


@contextmanager
def written_whole(path: Path) -> Iterator[IO[bytes]]:
    """Open a file that appears under its name only when the block ends without an error.

    Args:
        path: where the artefact belongs; its folder is made if it is missing.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    except OSError as problem:
        raise InputError(f"cannot be written: {problem.strerror}", source=path) from problem
    temporary = Path(name)
    try:
        with os.fdopen(handle, "wb") as stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
        temporary.chmod(0o644)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def write_text_whole(path: Path, text: str) -> None:
    """Write a text file whole or not at all."""
    with written_whole(path) as stream:
        stream.write(text.encode())


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of a file as 64 hexadecimal digits."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def peak_memory_mb() -> float:
    """Return the largest resident size that this process has had [MB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e6

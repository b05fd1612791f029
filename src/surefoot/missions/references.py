"""How artefacts of missions name their inputs: path and hash, so that a changed one is noticed."""

from __future__ import annotations

import os
from pathlib import Path

from surefoot.compute import sha256_of


def reference(path: Path, folder: Path) -> dict[str, str]:
    """Return path (relative to a folder) and hash of an input."""
    return {"path": os.path.relpath(path.resolve(), folder.resolve()), "sha256": sha256_of(path)}

"""JSON files that other programs write: one object, of a bounded size."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from surefoot.errors import InputError


def read_json_object(path: Path, most_bytes: int, *, hint: str = "") -> dict[str, Any]:
    """Return the object that a JSON file holds.

    Args:
        path: of the file.
        most_bytes: how large it may be.
        hint: said when it is no JSON, such as what writes these files.

    Raises:
        InputError: it cannot be read, is too large, or holds something else.
    """
    try:
        if path.stat().st_size > most_bytes:
            raise InputError(f"is larger than the {most_bytes} bytes that are allowed", source=path)
        document = json.loads(path.read_text("utf-8"))
    except OSError as problem:
        raise InputError(f"cannot be read: {problem.strerror}", source=path) from problem
    except (ValueError, RecursionError) as problem:
        raise InputError("; ".join(filter(None, ("is not whole JSON in UTF-8", hint))), source=path) from problem
    if not isinstance(document, dict):
        raise InputError("holds no JSON object, which is expected", source=path)
    return document

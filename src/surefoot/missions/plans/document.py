"""Reads plan.json (docs/formats.md, section 2), without what walking a plan needs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from surefoot.documents import is_format, read_json_object
from surefoot.errors import InputError

LARGEST_PLAN_BYTES = 50_000_000


def read_plan_document(folder: Path) -> dict[str, Any]:
    """Return the content of plan.json.

    Raises:
        InputError: if the folder holds no plan of this version.
    """
    path = folder / "plan.json"
    if not path.is_file():
        raise InputError("holds no plan.json; make a plan with: surefoot plan SCENARIO -o FOLDER", source=folder)
    document = read_json_object(path, LARGEST_PLAN_BYTES)
    if document.get("kind") != "biped-plan" or not is_format(document.get("format")):
        raise InputError("is not a plan of format 1 and kind biped-plan", source=path)
    return document

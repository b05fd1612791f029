"""Pictures of single results: the regions of a step, a foothold plan, a library of skills."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from surefoot.errors import InputError

_LARGEST_BYTES = 200_000_000


def draw_json(path: Path, out: Path) -> tuple[Path, ...]:
    """Draw what a JSON file holds: a foothold plan, or the regions of a step.

    Args:
        path: the file.
        out: the folder for the picture.

    Raises:
        InputError: it cannot be read, or is neither.
    """
    kind = _kind(path)
    if kind == "foothold-plan":
        from surefoot.viewer.footholds import draw_plan, read_foothold_plan

        picture = out / f"{path.stem}.png"
        draw_plan(read_foothold_plan(path), picture)
        return (picture,)
    if kind == "step-region":
        from surefoot.reach import load_region
        from surefoot.viewer.omegas import draw_omegas
        from surefoot.viewer.regions import draw_region

        region = load_region(path)
        return draw_region(region, out / f"{path.stem}.png"), draw_omegas(region, out / f"{path.stem}_omegas.png")
    raise InputError("is no kind that can be drawn; allowed are foothold-plan and step-region", source=path, key="kind")


@dataclass(frozen=True, slots=True)
class _Classes:
    """The terrain classes of a library."""

    name: str
    names: Sequence[str]


def draw_library(folder: Path, out: Path) -> tuple[Path, ...]:
    """Draw a library of skills: what physics said of every primitive, and the classes if they are built in.

    Args:
        folder: of the library.
        out: the folder for the pictures.
    """
    from surefoot.skills.classes import class_set
    from surefoot.skills.library import read_library
    from surefoot.viewer.skills_terrain import draw_classes, draw_physics

    library = read_library(folder)
    name = str(library.made_with["classes"])
    results = sorted(library.knowledge.results.values(), key=lambda one: one.primitive)
    pictures = [draw_physics(_Classes(name, library.classes), results, out / "skills.png")]
    try:
        classes = class_set(name)
    except InputError:  # the user's own classes are not among the built-in ones
        return tuple(pictures)
    return (*pictures, draw_classes(classes, out / "classes.png"))


def _kind(path: Path) -> object:
    if path.stat().st_size > _LARGEST_BYTES:
        raise InputError(f"is larger than the {_LARGEST_BYTES} bytes that are allowed", source=path)
    try:
        document = json.loads(path.read_text("utf-8"))
    except (ValueError, RecursionError) as problem:
        raise InputError("cannot be read as JSON", source=path) from problem
    return document.get("kind") if isinstance(document, dict) else None

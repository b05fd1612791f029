"""Pictures of single results: the regions of a step, a foothold plan, ground, a library of skills."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from surefoot.errors import InputError


def draw_footholds(path: Path, out: Path) -> tuple[Path, ...]:
    """Draw a foothold plan: footholds, feet, base and forces.

    Args:
        path: the file.
        out: the folder for the picture.
    """
    from surefoot.viewer.sources.foothold_motion import read_foothold_plan
    from surefoot.viewer.terrain.footholds import draw_plan

    picture = out / f"{path.stem}.png"
    draw_plan(read_foothold_plan(path), picture)
    return (picture,)


def draw_regions(path: Path, out: Path) -> tuple[Path, ...]:
    """Draw the regions of a step, and their lowest and highest winning omegas.

    Args:
        path: the file.
        out: the folder for the pictures.
    """
    from surefoot.reach import load_region
    from surefoot.viewer.steps.omegas import draw_omegas
    from surefoot.viewer.steps.regions import draw_region

    region = load_region(path)
    return draw_region(region, out / f"{path.stem}.png"), draw_omegas(region, out / f"{path.stem}_omegas.png")


def draw_ground(path: Path, out: Path) -> tuple[Path, ...]:
    """Draw the terrain of a quadruped: polygons by height, and the class of every cell.

    Args:
        path: the file, or one that ``surefoot terrain segment`` made.
        out: the folder for the picture.
    """
    from surefoot.skills import read_terrain
    from surefoot.viewer.terrain.classes import draw_quadruped_terrain

    return (draw_quadruped_terrain(read_terrain(path), out / f"{path.stem}.png"),)


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
    from surefoot.viewer.terrain.classes import draw_classes, draw_physics

    library = read_library(folder)
    name = str(library.made_with["classes"])
    results = sorted(library.knowledge.results.values(), key=lambda one: one.primitive)
    pictures = [draw_physics(_Classes(name, library.classes), results, out / "skills.png")]
    try:
        classes = class_set(name)
    except InputError:  # the user's own classes are not among the built-in ones
        return tuple(pictures)
    return (*pictures, draw_classes(classes, out / "classes.png"))

"""A campaign of quadruped missions in a folder: what is measured is on disk at once, and is not measured twice."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from pydantic import TypeAdapter, ValidationError

from surefoot.compute import process_pool, write_text_whole
from surefoot.errors import InputError
from surefoot.skills import QuadrupedTerrain, TerrainSet, generated, make_library, read_library, terrain_set
from surefoot.skills.library import LIBRARY
from surefoot.skills.physics import PRELOAD
from surefoot.skills.terrain_checks import terrain_checks

SCENES = ("unstructured-4", "unstructured-8", "rebar-7", "rebar-14")
"""The scenes of Zhou et al. 2025, Fig. 8."""
Say = Callable[[str], None]
T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Campaign:
    """What is measured, and where it is kept.

    Attributes:
        folder: of everything; a later campaign in it goes on where this one stopped.
        scenes: of ``SCENES``.
        seeds: of the maps, the same for every scene.
        say: is told what is measured.
    """

    folder: Path
    scenes: Sequence[str] = SCENES
    seeds: Sequence[int] = (0,)
    say: Say = lambda _: None

    def place(self, scene: str, seed: int) -> Path:
        """Return the folder of a map."""
        return self.folder / scene / f"seed-{seed}"

    def library(self, scene: str) -> Path:
        """Return the folder of a scene's skills, which ``make_scene_library`` fills."""
        return self.folder / scene / "library"

    def once(self, reader: TypeAdapter[T], path: Path, measure: Callable[[], T]) -> T:
        """Return what was measured before, or measure it and keep it.

        Args:
            reader: of dataclasses of plain values.
            path: the file.
            measure: called where there is no such file.

        Raises:
            InputError: the file holds something else.
        """
        if path.is_file():
            try:
                return reader.validate_json(path.read_bytes())
            except ValidationError as refused:
                message = "holds no such measurement; remove the file, or name another folder"
                raise InputError(message, source=path) from refused
        value = measure()
        write_text_whole(path, reader.dump_json(value).decode() + "\n")
        return value


def make_scene_library(campaign: Campaign, scene: str) -> Path:
    """Make one library for the terrain states of a scene's maps, where there is none that has them; return its folder.

    Checks that are in the folder are not made again, so that more seeds may be added later.
    """
    folder = campaign.library(scene)
    joined = _joined([generated(scene, seed) for seed in campaign.seeds])
    if (folder / LIBRARY).is_file() and set(joined.pairs()) <= set(read_library(folder).pairs):
        return folder
    workers = len(os.sched_getaffinity(0))
    with process_pool(workers, preload=PRELOAD) as executor:
        checks = terrain_checks(generated(scene, 0), executor)
        make_library(joined, folder, checks, at_once=3 * workers, say=_briefly(campaign.say, scene))
    return folder


def _joined(terrains: Sequence[QuadrupedTerrain]) -> TerrainSet:
    sets = [terrain_set(terrain) for terrain in terrains]
    states = dict.fromkeys(state for one in sets for state in one.states)
    first = sets[0]
    name = first.classes.name
    return TerrainSet(name, first.cell_m, first.classes, first.robot, tuple(states), first.asked)


def _briefly(say: Say, scene: str) -> Say:
    """Leave out what a synthesis says about every single pair: there are thousands."""

    def told(message: str) -> None:
        if message.startswith(("checking", "asking", "going on")):
            say(f"{scene}, library: {message if len(message) < _LONGEST else message[:_LONGEST] + '...'}")

    return told


_LONGEST = 100

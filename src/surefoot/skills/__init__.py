"""Skills: classes of terrain, what physics certifies on them, and their composition by synthesis and repair."""

from __future__ import annotations

from surefoot.skills.classes import ClassSet, class_set, read_classes
from surefoot.skills.encoding import pair_specification
from surefoot.skills.grid import LocalGrid, TerrainSet, terrain_set
from surefoot.skills.library import SkillLibrary, read_library
from surefoot.skills.making import make_library
from surefoot.skills.manager import Knowledge, Outcome, PairAnswer, handle, synthesize_library
from surefoot.skills.physics import Limits, PhysicsOfClasses
from surefoot.skills.quadruped_terrain import QuadrupedTerrain
from surefoot.skills.terrain_file import read_terrain, write_terrain
from surefoot.skills.terrains import generated

__all__ = [
    "ClassSet",
    "Knowledge",
    "Limits",
    "LocalGrid",
    "Outcome",
    "PairAnswer",
    "PhysicsOfClasses",
    "QuadrupedTerrain",
    "SkillLibrary",
    "TerrainSet",
    "class_set",
    "generated",
    "handle",
    "make_library",
    "pair_specification",
    "read_classes",
    "read_library",
    "read_terrain",
    "synthesize_library",
    "terrain_set",
    "write_terrain",
]

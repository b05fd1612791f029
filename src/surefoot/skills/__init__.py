"""Skills: classes of terrain, what physics certifies on them, and their composition by synthesis and repair."""

from __future__ import annotations

from surefoot.skills.classes import ClassSet, class_set, read_classes
from surefoot.skills.encoding import pair_specification
from surefoot.skills.grid import LocalGrid, TerrainSet, terrain_set
from surefoot.skills.heading_encoding import heading_pair_specification
from surefoot.skills.headings import Turning, turning_of
from surefoot.skills.library import SkillLibrary, read_library
from surefoot.skills.making import make_library
from surefoot.skills.manager import Knowledge, Outcome, PairAnswer, handle, synthesize_library
from surefoot.skills.next_skill import NextSkill, next_skill, steps
from surefoot.skills.physics import Limits, PhysicsOfClasses
from surefoot.skills.quadruped_terrain import QuadrupedTerrain
from surefoot.skills.terrain_file import read_terrain, write_terrain
from surefoot.skills.terrains import generated

__all__ = [
    "ClassSet",
    "Knowledge",
    "Limits",
    "LocalGrid",
    "NextSkill",
    "Outcome",
    "PairAnswer",
    "PhysicsOfClasses",
    "QuadrupedTerrain",
    "SkillLibrary",
    "TerrainSet",
    "Turning",
    "class_set",
    "generated",
    "handle",
    "heading_pair_specification",
    "make_library",
    "next_skill",
    "pair_specification",
    "read_classes",
    "read_library",
    "read_terrain",
    "steps",
    "synthesize_library",
    "terrain_set",
    "turning_of",
    "write_terrain",
]

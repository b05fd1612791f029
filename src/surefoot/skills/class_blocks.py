"""The blocks of a file of terrain classes, as docs/formats.md lists them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from surefoot.documents import FormatOne
from surefoot.footholds.problem_blocks import Block

Name = Annotated[str, Field(min_length=1, max_length=40, pattern=r"^[A-Za-z0-9][A-Za-z0-9 _-]*$")]
Spacing = Annotated[float, Field(gt=0, le=10)] | Literal["single", "none"]
Rule = dict[str, Name | tuple[Name, ...]]
Rules = Annotated[tuple[Rule, ...], Field(min_length=1, max_length=100)]


class LevelBlock(Block):
    """A range of a measure: from where the level before ends to `below`."""

    name: Name
    below: Annotated[float, Field(ge=-1e4, le=1e4, description="the level ends here; left out for the last one")] | (
        None
    ) = None


class GroundBlock(Block):
    """The worst case of a class, a pattern within one cell."""

    pattern: Annotated[Literal["whole", "stones", "strips", "bars"], Field(description="whole, stones, strips, bars")]
    height_m: Annotated[float, Field(ge=-1, le=1, description="above where the robot stands")] = 0.0
    per_side: Annotated[int, Field(ge=1, le=20, description="stones along each side of the cell")] = 1
    spacing_m: Annotated[float, Field(ge=0, le=2, description="between stones")] = 0.0
    open_m: Annotated[float, Field(ge=0, le=2, description="between the two strips")] = 0.0
    across: Annotated[Spacing, Field(description="spacing of bars across the heading, or single, or none")] = "none"
    along: Annotated[Spacing, Field(description="spacing of bars along the heading, or single, or none")] = "none"


class ClassBlock(Block):
    """A class: rules that claim cells, and its worst case."""

    about: Annotated[str, Field(max_length=200)] = ""
    when: Annotated[Rules, Field(description="rules, any of which claims a cell")]
    ground: Annotated[GroundBlock, Field(description="the worst case of the class")]


class SetBlock(Block):
    """A set of classes."""

    about: Annotated[str, Field(max_length=200)] = ""
    robot: Annotated[str, Field(min_length=1, max_length=100)]
    cell_m: Annotated[float, Field(ge=0.1, le=5)]
    cells_m: Annotated[
        tuple[Annotated[float, Field(ge=0.1, le=5)], Annotated[float, Field(ge=0.1, le=5)]] | None,
        Field(description="least and largest side of the cells for which the rules make sense; default: cell_m only"),
    ] = None
    margin_m: Annotated[float, Field(ge=0, le=0.1, description="taken off every edge of the ground")] = 0.0
    measures: Annotated[Literal["ground", "bars"], Field(description="how cells are measured: ground or bars")]
    levels: Annotated[dict[str, tuple[LevelBlock, ...]], Field(min_length=1)]
    classes: Annotated[dict[Name, ClassBlock], Field(min_length=1, max_length=100)]
    easy: Annotated[
        tuple[tuple[Name, Name], ...],
        Field(max_length=1000, description="pairs of classes among which the first skills are looked for"),
    ] = ()
    obstacle: Annotated[Rules, Field(description="rules that claim a cell for the obstacles")]


class RulesBlock(Block):
    """A file of terrain classes."""

    format: FormatOne
    kind: Literal["terrain-classes"]
    sets: Annotated[dict[Name, SetBlock], Field(min_length=1, max_length=20)]

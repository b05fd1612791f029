"""The scenario of a biped mission: what `docs/formats.md` 1 allows, as frozen values.

``read_scenario`` is the boundary where untrusted text becomes values: every problem of a file is reported at once, with
its line, its dotted key and what is allowed. What only the map can tell (is the start free? can a goal be reached?) is
checked later, by whoever reads the map; ``Scenario.place`` gives the file, line and key for such a message.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, PrivateAttr, ValidationError, ValidationInfo, field_validator

from surefoot.documents import FileProblems, FormatOne, Loc, dotted, problems_of, read_yaml
from surefoot.errors import InputError
from surefoot.missions.scenario.blocks import (
    Block,
    GoalBlock,
    GridBlock,
    HeightsBlock,
    NavigationBlock,
    ObstacleBlock,
    RegionBlock,
    SensorBlock,
    StartBlock,
    WalkingBlock,
    some,
)
from surefoot.missions.scenario.checks import rectangle_problems, region_problems, several


class Scenario(Block):
    """A biped's mission: map, grid, start, goals, obstacles, what it sees, how it walks."""

    format: FormatOne
    kind: Annotated[Literal["biped"], Field(description="what kind of mission this is")]
    map: Annotated[
        str,
        Field(min_length=1, max_length=4096, description="ROS map_server YAML or black-and-white picture, relative"),
    ]
    map_resolution_m: Annotated[
        float | None, Field(gt=0, le=100, description="metres per pixel; only (and always) for a picture without YAML")
    ] = None
    grid: GridBlock
    robot: Annotated[str, Field(min_length=1, max_length=100, description="a name in surefoot.robots")] = "digit"
    start: StartBlock
    goals: Annotated[tuple[GoalBlock, ...], *some(1000), Field(description="visited in this order, for ever")]
    obstacles: Annotated[tuple[ObstacleBlock, ...], Field(max_length=16)] = ()
    sensor: SensorBlock
    belief_regions: Annotated[
        tuple[RegionBlock, ...], Field(max_length=256, description="the rest of the free cells is one more region")
    ] = ()
    heights: HeightsBlock = HeightsBlock()
    navigation: NavigationBlock = NavigationBlock()
    walking: WalkingBlock = WalkingBlock()

    _path: Path | None = PrivateAttr(default=None)
    _lines: dict[Loc, int] = PrivateAttr(default_factory=dict)

    @field_validator("map")
    @classmethod
    def _is_a_path(cls, path: str) -> str:
        if "\0" in path:
            raise ValueError("needs a path without NUL characters")
        return path

    @field_validator("map_resolution_m")
    @classmethod
    def _for_pictures(cls, resolution: float | None, info: ValidationInfo) -> float | None:
        name = info.data.get("map")
        if name is None:
            return resolution
        described = Path(name).suffix.lower() in {".yaml", ".yml"}
        if described and resolution is not None:
            raise ValueError("is only for a picture without YAML; this map's YAML file already says its resolution")
        if not described and resolution is None:
            raise ValueError("is required (metres per pixel), because the map is a picture without YAML")
        return resolution

    @field_validator("obstacles", "belief_regions", "heights")
    @classmethod
    def _rectangles_are_some(cls, value: Any, info: ValidationInfo) -> Any:
        grid = info.data.get("grid")
        if grid is not None and info.field_name is not None:
            several(rectangle_problems(value, (info.field_name,), grid.rotation_rad))
            if info.field_name == "belief_regions":
                several(region_problems(value, grid.cell_size_m, grid.origin_m, grid.rotation_rad))
        return value

    @property
    def path(self) -> Path | None:
        """The file that this was read from."""
        return self._path

    @property
    def map_path(self) -> Path:
        """The map, relative to the scenario's folder unless absolute."""
        return Path(self.map) if self._path is None else self._path.parent / self.map

    def place(self, *loc: str | int) -> dict[str, Any]:
        """Return where something stands, as keywords for an InputError.

        Args:
            loc: the keys and indices that lead to it, such as ``"goals", 1, "position_m"``; the nearest one that stands
                in the file gives the line.
        """
        known = next((loc[:size] for size in range(len(loc), -1, -1) if loc[:size] in self._lines), None)
        return {"source": self._path, "line": None if known is None else self._lines[known], "key": dotted(loc) or None}


def read_scenario(path: Path) -> Scenario:
    """Read and check a scenario file.

    Args:
        path: a YAML file as `docs/formats.md` 1 says.

    Raises:
        InputError: with every problem of the file, one sentence and one line of text each.
    """
    path = Path(path)
    document = read_yaml(path)
    problems = list(document.problems)
    if not isinstance(document.value, dict):
        raise InputError("must be a mapping of keys to values, such as `kind: biped`", source=path, line=1)
    try:
        scenario = Scenario.model_validate(document.value)
    except ValidationError as refused:
        problems += problems_of(refused, scenario_schema(), path, document.lines)
        raise FileProblems(problems) from None
    if problems:
        raise FileProblems(problems)
    scenario._path = path
    scenario._lines = document.lines
    return scenario


def scenario_schema() -> dict[str, Any]:
    """Return the JSON Schema of a scenario file."""
    schema = Scenario.model_json_schema()
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **schema,
        "title": "Surefoot biped scenario, format 1",
    }

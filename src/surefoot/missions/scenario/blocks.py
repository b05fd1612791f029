"""The blocks of a scenario file, as `docs/formats.md` 1 lists them."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationInfo, field_validator, model_validator
from pydantic_core import PydanticKnownError

_REACH_M = 1e5

Metres = Annotated[float, Field(ge=-_REACH_M, le=_REACH_M)]
Length = Annotated[float, Field(gt=0, le=_REACH_M)]
NotNegative = Annotated[float, Field(ge=0, le=1e6)]
Point = Annotated[tuple[Metres, Metres], Field(description="[x, y] in metres of the map")]
Costs = tuple[NotNegative, NotNegative, NotNegative, NotNegative]
Compass = Literal["north", "east", "south", "west"]
StepCells = Annotated[int, Field(ge=1, le=63)]
TurnCells = Annotated[float, Field(ge=0.1, le=63)]
ApexSpeed = Annotated[float, Field(ge=0.11, le=2)]


def _at_least_one(items: tuple[Any, ...]) -> tuple[Any, ...]:
    if not items:
        raise PydanticKnownError("too_short", {"field_type": "Tuple", "min_length": 1, "actual_length": 0})
    return items


def some(most: int) -> tuple[Any, Any]:
    """Return the annotations of a list of 1 to so many items.

    With ``min_length`` a list whose only item is refused would also be called empty.
    """
    return Field(max_length=most, json_schema_extra={"minItems": 1}), AfterValidator(_at_least_one)


def _two_corners(corners: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    if corners[:2] == corners[2:]:
        raise ValueError("needs two opposite corners [x0, y0, x1, y1] that differ")
    return corners


Rectangle = Annotated[
    tuple[Metres, Metres, Metres, Metres],
    AfterValidator(_two_corners),
    Field(description="two opposite corners [x0, y0, x1, y1] in metres of the map; the sides are parallel to the grid"),
]


class Block(BaseModel):
    """What all blocks share: unknown keys refused, no guessing of types, frozen, a key without a value is not given."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False, validate_default=True)

    @model_validator(mode="before")
    @classmethod
    def _drop_empty(cls, given: Any) -> Any:
        if not isinstance(given, dict):
            return given
        return {key: value for key, value in given.items() if value is not None or key not in cls.model_fields}


class GridBlock(Block):
    """How the map is cut into coarse cells."""

    cell_size_m: Annotated[float, Field(ge=0.1, le=100, description="side of a coarse cell")]
    origin_m: Annotated[Point, Field(description="a point where cell corners lie")] = (0.0, 0.0)
    rotation_rad: Annotated[
        float, Field(ge=-2 * math.pi, le=2 * math.pi, description="how the grid is turned, counter-clockwise")
    ] = 0.0
    unknown: Annotated[Literal["blocked", "free"], Field(description="what pixels of unknown occupancy count as")] = (
        "blocked"
    )


class StartBlock(Block):
    """Where the robot stands at first."""

    position_m: Point
    heading: Annotated[Compass, Field(description="a direction of the grid")]


class GoalBlock(Block):
    """A place to visit."""

    position_m: Point


class ForbiddenBlock(Block):
    """Where an obstacle never goes."""

    rectangle_m: Rectangle


class ObstacleBlock(Block):
    """A moving obstacle."""

    start_m: Annotated[Point, Field(description="where it is at the start, which the robot knows")]
    forbidden: Annotated[
        tuple[ForbiddenBlock, ...], Field(max_length=1000, description="where this obstacle never goes")
    ] = ()
    speed_cells: Annotated[int, Field(ge=1, le=3, description="how many cells it moves in a turn at most")] = 1


class SensorBlock(Block):
    """How far the robot sees."""

    range_m: Length


class RegionBlock(Block):
    """One belief region: the cells whose centres lie in one of the rectangles."""

    rectangles_m: Annotated[tuple[Rectangle, ...], *some(1000)]


class FloorBlock(Block):
    """Cells with a floor that is not at height 0."""

    rectangles_m: Annotated[tuple[Rectangle, ...], *some(1000)]
    height_m: Annotated[float, Field(ge=-100, le=100)]


class StairsBlock(Block):
    """A flight of stairs (rules.md 2)."""

    rectangle_m: Rectangle
    up: Annotated[Compass, Field(description="the direction of the grid in which the stairs climb")]
    risers: Annotated[int, Field(ge=1, le=1000, description="how many")]
    riser_m: Annotated[float, Field(gt=0, le=1, description="height of one riser")]
    tread_m: Annotated[float, Field(gt=0, le=10, description="depth of one tread")]
    first_riser_m: Annotated[
        float, Field(ge=0, le=1000, description="from the lower edge of the rectangle, along `up`")
    ]


class HeightsBlock(Block):
    """Floors and stairs; everywhere else the floor is flat, at 0."""

    floors: Annotated[tuple[FloorBlock, ...], Field(max_length=1000)] = ()
    stairs: Annotated[tuple[StairsBlock, ...], Field(max_length=1000)] = ()


class NavigationBlock(Block):
    """Options of the navigation game (rules.md 3 and 4)."""

    view: Annotated[
        Literal["post", "pre"], Field(description="obstacles are seen from the cell that is reached, or left")
    ] = "post"
    corners: Annotated[
        Literal["visible", "hidden"], Field(description="whether a line of sight may graze a blocked corner")
    ] = "visible"
    belief: Annotated[
        Literal["regions", "exact", "single", "automatic"] | None,
        Field(description="how precisely hidden obstacles are tracked; default: regions if there are some, else exact"),
    ] = None
    belief_precision: Annotated[
        float | None,
        Field(ge=0, le=1, description="of automatic belief regions: 0 is coarsest, 1 is finest; default 0.25"),
    ] = None
    belief_tracking: Annotated[
        Literal["joint", "separate"],
        Field(description="whether obstacles with the same domain and speed are interchangeable, or all told apart"),
    ] = "joint"

    @field_validator("belief_precision")
    @classmethod
    def _only_automatic(cls, precision: float | None, info: ValidationInfo) -> float | None:
        if precision is not None and info.data.get("belief", "automatic") != "automatic":
            raise ValueError("is only for belief: automatic")
        return precision


class WalkingBlock(Block):
    """Numbers of the gait. What is not given gets the default of `surefoot.walking.walking_parameters`.

    The ranges are those of `walking_parameters`, which also checks what depends on several keys.
    """

    fine_cells: Annotated[
        int | None,
        Field(ge=4, le=64, description="fine cells per side of a cell; default: one per 0.104 m, at least 26"),
    ] = None
    turn_angle_deg: Annotated[
        float | None, Field(ge=5, le=45, description="heading change of a turn step; must divide 90; default 22.5")
    ] = None
    straight_cells: Annotated[
        Annotated[tuple[StepCells, ...], *some(63)] | None,
        Field(description="lengths of straight steps in fine cells; default [4, 3, 2]"),
    ] = None
    pre_step_cells: Annotated[StepCells | None, Field(description="default 4")] = None
    stop_cells: Annotated[StepCells | None, Field(description="default 2")] = None
    turn_a_cells: Annotated[
        Annotated[tuple[TurnCells, ...], *some(18)] | None,
        Field(description="lengths of the steps of a turn away from the stance foot"),
    ] = None
    turn_b_cells: Annotated[
        Annotated[tuple[TurnCells, ...], *some(18)] | None,
        Field(description="lengths of the steps of a turn toward the stance foot"),
    ] = None
    side_band_cells: Annotated[
        int | None, Field(ge=0, le=31, description="kept free to the side of the robot; default 6")
    ] = None
    sagittal_outcomes_cells: Annotated[int | None, Field(ge=0, le=2, description="default 1")] = None
    lateral_outcomes_cells: Annotated[int | None, Field(ge=0, le=4, description="default 2")] = None
    max_step_height_m: Annotated[float | None, Field(ge=0, le=0.2, description="default 0.2")] = None
    safety_distance_m: Annotated[
        float | None, Field(ge=0.1, le=2, description="bound on foot to waypoint, sideways; default 0.52")
    ] = None
    apex_speed_mps: Annotated[
        tuple[ApexSpeed, ApexSpeed] | None, Field(description="[least, most]; default [0.2, 0.7]")
    ] = None
    steering_speed_max_mps: Annotated[
        ApexSpeed | None, Field(description="cap of the apex speed at a turn step; default 0.4")
    ] = None
    switch_speed_max_mps: Annotated[float | None, Field(ge=0.11, le=3, description="default 1.1")] = None
    dy1_m: Annotated[
        float | None, Field(ge=0, le=0.5, description="desired apex to waypoint, straight; default 0.10")
    ] = None
    dy2_m: Annotated[float | None, Field(ge=0.02, le=0.5, description="desired foot to apex; default 0.135")] = None
    cost_straight: Annotated[
        Costs | None, Field(description="[c1, c2, c3, c4] of Algorithm 1; default [1, 1, 0, 0]")
    ] = None
    cost_steering: Annotated[
        Costs | None, Field(description="[c1, c2, c3, c4] of Algorithm 1; default [7, 4, 0, 0]")
    ] = None
    desired_duration_s: Annotated[float | None, Field(ge=0.05, le=5, description="used by c3; default 0.45")] = None
    desired_width_m: Annotated[float | None, Field(ge=0, le=2, description="used by c4; default 0.45")] = None

    @field_validator("turn_angle_deg")
    @classmethod
    def _divides_90(cls, angle: float | None) -> float | None:
        if angle is not None and abs(round(90 / angle) * angle - 90) > 1e-6:
            raise ValueError("must divide 90, such as 15, 18, 22.5, 30 or 45")
        return angle

    @field_validator("turn_a_cells", "turn_b_cells")
    @classmethod
    def _whole_turn(cls, lengths: tuple[float, ...] | None, info: ValidationInfo) -> tuple[float, ...] | None:
        steps = round(90 / (info.data.get("turn_angle_deg") or 22.5))
        if lengths is not None and "turn_angle_deg" in info.data and len(lengths) != steps:
            raise ValueError(f"needs {steps} lengths, one for each step of a quarter turn, not {len(lengths)}")
        return lengths

    @field_validator("apex_speed_mps")
    @classmethod
    def _ascending(cls, speeds: tuple[float, float] | None) -> tuple[float, float] | None:
        if speeds is not None and speeds[0] > speeds[1]:
            raise ValueError("needs [least, most] with least below most, or both equal")
        return speeds

    def given(self) -> dict[str, Any]:
        """Return the keys that the scenario gives, for ``walking_parameters(cell_size_m, **given)``."""
        return {key: value for key in type(self).model_fields if (value := getattr(self, key)) is not None}

"""The blocks of a problem file, as docs/formats.md lists them."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, model_validator

from surefoot.documents import FormatOne

_REACH_M = 1e4

Metres = Annotated[float, Field(ge=-_REACH_M, le=_REACH_M)]
Angle = Annotated[float, Field(ge=-100, le=100)]
Point = tuple[Metres, Metres, Metres]
Positive = Annotated[float, Field(gt=0, le=1e6)]
Feet = tuple[Point, Point, Point, Point]


class Block(BaseModel):
    """What all blocks share: unknown keys refused, no guessing of types, frozen, a key without a value is not given."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False, validate_default=True)

    @model_validator(mode="before")
    @classmethod
    def _without_empty_keys(cls, given: Any) -> Any:
        if isinstance(given, dict):
            return {key: value for key, value in given.items() if value is not None or key not in cls.model_fields}
        return given


class GaitBlock(Block):
    """A gait written inline."""

    modes: Annotated[tuple[Annotated[str, Field(max_length=40)], ...], Field(min_length=1, max_length=1000)]
    switching_times_s: Annotated[tuple[float, ...], Field(min_length=2, max_length=1001)]


class StartBlock(Block):
    """The pose at the first sample."""

    position_m: Annotated[Point, Field(description="[x, y, z] of the base")]
    rpy_rad: Annotated[tuple[Angle, Angle, Angle], Field(description="roll, pitch, yaw")] = (0.0, 0.0, 0.0)
    feet_m: Annotated[
        Feet | None, Field(description="[x, y, z] of the feet FL, FR, RL, RR; default: nominal below the base")
    ] = None


class GoalBlock(Block):
    """The pose at the last sample."""

    position_m: Annotated[Point, Field(description="[x, y, z] of the base")]
    rpy_rad: Annotated[tuple[Angle, Angle, Angle], Field(description="roll, pitch, yaw")] = (0.0, 0.0, 0.0)


class PolygonBlock(Block):
    """A convex, planar polygon on which feet may stand."""

    vertices_m: Annotated[
        tuple[Point, ...], Field(min_length=3, max_length=200, description="[[x, y, z], ...], in either sense")
    ]
    friction: Annotated[float, Field(ge=0, le=10, description="coefficient of friction")] = 0.6


class RegionBlock(Block):
    """A convex region that is free of obstacles: a point p is inside when A p <= b."""

    A: Annotated[tuple[Point, ...], Field(min_length=1, max_length=100)]
    b: Annotated[tuple[Metres, ...], Field(min_length=1, max_length=100)]


class OptionsBlock(Block):
    """Switches and limits."""

    clearance_m: Annotated[
        float, Field(ge=0, le=2, description="height of swing feet above lift-off and touch-down")
    ] = 0.05
    collision: Annotated[bool, Field(description="keep every foot in one free region per window")] = False
    collision_windows: Annotated[int, Field(ge=1, le=200)] = 30
    moment_balance: Annotated[bool, Field(description="let forces turn the base, about levers of the reference")] = (
        False
    )
    tilt_max_rad: Annotated[
        float, Field(gt=0, le=4, description="with moment balance: largest deviation of each angle from its reference")
    ] = 0.35
    com_support_m: Annotated[
        Positive | None,
        Field(description="largest distance of the base from the mean of three or more feet in contact"),
    ] = None
    joint_reach: Annotated[
        bool, Field(description="keep feet where the legs reach with their joints' limits; not with gait: free")
    ] = False
    pitch_keyframe: Annotated[bool, Field(description="let the reference pitch pass the slope half way")] = False
    cell_s: Annotated[
        Positive, Field(description="gait: free: how long the cells are in which a foot is in contact or not")
    ] = 0.1
    min_dwell_cells: Annotated[
        int, Field(ge=1, le=1000, description="gait: free: how many cells a stance or a swing lasts at least")
    ] = 1
    gap: Annotated[float, Field(ge=1e-9, lt=1, description="relative gap at which the search stops")] = 1e-4
    first_plan: Annotated[bool, Field(description="whether the search stops at the first plan")] = False
    time_limit_s: Annotated[float, Field(gt=0, le=86400)] = 10.0


class WeightsBlock(Block):
    """Weights of the squared deviations (Table I)."""

    position: Positive = 1000.0
    orientation: Positive = 1000.0
    foot: Positive = 1000.0
    acceleration: Positive = 10.0
    angular_acceleration: Positive = 10.0
    foot_acceleration: Positive = 0.5
    force: Positive = 0.1


class ProblemBlock(Block):
    """A foothold problem: robot, gait, two poses, terrain."""

    format: FormatOne
    robot: Annotated[str, Field(min_length=1, max_length=4096, description="go2, chotu, or a robot file, relative")]
    gait: Annotated[
        str | GaitBlock,
        Field(
            description="a name, a file, {modes: [...], switching_times_s: [...]}, or free: the gait is to be found",
            union_mode="left_to_right",
        ),
    ]
    horizon_s: Annotated[Positive | None, Field(description="gait: free: how long the gait lasts")] = None
    step_s: Annotated[float, Field(ge=1e-3, le=1, description="time between samples")] = 0.025
    start: StartBlock
    goal: GoalBlock
    polygons: Annotated[tuple[PolygonBlock, ...], Field(min_length=1, max_length=500)]
    free_regions: Annotated[tuple[RegionBlock, ...], Field(max_length=50)] = ()
    options: OptionsBlock = OptionsBlock()
    weights: WeightsBlock = WeightsBlock()
    gravity_mps2: Annotated[float, Field(gt=0, le=100)] = 9.81


class RobotBlock(Block):
    """A robot file: the numbers of Table II, and of the legs."""

    format: FormatOne
    name: Annotated[str, Field(min_length=1, max_length=100)]
    mass_kg: Positive
    inertia_kgm2: tuple[Positive, Positive, Positive]
    foot_reference_m: Annotated[tuple[Positive, Positive, Metres], Field(description="of the front left foot")]
    foot_reach_m: tuple[Positive, Positive, Positive]
    joint_reference_rad: tuple[Angle, Angle, Angle] = (0.0, 0.72, -1.44)
    torque_max_nm: tuple[Positive, Positive, Positive]
    base_torque_max_nm: Positive = 30.0
    link_m: Positive = 0.213
    hip_offset_m: Annotated[float, Field(ge=0, le=10)] = 0.0955

"""Scenario files of a biped, read as formats.md 1 says."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import yaml

from surefoot.errors import InputError
from surefoot.frames import Direction
from surefoot.verify.values import Fields, Rectangle

LARGEST_BYTES = 4_000_000
BELIEFS = ("regions", "exact", "single", "automatic")
BY_SIZE = "by size"
FASTEST_CELLS = 3
HEADINGS = tuple(direction.name.lower() for direction in Direction)
_REQUIRED = ("format", "kind", "map", "grid", "start", "goals", "sensor")
_TOP = (*_REQUIRED, "map_resolution_m", "robot", "obstacles", "belief_regions", "heights", "navigation", "walking")
_WHOLE = {"pre_step_cells": 4, "stop_cells": 2, "side_band_cells": 6}
_OUTCOMES = {"sagittal_outcomes_cells": 1, "lateral_outcomes_cells": 2}
_NUMBERS = {
    "max_step_height_m": 0.2,
    "safety_distance_m": 0.52,
    "steering_speed_max_mps": 0.4,
    "switch_speed_max_mps": 1.1,
    "dy1_m": 0.10,
    "dy2_m": 0.135,
    "desired_duration_s": 0.45,
    "desired_width_m": 0.45,
}
_LISTS = {
    "apex_speed_mps": (0.2, 0.7),
    "cost_straight": (1.0, 1.0, 0.0, 0.0),
    "cost_steering": (7.0, 4.0, 0.0, 0.0),
}
TURNS = ("turn_a_cells", "turn_b_cells")
WALKING_KEYS = ("fine_cells", "turn_angle_deg", "straight_cells", *TURNS, *_WHOLE, *_OUTCOMES, *_NUMBERS, *_LISTS)


@dataclass(frozen=True, slots=True)
class FloorPart:
    """A part of the floor at its own height."""

    rectangles_m: tuple[Rectangle, ...]
    height_m: float


@dataclass(frozen=True, slots=True)
class StairsPart:
    """Stairs: risers across a rectangle, counted from its lower edge."""

    rectangle_m: Rectangle
    up: Direction
    risers: int
    riser_m: float
    tread_m: float
    first_riser_m: float


@dataclass(frozen=True, slots=True)
class ObstaclePart:
    """A moving obstacle: where it starts, where it never goes, and how many cells it moves in a turn at most."""

    start_m: tuple[float, float]
    forbidden: tuple[Rectangle, ...]
    speed_cells: int


@dataclass(frozen=True, slots=True)
class Scenario:
    """A scenario with the defaults of formats.md 1 filled in; ``walking`` leaves derived turn lengths out."""

    path: Path
    map_path: Path
    map_resolution_m: float | None
    cell_size_m: float
    origin_m: tuple[float, float]
    rotation_rad: float
    unknown_blocked: bool
    robot: str
    start_m: tuple[float, float]
    start_heading: Direction
    goals_m: tuple[tuple[float, float], ...]
    obstacles: tuple[ObstaclePart, ...]
    range_m: float
    regions: tuple[tuple[Rectangle, ...], ...]
    floors: tuple[FloorPart, ...]
    stairs: tuple[StairsPart, ...]
    view_post: bool
    corners_hide: bool
    belief: str
    tell_apart: bool
    walking: dict[str, float | tuple[float, ...]]


def read_scenario(path: Path) -> Scenario:
    """Read a scenario file.

    Raises:
        InputError: the file or one of its values cannot be used.
    """
    top = Fields.of(load_yaml(path), path)
    top.only(_TOP)
    if top.get("format") != 1 or type(top.get("format")) is not int or top.get("kind") != "biped":
        raise InputError("has to be of kind biped in format 1", source=path, key="kind")
    grid, start = top.mapping("grid"), top.mapping("start")
    grid.only(("cell_size_m", "origin_m", "rotation_rad", "unknown"))
    start.only(("position_m", "heading"))
    sensor = top.mapping("sensor")
    sensor.only(("range_m",))
    goals = top.mappings("goals")
    if not goals:
        raise top.wrong("goals", "has to name at least one goal")
    for goal in goals:
        goal.only(("position_m",))
    cell_size_m = grid.number("cell_size_m", least=1e-3)
    regions = tuple(_region(region) for region in top.mappings("belief_regions", optional=True))
    heights = top.mapping("heights", optional=True)
    heights.only(("floors", "stairs"))
    game = top.mapping("navigation", optional=True)
    game.only(("view", "corners", "belief", "belief_precision", "belief_tracking"))
    belief = game.text("belief", "regions" if regions else BY_SIZE, among=(*BELIEFS, BY_SIZE))
    if game.has("belief_precision") and belief != "automatic":
        raise game.wrong("belief_precision", "is only for belief: automatic")
    return Scenario(
        path=path,
        map_path=path.parent / top.text("map"),
        map_resolution_m=top.number("map_resolution_m", least=0) if top.has("map_resolution_m") else None,
        cell_size_m=cell_size_m,
        origin_m=grid.point("origin_m") if grid.has("origin_m") else (0.0, 0.0),
        rotation_rad=grid.number("rotation_rad", 0.0),
        unknown_blocked=grid.text("unknown", "blocked", among=("blocked", "free")) == "blocked",
        robot=top.text("robot", "digit"),
        start_m=start.point("position_m"),
        start_heading=Direction(HEADINGS.index(start.text("heading", among=HEADINGS))),
        goals_m=tuple(goal.point("position_m") for goal in goals),
        obstacles=tuple(_obstacle(part) for part in top.mappings("obstacles", optional=True)),
        range_m=sensor.number("range_m", least=0),
        regions=regions,
        floors=tuple(_floor(part) for part in heights.mappings("floors", optional=True)),
        stairs=tuple(_stairs(part) for part in heights.mappings("stairs", optional=True)),
        view_post=game.text("view", "post", among=("post", "pre")) == "post",
        corners_hide=game.text("corners", "visible", among=("visible", "hidden")) == "hidden",
        belief=belief,
        tell_apart=game.text("belief_tracking", "joint", among=("joint", "separate")) == "separate",
        walking=_walking(top.mapping("walking", optional=True), cell_size_m),
    )


def load_yaml(path: Path) -> object:
    """Return what a YAML file of moderate size holds."""
    try:
        if path.stat().st_size > LARGEST_BYTES:
            raise InputError(f"is larger than {LARGEST_BYTES} bytes", source=path)
        return yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as problem:
        raise InputError(f"cannot be read: {problem.strerror}", source=path) from problem
    except (yaml.YAMLError, UnicodeDecodeError, ValueError, RecursionError) as problem:
        raise InputError("is not readable YAML in UTF-8", source=path) from problem


def _region(fields: Fields) -> tuple[Rectangle, ...]:
    fields.only(("rectangles_m",))
    return fields.rectangles("rectangles_m")


def _obstacle(fields: Fields) -> ObstaclePart:
    fields.only(("start_m", "forbidden", "speed_cells"))
    forbidden = fields.mappings("forbidden", optional=True)
    for part in forbidden:
        part.only(("rectangle_m",))
    rectangles = tuple(part.rectangle("rectangle_m") for part in forbidden)
    return ObstaclePart(
        fields.point("start_m"), rectangles, fields.whole("speed_cells", 1, least=1, most=FASTEST_CELLS)
    )


def _floor(fields: Fields) -> FloorPart:
    fields.only(("rectangles_m", "height_m"))
    return FloorPart(fields.rectangles("rectangles_m"), fields.number("height_m"))


def _stairs(fields: Fields) -> StairsPart:
    fields.only(("rectangle_m", "up", "risers", "riser_m", "tread_m", "first_riser_m"))
    return StairsPart(
        rectangle_m=fields.rectangle("rectangle_m"),
        up=Direction(HEADINGS.index(fields.text("up", among=HEADINGS))),
        risers=fields.whole("risers", least=1, most=10_000),
        riser_m=fields.number("riser_m"),
        tread_m=fields.number("tread_m", least=0),
        first_riser_m=fields.number("first_riser_m", least=0),
    )


def _walking(fields: Fields, cell_size_m: float) -> dict[str, float | tuple[float, ...]]:
    """Return the walking block with its defaults; turn lengths only when they are given."""
    fields.only(WALKING_KEYS)
    found: dict[str, float | tuple[float, ...]] = {
        "fine_cells": fields.whole("fine_cells", max(26, math.floor(cell_size_m / 0.104 + 0.5)), least=1, most=1000),
        "turn_angle_deg": fields.number("turn_angle_deg", 22.5),
        "straight_cells": fields.wholes("straight_cells") if fields.has("straight_cells") else (4, 3, 2),
    }
    for name, default in (_WHOLE | _OUTCOMES).items():
        found[name] = fields.whole(name, default, least=0, most=1000)
    for name, value in _NUMBERS.items():
        found[name] = fields.number(name, value)
    for name, values in _LISTS.items():
        found[name] = fields.numbers(name, len(values), values)
    for name in TURNS:
        if fields.has(name):
            found[name] = fields.numbers(name)
    return found

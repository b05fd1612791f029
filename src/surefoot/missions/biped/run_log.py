"""Reads a run log (docs/formats.md, section 3) into frozen values, for viewers and other programs."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NoReturn

from pydantic import ConfigDict, TypeAdapter, ValidationError

from surefoot.documents import FormatOne
from surefoot.errors import InputError

MAX_BYTES = 300_000_000
MAX_LINE = 10_000_000

Place = tuple[float, float]
Point = tuple[float, float, float]
CellPair = tuple[int, int]
Compass = Literal["north", "east", "south", "west"]


@dataclass(frozen=True, slots=True)
class Reference:
    """An input of the run: its path relative to the run's folder, and its hash."""

    path: str
    sha256: str


@dataclass(frozen=True, slots=True)
class Header:
    """What was run: the inputs, the seed and how the obstacles moved."""

    kind: Literal["biped-run"]
    format: FormatOne
    surefoot: str
    versions: dict[str, str]
    scenario: Reference
    map: Reference
    plan: Reference
    seed: int
    policy: str
    steps: int
    kinds: tuple[tuple[int, ...], ...]
    breaks_assumptions: bool
    pushes: dict[str, str | float] | None = None


@dataclass(frozen=True, slots=True)
class Turn:
    """A decision, before its steps; cells are (row, column), ``visible`` and ``hidden`` per kind of obstacles.

    ``strategy`` is 0 for the plan's, j for that of the j-th replan, -1 when no strategy is trusted.
    """

    turn: int
    time_s: float
    cell: CellPair
    heading: Compass
    goal: int
    obstacles: tuple[CellPair, ...]
    visible: tuple[tuple[CellPair, ...], ...]
    hidden: tuple[tuple[CellPair, ...], ...]
    order: str
    strategy: int


@dataclass(frozen=True, slots=True)
class FinePlace:
    """A state of the action game."""

    row: int
    column: int
    heading: int
    stance: int
    mode: int
    context: int


@dataclass(frozen=True, slots=True)
class Outcome:
    """How far a step ended from its nominal fine cell."""

    sagittal: int
    lateral: int


@dataclass(frozen=True, slots=True)
class PlannedStep:
    """What a pushed step was to be."""

    next_foot_m: Point
    next_waypoint_m: Point
    next_apex_speed_mps: float
    first_half_s: float
    second_half_s: float


@dataclass(frozen=True, slots=True)
class StepPush:
    """A push, and how the step went on; arcs are pairs (duration, omega)."""

    time_s: float
    jump_mps: Place
    recovery: Literal["region", "step"]
    window_mps: Place | None
    omegas_before_switch: tuple[Place, ...]
    omegas_after_switch: tuple[Place, ...]
    put_off: bool
    planned: PlannedStep


@dataclass(frozen=True, slots=True)
class FallPush:
    """A push that nothing recovered."""

    time_s: float
    jump_mps: Place


@dataclass(frozen=True, slots=True)
class Fall:
    """The robot fell after a push; the pushed step has no record."""

    step: int
    time_s: float
    reason: str
    margin_mps: float
    push: FallPush


@dataclass(frozen=True, slots=True)
class Step:
    """A walking step, in map coordinates; the fields are those of docs/formats.md 3."""

    step: int
    turn: int
    time_s: float
    fine: FinePlace
    action: int
    outcome: Outcome
    yaw_rad: float
    heading_change_rad: float
    length_m: float
    height_change_m: float
    stance: Literal["left", "right"]
    waypoint_m: Point
    next_waypoint_m: Point
    com_m: Point
    velocity_mps: Place
    foot_m: Point
    next_foot_m: Point
    swing_from_m: Point
    swing_velocity_mps: Point
    swing_lift_m: Point
    omega_radps: float
    first_half_s: float
    second_half_s: float
    switch_m: Place
    switch_velocity_mps: Place
    next_com_m: Point
    next_velocity_mps: Place
    dy1_m: float
    dy2_m: float
    apex_speed_mps: float
    next_apex_speed_mps: float
    next_heading_changes_rad: tuple[float, ...]
    sign_alternates: bool
    dy2_in_range: bool
    rise_s: float | None = None
    rise_com_m: Point | None = None
    rest_s: float | None = None
    rest_com_m: Point | None = None
    closing_foot_m: Point | None = None
    transition: Literal["nominal", "forward", "backward", "left", "right"] = "nominal"
    moved_cells: CellPair = (0, 0)
    next_side_speed_mps: float | None = None
    push: StepPush | None = None


@dataclass(frozen=True, slots=True)
class Violation:
    """An assumption that the robot saw broken, before the turn of that number."""

    turn: int
    time_s: float
    violation: Literal["collides", "forbidden", "jumps", "appears", "vanishes"]
    kind: int
    cell: CellPair | None


@dataclass(frozen=True, slots=True)
class Replan:
    """A new navigation strategy, in force from the turn of that number on."""

    turn: int
    time_s: float
    strategy: int
    cell: CellPair
    heading: Compass
    goal: int
    visible: tuple[tuple[CellPair, ...], ...]
    hidden: tuple[tuple[CellPair, ...], ...]
    domains: tuple[tuple[CellPair, ...], ...]
    path: str
    sha256: str


@dataclass(frozen=True, slots=True)
class Unsafe:
    """The robot stopped, because no step satisfied the theorems."""

    step: int
    time_s: float
    reason: str


@dataclass(frozen=True, slots=True)
class End:
    """The end of a run that was not cut short."""

    steps: int
    turns_coarse: int
    goals_reached: tuple[int, ...]
    time_s: float


@dataclass(frozen=True, slots=True)
class Run:
    """A run log.

    Attributes:
        path: the file.
        header: what was run.
        turns: decisions, in order.
        steps: walking steps, in order.
        unsafe: moments without a safe step.
        falls: pushes that nothing recovered.
        violations: assumptions that the robot saw broken, in order.
        replans: new strategies, in order.
        end: None when the run was interrupted.
    """

    path: Path
    header: Header
    turns: tuple[Turn, ...]
    steps: tuple[Step, ...]
    unsafe: tuple[Unsafe, ...]
    falls: tuple[Fall, ...]
    violations: tuple[Violation, ...]
    replans: tuple[Replan, ...]
    end: End | None

    @property
    def folder(self) -> Path:
        """Return the run's folder; the paths in the header are relative to it."""
        return self.path.parent


_RECORDS = {
    "header": Header,
    "turn": Turn,
    "step": Step,
    "unsafe": Unsafe,
    "fall": Fall,
    "violation": Violation,
    "replan": Replan,
    "end": End,
}
for _type in (Reference, FinePlace, Outcome, PlannedStep, StepPush, FallPush, *_RECORDS.values()):
    setattr(_type, "__pydantic_config__", ConfigDict(strict=True, allow_inf_nan=False, extra="ignore"))  # noqa: B010


def read_run(path: Path, *, growing: bool = False) -> Run:
    """Read a run log.

    Args:
        path: the file ``run.jsonl``, or the folder that holds it.
        growing: whether a last line without its end is passed over, because it is still being written.

    Raises:
        InputError: if it cannot be read, was cut off in the middle of a line, or holds other records than a log does.
    """
    path = path / "run.jsonl" if path.is_dir() else path
    readers: dict[str, TypeAdapter[Any]] = {name: TypeAdapter(record) for name, record in _RECORDS.items()}
    found: dict[type, list[Any]] = {record: [] for record in _RECORDS.values()}
    for line, text in _lines(path, growing=growing):
        value = _record(text, readers, path, line)
        if not found[Header] and not isinstance(value, Header):
            raise InputError("the first record has to be the header of a biped-run", source=path, line=line)
        if isinstance(value, Turn | Step):
            _check_number(value, len(found[type(value)]), path, line)
        found[type(value)].append(value)
    if not found[Header]:
        raise InputError("is empty; a run log begins with a header", source=path)
    return Run(
        path,
        found[Header][0],
        tuple(found[Turn]),
        tuple(found[Step]),
        tuple(found[Unsafe]),
        tuple(found[Fall]),
        tuple(found[Violation]),
        tuple(found[Replan]),
        found[End][-1] if found[End] else None,
    )


def _lines(path: Path, *, growing: bool) -> list[tuple[int, bytes]]:
    if not path.is_file():
        raise InputError("does not exist; a run's folder holds run.jsonl", source=path)
    if path.stat().st_size > MAX_BYTES:
        raise InputError(f"is larger than the {MAX_BYTES} bytes that are allowed", source=path)
    with path.open("rb") as stream:
        lines = enumerate(stream, 1)
        return [(number, text) for number, text in lines if text.strip() and (text.endswith(b"\n") or not growing)]


def _record(text: bytes, readers: dict[str, TypeAdapter[Any]], path: Path, line: int) -> Any:
    if len(text) > MAX_LINE:
        raise InputError(f"a record is longer than the {MAX_LINE} bytes that are allowed", source=path, line=line)
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as problem:
        message = "is not a whole JSON record; the log was cut off or changed here"
        raise InputError(message, source=path, line=line) from problem
    kind = content.get("record") if isinstance(content, dict) else None
    if kind not in readers:
        allowed = ", ".join(readers)
        raise InputError(f"the record is of no known kind; allowed are {allowed}", source=path, line=line)
    try:
        return readers[kind].validate_json(text)
    except ValidationError as problem:
        _refuse(problem, kind, path, line)


def _refuse(problem: ValidationError, kind: str, path: Path, line: int) -> NoReturn:
    first = problem.errors(include_url=False)[0]
    key = ".".join(map(str, first["loc"]))
    message = f"{first['msg'][:1].lower()}{first['msg'][1:]} in the {kind} record"
    raise InputError(message, source=path, line=line, key=key or None) from None


def _check_number(value: Turn | Step, expected: int, path: Path, line: int) -> None:
    key = "turn" if isinstance(value, Turn) else "step"
    number = getattr(value, key)
    if number != expected:
        raise InputError(f"must be {expected}, the next number, not {number}", source=path, line=line, key=key)

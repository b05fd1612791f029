"""Reads run logs, from formats.md 3: one record a line, checked for kind, keys and types."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.frames import Direction
from surefoot.verify.artefacts import check_kind, checked_file, parse_json, read_bytes
from surefoot.verify.runs.push_file import TRANSITIONS, Fall, Push, Pushing, read_fall, read_push, read_pushing
from surefoot.verify.scene.scenario import HEADINGS
from surefoot.verify.values import Fields

Vector = NDArray[np.float64]
Cell = tuple[int, int]
_ORDERS = tuple(f"{verb} {name}" for verb in ("move", "wait") for name in HEADINGS)
_POINTS = ("waypoint_m", "next_waypoint_m", "com_m", "next_com_m", "foot_m", "next_foot_m")
_SWING = ("swing_from_m", "swing_velocity_mps", "swing_lift_m")
_PLANE = ("velocity_mps", "next_velocity_mps", "switch_m", "switch_velocity_mps")
_NUMBERS = (
    "yaw_rad heading_change_rad length_m height_change_m omega_radps first_half_s second_half_s dy1_m dy2_m "
    "apex_speed_mps next_apex_speed_mps"
)
POLICIES = ("random", "adversarial", "scripted")
NUMBERS = tuple(_NUMBERS.split())
VECTORS = {**dict.fromkeys((*_POINTS, *_SWING), 3), **dict.fromkeys(_PLANE, 2)}


@dataclass(frozen=True, slots=True)
class Turn:
    """A decision of the navigation strategy; order 0-3 is a move, 4-7 a wait."""

    line: int
    turn: int
    time_s: float
    cell: Cell
    heading: Direction
    goal: int
    obstacles: tuple[Cell, ...]
    visible: tuple[tuple[Cell, ...], ...]
    hidden: tuple[tuple[Cell, ...], ...]
    order: int
    strategy: int


@dataclass(frozen=True, slots=True)
class Violation:
    """An obstacle broke an assumption, as the robot saw at the end of the turn before."""

    line: int
    turn: int
    time_s: float
    name: str
    kind: int
    cell: Cell | None


@dataclass(frozen=True, slots=True)
class Replan:
    """A strategy that was planned in the middle of a walk, from what was known then."""

    line: int
    turn: int
    time_s: float
    strategy: int
    cell: Cell
    heading: Direction
    goal: int
    visible: tuple[tuple[Cell, ...], ...]
    hidden: tuple[tuple[Cell, ...], ...]
    domains: tuple[tuple[Cell, ...], ...]
    path: Path


@dataclass(frozen=True, slots=True)
class Support:
    """A double support: how long it lasts, and where the centre of mass rests at its far end."""

    lasts_s: float
    com_m: Vector


@dataclass(frozen=True, slots=True)
class Step:
    """A walking step; numbers and vectors are kept under the names of formats.md."""

    line: int
    step: int
    turn: int
    time_s: float
    core: tuple[int, int, int, int, int]
    context: int
    action: int
    sagittal: int
    lateral: int
    stance: int
    numbers: dict[str, float]
    vectors: dict[str, Vector]
    next_heading_changes_rad: tuple[float, ...]
    sign_alternates: bool
    dy2_in_range: bool
    rise: Support | None
    rest: Support | None
    closing_foot_m: Vector | None
    transition: str | None
    moved: tuple[int, int]
    side_speed_mps: float | None
    push: Push | None

    @property
    def duration_s(self) -> float:
        """Return the time from apex to apex."""
        return self.numbers["first_half_s"] + self.numbers["second_half_s"]


@dataclass(frozen=True, slots=True)
class Unsafe:
    """The robot stopped because no step satisfied the theorems."""

    line: int
    step: int


Record = Turn | Step | Unsafe | Fall | Violation | Replan


@dataclass(frozen=True, slots=True)
class End:
    """What the run says of itself."""

    line: int
    steps: int
    turns_coarse: int
    goals_reached: tuple[int, ...]
    time_s: float


@dataclass(frozen=True, slots=True)
class RunFile:
    """A run log.

    Attributes:
        plan_folder: the plan that was walked.
        steps: how many steps were to be walked.
        kinds: the obstacles of every kind.
        breaks_assumptions: whether the obstacles may break their assumptions.
        pushing: which pushes the header allows.
        records: everything between header and end, in the order of the file.
        end: the end record; None when the log just ends.
    """

    plan_folder: Path
    steps: int
    kinds: tuple[tuple[int, ...], ...]
    breaks_assumptions: bool
    pushing: Pushing
    records: tuple[Record, ...]
    end: End | None


def read_run(folder: Path) -> RunFile:
    """Read a run folder and check the hashes in its header.

    Raises:
        InputError: a line is truncated or malformed, or an input is missing or stale.
    """
    path = folder / "run.jsonl"
    lines = read_bytes(path).splitlines()
    if not lines:
        raise InputError("is empty; it has to begin with a header", source=path)
    header = _fields(lines[0], path, 1)
    if header.text("record") != "header":
        raise header.wrong("record", "has to be header in the first line")
    plan_folder = _check_header(header, folder)
    records: list[Record] = []
    end = None
    for number, text in enumerate(lines[1:], start=2):
        if end is not None:
            raise InputError("follows the end record, which has to be the last", source=path, line=number)
        fields = _fields(text, path, number)
        kind = fields.text("record", among=(*_READERS, "replan", "end"))
        if kind == "end":
            end = _end(fields, number)
        else:
            records.append(_replan(fields, number, folder) if kind == "replan" else _READERS[kind](fields, number))
    return RunFile(
        plan_folder=plan_folder,
        steps=header.whole("steps", least=0),
        kinds=tuple(header.lists_of_wholes("kinds")),
        breaks_assumptions=header.flag("breaks_assumptions"),
        pushing=read_pushing(header, folder),
        records=tuple(records),
        end=end,
    )


def _fields(text: bytes, path: Path, line: int) -> Fields:
    return Fields.of(parse_json(text, path, line), path, line=line)


def _check_header(header: Fields, folder: Path) -> Path:
    """Check kind, format and hashes; return the folder of the plan."""
    check_kind(header, "biped-run")
    header.text("surefoot")
    seed = header.get("seed")
    if type(seed) is not int or seed < 0:
        raise header.wrong("seed", "has to be a whole number, at least 0")
    policy = header.text("policy", among=POLICIES)
    if header.flag("breaks_assumptions") and policy != "scripted":
        raise header.wrong("breaks_assumptions", "can only be true with policy scripted")
    checked_file(header.mapping("scenario"), folder)
    checked_file(header.mapping("map"), folder)
    plan = header.mapping("plan")
    given = folder / plan.text("path")
    inside = given / "plan.json" if given.is_dir() else given
    checked_file(Fields({**plan.values, "path": _relative(inside, folder)}, plan.source, plan.place, plan.line), folder)
    return inside.parent


def _relative(path: Path, folder: Path) -> str:
    """Return a path below or beside a folder as text relative to it."""
    return str(path.relative_to(folder)) if path.is_relative_to(folder) else str(path)


def _turn(fields: Fields, line: int) -> Turn:
    return Turn(
        line=line,
        turn=fields.whole("turn", least=0),
        time_s=fields.number("time_s"),
        cell=fields.cell("cell"),
        heading=Direction(HEADINGS.index(fields.text("heading", among=HEADINGS))),
        goal=fields.whole("goal", least=0),
        obstacles=fields.cells("obstacles"),
        visible=fields.lists_of_cells("visible"),
        hidden=fields.lists_of_cells("hidden"),
        order=_ORDERS.index(fields.text("order", among=_ORDERS)),
        strategy=fields.whole("strategy", least=-1),
    )


def _violation(fields: Fields, line: int) -> Violation:
    return Violation(
        line=line,
        turn=fields.whole("turn", least=0),
        time_s=fields.number("time_s"),
        name=fields.text("violation"),
        kind=fields.whole("kind", least=0),
        cell=fields.cell("cell") if _given(fields, "cell") else None,
    )


def _replan(fields: Fields, line: int, folder: Path) -> Replan:
    return Replan(
        line=line,
        turn=fields.whole("turn", least=0),
        time_s=fields.number("time_s"),
        strategy=fields.whole("strategy", least=1),
        cell=fields.cell("cell"),
        heading=Direction(HEADINGS.index(fields.text("heading", among=HEADINGS))),
        goal=fields.whole("goal", least=0),
        visible=fields.lists_of_cells("visible"),
        hidden=fields.lists_of_cells("hidden"),
        domains=fields.lists_of_cells("domains"),
        path=checked_file(fields, folder),
    )


def _step(fields: Fields, line: int) -> Step:
    fine, outcome = fields.mapping("fine"), fields.mapping("outcome")
    row, column, heading = (fine.whole(name, least=0, most=10_000) for name in ("row", "column", "heading"))
    core = (row, column, heading, fine.whole("stance", least=0, most=1), fine.whole("mode", least=0, most=6))
    return Step(
        line=line,
        step=fields.whole("step", least=0),
        turn=fields.whole("turn", least=0),
        time_s=fields.number("time_s"),
        core=core,
        context=fine.whole("context", least=0, most=32_767),
        action=fields.whole("action", least=0, most=32_767),
        sagittal=outcome.whole("sagittal", least=-10_000, most=10_000),
        lateral=outcome.whole("lateral", least=-10_000, most=10_000),
        stance=("left", "right").index(fields.text("stance", among=("left", "right"))),
        numbers={name: fields.number(name) for name in NUMBERS},
        vectors={name: np.array(fields.numbers(name, size)) for name, size in VECTORS.items()},
        next_heading_changes_rad=fields.numbers("next_heading_changes_rad"),
        sign_alternates=fields.flag("sign_alternates"),
        dy2_in_range=fields.flag("dy2_in_range"),
        rise=_support(fields, "rise"),
        rest=_support(fields, "rest"),
        closing_foot_m=np.array(fields.numbers("closing_foot_m", 3)) if _given(fields, "closing_foot_m") else None,
        transition=fields.text("transition", among=TRANSITIONS) if _given(fields, "transition") else None,
        moved=fields.cell("moved_cells") if _given(fields, "moved_cells") else (0, 0),
        side_speed_mps=fields.number("next_side_speed_mps") if _given(fields, "next_side_speed_mps") else None,
        push=read_push(fields),
    )


def _given(fields: Fields, name: str) -> bool:
    return fields.values.get(name) is not None


def _support(fields: Fields, name: str) -> Support | None:
    """Return the double support before a start or after a stop, when the record has one."""
    if not _given(fields, f"{name}_s"):
        return None
    return Support(fields.number(f"{name}_s"), np.array(fields.numbers(f"{name}_com_m", 3)))


def _unsafe(fields: Fields, line: int) -> Unsafe:
    fields.text("reason")
    fields.number("time_s")
    return Unsafe(line, fields.whole("step", least=0))


def _end(fields: Fields, line: int) -> End:
    return End(
        line=line,
        steps=fields.whole("steps", least=0),
        turns_coarse=fields.whole("turns_coarse", least=0),
        goals_reached=fields.wholes("goals_reached"),
        time_s=fields.number("time_s"),
    )


_READERS: dict[str, Callable[[Fields, int], Record]] = {
    "turn": _turn,
    "step": _step,
    "unsafe": _unsafe,
    "fall": read_fall,
    "violation": _violation,
}

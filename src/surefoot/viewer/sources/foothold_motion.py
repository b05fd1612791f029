"""Motions of a quadruped as scenes and recordings need them: of a foothold plan, or of the segments of a run."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.compute import sha256_of
from surefoot.documents import is_format, read_json_object
from surefoot.errors import InputError
from surefoot.robots.legs import Legs, legs_of
from surefoot.viewer.rotations import rotations

Array = NDArray[np.float64]

_LARGEST_PLAN_BYTES = 64_000_000
_LARGEST_LOG_BYTES = 300_000_000


@dataclass(frozen=True, slots=True, eq=False)
class FootholdMotion:
    """A sampled motion; SI units, the world's frame, feet in the order front left, front right, hind left, hind right.

    Attributes:
        time_s: ascending, shape (n,).
        base_m, rpy_rad: shape (n, 3).
        feet_m, forces_n: shape (n, 4, 3).
        polygons_m: what feet may stand on, each (corners, 3).
        friction: of every polygon.
        footholds_m: of every foot, where it stands one after the other.
        goal_m: of the base.
        hips_m: the upper ends of the legs in the frame of the base, shape (4, 3).
        robot: its name.
        legs: its joints.
        words: what is said at every sample, beside the loads.
    """

    time_s: Array
    base_m: Array
    rpy_rad: Array
    feet_m: Array
    forces_n: Array
    polygons_m: tuple[Array, ...]
    friction: tuple[float, ...]
    footholds_m: tuple[Array, ...]
    goal_m: tuple[float, float, float]
    hips_m: Array
    robot: str
    legs: Legs
    words: tuple[str, ...]

    def joints_rad(self, legs: Legs | None = None) -> tuple[Array, Array]:
        """Return the angles of the joints, shape (n, 4, 3), and how far [m] each foot is out of reach, shape (n, 4).

        Args:
            legs: that should stand where the feet do; None takes the robot's own.
        """
        axes = rotations(self.rpy_rad)
        return (legs or self.legs).joints_rad(np.einsum("nji,nkj->nki", axes, self.feet_m - self.base_m[:, None]))


def read_motion(path: Path) -> FootholdMotion:
    """Read the motion of a foothold plan (a file), or of a quadruped's run (its folder).

    Raises:
        InputError: it cannot be read, or holds no motion.
    """
    if path.is_file():
        return plan_motion(path)
    return _run_motion(path / "run.jsonl")


def plan_motion(plan: Path, begin_s: float = 0.0, word: str = "") -> FootholdMotion:
    """Return the motion of a plan file (docs/formats.md, section 6).

    Args:
        plan: the file.
        begin_s: the moment of its first sample.
        word: what is said at every sample.

    Raises:
        InputError: it is no plan, or holds no whole motion.
    """
    document = read_foothold_plan(plan)
    try:
        return _motion_of(document, begin_s, word)
    except (KeyError, TypeError, ValueError, IndexError) as problem:
        raise InputError(f"holds no whole motion ({problem})", source=plan, key="motion") from problem


def _motion_of(document: Mapping[str, Any], begin_s: float, word: str) -> FootholdMotion:
    values, motion = document["values"], document["motion"]
    samples = len(motion["base_m"])
    base_m, rpy_rad = (_array(motion, name, samples, 3) for name in ("base_m", "rpy_rad"))
    feet_m, forces_n = (_array(motion, name, samples, 4, 3) for name in ("feet_m", "forces_n"))
    robot = values["robot"]
    ahead_m, aside_m, below_m = robot["foot_reference_m"]
    return FootholdMotion(
        time_s=begin_s + float(values["step_s"]) * np.arange(len(base_m), dtype=np.float64),
        base_m=base_m,
        rpy_rad=rpy_rad,
        feet_m=feet_m,
        forces_n=forces_n,
        polygons_m=tuple(np.array(one["vertices_m"], np.float64) for one in values["polygons"]),
        friction=tuple(float(one["friction"]) for one in values["polygons"]),
        footholds_m=tuple(feet_m[_touches(motion["footsteps"], foot, len(feet_m)), foot] for foot in range(4)),
        goal_m=tuple(values["goal"]["position_m"]),
        hips_m=np.array([(x * ahead_m, y * aside_m, 0.0) for x in (1, -1) for y in (1, -1)]),
        robot=str(robot["name"]),
        legs=legs_of(robot["name"], (ahead_m, aside_m, below_m), robot["hip_offset_m"], robot["link_m"]),
        words=(word,) * len(base_m),
    )


def _array(motion: Mapping[str, Any], name: str, *shape: int) -> Array:
    numbers = np.array(motion[name], np.float64)
    if numbers.shape != shape or not numbers.size or not np.isfinite(numbers).all():
        raise ValueError(f"{name} needs finite numbers of shape {shape}, at least one")
    return numbers


def joined(motions: Sequence[FootholdMotion]) -> FootholdMotion:
    """Return motions one after the other; polygons that several have are taken once."""
    names = ("time_s", "base_m", "rpy_rad", "feet_m", "forces_n")
    arrays = {name: np.concatenate([getattr(one, name) for one in motions]) for name in names}
    polygons: dict[bytes, tuple[Array, float]] = {}
    for one in motions:
        for polygon, friction in zip(one.polygons_m, one.friction, strict=True):
            polygons.setdefault(polygon.round(6).tobytes(), (polygon, friction))
    return FootholdMotion(
        **arrays,
        polygons_m=tuple(polygon for polygon, _ in polygons.values()),
        friction=tuple(friction for _, friction in polygons.values()),
        footholds_m=tuple(np.concatenate([one.footholds_m[foot] for one in motions]) for foot in range(4)),
        goal_m=motions[-1].goal_m,
        hips_m=motions[0].hips_m,
        robot=motions[0].robot,
        legs=motions[0].legs,
        words=tuple(word for one in motions for word in one.words),
    )


def _touches(footsteps: Sequence[Mapping[str, Any]], foot: int, samples: int) -> list[int]:
    """Return the samples at which a foot comes to stand, the first one included."""
    return [0, *(int(one["touch"]) for one in footsteps if one["foot"] == foot and int(one["touch"]) < samples)]


@dataclass(frozen=True, slots=True)
class Segment:
    """What the log of a quadruped's run says of a segment.

    Attributes:
        plan: the file of its motion.
        sha256: of that file.
        start_s: the moment of its first sample.
        word: what is said while it is walked.
        line: of its record.
    """

    plan: Path
    sha256: str
    start_s: float
    word: str
    line: int


def read_segments(log: Path, *, growing: bool = False) -> tuple[Segment, ...]:
    """Return the segments that a quadruped's log holds by now; there may be none yet.

    Args:
        log: the file.
        growing: whether a last line without its end is passed over, because it is still being written.

    Raises:
        InputError: it is no log of a quadruped's run.
    """
    found, happened = [], ""
    for line, record in records_of(log, growing=growing):
        if record.get("record") == "event":
            happened = "; ".join([*filter(None, [happened]), _told(log, line, record)])
        if record.get("record") == "segment":
            found.append(_segment(log, line, record, happened))
            happened = ""
    return tuple(found)


def _told(log: Path, line: int, record: Mapping[str, Any]) -> str:
    """Say what happened to the world."""
    try:
        event = record["event"]
        if "push_m" in event:
            return f"pushed by {math.hypot(*event['push_m']):.2f} m"
        what, area = ("an obstacle", event["obstacle_m"]) if "obstacle_m" in event else ("a hole", event["hole_m"])
        (west, south), (east, north) = area
        return f"{what} appeared, x {west:g} to {east:g} m, y {south:g} to {north:g} m"
    except (KeyError, TypeError, ValueError) as problem:
        raise InputError(f"lacks {problem}, or holds another type there", source=log, line=line) from problem


def _segment(log: Path, line: int, record: Mapping[str, Any], happened: str) -> Segment:
    try:
        what = f"segment {record['number']}: {record['primitive'] or 'in place'}"
        word = what if not happened else f"{what} (before it: {happened})"
        plan = record["plan"]
        return Segment(log.parent / str(plan["path"]), str(plan["sha256"]), float(record["start_s"]), word, line)
    except (KeyError, TypeError, ValueError) as problem:
        raise InputError(f"lacks {problem}, or holds another type there", source=log, line=line) from problem


def segment_motion(log: Path, segment: Segment) -> FootholdMotion:
    """Return the motion of a segment of a log.

    Raises:
        InputError: its plan is missing or was changed.
    """
    if not segment.plan.is_file() or sha256_of(segment.plan) != segment.sha256:
        raise InputError(f"the plan {segment.plan.name} is missing or was changed", source=log, line=segment.line)
    return plan_motion(segment.plan, segment.start_s, segment.word)


def _run_motion(log: Path) -> FootholdMotion:
    """Return the segments of a quadruped's run, one after the other."""
    segments = read_segments(log)
    if not segments:
        raise InputError("holds no segment, so there is nothing to replay", source=log)
    return joined([segment_motion(log, one) for one in segments])


def records_of(log: Path, *, growing: bool = False) -> list[tuple[int, dict[str, Any]]]:
    """Return the records of a log with their lines.

    Args:
        log: the file.
        growing: whether a last line without its end is passed over, because it is still being written.

    Raises:
        InputError: it is no log of a quadruped's run, or was cut off.
    """
    if log.stat().st_size > _LARGEST_LOG_BYTES:
        raise InputError(f"is larger than the {_LARGEST_LOG_BYTES} bytes that are allowed", source=log)
    found = []
    for line, text in enumerate(log.read_bytes().splitlines(keepends=True), 1):
        if growing and not text.endswith(b"\n"):
            break
        try:
            record = json.loads(text)
        except (ValueError, RecursionError) as problem:
            message = "is not a whole JSON record; the log was cut off or changed here"
            raise InputError(message, source=log, line=line) from problem
        if not isinstance(record, dict):
            raise InputError("a record has to be a mapping", source=log, line=line)
        if line == 1 and (record.get("kind") != "quadruped-run" or not is_format(record.get("format"))):
            raise InputError("is no log of a quadruped's run of format 1", source=log, line=1, key="kind")
        found.append((line, record))
    return found


def read_foothold_plan(plan: Path) -> dict[str, Any]:
    """Return the object of a plan file that holds a motion.

    Raises:
        InputError: the file is no foothold plan, or holds no motion.
    """
    document = read_json_object(plan, _LARGEST_PLAN_BYTES)
    if document.get("kind") != "foothold-plan" or not is_format(document.get("format")):
        raise InputError("is no foothold plan of format 1", source=plan, key="kind")
    if not isinstance(document.get("motion"), dict):
        raise InputError("holds no motion: only feasible plans can be animated", source=plan, key="motion")
    return document

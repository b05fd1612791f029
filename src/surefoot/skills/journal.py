"""The journal of a library that is being made: every check of physics is on disk before the next one counts.

``checks.jsonl`` begins with a line that says with what it is made; then comes one line per check, each flushed to the
disk, and the plan of a certificate lies whole in ``plans/`` before its line is written. Killed at any time, a synthesis
loses the check in hand; started again, it asks the journal first and goes on where it was.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import IO, Any

from surefoot.compute import sha256_of, write_text_whole
from surefoot.documents import is_format
from surefoot.errors import InputError
from surefoot.skills.values import CheckResult, Physics, PhysicsCheck, Primitive

CHECKS = "checks.jsonl"
PLANS = "plans"
KIND = "skill-checks"
FORMAT = 1


class Stage(StrEnum):
    """What a check is for."""

    START = "start"
    REPAIR = "repair"


@dataclass(frozen=True, slots=True)
class PlanFile:
    """Where the certificate of a check is.

    Attributes:
        path: inside the library.
        sha256: of the file.
    """

    path: str
    sha256: str


@dataclass(slots=True)
class Journal:
    """The checks of a library, in memory and on disk; grows while physics answers.

    Attributes:
        folder: of the library.
        results: every answer, by stage and primitive. Infeasible at the start, where only given gaits are tried, does
            not mean infeasible for the repair.
        plans: certificates of the feasible ones.
    """

    folder: Path
    results: dict[tuple[Stage, Primitive], CheckResult]
    plans: dict[Primitive, PlanFile]
    _stream: IO[bytes] = field(repr=False)

    def recording(self, physics: PhysicsCheck, stage: Stage) -> PhysicsCheck:
        """Return the same physics, which asks the journal first and writes down every new answer at once."""

        def check(primitives: Sequence[Primitive]) -> Iterator[CheckResult]:
            yield from (self.results[stage, one] for one in primitives if (stage, one) in self.results)
            new = [one for one in primitives if (stage, one) not in self.results]
            for result in physics(new) if new else ():
                self._note(result, stage)
                yield result

        return check

    def _note(self, result: CheckResult, stage: Stage) -> None:
        plan = None
        if result.plan is not None:
            sha256 = hashlib.sha256(result.plan.encode()).hexdigest()
            plan = PlanFile(f"{PLANS}/{_slug(result.primitive)}-{sha256[:12]}.json", sha256)
            write_text_whole(self.folder / plan.path, result.plan)
            self.plans[result.primitive] = plan
        _append(self._stream, {"stage": stage.value, **check_object(result, plan)})
        self.results[stage, result.primitive] = result


@contextmanager
def open_journal(folder: Path, made_with: Mapping[str, Any], *, retry_unknown: bool = False) -> Iterator[Journal]:
    """Open the journal of a library, a new one or one that was interrupted.

    Args:
        folder: of the library.
        made_with: everything that the answers of physics depend on; JSON values.
        retry_unknown: ask again about what was left undecided.

    Raises:
        InputError: the library was made with something else, is being made by another process, or is damaged.
    """
    path = folder / CHECKS
    try:
        folder.mkdir(parents=True, exist_ok=True)
        stream = path.open("a+b")
    except OSError as problem:
        raise InputError(f"cannot be written: {problem.strerror}", source=folder) from problem
    with stream:
        _lock(stream, path)
        header = {"kind": KIND, "format": FORMAT, "made_with": json.loads(json.dumps(dict(made_with)))}
        lines = _whole_lines(stream)
        if lines:
            _check_header(_parsed(lines[0], path, 1), header, path)
        else:
            stream.truncate(0)
            _append(stream, header)
        journal = Journal(folder, {}, {}, stream)
        for number, line in enumerate(lines[1:], start=2):
            stage, result, plan = _read_line(line, path, number)
            lost = plan is not None and not _is_whole(folder / plan.path, plan.sha256)
            if lost or (result.verdict is Physics.UNKNOWN and retry_unknown):
                continue
            journal.results[stage, result.primitive] = result
            if plan is not None:
                journal.plans[result.primitive] = plan
        yield journal


def check_object(result: CheckResult, plan: PlanFile | None) -> dict[str, Any]:
    """Return a check as it stands in files (docs/formats.md)."""
    return {
        "primitive": result.primitive.name,
        "verdict": result.verdict.value,
        "gait": result.gait,
        "horizon_s": result.horizon_s,
        "cost": result.cost,
        "time_s": round(result.time_s, 4),
        "explanation": result.explanation,
        "plan": None if plan is None else {"path": plan.path, "sha256": plan.sha256},
    }


def read_check(value: Any, path: Path, line: int | None = None) -> tuple[CheckResult, PlanFile | None]:
    """Return the check of an object.

    Raises:
        InputError: something in it is missing or wrong.
    """
    try:
        plan = value["plan"]
        result = CheckResult(
            primitive=Primitive.parse(str(value["primitive"])),
            verdict=Physics(value["verdict"]),
            gait=str(value["gait"]),
            explanation=str(value["explanation"]),
            time_s=float(value["time_s"]),
            horizon_s=float(value["horizon_s"]),
            cost=float(value["cost"]),
        )
        return result, None if plan is None else PlanFile(_inside(str(plan["path"])), str(plan["sha256"]))
    except (KeyError, TypeError, ValueError, InputError) as problem:
        raise InputError(f"holds no check of physics ({problem})", source=path, line=line) from problem


def _read_line(line: bytes, path: Path, number: int) -> tuple[Stage, CheckResult, PlanFile | None]:
    value = _parsed(line, path, number)
    result, plan = read_check(value, path, number)
    try:
        return Stage(value["stage"]), result, plan
    except (KeyError, ValueError) as problem:
        allowed = " or ".join(Stage)
        raise InputError(f"has to be {allowed}", source=path, line=number, key="stage") from problem


def _inside(path: str) -> str:
    if not re.fullmatch(rf"{PLANS}/[A-Za-z0-9_.-]+", path):
        raise ValueError(f"{path[:80]!r} is no file of {PLANS}/")
    return path


def _is_whole(path: Path, sha256: str) -> bool:
    try:
        return sha256_of(path) == sha256
    except OSError:
        return False


def _lock(stream: IO[bytes], path: Path) -> None:
    try:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as problem:
        raise InputError("is being written by another synthesis; wait for it or stop it", source=path) from problem


def _whole_lines(stream: IO[bytes]) -> list[bytes]:
    """Return the lines that were written to their end; what follows them was cut off by an interruption and goes."""
    stream.seek(0)
    text = stream.read()
    whole = text.rfind(b"\n") + 1
    if whole < len(text):
        stream.truncate(whole)
    return text[:whole].splitlines()


def _append(stream: IO[bytes], value: Mapping[str, Any]) -> None:
    stream.write(json.dumps(value).encode() + b"\n")
    stream.flush()
    os.fsync(stream.fileno())


def _parsed(line: bytes, path: Path, number: int) -> Any:
    try:
        return json.loads(line)
    except (ValueError, RecursionError) as problem:
        message = f"is damaged; repair or remove this line, or begin anew without {CHECKS}"
        raise InputError(message, source=path, line=number) from problem


def _check_header(found: Any, expected: Mapping[str, Any], path: Path) -> None:
    if not isinstance(found, dict) or found.get("kind") != KIND or not is_format(found.get("format"), FORMAT):
        raise InputError(f"is no journal of kind {KIND}, format {FORMAT}", source=path, line=1)
    difference = differing(found.get("made_with"), expected["made_with"])
    if difference:
        message = f"this library was made with other rules: {difference}; choose another folder for the new ones"
        raise InputError(message, source=path, line=1)


def differing(found: Any, expected: Mapping[str, Any]) -> str | None:
    """Return in words the first thing that two libraries were not made with alike; None if there is none."""
    found = found if isinstance(found, dict) else {}
    for key in sorted({*found, *expected}):
        if found.get(key) != expected.get(key):
            return f"{key} was {_shown(found.get(key))} and is now {_shown(expected.get(key))}"
    return None


def _shown(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 70 else f"{text[:64]}...{text[-1]}"


def _slug(primitive: Primitive) -> str:
    return re.sub(r"[^A-Za-z0-9]+", "_", primitive.name)

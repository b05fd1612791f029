"""Pushes on a walking robot: scripted in a file, or drawn at random (docs/formats.md, section 3)."""

from __future__ import annotations

import math
import random
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, TypeVar

from surefoot.documents import Loc, dotted, is_format, read_yaml, unknown_key
from surefoot.errors import InputError

HARDEST_MPS = 10.0
MOST_STEPS = 10_000_000
_KIND = "push-script"
_KEYS = ("step", "instant", "sagittal_mps", "lateral_mps")


@dataclass(frozen=True, slots=True)
class StepPush:
    """A jump of the CoM's velocity during a walking step.

    Attributes:
        instant: when it comes, as a share of the planned time from apex to apex, at least 0 and below 1.
        sagittal_mps: along the heading of the step.
        lateral_mps: to the left of it.
    """

    instant: float
    sagittal_mps: float
    lateral_mps: float

    @property
    def jump_mps(self) -> tuple[float, float]:
        """Return the jump ahead and to the left."""
        return self.sagittal_mps, self.lateral_mps


class Pushed(Protocol):
    """What became of a push."""

    @property
    def by(self) -> str | None:
        """Return what recovered it; nothing for a fall."""


Outcome = TypeVar("Outcome", bound=Pushed)


class PushSource(Protocol):
    """Says which steps are pushed."""

    def at(self, step: int) -> StepPush | None:
        """Return the push during a step; called once for every step, in order."""

    def after(self, steps: int) -> tuple[int, ...]:
        """Return the steps that are to be pushed, but come after so many steps."""

    def described(self, folder: Path) -> dict[str, Any]:
        """Return what the header of a run log in a folder says about the pushes."""


@dataclass(frozen=True, slots=True)
class RandomPushes:
    """Pushes of random steps: instants and jumps are uniform.

    Attributes:
        seed: the same seed, the same pushes.
        size_mps: the largest jump along the heading.
        side_size_mps: the largest jump sideways.
        rate: share of the steps that are pushed.
    """

    seed: int
    size_mps: float = 0.2
    side_size_mps: float = 0.05
    rate: float = 0.1

    def __post_init__(self) -> None:
        for name in ("size_mps", "side_size_mps"):
            if not 0 <= getattr(self, name) <= HARDEST_MPS:
                raise InputError(
                    f"{getattr(self, name):g} is not allowed; from 0 to {HARDEST_MPS:g} m/s is",
                    key=f"push-{name.removesuffix('_mps').replace('_', '-')}",
                )
        if not 0 < self.rate <= 1:
            raise InputError(f"{self.rate:g} is not allowed; above 0 and at most 1 is", key="push-rate")

    def at(self, step: int) -> StepPush | None:
        """Return the push during a step."""
        chance = random.Random(f"push {self.seed} {step}")  # noqa: S311 - a simulation, not a secret
        if chance.random() >= self.rate:
            return None
        instant = chance.random()
        ahead, left = (chance.uniform(-size, size) for size in (self.size_mps, self.side_size_mps))
        return StepPush(instant, ahead, left)

    def after(self, steps: int) -> tuple[int, ...]:
        """Return the steps that a script names beyond those that are walked: none."""
        return ()

    def described(self, folder: Path) -> dict[str, Any]:
        """Return what the header of a run log says about the pushes."""
        return {
            "kind": "random",
            "size_mps": self.size_mps,
            "side_size_mps": self.side_size_mps,
            "rate": self.rate,
        }


@dataclass(frozen=True, slots=True)
class ScriptedPushes:
    """Pushes as a file lists them.

    Attributes:
        path: of the file.
        by_step: the pushes.
    """

    path: Path
    by_step: Mapping[int, StepPush]

    def at(self, step: int) -> StepPush | None:
        """Return the push during a step."""
        return self.by_step.get(step)

    def after(self, steps: int) -> tuple[int, ...]:
        """Return the steps that the script pushes after so many steps."""
        return tuple(sorted(step for step in self.by_step if step >= steps))

    def described(self, folder: Path) -> dict[str, Any]:
        """Return what the header of a run log says about the pushes."""
        from surefoot.missions.references import reference

        return {"kind": "scripted", **reference(self.path, folder)}


def push_source(text: str | None, seed: int, sizes: Mapping[str, float]) -> PushSource | None:
    """Return the pushes that a person asks for: none, ``random``, or those of a file.

    Args:
        text: the word random, the path of a script, or None.
        seed: of random pushes.
        sizes: of random pushes, the attributes of ``RandomPushes`` that are given.

    Raises:
        InputError: if sizes are given without random pushes, are not allowed, or the script is none.
    """
    if text == "random":
        return RandomPushes(seed, **sizes)
    if sizes:
        raise InputError("--push-size, --push-side-size and --push-rate belong to --pushes random")
    return None if text is None else read_pushes(Path(text))


def read_pushes(path: Path) -> ScriptedPushes:
    """Read a push script: ``{format: 1, kind: push-script, pushes: [{step, instant, sagittal_mps, lateral_mps}]}``.

    Raises:
        InputError: if the file is no such script, or pushes a step twice.
    """
    document = read_yaml(path)
    if document.problems:
        raise document.problems[0]
    content = document.value
    if not isinstance(content, dict) or content.get("kind") != _KIND or not is_format(content.get("format")):
        raise InputError("must be a mapping with format: 1, kind: push-script and pushes", source=path)
    _only(content, ("format", "kind", "pushes"), path, document.lines, ())
    listed = content.get("pushes")
    if not isinstance(listed, tuple) or not listed:
        message = "has to be a list of at least one push"
        raise InputError(message, source=path, line=document.lines.get(("pushes",)), key="pushes")
    by_step: dict[int, StepPush] = {}
    for number, entry in enumerate(listed):
        line = document.lines.get(("pushes", number))
        _only(entry, _KEYS, path, document.lines, ("pushes", number))
        step, push = _push(path, entry, f"pushes[{number}]", line)
        if step in by_step:
            message = f"step {step} is pushed twice; at most one push a step is allowed"
            raise InputError(message, source=path, line=line, key=f"pushes[{number}]")
        by_step[step] = push
    return ScriptedPushes(path, by_step)


def _only(mapping: object, allowed: tuple[str, ...], path: Path, lines: Mapping[Loc, int], place: Loc) -> None:
    """Refuse the first key of a mapping that is not allowed."""
    strange = next((key for key in mapping if key not in allowed), None) if isinstance(mapping, dict) else None
    if strange is not None:
        there = (*place, strange)
        raise InputError(unknown_key(strange, allowed), source=path, line=lines.get(there), key=dotted(there))


def _push(path: Path, entry: object, key: str, line: int | None) -> tuple[int, StepPush]:
    """Return one push of a script, with its step."""

    def wrong(name: str, allowed: str) -> InputError:
        return InputError(f"has to be {allowed}", source=path, line=line, key=f"{key}.{name}")

    if not isinstance(entry, dict) or not {"step", "instant"} <= set(entry) <= set(_KEYS):
        allowed = "the keys are step and instant, and sagittal_mps or lateral_mps or both"
        raise InputError(allowed, source=path, line=line, key=key)
    step = entry["step"]
    if type(step) is not int or not 0 <= step < MOST_STEPS:
        raise wrong("step", "the number of a step, counted from 0")
    numbers = {name: entry.get(name, 0.0) for name in _KEYS[1:]}
    for name, value in numbers.items():
        if type(value) not in (int, float) or not math.isfinite(value) or abs(value) > HARDEST_MPS:
            raise wrong(name, f"a number from -{HARDEST_MPS:g} to {HARDEST_MPS:g}")
    if not 0 <= numbers["instant"] < 1:
        raise wrong("instant", "a share of the step, at least 0 and below 1")
    if not numbers["sagittal_mps"] and not numbers["lateral_mps"]:
        raise wrong("sagittal_mps", "other than 0, or lateral_mps has")
    return step, StepPush(*(float(numbers[name]) for name in _KEYS[1:]))


class Pusher:
    """Pushes a walking robot and counts what becomes of it.

    Args:
        source: of the pushes; none when nobody pushes.
    """

    def __init__(self, source: PushSource | None = None) -> None:
        self.source = source
        self.pushes = self.falls = 0
        self.recovered = {"region": 0, "step": 0}
        self._last: int | None = None
        self._by: str | None = None

    def at(self, step: int) -> StepPush | None:
        """Return the push during a step, and remember it."""
        push = None if self.source is None else self.source.at(step)
        if push is not None:
            self.pushes += 1
            self._last = step
        return push

    def counted(self, found: Outcome) -> Outcome:
        """Count what became of the last push, and return it."""
        self._by = None if found.by is None else str(found.by)
        if self._by is None:
            self.falls += 1
        else:
            self.recovered[self._by] += 1
        return found

    def blamed(self) -> int | None:
        """Return the step of the last push before a step that cannot be walked, which counts as its fall."""
        self.falls += self._last is not None
        if self._by is not None:
            self.recovered[self._by] -= 1
        return self._last

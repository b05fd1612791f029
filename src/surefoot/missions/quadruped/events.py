"""What happens to the world of a quadruped's mission: a YAML file (docs/formats.md 12)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

from surefoot.documents import Loc, read_yaml
from surefoot.errors import InputError
from surefoot.skills.patches import Rectangle

_KNOWN = {"format": 1, "kind": "quadruped-events"}
_WHEN = ("at_segment", "at_s")
_MOST = 1000
_FARTHEST_M = 1e4


class Happening(StrEnum):
    """What may happen."""

    OBSTACLE = "obstacle_m"
    HOLE = "hole_m"
    PUSH = "push_m"


@dataclass(frozen=True, slots=True)
class Event:
    """One thing that happens.

    Attributes:
        what: an obstacle appears, ground goes, or the robot finds itself elsewhere.
        at_segment: seen before this segment is planned; None if a time is given.
        at_s: seen at this time of the mission.
        area: of an obstacle or a hole.
        push_m: change of the robot's place along x and y.
    """

    what: Happening
    at_segment: int | None
    at_s: float | None
    area: Rectangle | None
    push_m: tuple[float, float] | None

    def due(self, segment: int, time_s: float) -> bool:
        """Return whether it has happened when a segment is planned."""
        return segment >= self.at_segment if self.at_segment is not None else time_s >= (self.at_s or 0.0)

    def described(self) -> dict[str, Any]:
        """Return it as it stands in a file."""
        when = {"at_segment": self.at_segment} if self.at_segment is not None else {"at_s": self.at_s}
        if self.area is None:
            return {**when, self.what.value: list(self.push_m or ())}
        return {**when, self.what.value: [[self.area.west, self.area.south], [self.area.east, self.area.north]]}


def read_events(path: Path) -> tuple[Event, ...]:
    """Read a file of events.

    Raises:
        InputError: it is no such file.
    """
    document = read_yaml(path)
    if document.problems:
        raise document.problems[0]
    return _Reading(path, document.lines).events(document.value)


class _Reading:
    def __init__(self, path: Path, lines: dict[Loc, int]) -> None:
        self.path, self.lines = path, lines

    def wrong(self, message: str, *loc: str | int) -> InputError:
        known: Loc = next((loc[:size] for size in range(len(loc), -1, -1) if loc[:size] in self.lines), ())
        return InputError(message, source=self.path, line=self.lines.get(known), key=".".join(map(str, loc)) or None)

    def events(self, value: object) -> tuple[Event, ...]:
        if not isinstance(value, dict) or set(value) != {*_KNOWN, "events"}:
            raise self.wrong("needs exactly the keys format, kind and events")
        for key, allowed in _KNOWN.items():
            if value[key] != allowed or type(value[key]) is not type(allowed):
                raise self.wrong(f"has to be {allowed}", key)
        given = value["events"]
        if not isinstance(given, list | tuple) or len(given) > _MOST:
            raise self.wrong(f"needs a list of at most {_MOST} events", "events")
        return tuple(self.event(one, k) for k, one in enumerate(given))

    def event(self, one: object, number: int) -> Event:
        loc = ("events", number)
        if not isinstance(one, dict) or len(one) != 2:
            raise self.wrong("needs two keys: at_segment or at_s, and one of obstacle_m, hole_m and push_m", *loc)
        when = [key for key in one if key in _WHEN]
        what = [key for key in one if key in list(Happening)]
        if len(when) != 1 or len(what) != 1:
            raise self.wrong("needs at_segment or at_s, and one of obstacle_m, hole_m and push_m", *loc)
        segment, time_s = self.when(one, when[0], loc)
        happening = Happening(what[0])
        if happening is Happening.PUSH:
            return Event(happening, segment, time_s, None, self.pair(one[what[0]], *loc, what[0]))
        return Event(happening, segment, time_s, self.area(one[what[0]], *loc, what[0]), None)

    def when(self, one: Mapping[str, object], key: str, loc: tuple[str | int, ...]) -> tuple[int | None, float | None]:
        value = one[key]
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value <= 1e6:
            raise self.wrong("needs a number from 0 to 1e6", *loc, key)
        if key == "at_s":
            return None, float(value)
        if not isinstance(value, int):
            raise self.wrong("needs a whole number: segments are counted from 0", *loc, key)
        return value, None

    def pair(self, value: object, *loc: str | int) -> tuple[float, float]:
        if not isinstance(value, list | tuple) or len(value) != 2 or not all(_is_place(one) for one in value):
            raise self.wrong("needs [x, y] in metres", *loc)
        return float(value[0]), float(value[1])

    def area(self, value: object, *loc: str | int) -> Rectangle:
        if not isinstance(value, list | tuple) or len(value) != 2:
            raise self.wrong("needs two corners, [[x, y], [x, y]]", *loc)
        (a, b), (c, d) = self.pair(value[0], *loc), self.pair(value[1], *loc)
        if not (a < c and b < d):
            raise self.wrong("needs the corner with the least x and y first, and an area", *loc)
        return Rectangle(a, b, c, d)


def _is_place(value: object) -> bool:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return number and math.isfinite(value) and abs(value) <= _FARTHEST_M  # type: ignore[arg-type]

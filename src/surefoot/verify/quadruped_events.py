"""When the events of a quadruped's run are seen: each once, not before it is due, and before the next plan."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from surefoot.verify.values import Fields

_TIME_S = 1e-6


@dataclass(frozen=True, slots=True)
class Planned:
    """When the planner last looked at the world.

    Attributes:
        segment: that it then planned.
        time_s: when it began [s of the mission].
    """

    segment: int
    time_s: float


class Expected:
    """The events that the header names and that have not been seen yet.

    Args:
        header: of the run.
    """

    def __init__(self, header: Fields) -> None:
        self.waiting = list(header.mappings("events"))
        self.seen: list[Fields] = []

    def see(self, event: Fields) -> str:
        """Take an event over; return what is wrong, empty if nothing is."""
        found = next((one for one in self.waiting if dict(one.values) == dict(event.values)), None)
        if found is None:
            return "is none of those that the header names, or was seen before"
        self.waiting.remove(found)
        self.seen.append(found)
        return ""

    def problems(self, planned: Planned) -> list[str]:
        """Return what is wrong when a segment is planned: what was seen too early, and what should have been seen."""
        early = [f"{_named(one.values)} is seen before it is due" for one in self.seen if not _due(one, planned)]
        late = [
            f"{_named(one.values)} is due, and was not seen" for one in self.waiting if _due(one, planned, -_TIME_S)
        ]
        self.seen = []
        return early + late


def _due(event: Fields, planned: Planned, early_s: float = _TIME_S) -> bool:
    """Return whether an event has happened when the planner looks; ``early_s`` is how early it may be."""
    if event.has("at_segment"):
        return planned.segment >= event.whole("at_segment")
    return planned.time_s >= event.number("at_s") - early_s


def _named(values: Mapping[str, object]) -> str:
    return " ".join(f"{key} {value}" for key, value in values.items())

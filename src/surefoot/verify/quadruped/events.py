"""When the events of a quadruped's run are seen: each once, not before it is due, and before the next motion begins."""

from __future__ import annotations

from collections.abc import Mapping

from surefoot.verify.values import Fields

_TIME_S = 1e-6


class Expected:
    """The events that the header names and that have not been seen yet.

    Args:
        header: of the run.
    """

    def __init__(self, header: Fields) -> None:
        self.waiting = list(header.mappings("events"))
        self.seen_s: list[float] = []
        self.withdrawn_s = 0.0

    def see(self, record: Fields, segments: int, started_s: float) -> list[str]:
        """Take an event over; return what is wrong with it.

        Args:
            record: of the event.
            segments: how many motions were sent before.
            started_s: when the last of them began: the planner looks from then on.
        """
        event, seen_s = record.mapping("event"), record.number("seen_s", least=0.0)
        self.seen_s.append(seen_s)
        found = next((one for one in self.waiting if dict(one.values) == dict(event.values)), None)
        if found is None:
            return ["is none of those that the header names, or was seen before"]
        self.waiting.remove(found)
        early = not _due(found, segments, seen_s + _TIME_S) or seen_s < started_s - _TIME_S
        return [f"{_named(found.values)} is seen before it is due"] if early else []

    def withdrawn(self, record: Fields) -> str:
        """Take over that a motion is not walked; return what is wrong, empty if nothing is."""
        self.withdrawn_s = record.number("seen_s", least=0.0)
        if not self.seen_s or self.withdrawn_s != self.seen_s[-1]:
            return "comes without anything that happened at that time"
        return ""

    def problems(self, segment: int, plan_start_s: float, start_s: float) -> list[str]:
        """Return what is wrong when a motion begins: what should have been seen, and when it was planned."""
        found = [
            f"{_named(one.values)} is due, and was not seen"
            for one in self.waiting
            if _due(one, segment, start_s - _TIME_S)
        ]
        if any(seen_s > start_s + _TIME_S for seen_s in self.seen_s):
            found.append("what happened is seen after the motion began that it comes before")
        if plan_start_s < self.withdrawn_s - _TIME_S:
            found.append("is planned before the motion was withdrawn that it stands for")
        self.seen_s, self.withdrawn_s = [], 0.0
        return found


def _due(event: Fields, segment: int, time_s: float) -> bool:
    """Return whether an event has happened."""
    if event.has("at_segment"):
        return segment >= event.whole("at_segment")
    return time_s >= event.number("at_s")


def _named(values: Mapping[str, object]) -> str:
    return " ".join(f"{key} {value}" for key, value in values.items())

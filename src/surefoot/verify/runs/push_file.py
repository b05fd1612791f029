"""Reads what a run log says about pushes, from formats.md 3, and the script that they come from."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from surefoot.verify.artefacts import check_kind, checked_file
from surefoot.verify.scene.scenario import load_yaml
from surefoot.verify.values import Fields

Vector = NDArray[np.float64]
Arcs = tuple[tuple[float, float], ...]
TRANSITIONS = ("nominal", "forward", "backward", "left", "right")
MOST_ARCS = 10_000


@dataclass(frozen=True, slots=True)
class Push:
    """How a pushed step went on; the fields are those of formats.md.

    Attributes:
        time_s: since the start apex.
        jump_mps: ahead and to the left.
        region: whether the log credits the controllable region.
        window_mps: at which apex speeds the law aimed; None for no law.
        before: arcs (duration, omega) until the switch.
        after: arcs after it.
        put_off: whether a stop was not carried out.
        planned_foot_m: where the next foot was to stand.
        planned_waypoint_m: the waypoint that was planned.
        planned_speed_mps: at the next apex.
        planned_halves_s: first and second half.
    """

    time_s: float
    jump_mps: tuple[float, float]
    region: bool
    window_mps: tuple[float, float] | None
    before: Arcs
    after: Arcs
    put_off: bool
    planned_foot_m: Vector
    planned_waypoint_m: Vector
    planned_speed_mps: float
    planned_halves_s: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Fall:
    """A push that nothing recovered; the margin is by how much it was too large, negative."""

    line: int
    step: int
    time_s: float
    jump_mps: tuple[float, float]
    margin_mps: float


@dataclass(frozen=True, slots=True)
class Pushing:
    """Which pushes the header allows.

    Attributes:
        script: (instant, ahead, left) by step; None for random pushes, empty for none at all.
        sizes_mps: the largest random jumps, ahead and sideways.
    """

    script: dict[int, tuple[float, float, float]] | None
    sizes_mps: tuple[float, float] = (0.0, 0.0)


def read_push(step: Fields) -> Push | None:
    """Return the push of a step record."""
    if step.values.get("push") is None:
        return None
    fields, planned = step.mapping("push"), step.mapping("push").mapping("planned")
    window = None if fields.get("window_mps") is None else fields.point("window_mps")
    return Push(
        time_s=fields.number("time_s", least=0.0),
        jump_mps=fields.point("jump_mps"),
        region=fields.text("recovery", among=("region", "step")) == "region",
        window_mps=window,
        before=_arcs(fields, "omegas_before_switch"),
        after=_arcs(fields, "omegas_after_switch"),
        put_off=fields.flag("put_off"),
        planned_foot_m=np.array(planned.numbers("next_foot_m", 3)),
        planned_waypoint_m=np.array(planned.numbers("next_waypoint_m", 3)),
        planned_speed_mps=planned.number("next_apex_speed_mps"),
        planned_halves_s=(planned.number("first_half_s"), planned.number("second_half_s")),
    )


def _arcs(fields: Fields, name: str) -> Arcs:
    listed = fields.items(name)
    if len(listed) > MOST_ARCS:
        raise fields.wrong(name, f"has to hold at most {MOST_ARCS} arcs")
    found = [Fields({name: pair}, fields.source, fields.place, fields.line).numbers(name, 2) for pair in listed]
    return tuple((duration, omega) for duration, omega in found)


def read_fall(fields: Fields, line: int) -> Fall:
    """Return a fall record."""
    fields.text("reason")
    margin = fields.number("margin_mps")
    if margin > 0:
        raise fields.wrong("margin_mps", "has to be at most 0")
    push = fields.mapping("push")
    step, time_s = fields.whole("step", least=0), push.number("time_s", least=0.0)
    return Fall(line, step, time_s, push.point("jump_mps"), margin)


def read_pushing(header: Fields, folder: Path) -> Pushing:
    """Return which pushes a header allows; the script is read where there is one."""
    if header.values.get("pushes") is None:
        return Pushing({})
    fields = header.mapping("pushes")
    if fields.text("kind", among=("scripted", "random")) == "random":
        fields.number("rate", least=0.0)
        return Pushing(None, (fields.number("size_mps", least=0.0), fields.number("side_size_mps", least=0.0)))
    path = checked_file(fields, folder)
    return Pushing(_script(Fields.of(load_yaml(path), path)))


def _script(document: Fields) -> dict[int, tuple[float, float, float]]:
    document.only(("format", "kind", "pushes"))
    check_kind(document, "push-script")
    found: dict[int, tuple[float, float, float]] = {}
    for entry in document.mappings("pushes"):
        entry.only(("step", "instant", "sagittal_mps", "lateral_mps"))
        step = entry.whole("step", least=0)
        if step in found:
            raise entry.wrong("step", "is pushed twice")
        jumps = entry.number("sagittal_mps", 0.0), entry.number("lateral_mps", 0.0)
        found[step] = (entry.number("instant", least=0.0), *jumps)
    return found

"""The run log of a quadruped (docs/formats.md, "Run of a quadruped"): records and plans, on disk as they happen."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from surefoot.compute import sha256_of
from surefoot.footholds import write_plan
from surefoot.missions.quadruped.crossing import Crossed
from surefoot.missions.quadruped.events import Event, Happening
from surefoot.missions.quadruped.route import Pose
from surefoot.missions.quadruped.skills import Handled
from surefoot.missions.quadruped.stance import Segment, Stance
from surefoot.missions.quadruped.timeline import Slot
from surefoot.missions.run_writer import RunWriter
from surefoot.skills.values import Cell, CheckResult, Physics, Primitive, TerrainState

PLANS = "plans"
_HAPPENED = {
    Happening.OBSTACLE: "an obstacle has appeared",
    Happening.HOLE: "ground has gone",
    Happening.PUSH: "the robot finds itself elsewhere",
}


class Log:
    """Writes what happens.

    Args:
        writer: of ``run.jsonl``.
        say: is told in words.
    """

    def __init__(self, writer: RunWriter, say: Callable[[str], None] = lambda _: None) -> None:
        self.writer, self.say, self.folder = writer, say, writer.folder
        for old in sorted((self.folder / PLANS).glob("segment-*.json")):
            old.unlink()

    def write(self, record: str, **content: Any) -> None:
        """Append a record."""
        self.writer.write(record, **content)

    def request(
        self,
        number: int,
        stance: Stance,
        state: TerrainState,
        request: Cell,
        route: Sequence[Cell],
        edges: Sequence[tuple[Pose, Pose]],
        handled: Handled,
        plans: Mapping[Primitive, Mapping[str, str]],
    ) -> None:
        """Write a request and its strategy, or why there is none."""
        answer = handled.answer
        self.write(
            "request",
            number=number,
            cell=stance.cell,
            quarter_turns=stance.quarter_turns,
            labels=state.labels,
            request=request,
            route=route,
            disallowed=[[one[0], other[0]] for one, other in edges],
            source=handled.source,
            outcome=answer.outcome.value,
            strategy=_rows(handled),
            **_checks(handled.checked, plans),
            why=None if answer.why is None else answer.why.text,
            symbolic_ms=round(handled.symbolic_ms, 4),
        )
        if handled.source != "library":
            self.say(f"request {number}, {handled.source}: {answer.outcome.value}, {handled.symbolic_ms:.2f} ms")

    def prepared(self, checked: Sequence[CheckResult], plans: Mapping[Primitive, Mapping[str, str]]) -> None:
        """Write which skills were made before the robot set out."""
        checks = _checks(checked, plans)
        self.write("prepared", **checks)
        made, asked = len(checks["new"]), len(checks["asked"])
        lacks = f"{asked} skill{'s' if asked > 1 else ''} that the way lacks"
        self.say(f"before setting out, physics was asked about {lacks}, and found {made or 'none'}")

    def segment(
        self,
        segment: Segment,
        crossed: Crossed,
        slot: Slot,
        stance: Stance,
        target: Pose,
        name: str | None,
        move: tuple[Pose, Pose] | None,
    ) -> None:
        """Write a motion that is walked, in place if it has no name; its plan is a file before the record is."""
        assert crossed.solution is not None
        file = f"{PLANS}/segment-{segment.number:04}.json"
        write_plan(self.folder / file, crossed.problem, crossed.solution)
        self.write(
            "segment",
            number=segment.number,
            primitive=name,
            move=None if move is None else [pose[0] for pose in move],
            cells=[stance.cell, target[0]],
            quarter_turns=[stance.quarter_turns, target[1]],
            plan={"path": file, "sha256": sha256_of(self.folder / file)},
            start_s=segment.start_s,
            end_s=segment.end_s,
            plan_start_s=slot.plan_start_s,
            sent_s=slot.sent_s,
            idle_s=slot.idle_s,
            shift_m=round(crossed.shift_m, 6),
            polygons=len(crossed.problem.polygons),
            continuous=crossed.continuous,
            binaries=crossed.binaries,
            retarget_ms=round(crossed.retarget_ms, 3),
            solve_ms=round(crossed.solve_ms, 3),
            clock_ms=round(crossed.clock_ms, 3),
        )
        self.say(f"segment {segment.number}: {name or 'in place'}, {crossed.solve_ms:.0f} ms")

    def failed(
        self,
        stance: Stance,
        target: Pose,
        name: str,
        move: tuple[Pose, Pose] | None,
        crossed: Crossed,
    ) -> None:
        """Write a transition whose program has no motion."""
        self.write(
            "failed",
            primitive=name,
            move=None if move is None else [pose[0] for pose in move],
            cells=[stance.cell, target[0]],
            quarter_turns=[stance.quarter_turns, target[1]],
            outcome=crossed.outcome,
            reason=crossed.reason,
            contradiction=crossed.refuted and move is not None,
            polygons=len(crossed.problem.polygons),
            retarget_ms=round(crossed.retarget_ms, 3),
            solve_ms=round(crossed.solve_ms, 3),
        )
        self.say(f"{name} failed from {stance.cell} to {target[0]}: {crossed.reason}")

    def withdrawn(self, stance: Stance, target: Pose, name: str | None, seen_s: float) -> None:
        """Write a motion that was planned, and is not walked because of what happened before it began."""
        self.write("withdrawn", primitive=name, cells=[stance.cell, target[0]], seen_s=seen_s)
        self.say(f"{name or 'a step in place'} is withdrawn before it began")

    def event(self, event: Event, segment: int, seen_s: float, landed: Stance | None) -> None:
        """Write what happened to the world, before a segment."""
        stands = None if landed is None else {"cell": landed.cell, "base_m": landed.base_m, "feet_m": landed.feet_m}
        self.write("event", before_segment=segment, seen_s=seen_s, event=event.described(), stands=stands)
        self.say(f"before segment {segment}: {_HAPPENED[event.what]}")


def _checks(
    checked: Sequence[CheckResult], plans: Mapping[Primitive, Mapping[str, str]]
) -> dict[str, list[dict[str, Any]]]:
    """Return new skills with their certificates, and all that physics was asked."""
    new = [one.primitive for one in checked if one.verdict is Physics.FEASIBLE and one.primitive in plans]
    return {
        "new": [{"primitive": one.name, "plan": plans[one]} for one in new],
        "asked": [{"primitive": one.primitive.name, "verdict": one.verdict.value} for one in checked],
    }


def _rows(handled: Handled) -> list[list[Any]]:
    """Return a strategy as it stands in libraries: cell and direction; with headings cell, heading, way."""
    if handled.answer.poses:
        return [[*cell, heading, way] for (cell, heading), way in sorted(handled.answer.poses.items())]
    return [[*cell, way] for cell, way in sorted(handled.answer.strategy.items())]

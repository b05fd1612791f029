"""The run log of a quadruped (docs/formats.md, "Run of a quadruped"): records and plans, on disk as they happen."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from surefoot.compute import sha256_of
from surefoot.footholds import write_plan
from surefoot.missions.quadruped_crossing import Crossed
from surefoot.missions.quadruped_events import Event, Happening
from surefoot.missions.quadruped_route import Pose
from surefoot.missions.quadruped_skills import Handled
from surefoot.missions.quadruped_stance import Segment, Stance
from surefoot.missions.quadruped_timeline import Slot
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
        self.say(f"before setting out: skills made that the way lacks: {len(checks['new'])} of {len(checks['asked'])}")

    def segment(
        self,
        segment: Segment,
        crossed: Crossed,
        slot: Slot,
        stance: Stance,
        target: Pose,
        primitive: Primitive | None,
        move: tuple[Pose, Pose] | None,
    ) -> None:
        """Write a motion that is walked, in place if it has no primitive; its plan is a file before the record is."""
        assert crossed.solution is not None
        name = f"{PLANS}/segment-{segment.number:04}.json"
        write_plan(self.folder / name, crossed.problem, crossed.solution)
        self.write(
            "segment",
            number=segment.number,
            primitive=None if primitive is None else primitive.name,
            move=None if move is None else [pose[0] for pose in move],
            cells=[stance.cell, target[0]],
            quarter_turns=[stance.quarter_turns, target[1]],
            plan={"path": name, "sha256": sha256_of(self.folder / name)},
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
        self.say(f"segment {segment.number}: {primitive.name if primitive else 'in place'}, {crossed.solve_ms:.0f} ms")

    def failed(
        self,
        stance: Stance,
        target: Pose,
        primitive: Primitive,
        move: tuple[Pose, Pose],
        crossed: Crossed,
    ) -> None:
        """Write a transition whose program has no motion."""
        self.write(
            "failed",
            primitive=primitive.name,
            move=[pose[0] for pose in move],
            cells=[stance.cell, target[0]],
            quarter_turns=[stance.quarter_turns, target[1]],
            reason=crossed.reason,
            contradiction=crossed.infeasible,
            polygons=len(crossed.problem.polygons),
            retarget_ms=round(crossed.retarget_ms, 3),
            solve_ms=round(crossed.solve_ms, 3),
        )
        self.say(f"{primitive.name} failed from {stance.cell} to {target[0]}: {crossed.reason}")

    def event(self, event: Event, segment: int, landed: Stance | None) -> None:
        """Write what happened to the world, before a segment."""
        stands = None if landed is None else {"cell": landed.cell, "base_m": landed.base_m, "feet_m": landed.feet_m}
        self.write("event", before_segment=segment, event=event.described(), stands=stands)
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

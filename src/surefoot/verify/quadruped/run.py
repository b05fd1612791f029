"""Verifies the run of a quadruped: footholds, plans, moves of the automaton, continuity (docs/formats.md 12).

Written from docs/formats.md and docs/skills.md. It shares nothing with the executive: the plan of every segment goes
through the checker of foothold plans, every polygon in it is looked for in the terrain file, every class that a request
names is measured again on the polygons as they then are, strategies are followed cell by cell, and both timelines are
added up again.

Not checked: the gap of the programs, beyond what each plan proves.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from surefoot.compute import sha256_of
from surefoot.errors import InputError
from surefoot.robots.quadruped import quadruped
from surefoot.verify.findings import Ledger
from surefoot.verify.footholds.check import check_footholds
from surefoot.verify.footholds.file import BROKEN, FootholdFile, read_foothold_plan
from surefoot.verify.quadruped.claims import LEAVE, Claims
from surefoot.verify.quadruped.ending import Ending
from surefoot.verify.quadruped.events import Expected
from surefoot.verify.quadruped.file import QuadrupedRun, read_quadruped_run
from surefoot.verify.quadruped.moves import Automaton, Labels, Pose
from surefoot.verify.terrain.cell_classes import CellClasses
from surefoot.verify.terrain.laid import check_against_scan
from surefoot.verify.terrain.map import Array, Cell, Patch
from surefoot.verify.values import Fields, Rectangle

_NEAR_M = 1e-6
_ON_M = 2e-6
_TIME_S = 1e-6
_LANDED_M = 0.15
"""How far from where a push takes it the robot may find a pose to stand in (the box of re-targeting)."""
_GRAVITY_MPS2 = 9.81


def check_quadruped_run(folder: Path, ledger: Ledger) -> None:
    """Verify a run folder.

    Raises:
        InputError: a file is missing, truncated, stale or malformed.
    """
    run = read_quadruped_run(folder)
    ground = run.ground
    if ground.given.has("laid"):
        check_against_scan(ground, ground.given.source.parent, ledger)
    Replay(run, ledger).check()


class Replay:
    """The run while it is followed.

    Args:
        run: as it was read.
        ledger: takes the findings.
    """

    def __init__(self, run: QuadrupedRun, ledger: Ledger) -> None:
        self.run, self.ledger = run, ledger
        header = run.header
        start = header.mapping("start")
        self.cell: Cell = start.cell("cell")
        self.base, self.feet = np.array(start.numbers("base_m", 3)), _feet(start)
        self.cell_m = header.number("cell_m", least=1e-3)
        self.origin = np.array(header.point("origin_m"))
        self.cells: Cell = header.cell("cells")
        self.automaton = Automaton(run, ledger, header.cell("grid"))
        self.classes = CellClasses(run.ground, header.cell("grid"))
        self.claims = Claims(run, ledger, self.classes)
        self.goal: Cell = header.mapping("goal").cell("cell")
        self.looked: tuple[Pose, Labels] | None = None
        self.gone: list[Rectangle] = []
        self.expected = Expected(header)
        self.delays_s = header.numbers("delays_s") or (0.0,)
        self.ended = False
        self.before_push = self.cell
        self.segments = self.turns = 0
        self.walked_s = self.started_s = self.idle_s = 0.0

    def check(self) -> None:
        """Follow the run from its first record to its last."""
        self._check_header()
        self._check_stance("run.jsonl line 1")
        steps = {
            "segment": self._segment,
            "failed": self._failed,
            "event": self._event,
            "withdrawn": self._withdrawn,
            "violation": self._violation,
            "detour": self._detour,
            "request": self._request,
            "prepared": self.automaton.certify,
        }
        for record in self.run.records:
            place = f"run.jsonl line {record.line}"
            name = record.text("record")
            if self.ended:
                self._refuse("end", "is not the last record", place)
            if name in steps:
                try:
                    steps[name](record, place)
                except BROKEN as problem:
                    message = f"is no whole record of {name} ({type(problem).__name__}: {str(problem)[:80]})"
                    raise InputError(message, source=record.source, line=record.line) from problem
            elif name == "end":
                self._end(record, place)
        if not self.ended:
            self._refuse("end", "is missing: the run was interrupted", "run.jsonl")
        self.ledger.counts.update(segments=self.segments, requests=self.automaton.requests, idle_s=self.idle_s)

    def _refuse(self, rule: str, message: str, place: str) -> None:
        self.ledger.refuse(f"quadruped, {rule}", message, place)

    def _check_header(self) -> None:
        header, ground = self.run.header, self.run.ground
        for key in ("cell_m", "origin_m", "cells", "grid", "robot"):
            given = header.get(key)
            if (tuple(given) if isinstance(given, list) else given) != getattr(ground, key):
                self._refuse("header", f"{key} is not that of the terrain file", "run.jsonl line 1")
        if header.text("classes") != ground.rules.name:
            self._refuse("header", "the classes are not those of the terrain file", "run.jsonl line 1")
        goal = header.mapping("goal")
        if self._cell_of(np.array(goal.point("place_m"))) != self.goal:
            self._refuse("header", "the goal's cell is not where its place is", "run.jsonl line 1")

    def _cell_of(self, place: Array) -> Cell:
        row, column = np.floor((place - self.origin) / self.cell_m)
        return int(self.cells[0] - 1 - row), int(self.cells[1] - 1 - column)

    def _within(self, cell: Cell, place: Array) -> bool:
        centre = self.origin + (np.array(self.cells) - np.array(cell) - 0.5) * self.cell_m
        return bool((np.abs(place - centre) <= self.cell_m / 2 + _NEAR_M).all())

    def _patch(self, point: Array) -> Patch | None:
        """Return the polygon of the map that a foot stands on; None where there is none, or none any more."""
        if any(w + _ON_M < point[0] < e - _ON_M and s + _ON_M < point[1] < n - _ON_M for w, s, e, n in self.gone):
            return None
        return next((one for one in self.run.ground.patches if one.miss_m(point) <= _ON_M), None)

    def _check_stance(self, place: str) -> None:
        """Check where the robot is said to stand, other than at the end of a motion."""
        if not self._within(self.cell, self.base[:2]):
            self._refuse("cell", f"the base is not in cell {self.cell}", place)
        for foot in self.feet:
            if self._patch(foot) is None:
                self._refuse("foothold", f"a foot stands on no polygon at {_written(foot)}", place)

    def _request(self, record: Fields, place: str) -> None:
        labels = self.automaton.request(record, place, self.cell, self.turns)
        self.looked = (self.cell, self.turns), labels
        self._check_labels("labels", place)
        self.claims.route(record, self.cell, self.turns, self.goal, place)
        record.number("symbolic_ms", least=0.0)
        row, column = request = record.cell("request")
        if not (0 <= row < len(labels) and 0 <= column < len(labels[0])) or labels[row][column] == "obstacle":
            self._refuse("request", f"asks for {request}, an obstacle or outside of the grid", place)

    def _check_labels(self, rule: str, place: str) -> None:
        """Check that the classes of the request in force are those of the ground as it is now."""
        assert self.looked is not None
        (cell, turns), labels = self.looked
        for row, seen in enumerate(self.classes.labels(cell, turns)):
            for column, allowed in enumerate(seen):
                if labels[row][column] not in allowed:
                    found, local = " or ".join(sorted(allowed)), (row, column)
                    self._refuse(
                        rule, f"{labels[row][column]} in {local} of the grid, where {found} is measured", place
                    )

    def _event(self, record: Fields, place: str) -> None:
        event = record.mapping("event")
        self.automaton.given_up.clear()
        for name in ("obstacle_m", "hole_m"):
            if event.has(name):
                low, high = (Fields({name: corner}, record.source, name, record.line).point(name)
                             for corner in event.items(name))  # fmt: skip
                self.gone.append((*low, *high))
                if name == "obstacle_m":
                    self.classes.stands((*low, *high))
                else:
                    self.classes.gone((*low, *high))
        if record.get("stands") is not None:
            stands = record.mapping("stands")
            self._check_push(event, stands, place)
            if stands.cell("cell") != self.cell:
                self.automaton.interrupted()
            self.before_push = self.cell
            self.cell, self.base, self.feet = stands.cell("cell"), np.array(stands.numbers("base_m", 3)), _feet(stands)
            self._check_stance(place)
        if record.whole("before_segment") != self.segments:
            self._refuse("event", f"says that it comes before another segment than {self.segments}", place)
        for problem in self.expected.see(record, self.segments, self.started_s):
            self._refuse("event", problem, place)

    def _check_push(self, event: Fields, stands: Fields, place: str) -> None:
        """Check that only a push moves the robot, and about where it takes it."""
        if not event.has("push_m"):
            self._refuse("event", "moves the robot, and is no push", place)
            return
        pushed = self.base[:2] + np.array(event.point("push_m"))
        if float(np.abs(np.array(stands.numbers("base_m", 3))[:2] - pushed).max()) > _LANDED_M + _NEAR_M:
            self._refuse("event", f"takes the robot more than {_LANDED_M} m away from where it was pushed", place)

    def _withdrawn(self, record: Fields, place: str) -> None:
        problem = self.expected.withdrawn(record)
        here, _ = record.cells("cells")
        if problem or here not in (self.cell, self.before_push):
            self._refuse("withdrawn", problem or f"begins in {here}, but the robot is in {self.cell}", place)
        self.automaton.withdrawn(record, place)

    def _failed(self, record: Fields, place: str) -> None:
        here, there = record.cells("cells")
        if here != self.cell:
            self._refuse("move", f"is tried from {here}, but the robot is in {self.cell}", place)
        self.claims.failed(record, place)
        if record.text("primitive").startswith(LEAVE):
            self.claims.leaves(here, self.turns, place)
        self.automaton.failed(record, place, here, there, self.turns)

    def _violation(self, record: Fields, place: str) -> None:
        record.text("text")
        record.text("assumption", among=("post", "terrain", "obstacle"))
        self._check_here(record, place)

    def _detour(self, record: Fields, place: str) -> None:
        self._check_here(record, place)
        for pair in record.items("given_up"):
            here, there = Fields({"given_up": pair}, record.source, record.place, record.line).cells("given_up")
            self.automaton.given_up.add((here, there))

    def _check_here(self, record: Fields, place: str) -> None:
        if record.cell("cell") != self.cell:
            self._refuse("cell", f"names {record.cell('cell')}, but the robot is in {self.cell}", place)

    def _segment(self, record: Fields, place: str) -> None:
        if record.whole("number") != self.segments:
            self._refuse("segment", f"has number {record.whole('number')}, not {self.segments}", place)
        for problem in self.expected.problems(self.segments, record.number("plan_start_s"), record.number("start_s")):
            self._refuse("event", problem, place)
        self.segments += 1
        here, there = record.cells("cells")
        leaves = str(record.get("primitive")).startswith(LEAVE)
        if leaves:
            self.claims.leaves(here, self.turns, place)
        if here != self.cell:
            self._refuse("continuity", f"begins in {here}, but the robot is in {self.cell}", place)
        self.turns = self.automaton.move(record, place, here, there, self.turns)
        if record.get("primitive") is not None and self.looked is not None and not leaves:
            self._check_labels("assumption", place)
        for cell in (there,) if leaves else (here, there):
            if self.classes.blocked(cell):
                self._refuse("obstacle", f"cell {cell} holds an obstacle, or is outside of the map", place)
        plan = self._plan(record, place)
        if plan is not None:
            self._check_plan(plan, there, place)
            self._check_times(record, plan, place)
            self.claims.segment(record, plan, there, place)
            self.base, self.feet = plan.arrays["base_m"][-1], plan.arrays["feet_m"][-1]
        self.cell = there

    def _plan(self, record: Fields, place: str) -> FootholdFile | None:
        """Return the plan of a segment, after it went through the checker of foothold plans."""
        named = record.mapping("plan")
        path = self.run.folder / named.text("path")
        if not path.resolve().is_relative_to(self.run.folder.resolve()):
            raise named.wrong("path", "has to be inside the run folder")
        try:
            stale = sha256_of(path) != named.text("sha256")
        except OSError as problem:
            raise InputError("cannot be read", source=path) from problem
        if stale:
            self._refuse("plan", f"{named.text('path')} is another file than the one that was walked", place)
            return None
        ledger = Ledger()
        check_footholds(path, ledger)
        for finding in ledger.kept:
            self._refuse("plan", f"{finding.rule}: {finding.message}", f"{named.text('path')}, {place}")
        plan = read_foothold_plan(path)
        if plan.answer.get("verdict") != "feasible" or not plan.arrays:
            self._refuse("plan", "holds no motion", named.text("path"))
            return None
        return plan

    def _check_plan(self, plan: FootholdFile, there: Cell, place: str) -> None:
        """Check that a plan is about this robot, on this ground, from where the robot stands, into the next cell."""
        arrays, values = plan.arrays, plan.values
        self._check_robot(values["robot"], place)
        if plan.number("gravity_mps2") != _GRAVITY_MPS2:
            self._refuse("plan", f"is about a gravity other than {_GRAVITY_MPS2} m/s²", place)
        if not np.allclose(values["start"]["position_m"], self.base, atol=_NEAR_M):
            self._refuse("continuity", "the base does not begin where it came to rest", place)
        if not np.allclose(values["start"]["feet_m"], self.feet, atol=_NEAR_M):
            self._refuse("continuity", "the feet do not begin where they stand", place)
        yaws = [float(values[end]["rpy_rad"][2]) for end in ("start", "goal")]
        if abs(math.remainder(yaws[1] - self.turns * math.pi / 2, 2 * math.pi)) > _NEAR_M:
            self._refuse("heading", "the motion does not end with the heading of the automaton", place)
        if not self._within(there, arrays["base_m"][-1][:2]):
            self._refuse("cell", f"the base does not end in cell {there}", place)
        if float(np.abs(arrays["base_velocity_mps"][-1]).max()) > _NEAR_M or not plan.contacts[-1].all():
            self._refuse("rest", "the motion does not end at rest on four feet", place)
        for number, step in enumerate(plan.steps):
            foothold = arrays["feet_m"][step.touch, step.foot]
            self._check_foothold(foothold, values["polygons"][plan.polygons[number]], place)
        for foot in arrays["feet_m"][-1]:
            if self._patch(foot) is None:
                self._refuse("foothold", f"a foot ends on no polygon, at {_written(foot)}", place)

    def _check_robot(self, given: Mapping[str, Any], place: str) -> None:
        robot = quadruped(self.run.header.text("robot"))
        for name in robot.__slots__:
            expected = getattr(robot, name)
            found = tuple(given[name]) if isinstance(expected, tuple) else given.get(name, expected)
            if name != "source" and found != expected:
                self._refuse("robot", f"{name} is not that of {robot.name}", place)

    def _check_foothold(self, point: Array, polygon: Mapping[str, Any], place: str) -> None:
        """Check that a foothold is on the map, and that the program knew the ground there as it is."""
        patch = self._patch(point)
        if patch is None:
            self._refuse("foothold", f"is on no polygon of the terrain, at {_written(point)}", place)
            return
        corners = np.array(polygon["vertices_m"], dtype=float)
        if any(patch.miss_m(corner) > _ON_M for corner in corners) and not self._part_of_map(corners):
            self._refuse("foothold", f"the polygon below {_written(point)} is none of the terrain", place)
        if polygon["friction"] != patch.friction:
            self._refuse("foothold", f"friction at {_written(point)} is {patch.friction}", place)

    def _part_of_map(self, corners: Array) -> bool:
        """Return whether all corners lie on one polygon of the map (where polygons overlap, another than the first)."""
        return any(all(one.miss_m(corner) <= _ON_M for corner in corners) for one in self.run.ground.patches)

    def _check_times(self, record: Fields, plan: FootholdFile, place: str) -> None:
        start, end = record.number("start_s"), record.number("end_s")
        begun, sent, idle = record.number("plan_start_s"), record.number("sent_s"), record.number("idle_s")
        horizon = len(plan.contacts) * plan.number("step_s")
        first = self.segments == 1
        if abs(end - start - horizon) > _TIME_S:
            self._refuse("time", f"lasts {end - start:g} s, the plan {horizon:g} s", place)
        if not self.started_s - _TIME_S <= begun <= sent + _TIME_S:
            self._refuse("time", "is planned before the motion in front began, or sent before it was planned", place)
        if sent - self.started_s < self.delays_s[(self.segments - 1) % len(self.delays_s)] - _TIME_S:
            self._refuse("time", "is sent before the delay is over that the header names", place)
        if abs(start - max(sent, self.walked_s)) > _TIME_S:
            self._refuse("time", f"begins at {start:g} s, not when the robot stands and the plan is there", place)
        waited = 0.0 if first else max(sent - self.walked_s, 0.0)
        if abs(idle - waited) > _TIME_S:
            self._refuse("time", f"the robot waited {waited:g} s, not {idle:g} s", place)
        self.idle_s += waited
        self.started_s, self.walked_s = start, end

    def _end(self, record: Fields, place: str) -> None:
        self.ended = True
        reached = self.cell == self.goal
        if record.flag("reached") != reached:
            self._refuse("end", f"the robot is in {self.cell}, so reached is {str(reached).lower()}", place)
        if record.cell("cell") != self.cell or record.whole("segments") != self.segments:
            self._refuse("end", f"there are {self.segments} segments, and the last one ends in {self.cell}", place)
        why_not = record.text("why_not")
        ending = Ending(self.automaton, self.classes, self.goal, turning=self.run.ground.yaw)
        footing = all(self._patch(foot) is not None for foot in self.feet)
        problem = "" if reached else ending.problem(why_not, (self.cell, self.turns), self.segments, footing=footing)
        if problem or (reached and why_not):
            self._refuse("end", problem or "gives a reason, although the goal was reached", place)
        self.ledger.counts.update(reached=reached)


def _feet(fields: Fields) -> Array:
    rows = [Fields({"feet_m": row}, fields.source, fields.place, fields.line) for row in fields.items("feet_m")]
    feet = np.array([row.numbers("feet_m", 3) for row in rows])
    if feet.shape != (4, 3):
        raise fields.wrong("feet_m", "needs four places")
    return feet


def _written(point: Array) -> str:
    return "(" + ", ".join(f"{value:.3f}" for value in point) + ")"

"""Derives again what the records of a quadruped's run say about themselves (docs/formats.md 12).

Sizes of programs, options, the shift of re-targeting, routes, times, failed moves: what can be derived from plans,
ground and other records is, and of the rest at least type and range are checked.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from surefoot.robots.quadruped import quadruped
from surefoot.verify.findings import Ledger
from surefoot.verify.footholds.file import FootholdFile
from surefoot.verify.quadruped.file import QuadrupedRun
from surefoot.verify.terrain.cell_classes import CellClasses
from surefoot.verify.terrain.class_rules import OBSTACLE
from surefoot.verify.terrain.map import Cell
from surefoot.verify.values import Fields

LEAVE = "leave "
"""Begins the name of a motion out of a cell that has become an obstacle."""
_SHIFT_M = 1e-4
_TIME_S = 1e-4
_EDGE_M = 0.031
_OUTCOMES = ("infeasible", "no pose", "limit")
_PER_SAMPLE = 66
_CLOCK = 20.0


class Claims:
    """What a run says about itself.

    Args:
        run: as it was read.
        ledger: takes the findings.
        classes: of the ground as it is; changes with it.
    """

    def __init__(self, run: QuadrupedRun, ledger: Ledger, classes: CellClasses) -> None:
        self.run, self.ledger, self.classes = run, ledger, classes
        header = run.header
        self.gap = header.number("gap", least=0.0)
        self.time_limit_s = header.number("time_limit_s", least=0.0)
        self.collision = header.flag("collision")
        self.joint_reach = header.has("joint_reach") and header.flag("joint_reach")
        self.base_above_m = -quadruped(header.text("robot")).foot_reference_m[2]

    def _refuse(self, rule: str, message: str, place: str) -> None:
        self.ledger.refuse(f"quadruped, {rule}", message, place)

    def segment(self, record: Fields, plan: FootholdFile, there: Cell, place: str) -> None:
        """Check what the record of a motion says about its program."""
        values = plan.values
        options, polygons, regions = values["options"], len(values["polygons"]), len(values["free_regions"])
        windows = int(options["collision_windows"]) if options["collision"] else 0
        sizes = {
            "polygons": polygons,
            "continuous": _PER_SAMPLE * len(plan.contacts),
            "binaries": len(plan.steps) * polygons + 4 * windows * regions,
        }
        for name, expected in sizes.items():
            if record.whole(name) != expected:
                self._refuse("program", f"{name} is {record.whole(name)}; the plan has {expected}", place)
        self._options(options, regions, place)
        here, _ = record.cells("cells")
        if self.collision and not regions and self._edge(here, there):
            self._refuse("program", "collision is true, and feet need not keep clear of the edge of a step", place)
        self._shift(record, values["goal"]["position_m"], there, place)
        spent_s = 1e-3 * sum(record.number(name, least=0.0) for name in ("retarget_ms", "solve_ms"))
        record.number("clock_ms", least=0.0)
        planned_s = record.number("sent_s") - record.number("plan_start_s")
        if spent_s > planned_s + _TIME_S:
            self._refuse("time", f"planning took {planned_s:g} s, and its program {spent_s:g} s of them", place)

    def _options(self, options: dict[str, Any], regions: int, place: str) -> None:
        for name, expected in (("gap", self.gap), ("time_limit_s", _CLOCK * self.time_limit_s)):
            if abs(float(options[name]) - expected) > 1e-9 * max(1.0, expected):
                self._refuse("program", f"{name} is {options[name]:g} in the plan; the header says {expected:g}", place)
        if bool(options.get("joint_reach", False)) != self.joint_reach:
            self._refuse("program", "joint_reach in the plan is not that of the header", place)
        if bool(options["collision"]) != bool(regions) or (regions and not self.collision):
            self._refuse("program", "collision in the plan is not what the header and the free regions say", place)

    def _edge(self, here: Cell, there: Cell) -> bool:
        """Return whether two cells surely have the edge of a step between them."""
        heights = [self.classes.height_m(cell) for cell in (here, there)]
        levels = all(self.classes.has_level((here, there), one) for one in heights)
        return here != there and self.classes.edge_m(here, there) > _EDGE_M and levels

    def _shift(self, record: Fields, goal: list[float], there: Cell, place: str) -> None:
        """Check by how much the goal of a program is beside the middle of its cell."""
        (west, east), (south, north) = self.classes.box(there)
        height_m = self.classes.height_m(there)
        wished = np.array([(west + east) / 2, (south + north) / 2, height_m + self.base_above_m])
        shift_m = float(np.linalg.norm(np.array(goal, dtype=float) - wished))
        if not abs(record.number("shift_m", least=0.0) - shift_m) <= _SHIFT_M:
            self._refuse("program", f"shift_m is {record.number('shift_m'):g}; the goal is {shift_m:.6f} m off", place)

    def failed(self, record: Fields, place: str) -> None:
        """Check what the record of a move without a motion says about its program."""
        outcome, reason = record.text("outcome", among=_OUTCOMES), record.text("reason")
        for name in ("retarget_ms", "solve_ms"):
            record.number(name, least=0.0)
        record.whole("polygons", least=0)
        if not reason or reason.startswith("limit:") != (outcome == "limit"):
            self._refuse("failed", f"the reason is not that of {outcome}: {reason!r}", place)
        if outcome == "no pose" and record.number("solve_ms") != 0:
            self._refuse("failed", "a program was solved, although there is no pose to end in", place)
        certified = not record.text("primitive").startswith(LEAVE)
        if record.flag("contradiction") != (certified and outcome == "infeasible"):
            self._refuse("failed", f"contradiction is not what {outcome} means for this move", place)

    def route(self, record: Fields, cell: Cell, turns: int, goal: Cell, place: str) -> None:
        """Check that a route leads from the robot to the goal, from look to look, over cells to stand in."""
        route = record.cells("route")
        if not route or route[0] != cell or route[-1] != goal:
            self._refuse("route", f"does not lead from {cell} to {goal}", place)
            return
        rows, columns = self.classes.grid if turns % 2 == 0 else self.classes.grid[::-1]
        for here, there in pairwise(route):
            far = abs(there[0] - here[0]) > rows // 2 or abs(there[1] - here[1]) > columns // 2
            if far or here == there or not self.classes.stands_in(there, turns):
                self._refuse("route", f"goes from {here} to {there}, out of sight or into an obstacle", place)

    def leaves(self, cell: Cell, turns: int, place: str) -> None:
        """Check that a cell that is left without a skill has become an obstacle."""
        if OBSTACLE not in self.classes.own(cell, turns):
            self._refuse("leave", f"leaves {cell} without a skill, although the robot can stand there", place)

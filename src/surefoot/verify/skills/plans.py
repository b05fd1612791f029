"""Checks the certificate of a skill: a foothold plan that goes from one cell to the next in the skill's direction."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from surefoot.compute import sha256_of
from surefoot.errors import InputError
from surefoot.verify.artefacts import parse_json, read_bytes
from surefoot.verify.findings import Ledger
from surefoot.verify.footholds.check import check_footholds
from surefoot.verify.footholds.problem import named_gait
from surefoot.verify.values import Fields

WAYS = {"forward": (-1, 0), "backward": (1, 0), "left": (0, -1), "right": (0, 1)}
"""The change of (row, column) of a move; row 0 is ahead, column 0 to the left."""

TURNS = {"turn-left": 1, "turn-right": -1}
"""The change of heading of a turn in place, in quarter turns counter-clockwise."""

_TURN_RAD = 1e-6
_TIME_S = 1e-9
_COST = 1e-9
_ANY_GAIT = re.compile(r"free-[0-9]+(\.[0-9]+)?s")


def certificate_problem(check: Fields, way: str, cell_m: float, known: dict[str, Motion]) -> str:
    """Return what is wrong with the plan of a feasible check; empty if nothing is.

    Args:
        check: the check.
        way: the direction or the turn of its primitive.
        cell_m: side of a cell [m].
        known: plans that were checked before, by hash; grows.
    """
    if check.get("plan") is None:
        return "has no plan that could be checked"
    named = check.mapping("plan")
    folder = check.source.parent
    path = folder / named.text("path")
    if not path.resolve().is_relative_to((folder / "plans").resolve()):
        return f"names {named.text('path')}, which is not in plans/"
    if not path.is_file() or sha256_of(path) != named.text("sha256"):
        return f"has a plan that is missing or was changed, {named.text('path')}"
    sha256 = named.text("sha256")
    if sha256 not in known:
        known[sha256] = Motion.of(path)
    return known[sha256].misses(way, cell_m / 2) or known[sha256].contradicts(check)


@dataclass(frozen=True, slots=True)
class Motion:
    """A plan as it was checked; several primitives may have the same one.

    Attributes:
        problem: why it certifies nothing; empty if it does.
        ahead_m: how far it goes forward.
        left_m: how far it goes to the left.
        turned_rad: how far it turns, counter-clockwise.
        modes, times_s: its gait: which feet are in contact between which times.
        cost: its objective.
    """

    problem: str
    ahead_m: float = 0.0
    left_m: float = 0.0
    turned_rad: float = 0.0
    modes: tuple[str, ...] = ()
    times_s: tuple[float, ...] = (0.0,)
    cost: float = 0.0

    @classmethod
    def of(cls, path: Path) -> Motion:
        """Check a plan."""
        own = Ledger()
        try:
            check_footholds(path, own)
            fields = Fields.of(parse_json(read_bytes(path), path), path)
            values, cost = fields.mapping("values"), fields.mapping("answer").get("objective")
            start, goal = (values.mapping(end).numbers("position_m", 3) for end in ("start", "goal"))
            before, after = (values.mapping(end).numbers("rpy_rad", 3) for end in ("start", "goal"))
        except InputError as problem:
            return cls(f"has a plan that cannot be read: {problem.key or path.name} {problem.message}")
        if own.total or own.counts.get("verdict") != "feasible":
            return cls(f"has a plan that is refused: {own.kept[0] if own.kept else 'it claims no motion'}")
        if max(map(abs, (*before, *after[:2]))) > _TURN_RAD:
            return cls("has a plan that does not begin level and along x, and end level")
        gait = values.mapping("gait")
        modes, times = tuple(map(str, gait.items("modes"))), gait.numbers("switching_times_s")
        own_cost = float(cost) if isinstance(cost, int | float) else math.nan
        return cls("", goal[0] - start[0], goal[1] - start[1], after[2], modes, times, own_cost)

    def misses(self, way: str, half_m: float) -> str:
        """Return why the plan does not certify a direction or a turn; empty if it does."""
        return self.problem or (self.not_one_turn if way in TURNS else self.not_one_cell)(way, half_m)

    def contradicts(self, check: Fields) -> str:
        """Return which of gait, horizon and cost a check does not have from its plan; empty if it has them all."""
        name = check.text("gait")
        known = named_gait(name)
        if known is None and not _ANY_GAIT.fullmatch(name):
            return f"is said to be done in {name!r}, which is no gait"
        horizon_s = float(name[5:-1]) if known is None else known[1][-1]
        fits = known is None or (tuple(known[0]) == self.modes and np.allclose(known[1], self.times_s, atol=_TIME_S))
        if not fits or abs(horizon_s - self.times_s[-1]) > _TIME_S:
            return f"is said to be done in {name}, and its plan is not"
        if abs(check.number("horizon_s") - self.times_s[-1]) > _TIME_S:
            return f"is said to take {check.number('horizon_s'):g} s, and its plan takes {self.times_s[-1]:g} s"
        if not math.isclose(check.number("cost"), self.cost, rel_tol=_COST):
            return f"is said to cost {check.number('cost'):g}, and its plan costs {self.cost:g}"
        return ""

    def not_one_cell(self, way: str, half_m: float) -> str:
        """Return that the motion does not lead to the next cell in a direction; empty if it does."""
        down, right = WAYS[way]
        along_m = -down * self.ahead_m - right * self.left_m
        across_m = down * self.left_m - right * self.ahead_m
        if abs(self.turned_rad) > _TURN_RAD:
            return f"has a plan that turns by {math.degrees(self.turned_rad):.0f} degrees on its way {way}"
        if half_m < along_m < 3 * half_m and abs(across_m) < half_m:
            return ""
        return (
            f"has a plan that goes {self.ahead_m:.2f} m ahead and {self.left_m:.2f} m to the left, not one cell {way}"
        )

    def not_one_turn(self, way: str, half_m: float) -> str:
        """Return that the motion is no quarter turn on the spot; empty if it is."""
        stays = abs(self.ahead_m) < half_m and abs(self.left_m) < half_m
        if stays and abs(self.turned_rad - TURNS[way] * math.pi / 2) <= _TURN_RAD:
            return ""
        return (
            f"has a plan that turns by {math.degrees(self.turned_rad):.0f} degrees, {self.ahead_m:.2f} m ahead and "
            f"{self.left_m:.2f} m to the left, and is no {way} in place"
        )

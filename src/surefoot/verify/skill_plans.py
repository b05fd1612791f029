"""Checks the certificate of a skill: a foothold plan that goes from one cell to the next in the skill's direction."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from surefoot.compute import sha256_of
from surefoot.errors import InputError
from surefoot.verify.artefacts import parse_json, read_bytes
from surefoot.verify.findings import Ledger
from surefoot.verify.footholds import check_footholds
from surefoot.verify.values import Fields

WAYS = {"forward": (-1, 0), "backward": (1, 0), "left": (0, -1), "right": (0, 1)}
"""The change of (row, column) of a move; row 0 is ahead, column 0 to the left."""

TURNS = {"turn-left": 1, "turn-right": -1}
"""The change of heading of a turn in place, in quarter turns counter-clockwise."""

_TURN_RAD = 1e-6


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
    return known[sha256].misses(way, cell_m / 2)


@dataclass(frozen=True, slots=True)
class Motion:
    """A plan as it was checked; several primitives may have the same one.

    Attributes:
        problem: why it certifies nothing; empty if it does.
        ahead_m: how far it goes forward.
        left_m: how far it goes to the left.
        turned_rad: how far it turns, counter-clockwise.
    """

    problem: str
    ahead_m: float = 0.0
    left_m: float = 0.0
    turned_rad: float = 0.0

    @classmethod
    def of(cls, path: Path) -> Motion:
        """Check a plan."""
        own = Ledger()
        try:
            check_footholds(path, own)
            values = Fields.of(parse_json(read_bytes(path), path), path).mapping("values")
            start, goal = (values.mapping(end).numbers("position_m", 3) for end in ("start", "goal"))
            before, after = (values.mapping(end).numbers("rpy_rad", 3) for end in ("start", "goal"))
        except InputError as problem:
            return cls(f"has a plan that cannot be read: {problem.key or path.name} {problem.message}")
        if own.total or own.counts.get("verdict") != "feasible":
            return cls(f"has a plan that is refused: {own.kept[0] if own.kept else 'it claims no motion'}")
        if max(map(abs, (*before, *after[:2]))) > _TURN_RAD:
            return cls("has a plan that does not begin level and along x, and end level")
        return cls("", goal[0] - start[0], goal[1] - start[1], after[2])

    def misses(self, way: str, half_m: float) -> str:
        """Return why the plan does not certify a direction or a turn; empty if it does."""
        return self.problem or (self.not_one_turn if way in TURNS else self.not_one_cell)(way, half_m)

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

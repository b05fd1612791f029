"""Why a cell is an obstacle: the measures that keep it out of every class, and what is allowed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from surefoot.skills.classes import ClassSet
from surefoot.skills.measures import NONE, SINGLE
from surefoot.skills.quadruped_terrain import QuadrupedTerrain
from surefoot.skills.values import OBSTACLE, Cell

_WORDS = {
    "coverage": ("the share of it that ground covers is", ""),
    "largest": ("the share of its largest connected piece of ground is", ""),
    "band_m": ("the widest band without ground across it is", " m"),
    "spacing_m": ("the distance between its stones is", " m"),
    "rise_m": ("its height above the robot's ground is", " m"),
    "spread_m": ("the heights within it differ by", " m"),
    "slope_deg": ("its steepest ground has", " degrees"),
    "across_m": ("the spacing of its bars across the heading is", " m"),
    "along_m": ("the spacing of its bars along the heading is", " m"),
}
_BARS = ("across_m", "along_m")
_STAND_FOR = {"": "", "none": "without end", "single": "that of a single one"}


@dataclass(frozen=True, slots=True)
class Excess:
    """A measure that keeps a cell out of the class that is nearest to it.

    Attributes:
        measure: its name.
        value: what was measured.
        low: the least value of that class; minus infinity if there is none.
        high: where the class ends, itself not allowed; infinity if it does not.
    """

    measure: str
    value: float
    low: float
    high: float

    @property
    def text(self) -> str:
        """The measure, its value and its limit in words."""
        words, unit = _WORDS[self.measure]
        value = _STAND_FOR[self.stands_for] or f"{round(self.value, 3):g}{unit}"
        return f"{words} {value}, {self._allowed}"

    @property
    def stands_for(self) -> str:
        """What a value that is no number of its own stands for: ``none`` or a ``single`` bar; empty for numbers."""
        if self.value >= NONE:
            return "none"
        return "single" if self.measure in _BARS and self.value == SINGLE else ""

    @property
    def _allowed(self) -> str:
        if math.isinf(self.low):
            return f"allowed is less than {self.high:g}"
        if math.isinf(self.high):
            return f"at least {self.low:g} is needed"
        return f"allowed is {self.low:g} to {self.high:g}"


def excesses(classes: ClassSet, measured: Mapping[str, float]) -> tuple[Excess, ...]:
    """Return the fewest measures that would have to be others for a cell to be of a class; none if it is of one.

    Among as many measures, those count that are the fewest levels away.
    """
    if classes.classify(measured) != OBSTACLE:
        return ()
    here = classes.levels_of(measured)
    order = [[name for name, _ in levels] for levels in classes.levels.values()]

    def away(levels: tuple[str, ...]) -> tuple[int, int]:
        steps = [abs(names.index(a) - names.index(b)) for names, a, b in zip(order, here, levels, strict=True)]
        return sum(step > 0 for step in steps), sum(steps)

    nearest = min((levels for levels, label in classes.claims.items() if label != OBSTACLE), key=away)
    found = []
    for (measure, levels), was, wanted in zip(classes.levels.items(), here, nearest, strict=True):
        if was != wanted:
            ends = [-math.inf, *(end for _, end in levels)]
            k = [name for name, _ in levels].index(wanted)
            found.append(Excess(measure, measured[measure], ends[k], ends[k + 1]))
    return tuple(found)


def why_obstacle(terrain: QuadrupedTerrain, cell: Cell, support_m: float | None = None) -> tuple[Excess, ...]:
    """Return why a cell of the map is an obstacle; none if it is of a class.

    Args:
        terrain: the map.
        cell: of the map.
        support_m: height of the ground that the robot stands on; None: it stands in this cell.
    """
    measured = terrain.measured[cell]
    return excesses(terrain.classes, measured.seen_from(measured.height_m if support_m is None else support_m))


def in_words(why: tuple[Excess, ...]) -> str:
    """Return reasons as one clause."""
    return " and ".join(one.text for one in why)

"""Classes of terrain: levels of measures, rules over levels, and the worst case of every class.

The rules are data (``class_rules.yaml``, or a file of the user). Sets are small enough to be checked completely when
they are read: every combination of levels has to belong to exactly one class, so that no cell is without a class or has
two.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from itertools import product
from pathlib import Path

from pydantic import ValidationError

from surefoot.documents import Document, FileProblems, Loc, dotted, problems_of, read_yaml
from surefoot.errors import InputError
from surefoot.robots.quadruped import quadruped_names
from surefoot.skills.class_blocks import GroundBlock, RulesBlock, SetBlock
from surefoot.skills.values import OBSTACLE

MEASURES = {
    "ground": ("coverage", "band_m", "largest", "spacing_m", "rise_m", "spread_m", "slope_deg"),
    "bars": ("across_m", "along_m", "rise_m", "spread_m"),
}
"""What is measured of a cell, by the way of measuring (``surefoot.skills.measures``)."""

SHIPPED = Path(__file__).with_name("class_rules.yaml")
_MOST_COMBINATIONS = 200_000


@dataclass(frozen=True, slots=True)
class TerrainClass:
    """A class of terrain.

    Attributes:
        name: of the class.
        about: what it is, for people.
        ground: its worst case.
    """

    name: str
    about: str
    ground: GroundBlock


@dataclass(frozen=True, eq=False)
class ClassSet:
    """Classes that share measures.

    Attributes:
        name: of the set.
        robot: name of the robot that the set was made for.
        cell_m: side of a cell that it was made for.
        margin_m: what the foot needs on every edge.
        measures: ``ground`` or ``bars``, see ``MEASURES``.
        levels: by measure, pairs of a level's name and where it ends.
        classes: by name, in the order of the file; without the obstacle.
        claims: the class of every combination of levels, in the order of ``levels``.
        easy: pairs of classes (here, next) among which the first skills are looked for.
        digest: SHA-256 of the rules; a library keeps it.
        source: the file of rules; None for those that come with Surefoot.
        cells_m: least and largest side of the cells for which the rules make sense.
    """

    name: str
    robot: str
    cell_m: float
    margin_m: float
    measures: str
    levels: Mapping[str, tuple[tuple[str, float], ...]]
    classes: Mapping[str, TerrainClass]
    claims: Mapping[tuple[str, ...], str]
    easy: tuple[tuple[str, str], ...]
    digest: str
    source: Path | None = None
    cells_m: tuple[float, float] | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """The classes' names, without the obstacle."""
        return tuple(self.classes)

    def levels_of(self, measured: Mapping[str, float]) -> tuple[str, ...]:
        """Return the level of every measure."""
        return tuple(_level(levels, measured[name]) for name, levels in self.levels.items())

    def classify(self, measured: Mapping[str, float]) -> str:
        """Return the class that measures belong to, or ``obstacle``."""
        return self.claims[self.levels_of(measured)]

    def check_label(self, label: str) -> None:
        """Refuse what is neither a class of this set nor the obstacle.

        Raises:
            InputError: it is none.
        """
        if label != OBSTACLE and label not in self.classes:
            raise InputError(f"there is no class {label!r}; {self.name} has: {', '.join(self.names)}, {OBSTACLE}")

    def turned(self, label: str, quarter_turns: int) -> str:
        """Return what a label is called after the robot turned that many times by 90 degrees.

        Bars across the heading lie along it after a quarter turn, so their labels swap; all others stay.
        """
        if quarter_turns % 2 == 0 or label == OBSTACLE:
            return label
        ground = self.classes[label].ground
        return next(one.name for one in self.classes.values() if one.ground == swapped(ground))


def swapped(ground: GroundBlock) -> GroundBlock:
    """Return a pattern as it looks after a quarter turn."""
    return ground.model_copy(update={"across": ground.along, "along": ground.across})


def _level(levels: tuple[tuple[str, float], ...], value: float) -> str:
    return next((name for name, below in levels if value < below), levels[-1][0])


@cache
def class_set(name: str) -> ClassSet:
    """Return a set that comes with Surefoot.

    Raises:
        InputError: there is none of that name; the message lists those that exist.
    """
    sets = read_classes(SHIPPED)
    if name not in sets:
        raise InputError(
            f"there is no set of classes {name!r}; there are: {', '.join(sets)}, or give a file of rules", key="classes"
        )
    return sets[name]


def read_classes(path: Path) -> dict[str, ClassSet]:
    """Read a file of terrain classes and check that its rules claim every cell exactly once.

    Raises:
        InputError: with every problem of the file, one sentence each.
    """
    document = read_yaml(path)
    problems = list(document.problems)
    try:
        block = RulesBlock.model_validate(document.value)
    except ValidationError as refused:
        problems += problems_of(refused, RulesBlock.model_json_schema(), path, document.lines)
        raise FileProblems(problems) from None
    if problems:
        raise FileProblems(problems)
    return {name: _Reading(path, document, name, given).result() for name, given in block.sets.items()}


class _Reading:
    """What only several keys together tell about a set."""

    def __init__(self, path: Path, document: Document, name: str, block: SetBlock) -> None:
        self.path, self.lines, self.name, self.block = path, document.lines, name, block
        self.problems: list[InputError] = []

    def result(self) -> ClassSet:
        block = self.block
        if block.robot not in quadruped_names():
            self.complain(f"there is no robot {block.robot!r}; there are: {', '.join(quadruped_names())}", "robot")
        levels = {name: self.levels(name) for name in block.levels}
        wanted = MEASURES[block.measures]
        if sorted(levels) != sorted(wanted):
            self.complain(f"needs levels of exactly {', '.join(wanted)}, for `measures: {block.measures}`", "levels")
        if block.cells_m is not None and not block.cells_m[0] <= block.cell_m <= block.cells_m[1]:
            self.complain(f"needs two ascending numbers with cell_m, {block.cell_m:g}, between them", "cells_m")
        if OBSTACLE in block.classes:
            self.complain("is no class: its rules stand under the key `obstacle` of the set", "classes", OBSTACLE)
        self.check_rules(levels)
        for number, pair in enumerate(block.easy):
            if unknown := set(pair) - set(block.classes):
                self.complain(f"there is no class {', '.join(sorted(unknown))} in this set", "easy", number)
        self.stop()
        if math.prod(map(len, levels.values())) > _MOST_COMBINATIONS:
            self.complain(f"have more than {_MOST_COMBINATIONS} combinations; give fewer levels", "levels")
            self.stop()
        claims = self.claims(levels)
        classes = {name: TerrainClass(name, one.about, one.ground) for name, one in block.classes.items()}
        self.check_turns()
        self.stop()
        # which other cells a set serves changes nothing for the one that a library was made for
        text = json.dumps(block.model_dump(mode="json", exclude={"cells_m"}), sort_keys=True)
        digest = hashlib.sha256(text.encode()).hexdigest()
        return ClassSet(
            self.name, block.robot, block.cell_m, block.margin_m, block.measures, levels, classes, claims, block.easy,
            digest, None if self.path == SHIPPED else self.path, block.cells_m,
        )  # fmt: skip

    def complain(self, message: str, *where: str | int) -> None:
        loc: Loc = ("sets", self.name, *where)
        known = next((loc[:size] for size in range(len(loc), -1, -1) if loc[:size] in self.lines), ())
        self.problems.append(InputError(message, source=self.path, line=self.lines.get(known), key=dotted(loc)))

    def stop(self) -> None:
        if self.problems:
            raise FileProblems(self.problems)

    def levels(self, measure: str) -> tuple[tuple[str, float], ...]:
        given = self.block.levels[measure]
        ends = [one.below for one in given]
        if not ends or ends[-1] is not None or None in ends[:-1]:
            self.complain("needs `below` for every level but the last", "levels", measure)
            return ()
        numbers = [end for end in ends if end is not None]
        if numbers != sorted(set(numbers)) or len({one.name for one in given}) != len(given):
            self.complain("needs levels with different names and ascending ends", "levels", measure)
        return tuple((one.name, math.inf if one.below is None else one.below) for one in given)

    def check_rules(self, levels: Mapping[str, tuple[tuple[str, float], ...]]) -> None:
        """Refuse rules about measures or levels that do not exist."""
        places = [(("classes", name, "when"), one.when) for name, one in self.block.classes.items()]
        for place, rules in (*places, (("obstacle",), self.block.obstacle)):
            for number, rule in enumerate(rules):
                for measure, named in rule.items():
                    known = [name for name, _ in levels.get(measure, ())]
                    if not known:
                        self.complain(f"is no measure; there are: {', '.join(levels)}", *place, number, measure)
                    elif unknown := set(_listed(named)) - set(known):
                        what = ", ".join(sorted(unknown))
                        self.complain(f"has no level {what}; there are: {', '.join(known)}", *place, number, measure)

    def claims(self, levels: Mapping[str, tuple[tuple[str, float], ...]]) -> dict[tuple[str, ...], str]:
        """Return which class claims each combination of levels; refuse those that none or two claim."""
        rules = {name: one.when for name, one in self.block.classes.items()} | {OBSTACLE: self.block.obstacle}
        claimed: dict[tuple[str, ...], set[str]] = {}
        for combination in product(*([name for name, _ in named] for named in levels.values())):
            claimed[combination] = set()
        for name, given in rules.items():
            for rule in given:
                sides = [_listed(rule[m]) if m in rule else [n for n, _ in named] for m, named in levels.items()]
                for combination in product(*sides):
                    claimed[combination].add(name)
        for combination, names in claimed.items():
            if len(names) != 1:
                what = ", ".join(f"{m} {level}" for m, level in zip(levels, combination, strict=True))
                who = f"claimed by {' and '.join(sorted(names))}" if names else "claimed by no rule"
                self.complain(f"ground with {what} is {who}; exactly one class has to claim it", "classes")
                break
        unused = set(rules) - {name for names in claimed.values() for name in names} - {OBSTACLE}
        for name in sorted(unused):
            self.complain("is covered by no rule", "classes", name)
        return {combination: min(names, default=OBSTACLE) for combination, names in claimed.items()}

    def check_turns(self) -> None:
        grounds = {name: one.ground for name, one in self.block.classes.items()}
        for name, ground in grounds.items():
            if swapped(ground) not in grounds.values():
                self.complain(
                    "has no counterpart after a quarter turn; a class with `across` and `along` swapped is needed",
                    "classes",
                    name,
                )


def _listed(named: str | tuple[str, ...]) -> list[str]:
    return [named] if isinstance(named, str) else list(named)

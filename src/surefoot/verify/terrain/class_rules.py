"""Reads the rules of terrain classes, and tells which classes measures belong to (docs/formats.md 10).

A measure that lies within ``NEAR`` of the end of a level may belong to either side: the checker's numbers are its own.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from itertools import product
from pathlib import Path

from surefoot.documents import read_yaml
from surefoot.errors import InputError
from surefoot.verify.artefacts import check_kind
from surefoot.verify.values import Fields

SHIPPED = Path(__file__).parents[2] / "skills" / "class_rules.yaml"
OBSTACLE = "obstacle"
NEAR = 2e-5
_PATTERN = {"height_m": 0.0, "per_side": 1, "spacing_m": 0.0, "open_m": 0.0, "across": "none", "along": "none"}

Rule = Mapping[str, tuple[str, ...]]


@dataclass(frozen=True, slots=True)
class ClassRules:
    """A set of classes.

    Attributes:
        name: of the set.
        robot, cell_m, margin_m: what it was made for.
        bars: whether cells are measured as bars; else as ground.
        levels: by measure, names of levels and where they end.
        claims: by class, the obstacle included, its rules.
        turned: by class, what it is called after a quarter turn.
    """

    name: str
    robot: str
    cell_m: float
    margin_m: float
    bars: bool
    levels: Mapping[str, tuple[tuple[str, float], ...]]
    claims: Mapping[str, tuple[Rule, ...]]
    turned: Mapping[str, str]

    def labels(self, measured: Mapping[str, float]) -> frozenset[str]:
        """Return the classes that a cell may have; several only where a measure lies at the end of a level."""
        sides = [[(name, level) for level in self._levels(name, measured[name])] for name in self.levels]
        return frozenset(self._claimed(dict(one)) for one in product(*sides))

    def _levels(self, name: str, value: float) -> Iterator[str]:
        low = -math.inf
        for level, below in self.levels[name]:
            if low - NEAR <= value and (value < below + NEAR or math.isinf(below)):
                yield level
            low = below

    def _claimed(self, levels: Mapping[str, str]) -> str:
        for name, rules in self.claims.items():
            if any(all(levels[measure] in allowed for measure, allowed in rule.items()) for rule in rules):
                return name
        return OBSTACLE


def shipped_rules(name: str, asking: Path) -> ClassRules:
    """Return a set that comes with Surefoot.

    Raises:
        InputError: there is none of that name.
    """
    sets = _shipped()
    if name not in sets:
        message = f"there is no set of classes {name!r}; there are: {', '.join(sets)}"
        raise InputError(message, source=asking, key="classes")
    return sets[name]


@cache
def _shipped() -> dict[str, ClassRules]:
    return rules_of(SHIPPED)


def rules_of(path: Path) -> dict[str, ClassRules]:
    """Read a file of rules.

    Raises:
        InputError: it is no such file.
    """
    document = read_yaml(path)
    if document.problems:
        raise document.problems[0]
    fields = Fields.of(listed(document.value), path)
    check_kind(fields, "terrain-classes")
    sets = fields.mapping("sets")
    return {name: _rules(name, sets.mapping(name)) for name in sets.values}


def listed(value: object) -> object:
    """Return a value of a YAML file with lists where JSON has them."""
    if isinstance(value, dict):
        return {key: listed(inner) for key, inner in value.items()}
    return [listed(inner) for inner in value] if isinstance(value, tuple | list) else value


def _rules(name: str, fields: Fields) -> ClassRules:
    classes = fields.mapping("classes")
    levels = fields.mapping("levels")
    claims = {one: _claims(classes.mapping(one), "when") for one in classes.values}
    return ClassRules(
        name=name,
        robot=fields.text("robot"),
        cell_m=fields.number("cell_m", least=1e-3),
        margin_m=fields.number("margin_m", 0.0, least=0.0),
        bars=fields.text("measures", among=("ground", "bars")) == "bars",
        levels={measure: tuple(_level(one) for one in levels.mappings(measure)) for measure in levels.values},
        claims={**claims, OBSTACLE: _claims(fields, OBSTACLE)},
        turned={one: _turned(one, classes) for one in classes.values},
    )


def _level(fields: Fields) -> tuple[str, float]:
    last = fields.values.get("below") is None
    return fields.text("name"), math.inf if last else fields.number("below")


def _claims(fields: Fields, key: str) -> tuple[Rule, ...]:
    return tuple({measure: _names(rule, measure) for measure in rule.values} for rule in fields.mappings(key))


def _names(rule: Fields, measure: str) -> tuple[str, ...]:
    value = rule.get(measure)
    return (value,) if isinstance(value, str) else tuple(map(str, rule.items(measure)))


def _turned(name: str, classes: Fields) -> str:
    """Return the class whose bars lie along where those of this one lie across, and across where they lie along."""
    swapped = _ground(classes, name)
    swapped |= {"across": swapped["along"], "along": swapped["across"]}
    found = next((one for one in classes.values if _ground(classes, one) == swapped), None)
    if found is None:
        raise InputError(f"{name} has no counterpart after a quarter turn", source=classes.source, key=classes.place)
    return found


def _ground(classes: Fields, name: str) -> dict[str, object]:
    return {**_PATTERN, **classes.mapping(name).mapping("ground").values}

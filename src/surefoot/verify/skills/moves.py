"""The graph of a local grid as formats.md, section "Library of skills", has it: places, and what leads between them.

A place is (row, column, heading). Without headings the last is always 0.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from surefoot.verify.skills.plans import TURNS, WAYS
from surefoot.verify.values import Fields

Cell = tuple[int, int]
Place = tuple[int, int, int]
Labels = tuple[tuple[str, ...], ...]
Primitive = tuple[str, str, str]

OBSTACLE = "obstacle"
FACING = ("ahead", "left", "back", "right")

_AHEAD = ((-1, 0), (0, -1), (1, 0), (0, 1))
_ASIDE = {"forward": 0, "left": 1, "backward": 2, "right": 3}


@dataclass(frozen=True, slots=True)
class Headings:
    """What a library with headings says about them.

    Attributes:
        turned: what a class is called after a quarter turn.
        directions: which way the robot walks.
    """

    turned: Mapping[str, str]
    directions: tuple[str, ...]

    @classmethod
    def of(cls, library: Fields, classes: tuple[str, ...]) -> Headings | None:
        """Read the block of a library; None if it has no headings.

        Raises:
            InputError: half a turn does not give a class its name back, or there is no such direction.
        """
        if not library.has("headings"):
            return None
        fields = library.mapping("headings")
        named = fields.mapping("turned")
        turned = {name: named.text(name, among=classes) for name in classes}
        named.only(classes)
        made_with = library.mapping("made_with")
        bars = made_with.has("classes") and made_with.text("classes").startswith("rebar-")
        for name, other in turned.items():
            across, _, along = name.partition("-")
            if turned[other] != name or (bars and other != f"{along}-{across}"):
                raise named.wrong(name, f"cannot be {other!r} after a quarter turn")
        directions = tuple(str(way) for way in fields.items("directions"))
        if not directions or not set(directions) <= WAYS.keys():
            raise fields.wrong("directions", f"has to hold some of {', '.join(WAYS)}")
        return cls(turned, directions)

    def seen(self, label: str, heading: int) -> str:
        """Return what the robot calls the class of a cell."""
        return self.turned[label] if heading % 2 else label


def inside(labels: Labels, cell: Cell) -> bool:
    """Return whether a cell lies in the grid."""
    return cell[0] in range(len(labels)) and cell[1] in range(len(labels[0]))


def label_at(labels: Labels, place: Place) -> str:
    """Return the class of a place; outside of the grid there are obstacles."""
    return labels[place[0]][place[1]] if inside(labels, place[:2]) else OBSTACLE


def led(place: Place, way: str) -> Place:
    """Return where a direction or a turn leads, also out of the grid."""
    row, column, heading = place
    if way in TURNS:
        return row, column, (heading + TURNS[way]) % 4
    down, right = _AHEAD[(heading + _ASIDE[way]) % 4]
    return row + down, column + right, heading


def primitive_at(labels: Labels, place: Place, way: str, headings: Headings | None) -> Primitive | None:
    """Return what it takes to go or turn; None where an obstacle, the grid's end or the directions forbid it."""
    target = led(place, way)
    here, there = label_at(labels, place), label_at(labels, target)
    if OBSTACLE in (here, there) or (way in TURNS and headings is None):
        return None
    if headings is None:
        return way, here, there
    if way in WAYS and way not in headings.directions:
        return None
    return way, headings.seen(here, place[2]), headings.seen(there, target[2])


def moves(labels: Labels, headings: Headings | None) -> Iterator[tuple[Place, Place, Primitive]]:
    """Yield everything that leads from one place to another."""
    for row, across in enumerate(labels):
        for column in range(len(across)):
            for heading in range(1 if headings is None else 4):
                place = (row, column, heading)
                for way in (*WAYS, *TURNS):
                    primitive = primitive_at(labels, place, way, headings)
                    if primitive is not None:
                        yield place, led(place, way), primitive

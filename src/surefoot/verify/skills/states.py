"""Checks the terrain states of a library against its terrain: every class of every cell is measured again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from pathlib import Path

from surefoot.verify.findings import Ledger
from surefoot.verify.skills.moves import OBSTACLE, Headings, Labels
from surefoot.verify.terrain.cell_classes import CellClasses, Seen
from surefoot.verify.terrain.map import MapFile, read_map
from surefoot.verify.values import Fields

_MOST_READINGS = 4096


def check_states(
    file: Path, library: Fields, states: Sequence[Labels], headings: Headings | None, ledger: Ledger
) -> None:
    """Compare the states of a library with those that a grid meets which is slid over the map.

    Args:
        file: of the terrain.
        library: what the library says about itself.
        states: its terrain states.
        headings: of a library with headings.
        ledger: takes the findings.

    Raises:
        InputError: the terrain file, or its rules, cannot be read.
    """
    made_with, terrain = library.mapping("made_with"), library.mapping("terrain")
    ground = read_map(file, made_with.text("classes"))
    _check_heads(ground, library, headings, ledger)
    if ground.grid != terrain.cell("grid"):
        ledger.refuse("skills, terrain", "the grid is not that of the terrain file", "terrain.grid")
        return
    met = [frozenset(_readings(seen)) for seen in _met(ground, headings)]
    possible, known = frozenset[Labels]().union(*met), frozenset(states)
    for number, labels in enumerate(states):
        if labels not in possible:
            message = "is not what is measured about any cell of the terrain"
            ledger.refuse("skills, classes", message, f"states[{number}]")
    missing = sum(known.isdisjoint(readings) for readings in met)
    if missing:
        ledger.refuse("skills, classes", f"{missing} grids that are measured on the terrain are missing", "states")
    ledger.counts["cells_measured"] = ground.cells[0] * ground.cells[1]


def _check_heads(ground: MapFile, library: Fields, headings: Headings | None, ledger: Ledger) -> None:
    """Check what a library says about classes, robot and cells."""
    made_with, rules = library.mapping("made_with"), ground.rules
    names = [name for name in rules.claims if name != OBSTACLE]
    said = {
        "made_with.classes": (made_with.text("classes"), rules.name),
        "made_with.robot": (made_with.text("robot"), ground.robot),
        "terrain.cell_m": (library.mapping("terrain").number("cell_m"), ground.cell_m),
        "made_with.cell_m": (made_with.number("cell_m"), ground.cell_m),
        "classes": (library.items("classes"), names),
        "headings": (headings is not None, ground.yaw),
        "headings.turned": (None if headings is None else dict(headings.turned), rules.turned if headings else None),
    }
    for place, (found, expected) in said.items():
        if found != expected:
            ledger.refuse("skills, terrain", f"is {found}, and by the terrain file {expected}", place)


def _met(ground: MapFile, headings: Headings | None) -> Iterator[Seen]:
    """Yield every local grid in whose middle the robot can stand."""
    classes = CellClasses(ground, ground.grid)
    rows, columns = ground.cells
    middle = ground.grid[0] // 2, ground.grid[1] // 2
    for row, column, turns in product(range(rows), range(columns), range(1 if headings is None else 4)):
        seen = classes.labels((row, column), turns)
        if seen[middle[0]][middle[1]] != frozenset((OBSTACLE,)):
            yield seen


def _readings(seen: Seen) -> Iterator[Labels]:
    """Yield the terrain states that a grid may be; several only where measures lie at the ends of levels."""
    columns = len(seen[0])
    for number, flat in enumerate(product(*(sorted(one) for line in seen for one in line))):
        if number >= _MOST_READINGS:
            return
        yield tuple(flat[k : k + columns] for k in range(0, len(flat), columns))

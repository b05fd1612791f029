"""Skills with headings in words: turns by class, and strategies, one picture for every way that the robot may face."""

from __future__ import annotations

from itertools import groupby

from surefoot.skills.headings import FACING, HEADINGS, Turning, seen_from_grid
from surefoot.skills.library import SkillLibrary
from surefoot.skills.manager import PairAnswer
from surefoot.skills.next_skill import steps
from surefoot.skills.values import OBSTACLE, Cell, Direction, Physics, Primitive, Turn

_ARROWS = {(-1, 0): "^", (1, 0): "v", (0, -1): "<", (0, 1): ">"}
_MARKS = {Physics.INFEASIBLE: "!", Physics.UNKNOWN: "?"}


def turn_lines(library: SkillLibrary, turning: Turning) -> list[str]:
    """Return on which classes the robot can turn, and which way it may walk."""
    width = max(map(len, library.classes))
    lines = ["", "turns in place on a class: L to the left, R to the right"]
    for name in library.classes:
        marks = [_mark(library, Primitive(turn, name, turning.seen(name, 1))) for turn in Turn]
        lines.append(f"  {name.ljust(width)}  {''.join(marks)}")
    walks = ", ".join(turning.directions)
    return [*lines, "", f"with headings; walks: {walks}"]


def _mark(library: SkillLibrary, primitive: Primitive) -> str:
    result = library.knowledge.results.get(primitive)
    if result is None:
        return "."
    return _MARKS.get(result.verdict, "L" if primitive.direction is Turn.LEFT else "R")


def heading_lines(turning: Turning, pair: PairAnswer) -> list[str]:
    """Return the way from the start in words, and the strategy for every heading."""
    heads = [f"facing {name}" for name in FACING]
    width = max([2 * pair.state.columns, *(len(head) + 2 for head in heads)])
    headings, every_row = range(HEADINGS), range(pair.state.rows)
    rows = ["".join(_row(pair, row, heading).ljust(width) for heading in headings) for row in every_row]
    lines = [f"way: {_way(turning, pair)}", "".join(head.ljust(width) for head in heads), *rows]
    return [f"  {line}".rstrip() for line in lines]


def _way(turning: Turning, pair: PairAnswer) -> str:
    names = [step.primitive.direction.value for step in steps(turning, pair)]
    counted = [(name, len(list(same))) for name, same in groupby(names)]
    return ", ".join(name if count == 1 else f"{count} x {name}" for name, count in counted) or "stays"


def _row(pair: PairAnswer, row: int, heading: int) -> str:
    return " ".join(_sign(pair, (row, column), heading) for column in range(pair.state.columns))


def _sign(pair: PairAnswer, cell: Cell, heading: int) -> str:
    if (cell, heading) not in pair.poses:
        return "#" if pair.state.label(cell) == OBSTACLE else "."
    way = pair.poses[cell, heading]
    if isinstance(way, Direction):
        return _ARROWS[seen_from_grid(way, heading)]
    return "*" if way is None else "L" if way is Turn.LEFT else "R"

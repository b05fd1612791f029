"""A library of skills in words: a table of moves between classes, the pairs without a strategy, one terrain state."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

from surefoot.cli.skills_heading_words import heading_lines, turn_lines
from surefoot.skills.headings import Turning
from surefoot.skills.library import SkillLibrary
from surefoot.skills.manager import Outcome, PairAnswer
from surefoot.skills.values import OBSTACLE, Cell, Direction, Physics, Primitive, TerrainState

_ARROWS = {Direction.FORWARD: "^", Direction.BACKWARD: "v", Direction.LEFT: "<", Direction.RIGHT: ">", None: "*"}


def library_object(library: SkillLibrary) -> dict[str, Any]:
    """Return the JSON object of a library."""
    results = library.knowledge.results.values()
    return {
        "made_with": library.made_with,
        "terrain": library.terrain,
        "skills": [
            {"primitive": one.name, "gait": skill.gait, "horizon_s": skill.horizon_s, "cost": skill.cost}
            for one, skill in sorted(library.skills.items())
        ],
        "refused": [
            {"primitive": result.primitive.name, "verdict": result.verdict.value, "why": result.explanation or None}
            for result in results
            if result.verdict is not Physics.FEASIBLE
        ],
        "without_strategy": [
            {"labels": pair.state.labels, "request": pair.request, "cause": pair.why.cause, "why": pair.why.text}
            for pair in library.pairs.values()
            if pair.why is not None
        ],
        **library.answer,
    }


def library_lines(library: SkillLibrary) -> list[str]:
    """Return what the robot can do, what it cannot do and why, and the pairs that have no strategy."""
    refused = sorted(library.knowledge.refused.items())
    return [
        "",
        "moves from the class of the row to that of the column: F forward, B backward, L left, R right;",
        "! infeasible, ? undecided, . never asked about",
        *_table(library),
        *([] if library.turning is None else turn_lines(library, library.turning)),
        "",
        f"skills by gait: {_counted(library)}",
        *(["", "refused:"] if refused else []),
        *(f"  {one.name}: {result.verdict}, {result.explanation or 'no reason given'}" for one, result in refused),
        *_without_strategy(library),
    ]


def state_lines(state: TerrainState, pairs: Sequence[PairAnswer], turning: Turning | None = None) -> list[str]:
    """Return the classes of a terrain state, and for every request the way to it, or why there is none.

    Args:
        state: the classes.
        pairs: of the state; it has none if all that could be asked for are obstacles.
        turning: of a library with headings.
    """
    width = max(len(label) for row in state.labels for label in row)
    lines = ["  ".join(label.ljust(width) for label in row).rstrip() for row in state.labels]
    if turning is not None:
        lines += ["", "^ < v > walks over the grid, L and R turn in place, * stays, # obstacle, . no way from here"]
    lines += [] if pairs else ["", "nothing can be asked for: all those cells are obstacles"]
    for pair in pairs:
        lines += ["", f"to {pair.request}: {pair.outcome}" + (f", with {_names(pair.new)}" if pair.new else "")]
        if pair.why is not None:
            lines.append(f"  {pair.why.text}")
        else:
            lines += _picture(pair) if turning is None else heading_lines(turning, pair)
    return lines


def _table(library: SkillLibrary) -> list[str]:
    names = [f"{number} {name}" for number, name in enumerate(library.classes, start=1)]
    first = max(map(len, names))
    rows = [f"  {' ' * first}  {'  '.join(str(number).ljust(4) for number in range(1, len(names) + 1))}".rstrip()]
    for label, here in zip(names, library.classes, strict=True):
        cells = ["".join(_mark(library, Primitive(way, here, there)) for way in Direction) for there in library.classes]
        rows.append(f"  {label.ljust(first)}  {'  '.join(cells)}")
    return rows


def _mark(library: SkillLibrary, primitive: Primitive) -> str:
    result = library.knowledge.results.get(primitive)
    if result is None:
        return "."
    marks = {Physics.FEASIBLE: primitive.direction[0].upper(), Physics.INFEASIBLE: "!", Physics.UNKNOWN: "?"}
    return marks[result.verdict]


def _counted(library: SkillLibrary) -> str:
    gaits = Counter(skill.gait for skill in library.skills.values())
    return ", ".join(f"{count} {gait}" for gait, count in gaits.most_common()) or "none"


def _without_strategy(library: SkillLibrary) -> list[str]:
    number = {state: index for index, state in enumerate(library.states)}
    left = [pair for pair in library.pairs.values() if pair.why is not None]
    head = ["", "pairs without a strategy:"] if left else []
    return head + [
        f"  state {number[pair.state]}, to {pair.request}: {pair.outcome}, {pair.why.text}" for pair in left if pair.why
    ]


def _names(primitives: Sequence[Primitive]) -> str:
    return ", ".join(one.name for one in primitives)


def _picture(pair: PairAnswer) -> list[str]:
    """Draw the strategy: an arrow in every cell from where the request can be reached, * in the request."""
    assert pair.outcome in (Outcome.REALIZABLE, Outcome.REPAIRED)

    def sign(cell: Cell) -> str:
        if cell in pair.strategy:
            return _ARROWS[pair.strategy[cell]]
        return "#" if pair.state.label(cell) == OBSTACLE else "."

    return ["  " + " ".join(sign((row, c)) for c in range(pair.state.columns)) for row in range(pair.state.rows)]

"""Skills as a specification: formulas (17)-(20), frame conditions and hard constraints over a local grid.

Inputs are the robot's row and column (one Boolean each, ``x0`` the front row, ``y0`` the left column), the class of
every cell (an integer, the last value is the obstacle) and the requested row and column. Outputs are the skills.

Source: Zhou et al., 2025, Sec. VI-B. What the paper leaves out is in docs/skills.md, "Encoding".
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import combinations

from surefoot.errors import InputError
from surefoot.games.partial import partial_evaluation
from surefoot.logic.building import TRUE, conjunction, disjunction
from surefoot.logic.syntax import (
    Atom,
    Comparison,
    Conjunct,
    Expression,
    Iff,
    Implies,
    Integer,
    Not,
    Number,
    Specification,
    Variable,
)
from surefoot.logic.writers import infix
from surefoot.skills.values import OBSTACLE, Cell, Direction, Primitive, TerrainState

Edge = tuple[Cell, Cell]


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """The propositions of a grid.

    Attributes:
        rows: of the grid.
        columns: of the grid.
        classes: terrain classes without the obstacle, which is numbered behind them.
        primitives: the skills.
    """

    rows: int
    columns: int
    classes: tuple[str, ...]
    primitives: tuple[Primitive, ...]
    _spelled: dict[str, str] = field(init=False, repr=False, compare=False, default_factory=dict)

    def __post_init__(self) -> None:
        """Spell the classes so that they can be part of names; by number where two would be spelled alike."""
        spelled = {name: re.sub(r"[^A-Za-z0-9]+", "_", name) for name in self.classes}
        unique = len(set(spelled.values())) == len(spelled)
        self._spelled.update(spelled if unique else {name: f"class{k}" for k, name in enumerate(self.classes)})

    def cells(self) -> tuple[Cell, ...]:
        """Return every cell, row by row."""
        return tuple((row, column) for row in range(self.rows) for column in range(self.columns))

    def edges(self) -> Iterator[tuple[Cell, Direction, Cell]]:
        """Yield every move between neighbours."""
        for cell in self.cells():
            for direction in Direction:
                row, column = direction.of(cell)
                if 0 <= row < self.rows and 0 <= column < self.columns:
                    yield cell, direction, (row, column)

    def number(self, name: str) -> int:
        """Return the number of a class."""
        return len(self.classes) if name == OBSTACLE else self.classes.index(name)

    def skill_name(self, primitive: Primitive) -> str:
        """Return the name of a skill's proposition."""
        way = primitive.direction.replace("-", "_")
        return f"{way}_{self._spelled[primitive.here]}_to_{self._spelled[primitive.next]}"

    def skill(self, primitive: Primitive, *, primed: bool = False) -> Atom:
        """Return the proposition of a skill."""
        return Atom(self.skill_name(primitive), primed)

    def at(self, cell: Cell, *, primed: bool = False) -> list[Expression]:
        """Return what holds where the robot stands in a cell."""
        return [Atom(f"x{cell[0]}", primed), Atom(f"y{cell[1]}", primed)]

    def only_at(self, cell: Cell, *, primed: bool = False) -> list[Expression]:
        """Return the same with every other row and column denied: a full assignment."""
        rows = (literal(f"x{row}", primed, row == cell[0]) for row in range(self.rows))
        columns = (literal(f"y{column}", primed, column == cell[1]) for column in range(self.columns))
        return [*rows, *columns]

    def is_class(self, cell: Cell, name: str, *, primed: bool = False) -> Expression:
        """Return that a cell has a class."""
        return Comparison("=", Integer(terrain_name(cell), primed), Number(self.number(name)))

    @property
    def position(self) -> tuple[list[str], list[str]]:
        """Names of rows and of columns where the robot may be."""
        return [f"x{row}" for row in range(self.rows)], [f"y{column}" for column in range(self.columns)]

    @property
    def request(self) -> tuple[list[str], list[str]]:
        """Names of rows and of columns that may be requested."""
        return [f"rx{row}" for row in range(self.rows)], [f"ry{column}" for column in range(self.columns)]


def terrain_name(cell: Cell) -> str:
    """Return the variable of a cell's class."""
    return f"n_{cell[0]}_{cell[1]}"


def specification(
    words: Vocabulary, *, disallowed: Iterable[Edge] = (), forbidden: Collection[Primitive] = ()
) -> Specification:
    """Return the specification over any terrain and any request.

    Args:
        words: grid, classes and skills.
        disallowed: moves between cells that failed at run time; the negated transitions are hard guarantees.
        forbidden: primitives that physics refused; no repair may create them.
    """
    edges = tuple(disallowed)
    inputs = [Variable(name) for names in words.position for name in names]
    inputs += [Variable(terrain_name(cell), 0, len(words.classes)) for cell in words.cells()]
    inputs += [Variable(name) for names in words.request for name in names]
    return Specification(
        inputs=tuple(inputs),
        outputs=tuple(Variable(words.skill_name(primitive)) for primitive in words.primitives),
        env_init=section("ENV_INIT", _environment_begins(words)),
        sys_init=section("SYS_INIT", (Not(words.skill(primitive)) for primitive in words.primitives)),
        env_trans=section("ENV_TRANS", (line for one in words.primitives for line in _posts(words, one))),
        env_trans_hard=section("ENV_TRANS_HARD", _environment_keeps(words)),
        sys_trans=section("SYS_TRANS", (_pre(words, primitive) for primitive in words.primitives)),
        sys_trans_hard=section("SYS_TRANS_HARD", _system_keeps(words, edges)),
        sys_liveness=section("SYS_LIVENESS", [_at_request(words)]),
        change_cons=section("CHANGE_CONS", _changes(words)),
        not_allowed_repair=section("NOT_ALLOWED_REPAIR", _no_repair(words, edges, forbidden)),
    )


def pair_specification(
    state: TerrainState,
    request: Cell,
    classes: Sequence[str],
    primitives: Iterable[Primitive],
    *,
    disallowed: Iterable[Edge] = (),
    forbidden: Collection[Primitive] = (),
) -> Specification:
    """Return what is left once terrain and request are known: the robot's position, and the skills that can be used.

    Raises:
        InputError: see ``check_pair``; or a class is none of those given.

    Source: Zhou et al., 2025, Definition 1 and Sec. VI-C.
    """
    check_pair(state, request)
    unknown = {name for row in state.labels for name in row} - {*classes, OBSTACLE}
    if unknown:
        raise InputError(f"{sorted(unknown)[0]!r} is no terrain class; there are: {', '.join(classes)}, {OBSTACLE}")
    words = Vocabulary(state.rows, state.columns, tuple(classes), tuple(primitives))
    known: dict[str, int | bool] = {terrain_name(cell): words.number(state.label(cell)) for cell in words.cells()}
    for names, place in zip(words.request, request, strict=True):
        known |= {name: index == place for index, name in enumerate(names)}
    usable = {state.primitive(cell, direction) for cell, direction, _ in words.edges()}
    known |= {words.skill_name(one): False for one in words.primitives if one not in usable}
    return partial_evaluation(specification(words, disallowed=disallowed, forbidden=forbidden), known)


def check_pair(state: TerrainState, request: Cell) -> None:
    """Refuse what cannot be a question.

    Raises:
        InputError: the robot stands in an obstacle, or the request is outside of the grid.
    """
    if state.label(state.centre) == OBSTACLE:
        raise InputError(f"the robot's own cell {state.centre} is an obstacle; it has to stand on some other class")
    if not (0 <= request[0] < state.rows and 0 <= request[1] < state.columns):
        allowed = f"rows go from 0 to {state.rows - 1}, columns from 0 to {state.columns - 1}"
        raise InputError(f"the request {tuple(request)} is outside of the grid; {allowed}")


def _environment_begins(words: Vocabulary) -> Iterator[Expression]:
    yield from words.only_at((words.rows // 2, words.columns // 2))
    for names in words.request:
        yield from exactly_one(names, primed=False)


def _posts(words: Vocabulary, primitive: Primitive) -> Iterator[Expression]:
    """Yield (17): where a skill runs and a pre-state of it holds, the robot is then in the cell that it leads to."""
    for cell, direction, target in words.edges():
        if direction is primitive.direction:
            pre = [words.skill(primitive), *_pre_state(words, primitive, cell, target, primed=False)]
            yield Implies(conjunction(pre), conjunction(words.only_at(target, primed=True)))


def _pre(words: Vocabulary, primitive: Primitive) -> Expression:
    """Return (19): a skill may run next only if one of its pre-states holds next."""
    states = [
        conjunction(_pre_state(words, primitive, cell, target, primed=True))
        for cell, direction, target in words.edges()
        if direction is primitive.direction
    ]
    return Implies(words.skill(primitive, primed=True), disjunction(states))


def _pre_state(words: Vocabulary, primitive: Primitive, cell: Cell, target: Cell, *, primed: bool) -> list[Expression]:
    here = words.is_class(cell, primitive.here, primed=primed)
    return [*words.at(cell, primed=primed), here, words.is_class(target, primitive.next, primed=primed)]


def _environment_keeps(words: Vocabulary) -> Iterator[Expression]:
    """Yield assumptions that no repair changes: one position, (i) terrain and request stay, (ii) idling stays."""
    for primed in (False, True):
        for names in words.position:
            yield from exactly_one(names, primed=primed)
    for cell in words.cells():
        name = terrain_name(cell)
        yield Comparison("=", Integer(name, primed=True), Integer(name))
    yield from (unchanged(name) for names in words.request for name in names)
    idle = conjunction([Not(words.skill(primitive)) for primitive in words.primitives])
    stay = conjunction([unchanged(name) for names in words.position for name in names])
    yield stay if idle is TRUE else Implies(idle, stay)


def _system_keeps(words: Vocabulary, disallowed: Sequence[Edge]) -> Iterator[Expression]:
    """Yield guarantees that no repair changes: one skill at a time, no obstacle now or next, no disallowed move."""
    for one, other in combinations(words.primitives, 2):
        yield Not(conjunction([words.skill(one, primed=True), words.skill(other, primed=True)]))
    for cell in words.cells():
        for primed in (False, True):
            inside = [*words.at(cell, primed=primed), words.is_class(cell, OBSTACLE, primed=primed)]
            yield Not(conjunction(inside))
    yield from _never(words, disallowed)


def _at_request(words: Vocabulary) -> Expression:
    requested = (conjunction([*words.at(cell), Atom(f"rx{cell[0]}"), Atom(f"ry{cell[1]}")]) for cell in words.cells())
    return disjunction(list(requested))


def _changes(words: Vocabulary) -> Iterator[Expression]:
    """Yield what a repaired state has to keep: one position, another one than before."""
    for names in words.position:
        yield from exactly_one(names, primed=True)
    yield Not(conjunction([unchanged(name) for names in words.position for name in names]))


def _no_repair(words: Vocabulary, disallowed: Sequence[Edge], forbidden: Collection[Primitive]) -> Iterator[Expression]:
    """Yield what every transition that a repair creates has to keep: neighbours only, nothing known to fail."""
    neighbours = {(cell, target) for cell, _, target in words.edges()}
    pairs = ((cell, target) for cell in words.cells() for target in words.cells() if cell != target)
    yield from _never(words, [pair for pair in pairs if pair not in neighbours])
    yield from _never(words, disallowed)
    for primitive in sorted(forbidden):
        for cell, direction, target in words.edges():
            if direction is primitive.direction:
                move = [*_pre_state(words, primitive, cell, target, primed=False), *words.at(target, primed=True)]
                yield Not(conjunction(move))


def _never(words: Vocabulary, edges: Iterable[Edge]) -> Iterator[Expression]:
    for cell, target in edges:
        yield Not(conjunction([*words.at(cell), *words.at(target, primed=True)]))


def exactly_one(names: Sequence[str], *, primed: bool) -> Iterator[Expression]:
    """Yield that one of several propositions holds, and only one."""
    yield disjunction([Atom(name, primed) for name in names])
    for one, other in combinations(names, 2):
        yield Not(conjunction([Atom(one, primed), Atom(other, primed)]))


def unchanged(name: str) -> Expression:
    """Return that a proposition stays as it is."""
    return Iff(Atom(name), Atom(name, primed=True))


def literal(name: str, primed: bool, holds: bool) -> Expression:
    """Return a proposition, or its negation."""
    return Atom(name, primed) if holds else Not(Atom(name, primed))


def section(name: str, lines: Iterable[Expression]) -> tuple[Conjunct, ...]:
    """Return a section of a specification."""
    return tuple(Conjunct(name, line, infix(line)) for line in lines)

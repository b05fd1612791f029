"""Reads the rows of a navigation strategy: decisions and their orders, each decision once."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.frames import Direction
from surefoot.verify.artefacts import Arrays
from surefoot.verify.findings import Ledger
from surefoot.verify.navigation.belief import KindKnown, Known, Obstacles
from surefoot.verify.navigation.belief_turn import WORD, Field, Ints
from surefoot.verify.row_index import numbered, row_of, slots_of
from surefoot.verify.scene.derived import Scene

WAIT = 4


class Decision(NamedTuple):
    """Where the robot is, what it knows and which goal is next."""

    cell: int
    heading: int
    known: Known
    goal: int


@dataclass(frozen=True, slots=True)
class KindStates:
    """What the rows of a strategy know of one kind, each once.

    Attributes:
        keys: (S, 2) code of the visible cells, and number of the hidden set.
        key_slots: index of the keys.
        visible: (S, members) places, ascending, then -1.
        sets: (M, words) hidden sets.
        set_slots: index of the sets.
    """

    keys: Ints
    key_slots: Ints
    visible: Ints
    sets: Ints
    set_slots: Ints

    def number(self, obstacles: Obstacles, part: KindKnown) -> int:
        """Return the number of a piece of knowledge, -1 when no row has it."""
        found = int(row_of(self.set_slots, self.sets, obstacles.words_of(part.hidden)))
        key = np.array([obstacles.code_of(part.visible), found], np.int64)
        return int(row_of(self.key_slots, self.keys, key)) if found >= 0 else -1


@dataclass(frozen=True, slots=True)
class Table:
    """The rows of ``navigation.npz``.

    Attributes:
        obstacles: whose knowledge the rows name.
        cells, headings, goals, orders: (N,).
        kinds: what is known of each kind.
        keys: (N, 1 + kinds) code of cell, heading and goal, and the number of what is known of each kind.
        slots: index of the keys.
    """

    obstacles: Obstacles
    cells: Ints
    headings: Ints
    goals: Ints
    orders: Ints
    kinds: tuple[KindStates, ...]
    keys: Ints
    slots: Ints

    def row(self, decision: Decision) -> int:
        """Return the row of a decision, -1 where there is none."""
        numbers = [states.number(self.obstacles, part) for states, part in zip(self.kinds, decision.known, strict=True)]
        if min(numbers, default=0) < 0:
            return -1
        robot = (np.array([number], np.int64) for number in (decision.cell, decision.heading, decision.goal))
        key = np.concatenate([pose_codes(*robot), np.array(numbers, np.int64)])
        return int(row_of(self.slots, self.keys, key))

    def order(self, decision: Decision) -> int | None:
        """Return the order of a decision; None where there is no row."""
        row = self.row(decision)
        return None if row < 0 else int(self.orders[row])

    def decision(self, row: int) -> Decision:
        """Return the decision of a row."""
        known = []
        for states, number in zip(self.kinds, self.keys[row, 1:], strict=True):
            code, hidden = states.keys[number]
            known.append(KindKnown(self.obstacles.listed(int(code)), self.obstacles.cells_of(states.sets[hidden])))
        return Decision(int(self.cells[row]), int(self.headings[row]), tuple(known), int(self.goals[row]))


def pose_codes(cells: Ints, headings: Ints, goals: Ints) -> Ints:
    """Return one number per row for cell, heading and goal."""
    return np.asarray((goals << 34) + (cells << 2) + headings)


def read_table(arrays: Arrays, source: Path, obstacles: Obstacles, goals: int, ledger: Ledger) -> Table | None:
    """Read the rows of a navigation strategy; None when some are malformed or stand there twice.

    Args:
        arrays: of the file, by name.
        source: the file.
        obstacles: of the game that it is played in.
        goals: how many there are.
        ledger: takes the findings.

    Raises:
        InputError: the arrays fit another number of obstacles, kinds or cells.
    """
    kinds, domain = obstacles.kinds, obstacles.domain
    if not np.array_equal(arrays["domain"], np.array(domain, np.int64)):
        ledger.refuse("rules.md 4, obstacle domain", "is not the union of the domains", f"{source.name} domain")
        return None
    shape = (sum(len(kind.members) for kind in kinds), len(kinds), -(-len(domain) // 8))
    if (arrays["visible"].shape[1], *arrays["hidden"].shape[1:]) != shape:
        raise InputError("has columns for another number of obstacles, kinds or cells", source=source, key="visible")
    cells, headings, goal, orders = (arrays[name].astype(np.int64) for name in ("cell", "heading", "goal", "order"))
    wrong = (cells < 0) | (cells >= len(obstacles.scene.sees)) | (headings < 0) | (headings > 3)
    wrong |= (goal < 0) | (goal >= goals)
    states, columns, first = [], [pose_codes(cells, headings, goal)], 0
    for number, kind in enumerate(kinds):
        visible = _places(arrays["visible"][:, first : first + len(kind.members)].astype(np.int64), domain)
        sets = _words(arrays["hidden"][:, number], obstacles.words)
        wrong |= _contradicts(obstacles.fields[number], visible, sets)
        first += len(kind.members)
        if wrong.any():
            break
        found, numbers = _states(obstacles.fields[number], visible, sets)
        states.append(found)
        columns.append(numbers)
    if wrong.any():
        where = f"{source.name} row {int(np.flatnonzero(wrong)[0])}"
        ledger.refuse("formats.md 2, navigation.npz", "holds values that no decision has", where, int(wrong.sum()))
        return None
    keys = np.stack(columns, axis=1)
    slots, twice = slots_of(keys)
    if twice >= 0:
        ledger.refuse("formats.md 2, navigation.npz", "a decision has two rows", f"{source.name} row {twice}")
        return None
    return Table(obstacles, cells, headings, goal, orders, tuple(states), keys, slots)


def _places(cells: Ints, domain: tuple[int, ...]) -> Ints:
    """Return the places of visible cells: -1 for a hidden obstacle, -2 for a cell outside all domains."""
    if not domain:
        return np.full_like(cells, -2)
    own = np.array(domain, np.int64)
    places = np.minimum(np.searchsorted(own, cells), len(own) - 1)
    return np.where(own[places] == cells, places, np.where(cells == -1, -1, -2))


def _words(packed: NDArray[np.uint8], words: int) -> Ints:
    """Return bits that are packed in bytes as words."""
    padded = np.zeros((len(packed), words * WORD // 8), np.uint8)
    padded[:, : packed.shape[1]] = packed
    return padded.view("<u4").astype(np.int64)


def _contradicts(field: Field, visible: Ints, sets: Ints) -> NDArray[np.bool_]:
    """Return which rows name cells outside the domain, list cells in another order, or hide nobody or too many."""
    shown = visible >= 0
    inside = field.domain[visible // WORD] >> (visible % WORD) & 1 == 1
    wrong = (visible < -1).any(axis=1) | (shown & ~inside).any(axis=1) | (sets & ~field.domain).any(axis=1)
    later, earlier = visible[:, 1:], visible[:, :-1]
    wrong |= ((later >= 0) & (later < earlier) | (later >= 0) & (earlier < 0)).any(axis=1)
    return np.asarray(wrong | (shown.all(axis=1) == sets.any(axis=1)), np.bool_)


def _states(field: Field, visible: Ints, sets: Ints) -> tuple[KindStates, Ints]:
    """Return the distinct pieces of knowledge of a kind, and the number of each row's."""
    codes = np.zeros(len(visible), np.int64)
    for column in range(visible.shape[1]):
        codes |= (visible[:, column] + 1) << (column * field.digit_bits)
    set_numbers, firsts = numbered(sets)
    own_sets = sets[firsts]
    numbers, first = numbered(np.stack([codes, set_numbers], axis=1))
    keys = np.stack([codes, set_numbers], axis=1)[first]
    return KindStates(keys, slots_of(keys)[0], visible[first], own_sets, slots_of(own_sets)[0]), numbers


def describe(scene: Scene, decision: Decision) -> str:
    """Return a decision as text."""
    heading = Direction(decision.heading).name.lower()
    text = f"cell {scene.cell(decision.cell)}, heading {heading}, goal {decision.goal}"
    for number, part in enumerate(decision.known):
        seen = ", ".join(str(scene.cell(cell)) for cell in part.visible)
        text += f"; kind {number}: " + (f"visible in {seen}" if part.visible else "hidden")
        if part.visible and part.hidden:
            text += ", others hidden"
    return text

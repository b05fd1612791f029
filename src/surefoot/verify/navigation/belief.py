"""The obstacles as the robot knows them, transcribed from rules.md 4: what is known at the start and after a turn."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from surefoot.errors import LimitExceeded
from surefoot.frames import Direction
from surefoot.verify.navigation.belief_turn import (
    EXACT,
    REGIONS,
    SINGLE,
    WORD,
    Field,
    Ints,
    abstraction,
    image,
    inserted,
    listed,
    places_of,
    turn_of_kind,
)
from surefoot.verify.scene.derived import ObstacleKind, Scene
from surefoot.verify.scene.scenario import BY_SIZE

MOST_CELLS_FOR_EXACT = 40
CODE_BITS = 62
METHODS = {"exact": EXACT, "regions": REGIONS, "single": SINGLE}


class KindKnown(NamedTuple):
    """What is known of the obstacles of one kind.

    Attributes:
        visible: cells of the visible ones, ascending.
        hidden: cells where the hidden ones may be, ascending; empty when none is hidden.
    """

    visible: tuple[int, ...]
    hidden: tuple[int, ...]


Known = tuple[KindKnown, ...]


class Abstraction(NamedTuple):
    """How hidden images are widened: a method among METHODS, and the regions, without the rest."""

    method: str
    regions: tuple[frozenset[int], ...]


class Turned(NamedTuple):
    """What a turn may lead to: whether a move is lost, and what may be known of each kind after it."""

    lost: bool
    kinds: tuple[tuple[KindKnown, ...], ...]


def abstraction_of(scene: Scene) -> Abstraction | None:
    """Return the belief abstraction that the scenario names; None when the planner chooses the regions."""
    method = scene.scenario.belief
    if method == BY_SIZE:
        entered = max((len(kind.domain) for kind in scene.obstacle_kinds), default=0)
        method = "exact" if scene.obstacles <= 1 and entered <= MOST_CELLS_FOR_EXACT else "single"
    if method == "automatic":
        return None
    return Abstraction(method, scene.regions if method == "regions" else ())


class Obstacles:
    """The obstacles of a navigation game, kind by kind.

    Attributes:
        scene: the scene.
        kinds: the kinds; the scene's, or with other domains after a replan.
        domain: the union of their domains, ascending; places count its cells.
        place: of each cell of the domain.
        fields: what the compiled rules need of each kind.
    """

    def __init__(self, scene: Scene, belief: Abstraction, kinds: tuple[ObstacleKind, ...] | None = None) -> None:
        self.scene = scene
        self.kinds = scene.obstacle_kinds if kinds is None else kinds
        self.domain = tuple(sorted({cell for kind in self.kinds for cell in kind.domain}))
        self.place = {cell: place for place, cell in enumerate(self.domain)}
        self.words = -(-len(self.domain) // WORD)
        self.fields = tuple(self._field(kind, belief) for kind in self.kinds)
        self._seen: dict[int, Ints] = {}

    def _field(self, kind: ObstacleKind, belief: Abstraction) -> Field:
        inside, digit_bits = frozenset(kind.domain), len(self.domain).bit_length()
        if digit_bits * len(kind.members) > CODE_BITS:
            allowed = CODE_BITS // digit_bits
            raise LimitExceeded(f"a kind has {len(kind.members)} obstacles; on this map at most {allowed} are checked")
        regions = [region & inside for region in belief.regions]
        regions.append(inside.difference(*belief.regions))
        rows = np.stack([self.words_of(region) for region in regions])
        near = np.full((len(self.domain), 4), -1, np.int64)
        for cell in kind.domain:
            for move in Direction:
                other = self.scene.target(self.scene.cell(cell), move)
                if self.scene.inside(other) and self.scene.index(other) in inside:
                    near[self.place[cell], move] = self.place[self.scene.index(other)]
        domain, method = self.words_of(kind.domain), METHODS[belief.method]
        return Field(near, kind.speed_cells, domain, method, rows, len(kind.members), digit_bits)

    def words_of(self, cells: Iterable[int]) -> Ints:
        """Return a set of cells as words; cells outside the domains are left out."""
        words = np.zeros(self.words, np.int64)
        for cell in cells:
            if cell in self.place:
                words[self.place[cell] // WORD] |= 1 << (self.place[cell] % WORD)
        return words

    def cells_of(self, words: Ints) -> tuple[int, ...]:
        """Return the cells of a set, ascending."""
        return tuple(self.domain[place] for place in places_of(words))

    def code_of(self, cells: Iterable[int]) -> int:
        """Return the code of a list of cells."""
        code, digit_bits = 0, len(self.domain).bit_length()
        for cell in cells:
            code = int(inserted(code, self.place[cell], digit_bits))
        return code

    def listed(self, code: int) -> tuple[int, ...]:
        """Return the cells of a code, ascending."""
        return tuple(self.domain[place] for place in listed(code, len(self.domain).bit_length()))

    def seen_from(self, cell: int) -> Ints:
        """Return what the robot sees of the domains from a cell."""
        if cell not in self._seen:
            row = self.scene.sees[cell]
            self._seen[cell] = self.words_of(other for other in self.domain if row[other])
        return self._seen[cell]

    def next_of(self, kind: int, cell: int, barred: int | None = None) -> tuple[int, ...]:
        """Return where an obstacle may be after one turn from a cell; the barred cell is a standing robot's."""
        bar = -1 if barred is None else self.place.get(barred, -1)
        return self.cells_of(image(self.fields[kind], self.words_of((cell,)), bar))

    def believed(self, kind: int, hidden: Iterable[int], viewer: int) -> tuple[int, ...]:
        """Return the belief that stands for a hidden image seen from a cell; empty for an empty one."""
        words = self.words_of(hidden)
        if not words.any():
            return ()
        return self.cells_of(abstraction(self.fields[kind], words, self.seen_from(viewer)))

    def at_start(self, cells: Sequence[int], robot: int) -> Known:
        """Return what is known at the start, given the cell of every obstacle."""
        sees = self.scene.sees[robot]
        found = []
        for number, kind in enumerate(self.kinds):
            own = sorted(cells[member] for member in kind.members)
            hidden = [cell for cell in own if not sees[cell]]
            found.append(KindKnown(tuple(cell for cell in own if sees[cell]), self.believed(number, hidden, robot)))
        return tuple(found)

    def turn(self, known: Known, robot: int, after: int, *, waits: bool) -> Turned:
        """Return the outcomes of one turn.

        Args:
            known: before the turn.
            robot: cell of the robot before the turn.
            after: its cell after the turn.
            waits: whether it stands.
        """
        seen = self.seen_from(after if self.scene.scenario.view_post else robot)
        barred = self.place.get(robot, -1) if waits else -1
        lost, kinds = False, []
        for field, part in zip(self.fields, known, strict=True):
            codes, numbers, rows, entered = turn_of_kind(
                field, self.code_of(part.visible), self.words_of(part.hidden), barred, seen
            )
            lost |= not waits and bool((entered & self.words_of((robot, after))).any())
            sets = [self.cells_of(row) for row in rows]
            kinds.append(tuple(KindKnown(self.listed(c), sets[n]) for c, n in zip(codes, numbers, strict=True)))
        return Turned(lost, tuple(kinds))

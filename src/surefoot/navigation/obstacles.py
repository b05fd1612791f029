"""Moving obstacles: where they may be, how they move, and what is known of them (docs/rules.md, section 4).

Sets of cells are bit masks over the union of the obstacles' domains: bit i stands for ``cells[i]``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import reduce
from operator import or_
from typing import Literal

from surefoot.navigation.coarse import CoarseMap, adjacent_free

BeliefTracking = Literal["joint", "separate"]
FASTEST_CELLS = 3


@dataclass(frozen=True, slots=True)
class Obstacle:
    """A moving obstacle.

    Attributes:
        start: its cell at the start.
        forbidden: cells that it never enters.
        speed_cells: how many moves it makes in a turn at most, 1 to 3.
    """

    start: int
    forbidden: frozenset[int] = frozenset()
    speed_cells: int = 1


@dataclass(frozen=True, slots=True)
class ObstacleKind:
    """Obstacles that are not told apart.

    Attributes:
        obstacles: their numbers, ascending.
        speed_cells: how many moves each of them makes in a turn at most.
        within: mask of their domain.
        beside: for every bit of the domain the mask of its 4-neighbours there, itself included; 0 for other bits.
    """

    obstacles: tuple[int, ...]
    speed_cells: int
    within: int
    beside: tuple[int, ...]

    def image(self, mask: int, barred: int = 0) -> int:
        """Return where obstacles in the mask can be after one turn (rules.md 4, ``next``).

        Args:
            mask: where they are.
            barred: the cell of a robot that stands, as a mask: no move ends there.
        """
        for _ in range(self.speed_cells):
            mask |= reduce(or_, (self.beside[bit] for bit in bits(mask)), 0) & ~barred
        return mask & ~barred


@dataclass(frozen=True, slots=True)
class ObstacleKinds:
    """All obstacles, kind by kind, and the cells that masks speak of.

    Attributes:
        cells: indices of the cells of all domains, ascending.
        bit: the bit number of a cell.
        seen_from: for every cell of the grid, the mask of the cells seen from it.
        kinds: ordered by their first obstacle.
    """

    cells: tuple[int, ...]
    bit: dict[int, int]
    seen_from: tuple[int, ...]
    kinds: tuple[ObstacleKind, ...]

    def __iter__(self) -> Iterator[ObstacleKind]:
        """Iterate over the kinds."""
        return iter(self.kinds)

    def mask(self, cells: Iterable[int]) -> int:
        """Return the mask of those of the given cells that lie in a domain."""
        return reduce(or_, (1 << self.bit[cell] for cell in cells if cell in self.bit), 0)

    def members(self, mask: int) -> tuple[int, ...]:
        """Return the cells of a mask, ascending."""
        return tuple(self.cells[bit] for bit in bits(mask))

    def kind_of(self, obstacle: int) -> ObstacleKind:
        """Return the kind of an obstacle."""
        return next(kind for kind in self.kinds if obstacle in kind.obstacles)

    def reach(self, kind: ObstacleKind, cell: int, standing: int | None = None) -> tuple[int, ...]:
        """Return the cells in which an obstacle can be after a turn.

        Args:
            kind: its kind.
            cell: where it is.
            standing: the cell of the robot when it stands there in this turn, else None.
        """
        return self.members(kind.image(1 << self.bit[cell], 0 if standing is None else self.mask((standing,))))


def bits(mask: int) -> Iterator[int]:
    """Yield the numbers of the set bits, ascending."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low


def obstacle_kinds(
    coarse: CoarseMap, obstacles: tuple[Obstacle, ...], tracking: BeliefTracking = "joint"
) -> ObstacleKinds:
    """Sort obstacles into kinds: those of equal domain and speed, or each on its own.

    Args:
        coarse: the map.
        obstacles: the obstacles, in the order of the scenario.
        tracking: whether obstacles of equal domain and speed are told apart ("separate") or not ("joint").

    Source: Shamsah et al., T-RO 2023, VI-F.
    """
    grid = coarse.grid
    free = frozenset(map(grid.index, grid.free_cells()))
    members: dict[tuple[frozenset[int], int, int], list[int]] = {}
    for number, obstacle in enumerate(obstacles):
        told_apart = number if tracking == "separate" else 0
        members.setdefault((free - obstacle.forbidden, obstacle.speed_cells, told_apart), []).append(number)
    cells = tuple(sorted(frozenset[int]().union(*(domain for domain, _, _ in members))))
    bit = {cell: number for number, cell in enumerate(cells)}

    def mask_of(indices: Iterable[int]) -> int:
        return reduce(or_, (1 << bit[index] for index in indices if index in bit), 0)

    near = [1 << bit[cell] | mask_of(map(grid.index, adjacent_free(grid, grid.cell(cell)))) for cell in cells]
    kinds = []
    for (domain, speed_cells, _), numbers in members.items():
        within = mask_of(domain)
        beside = tuple(mask & within if within >> number & 1 else 0 for number, mask in enumerate(near))
        kinds.append(ObstacleKind(tuple(numbers), speed_cells, within, beside))
    seen_from = tuple(mask_of(sees.nonzero()[0].tolist()) for sees in coarse.sees)
    return ObstacleKinds(cells, bit, seen_from, tuple(kinds))


@dataclass(frozen=True, slots=True)
class ObstacleState:
    """What the robot knows of the obstacles, one entry per kind.

    Attributes:
        visible: cells of the obstacles in view, ascending.
        hidden: mask of the cells that the others may be in; 0 when none is hidden.
    """

    visible: tuple[tuple[int, ...], ...]
    hidden: tuple[int, ...]

    def possible(self, kinds: ObstacleKinds) -> tuple[int, ...]:
        """Return for every kind the mask of all cells that one of its obstacles may be in."""
        return tuple(hidden | kinds.mask(seen) for seen, hidden in zip(self.visible, self.hidden, strict=True))

"""Moving obstacles: where they may be, how they move, and when they block a waiting robot.

Sets of cells are bit masks over an obstacle domain: bit i stands for ``domain[i]``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import reduce
from operator import or_

from surefoot.frames import Direction
from surefoot.navigation.coarse import CoarseMap, adjacent_free


@dataclass(frozen=True, slots=True)
class ObstacleDomain:
    """The cells that an obstacle may enter, and what can be reached and seen there.

    Attributes:
        cells: indices of the cells, ascending.
        bit: the bit number of a cell.
        reach: for every bit, the mask of the cells that one move (or staying) leads to.
        seen_from: for every cell of the grid, the mask of the domain cells seen from it.
    """

    cells: tuple[int, ...]
    bit: dict[int, int]
    reach: tuple[int, ...]
    seen_from: tuple[int, ...]

    @property
    def everywhere(self) -> int:
        """Return the mask of the whole domain."""
        return (1 << len(self.cells)) - 1

    def mask(self, cells: Iterable[int]) -> int:
        """Return the mask of those of the given cells that lie in the domain."""
        return reduce(or_, (1 << self.bit[cell] for cell in cells if cell in self.bit), 0)

    def members(self, mask: int) -> tuple[int, ...]:
        """Return the cells of a mask, ascending."""
        return tuple(self.cells[bit] for bit in bits(mask))

    def image(self, mask: int) -> int:
        """Return where obstacles in the mask can be after one turn (rules.md 4, ``next``)."""
        return reduce(or_, (self.reach[bit] for bit in bits(mask)), 0)


def bits(mask: int) -> Iterator[int]:
    """Yield the numbers of the set bits, ascending."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low


def obstacle_domain(coarse: CoarseMap, forbidden: frozenset[int]) -> ObstacleDomain:
    """Return the domain of an obstacle: every free cell that is not forbidden to it."""
    grid = coarse.grid
    cells = tuple(sorted(grid.index(cell) for cell in grid.free_cells() if grid.index(cell) not in forbidden))
    bit = {cell: number for number, cell in enumerate(cells)}

    def mask_of(indices: Iterable[int]) -> int:
        return reduce(or_, (1 << bit[index] for index in indices if index in bit), 0)

    reach = tuple(
        1 << bit[cell] | mask_of(grid.index(near) for near in adjacent_free(grid, grid.cell(cell))) for cell in cells
    )
    seen_from = tuple(mask_of(sees.nonzero()[0].tolist()) for sees in coarse.sees)
    return ObstacleDomain(cells, bit, reach, seen_from)


@dataclass(frozen=True, slots=True)
class ObstacleState:
    """What the robot knows of the obstacles.

    Attributes:
        visible: cells of the obstacles in view, ascending.
        hidden: mask of the cells that the others may be in; 0 when none is hidden.
    """

    visible: tuple[int, ...]
    hidden: int

    def possible(self, domain: ObstacleDomain) -> int:
        """Return the mask of all cells that some obstacle may be in."""
        return self.hidden | domain.mask(self.visible)


class Blocking:
    """Decides ``blocked_m`` of assumption (c), rules.md 4.

    Infinitely often it must be false that the robot waits for a move that obstacles block although they could make way.
    The robot cannot win by falsifying this. A violation needs one declared wait for ever, hence one cell s for ever;
    obstacles stay out of s then, and each of them has a path around s to a cell where it may stay, since that is what
    the two clauses ask for. Answers are remembered per (cell, move).

    Source: facts of experiments on Shamsah et al., T-RO 2023, VI-A, assumption (c), in its waiting form.
    """

    def __init__(self, coarse: CoarseMap, domain: ObstacleDomain) -> None:
        self._coarse = coarse
        self._domain = domain
        self._geometry: dict[tuple[int, Direction], tuple[int, int, int]] = {}

    def __call__(self, cell: int, direction: Direction, state: ObstacleState) -> bool:
        """Return whether obstacles block the move that the robot in a cell waits for."""
        threats, can_clear, can_show = self._areas(cell, direction)
        in_view = self._domain.mask(state.visible)
        if in_view & threats & can_clear:
            return True
        return bool(state.hidden & threats) and not state.hidden & ~can_show

    def _areas(self, cell: int, direction: Direction) -> tuple[int, int, int]:
        """Return the masks: cells that threaten the move; whose component has a free cell; a free cell in view."""
        key = (cell, direction)
        if key not in self._geometry:
            domain = self._domain
            goal = domain.mask((cell, int(self._coarse.target[cell, direction])))
            threats = reduce(or_, (1 << bit for bit in range(len(domain.cells)) if domain.reach[bit] & goal), 0)
            free = domain.everywhere & ~threats
            in_view = free & domain.seen_from[cell]
            can_clear = can_show = 0
            for component in components(domain, domain.everywhere & ~domain.mask((cell,))):
                can_clear |= component if component & free else 0
                can_show |= component if component & in_view else 0
            self._geometry[key] = threats, can_clear, can_show
        return self._geometry[key]


def components(domain: ObstacleDomain, within: int) -> Iterator[int]:
    """Yield the connected components of a part of the domain as masks."""
    while within:
        component = within & -within
        while (grown := domain.image(component) & within) != component:
            component = grown
        yield component
        within &= ~component

"""What cells over some ground are worth: where a robot can stand by the rules, and which of these hang together."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from surefoot.skills.quadruped_terrain import QuadrupedTerrain
from surefoot.skills.values import OBSTACLE, Cell, Direction


@dataclass(frozen=True, eq=False)
class Lay:
    """A lattice and what it is worth.

    Attributes:
        terrain: the ground in the frame of the lattice, start and goal among it as far as they are known.
        left_out: polygons of the scan that lie in crevices.
    """

    terrain: QuadrupedTerrain
    left_out: frozenset[int] = frozenset()

    @cached_property
    def standing(self) -> frozenset[Cell]:
        """Cells on which the robot can stand, by the rules."""
        classes, measured = self.terrain.classes, self.terrain.measured
        return frozenset(
            cell for cell, one in measured.items() if classes.classify(one.seen_from(one.height_m)) != OBSTACLE
        )

    @cached_property
    def parts(self) -> tuple[frozenset[Cell], ...]:
        """Sets of cells between which the rules allow moves both ways, the largest first."""
        left, found = set(self.standing), []
        while left:
            part, queue = set(), [min(left)]
            left.discard(queue[0])
            while queue:
                cell = queue.pop()
                part.add(cell)
                new = [one for way in Direction if (one := way.of(cell)) in left and self._passable(cell, one)]
                left.difference_update(new)
                queue += new
            found.append(frozenset(part))
        return tuple(sorted(found, key=lambda part: (-len(part), min(part))))

    def _passable(self, here: Cell, there: Cell) -> bool:
        measured, classes = self.terrain.measured, self.terrain.classes
        return all(
            classes.classify(measured[b].seen_from(measured[a].height_m)) != OBSTACLE
            for a, b in ((here, there), (there, here))
        )

    @cached_property
    def part(self) -> frozenset[Cell]:
        """The cells that count: those about the start if there is one, else the largest part."""
        if self.terrain.start_m is None:
            return self.parts[0] if self.parts else frozenset()
        start = self.terrain.cell_at(self.terrain.start_m)
        return next((part for part in self.parts if start in part), frozenset())

    @property
    def arrives(self) -> bool:
        """Whether the goal, if there is one, is among the cells that count."""
        return bool(self.part) and (
            self.terrain.goal_m is None or self.terrain.cell_at(self.terrain.goal_m) in self.part
        )

    @property
    def worth_m2(self) -> float:
        """Area of the cells that count."""
        return len(self.part) * self.terrain.cell_m**2

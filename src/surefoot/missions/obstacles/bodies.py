"""The moving obstacles of a scene as they truly are: where each starts, and where it can go."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass

from surefoot.navigation import NavigationProblem, ObstacleKind, ObstacleKinds


@dataclass(frozen=True, slots=True)
class Body:
    """A moving obstacle.

    Attributes:
        start: its cell at the start.
        kind: its kind.
        kinds: all kinds, with the cells that masks speak of.
    """

    start: int
    kind: ObstacleKind
    kinds: ObstacleKinds

    @property
    def domain(self) -> tuple[int, ...]:
        """Return the cells that it may enter, ascending."""
        return self.kinds.members(self.kind.within)

    def next_cells(self, cell: int, barred: int | None = None) -> tuple[int, ...]:
        """Return where it can be after a turn, ascending; from outside its domain, just there.

        Args:
            cell: where it is.
            barred: the cell of a robot that stands, which no move may enter (assumption (a)).
        """
        if not self.kinds.mask((cell,)) & self.kind.within:
            return (cell,)
        return self.kinds.reach(self.kind, cell, barred)

    def turns_to(self, goals: Iterable[int], barred: int | None = None) -> dict[int, int]:
        """Return how many turns the shortest way to the nearest goal takes, by cell; others are left out."""
        domain = frozenset(self.domain)
        found = {goal: 0 for goal in goals if goal in domain and goal != barred}
        queue = deque(found)
        while queue:
            cell = queue.popleft()
            # A way back is as long as the way there.
            for near in self.next_cells(cell, barred):
                if near not in found:
                    found[near] = found[cell] + 1
                    queue.append(near)
        return found


def bodies_of(problem: NavigationProblem) -> tuple[Body, ...]:
    """Return the obstacles of a navigation problem, in the order of the scenario."""
    kinds = problem.obstacle_kinds
    return tuple(Body(start, kinds.kind_of(number), kinds) for number, start in enumerate(problem.obstacle_starts))

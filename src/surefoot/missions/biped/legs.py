"""How the robot got from one goal to the next: straight there, around to see, or by waiting (Shamsah et al., IX-C)."""

from __future__ import annotations

from surefoot.frames import Direction
from surefoot.navigation import CoarseMap, Order, allowed_orders

REACTIONS = ("direct", "loop", "wait")
"""A *leg* leads from one goal (or the start) to the next one. It is a *loop* when it took more moves than the shortest
way, a *wait* when it took no more but the robot waited on it, and *direct* otherwise."""


class Legs:
    """Counts the reactions of a walk.

    Args:
        coarse: the map.
        cell: where the robot starts.
        heading: its heading there.
    """

    def __init__(self, coarse: CoarseMap, cell: int, heading: Direction) -> None:
        self.counts = dict.fromkeys(REACTIONS, 0)
        self._coarse = coarse
        self._begin(cell, heading)

    def order(self, order: Order) -> None:
        """Count an order that was carried out."""
        self._waits += order.waits
        self._moves += not order.waits

    def finish(self, goal: int, heading: Direction) -> None:
        """End a leg in its goal and begin the next one there."""
        shortest = fewest_moves(self._coarse, self._cell, self._heading, goal)
        self.counts["loop" if self._moves > shortest else "wait" if self._waits else "direct"] += 1
        self._begin(goal, heading)

    def _begin(self, cell: int, heading: Direction) -> None:
        self._cell, self._heading = cell, heading
        self._moves = self._waits = 0


def fewest_moves(coarse: CoarseMap, cell: int, heading: Direction, goal: int) -> int:
    """Return how many moves lead from a cell into a goal at least, without U-turns; 0 when none do."""
    front, met = [(cell, heading)], {(cell, heading)}
    moves = 0
    while front:
        moves += 1
        following = []
        for place, facing in front:
            for order in allowed_orders(coarse, place, facing):
                after = int(coarse.target[place, order.direction]), order.direction
                if after[0] == goal:
                    return moves
                if after not in met:
                    met.add(after)
                    following.append(after)
        front = following
    return 0

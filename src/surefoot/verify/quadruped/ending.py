"""Checks why a quadruped's run ended before its goal: every reason is derived again (docs/formats.md 12).

For "no way" all moves are followed that classes, refused skills, failed and given up moves leave: where they surely
lead to the goal, there was a way.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from surefoot.verify.quadruped.moves import Automaton, Pose
from surefoot.verify.skills.moves import led
from surefoot.verify.skills.plans import TURNS
from surefoot.verify.terrain.cell_classes import CellClasses, Seen, on_map
from surefoot.verify.terrain.class_rules import OBSTACLE
from surefoot.verify.terrain.map import Cell

FOOT = "the ground below a foot of the robot has gone"
OWN_CELL = "the robot's own cell has become an obstacle, and no motion leads out of it"
NO_WAY = "no way leads to the goal: the global planner knows none that is not blocked or refused"
LIMIT = "the limit of {} segments was reached"
_PER_CELL = 4


class Ending:
    """What is known when a run ends.

    Args:
        automaton: what was refused, failed and given up.
        classes: of the ground as it is.
        goal: cell of the map.
        turning: whether the robot turns.
    """

    def __init__(self, automaton: Automaton, classes: CellClasses, goal: Cell, *, turning: bool) -> None:
        self.automaton, self.classes, self.goal, self.turning = automaton, classes, goal, turning
        self.grid = classes.grid

    def problem(self, why_not: str, pose: Pose, segments: int, *, footing: bool) -> str:
        """Return what is wrong with the reason of a run that has not reached its goal; empty if nothing is.

        Args:
            why_not: the reason.
            pose: where the robot stands.
            segments: how many motions it walked.
            footing: whether there is ground below all its feet.
        """
        most = _PER_CELL * math.prod(self.classes.ground.cells)
        if why_not == LIMIT.format(most):
            return "" if segments >= most else f"there are {segments} segments only"
        if why_not == FOOT:
            return "there is ground below every foot" if footing else ""
        if why_not == OWN_CELL:
            return self._own_cell(pose)
        if why_not == NO_WAY:
            return "moves lead to the goal that nothing forbids" if self._way(pose) else ""
        return f"{why_not!r} is no reason for a run to end"

    def _own_cell(self, pose: Pose) -> str:
        cell, turns = pose
        if OBSTACLE not in self.classes.own(cell, turns):
            return f"the robot can stand in {cell}"
        for way in self.classes.ground.directions:
            row, column, _ = led((0, 0, 0), way)
            there = on_map(cell, (row, column), turns)
            free = OBSTACLE not in self.classes.own(there, turns) and math.isfinite(self.classes.height_m(cell))
            if free and ((cell, turns % 4), (there, turns % 4)) not in self.automaton.lost:
                return f"going {way} from {cell} was not tried"
        return ""

    def _way(self, pose: Pose) -> bool:
        """Return whether moves that are surely allowed lead from look to look to the goal."""
        start, turns = pose
        seen, stack = {start}, [start]
        while stack:
            for cell in self._next_looks(stack.pop(), turns):
                if cell not in seen:
                    seen.add(cell)
                    stack.append(cell)
        return self.goal in seen

    def _next_looks(self, cell: Cell, turns: int) -> Iterator[Cell]:
        """Yield the cells of a grid that are surely within reach of its centre, and in which the robot can stand."""
        if OBSTACLE in self.classes.own(cell, turns):
            return
        labels = self.classes.labels(cell, turns)
        first = self.grid[0] // 2, self.grid[1] // 2, 0
        seen, stack = {first}, [first]
        while stack:
            here = stack.pop()
            place, _ = self._on_map((cell, turns), here)
            if here[:2] != first[:2] and OBSTACLE not in self.classes.own(place, turns):
                yield place
            for way in (*self.classes.ground.directions, *(TURNS if self.turning else ())):
                there = led(here, way)
                ends = self._on_map((cell, turns), here), self._on_map((cell, turns), there)
                if there not in seen and self._allowed(labels, way, here, there) and not self.automaton.closed(*ends):
                    seen.add(there)
                    stack.append(there)

    def _on_map(self, looked: Pose, place: tuple[int, int, int]) -> Pose:
        offset = place[0] - self.grid[0] // 2, place[1] - self.grid[1] // 2
        return on_map(looked[0], offset, looked[1]), (looked[1] + place[2]) % 4

    def _allowed(self, labels: Seen, way: str, here: tuple[int, int, int], there: tuple[int, int, int]) -> bool:
        """Return whether no reading of the classes makes a move one that is refused."""
        if not (0 <= there[0] < self.grid[0] and 0 <= there[1] < self.grid[1]):
            return False
        before, after = labels[here[0]][here[1]], labels[there[0]][there[1]]
        names = {
            f"{way} {self.automaton.named(one, here[2])}->{self.automaton.named(other, there[2])}"
            for one in before
            for other in after
            if way not in TURNS or one == other
        }
        return OBSTACLE not in before | after and not names & self.automaton.refused

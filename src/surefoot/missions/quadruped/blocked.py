"""Why no way leads to the goal: the obstacles, refused skills and failed programs that stand in it, with measures."""

from __future__ import annotations

from dataclasses import dataclass

from surefoot.footholds import solve
from surefoot.missions.quadruped.crossing import Crossed
from surefoot.missions.quadruped.route import Edge, in_grid, moves_from
from surefoot.missions.quadruped.world import World, overlap
from surefoot.skills.blocking import Barrier, barriers
from surefoot.skills.headings import Turning
from surefoot.skills.manager import Knowledge
from surefoot.skills.values import Cell

_HEADINGS = 4


@dataclass(frozen=True, slots=True, eq=False)
class Blockade:
    """What a mission knows when it finds no way.

    Attributes:
        world: the map.
        knowledge: what physics said.
        failed: programs without a motion, by move.
        turning: how a robot that turns sees a grid; None for one that does not.
    """

    world: World
    knowledge: Knowledge
    failed: dict[Edge, Crossed]
    turning: Turning | None

    def between(self, here: Cell, goal: Cell) -> tuple[Barrier, ...]:
        """Return what is in the way, along the way with the fewest barriers."""
        return barriers(self.world.terrain, here, goal, self._closed)

    def _closed(self, here: Cell, there: Cell) -> str:
        if any(overlap(self.world.terrain.square_m(there), box) for box in self.world.obstacles):
            return "something stands there"
        programs = [crossed for (a, b), crossed in self.failed.items() if (a[0], b[0]) == (here, there)]
        if programs:
            return f"on the real polygons, {_explained(programs[-1])}"
        said = [self._refused(here, there, turns) for turns in range(1 if self.turning is None else _HEADINGS)]
        return said[0] if all(said) else ""

    def _refused(self, here: Cell, there: Cell, quarter_turns: int) -> str:
        """Return why physics has no skill for a move with a heading; empty if nobody knows."""
        state = self.world.state(here, quarter_turns)
        if state is None:
            return ""
        wanted = in_grid(here, there, quarter_turns, (state.rows, state.columns))
        for primitive, after in moves_from(state, (state.centre, 0), self.turning):
            if after[0] == wanted and wanted != state.centre and primitive in self.knowledge.refused:
                result = self.knowledge.refused[primitive]
                return f"physics refuses {primitive.name}: {result.explanation or result.verdict.value}"
        return ""


def _explained(crossed: Crossed) -> str:
    """Return what would have to give for a program that has no motion."""
    if crossed.solution is None:
        return crossed.reason
    found = solve(crossed.problem, why=True)
    return found.explanation.text if found.explanation is not None else crossed.reason

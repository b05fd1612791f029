"""The global planner: shortest ways over the cells of the whole map, and the way point of a local grid.

Source: Zhou et al. 2025, IX-D: a naive global shortest path; "the closest non-obstacle cell in the local grid map
pointing toward the global target". Here a way is one of requests: what a move asks of the robot depends on where it
stands when it looks around, as heights are relative to that.
"""

from __future__ import annotations

import heapq
import math
from collections import deque
from collections.abc import Collection, Iterator

from surefoot.missions.quadruped.world import World
from surefoot.skills.grid import requests_of
from surefoot.skills.headings import Turning
from surefoot.skills.values import Cell, Direction, Primitive, TerrainState, Turn

Pose = tuple[Cell, int]
"""A cell of the map, and a heading in quarter turns from 0 to 3."""
Edge = tuple[Pose, Pose]
"""A move, or a turn in place."""


def offset_on_map(offset: Cell, quarter_turns: int) -> Cell:
    """Return a change of (row, column) of a local grid as a change on the map, whose rows run against x."""
    row, column = offset
    for _ in range(quarter_turns % 4):
        row, column = -column, row
    return row, column


def on_map(cell: Cell, local: Cell, quarter_turns: int, grid: tuple[int, int]) -> Cell:
    """Return the cell of the map below a cell of the local grid about ``cell``."""
    row, column = offset_on_map((local[0] - grid[0] // 2, local[1] - grid[1] // 2), quarter_turns)
    return cell[0] + row, cell[1] + column


def in_grid(cell: Cell, other: Cell, quarter_turns: int, grid: tuple[int, int]) -> Cell | None:
    """Return where another cell of the map is in the local grid about ``cell``; None outside of it."""
    row, column = offset_on_map((other[0] - cell[0], other[1] - cell[1]), -quarter_turns)
    local = row + grid[0] // 2, column + grid[1] // 2
    return local if 0 <= local[0] < grid[0] and 0 <= local[1] < grid[1] else None


def pose_on_map(looked: Pose, local: Pose, grid: tuple[int, int]) -> Pose:
    """Return the pose on the map of a pose in the local grid that lies about a pose."""
    return on_map(looked[0], local[0], looked[1], grid), (looked[1] + local[1]) % 4


def pose_in_grid(looked: Pose, other: Pose, grid: tuple[int, int]) -> Pose | None:
    """Return where a pose of the map is in the local grid about another one; None outside of it."""
    local = in_grid(looked[0], other[0], looked[1], grid)
    return None if local is None else (local, (other[1] - looked[1]) % 4)


def moves_from(state: TerrainState, local: Pose, turning: Turning | None) -> Iterator[tuple[Primitive, Pose]]:
    """Yield what a robot in a local pose could do if it had every primitive, and where that leads."""
    if turning is None:
        for direction in Direction:
            primitive = state.primitive(local[0], direction)
            if primitive is not None:
                yield primitive, (direction.of(local[0]), local[1])
        return
    for way in (*turning.directions, *Turn):
        primitive = turning.primitive(state, local, way)
        if primitive is not None:
            yield primitive, turning.after(local, way)


class Routes:
    """Shortest ways to a goal over the requests that can be made, as far as anybody knows.

    From a cell the robot may ask for every cell of its local grid that classes, refused primitives and failed moves
    leave within reach; there it looks around anew. Such a step costs the moves that it takes.

    Args:
        world: the map.
        goal: cell of the map.
        quarter_turns: heading of the robot when it looks around.
        refused: primitives that physics refused.
        closed: moves that failed, or that were given up.
        turning: how a robot that turns sees a grid; None for one that does not.
    """

    def __init__(
        self,
        world: World,
        goal: Cell,
        quarter_turns: int,
        refused: Collection[Primitive],
        closed: Collection[Edge],
        turning: Turning | None = None,
    ) -> None:
        self.world, self.goal, self.turns = world, goal, quarter_turns
        self.refused, self.closed, self.turning = refused, closed, turning
        self.steps: dict[Cell, dict[Cell, int]] = {}
        self.left = self._distances()

    def _distances(self) -> dict[Cell, int]:
        """Return the number of moves to the goal from every cell that has a way (Dijkstra, from the goal backwards)."""
        rows, columns = self.world.terrain.cells
        before: dict[Cell, list[tuple[Cell, int]]] = {}
        for cell in ((r, c) for r in range(rows) for c in range(columns)):
            self.steps[cell] = self._within_reach(cell)
            for target, moves in self.steps[cell].items():
                before.setdefault(target, []).append((cell, moves))
        left, heap = {self.goal: 0}, [(0, self.goal)]
        while heap:
            done, cell = heapq.heappop(heap)
            if done > left[cell]:
                continue
            for source, moves in before.get(cell, ()):
                if done + moves < left.get(source, _FAR):
                    left[source] = done + moves
                    heapq.heappush(heap, (left[source], source))
        return left

    def _within_reach(self, cell: Cell) -> dict[Cell, int]:
        """Return the cells that can be asked for from a cell, with the number of moves to each."""
        state = self.world.state(cell, self.turns)
        if state is None:
            return {}
        grid = (state.rows, state.columns)
        moves: dict[Pose, int] = {(state.centre, 0): 0}
        queue = deque(moves)
        found: dict[Cell, int] = {}
        while queue:
            local = queue.popleft()
            place = pose_on_map((cell, self.turns), local, grid)
            if local[0] != state.centre and self.world.state(place[0], self.turns) is not None:
                found.setdefault(place[0], moves[local])
            for primitive, after in moves_from(state, local, self.turning):
                edge = place, pose_on_map((cell, self.turns), after, grid)
                if after in moves or primitive in self.refused or edge in self.closed:
                    continue
                moves[after] = moves[local] + 1
                queue.append(after)
        return found

    def route(self, cell: Cell) -> tuple[Cell, ...] | None:
        """Return the cells where the robot will look around on its way, both ends included; None if there is no way."""
        if cell not in self.left:
            return None
        way = [cell]
        while way[-1] != self.goal:
            steps = self.steps[way[-1]]
            way.append(
                min((one for one in steps if one in self.left), key=lambda one: (steps[one] + self.left[one], one))
            )
        return tuple(way)

    def wishes(self, cell: Cell, state: TerrainState, asked: Collection[Cell] | None) -> tuple[Cell, ...]:
        """Return the cells of a local grid to ask for, best first: those from which less is left to the goal.

        The usual requests come first, the nearest to the goal before all others, ties by the angle to it. Other cells
        follow: requests that a library has not seen are the runtime repair's business. The goal itself is asked for
        wherever it is seen.

        Args:
            cell: of the map, where the robot is.
            state: classes about it.
            asked: cells that may be asked for; None for the usual ones.
        """
        usual = requests_of(state) if asked is None else tuple(asked)
        now = self.left.get(cell, _FAR)
        ranked = []
        for local in state.cells():
            place = on_map(cell, local, self.turns, (state.rows, state.columns))
            if place not in self.steps.get(cell, {}) or self.left.get(place, _FAR) >= now:
                continue
            rank = (place != self.goal, local not in usual, self.left[place], _turn(cell, place, self.goal))
            ranked.append((rank, local))
        return tuple(local for _, local in sorted(ranked))


_FAR = 1_000_000_000


def _turn(cell: Cell, place: Cell, goal: Cell) -> float:
    """Return the angle between the way to a cell and the way to the goal."""
    a = math.atan2(place[0] - cell[0], place[1] - cell[1])
    b = math.atan2(goal[0] - cell[0], goal[1] - cell[1])
    return round(abs(math.remainder(a - b, math.tau)), 9)

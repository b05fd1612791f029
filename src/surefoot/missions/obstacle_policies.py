"""How simulated obstacles move: at random, against the robot, or by a script."""

from __future__ import annotations

import random
from collections import deque
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Protocol

from surefoot.documents import read_yaml
from surefoot.errors import InputError
from surefoot.frames import Direction
from surefoot.navigation import CoarseMap, ObstacleDomain, Order
from surefoot.world import CoarseGrid

FARTHEST_M = 1e6
PATIENCE_TURNS = 20
"""Within so many turns of waiting an adversary makes way (assumption (c))."""


@dataclass(frozen=True, slots=True)
class Situation:
    """What an obstacle knows when it moves: everything.

    Attributes:
        turn: number of the turn.
        cell: the robot's cell before the turn.
        order: the order that it carries out.
        truth: the obstacle's cell.
        legal: cells that the obstacle may move to, staying included.
    """

    turn: int
    cell: int
    order: Order
    truth: int
    legal: tuple[int, ...]


class Policy(Protocol):
    """Chooses an obstacle's next cell among the legal ones."""

    def __call__(self, situation: Situation) -> int:
        """Return the next cell."""


def random_policy(seed: int) -> Policy:
    """Return a policy that picks a legal cell with equal chances."""
    chance = random.Random(seed)  # noqa: S311 - a simulation, not a secret
    return lambda situation: chance.choice(situation.legal)


def legal_cells(domain: ObstacleDomain, truth: int, robot: int, order: Order) -> tuple[int, ...]:
    """Return where an obstacle may go: one move or none, and not into a robot that stands (assumption (a))."""
    reach = domain.reach[domain.bit[truth]]
    return domain.members(reach & ~(domain.mask((robot,)) if order.waits else 0))


class Adversary:
    """Hunts the robot and blocks its way, within the rules.

    It walks the shortest way to the cell that the robot wants to enter next and stays there. While the robot waits for
    a move, the adversary counts; just in time to be gone within PATIENCE_TURNS it walks to a cell in the robot's view
    that does not threaten the move, if it can reach one (docs/rules.md 4, assumption (c)).

    Args:
        coarse: the map.
        domain: where the obstacle may be.
        seed: breaks ties.
    """

    def __init__(self, coarse: CoarseMap, domain: ObstacleDomain, seed: int) -> None:
        self._coarse = coarse
        self._domain = domain
        self._chance = random.Random(seed)  # noqa: S311
        self._awaited: tuple[int, Direction] | None = None
        self._waited = 0

    def __call__(self, situation: Situation) -> int:
        """Return the next cell."""
        order, cell = situation.order, situation.cell
        target = int(self._coarse.target[cell, order.direction])
        if not order.waits:
            self._awaited = None
            return self._toward({target}, situation, barred=None)
        if self._awaited != (cell, order.direction):
            self._awaited, self._waited = (cell, order.direction), 0
        self._waited += 1
        refuge = self._refuge(cell, target)
        away = self._distances(refuge, barred=cell).get(situation.truth)
        if away is not None and self._waited + away + 1 >= PATIENCE_TURNS:
            return self._toward(refuge, situation, barred=cell)
        return self._toward({target}, situation, barred=cell)

    def _refuge(self, cell: int, target: int) -> set[int]:
        """Return the cells in the robot's view from which neither its cell nor its target can be entered next."""
        domain = self._domain
        wanted = domain.mask((cell, target))
        return {
            place
            for bit, place in enumerate(domain.cells)
            if not domain.reach[bit] & wanted and domain.seen_from[cell] >> bit & 1
        }

    def _toward(self, goals: set[int], situation: Situation, barred: int | None) -> int:
        """Return the legal cell nearest to the goals; where no way leads there, the nearest as the crow flies."""
        distances = self._distances(goals & set(self._domain.cells), barred)
        crow = self._coarse.grid

        def cost(place: int) -> tuple[float, float, float]:
            row, column = crow.cell(place)
            straight = min((abs(row - r) + abs(column - c) for r, c in map(crow.cell, goals)), default=0)
            return distances.get(place, float("inf")), straight, self._chance.random()

        return min(situation.legal, key=cost)

    def _distances(self, goals: set[int], barred: int | None) -> dict[int, int]:
        """Return the length of the shortest way of an obstacle to the goals, by cell."""
        domain = self._domain
        distance = {goal: 0 for goal in goals if goal != barred}
        queue = deque(distance)
        while queue:
            place = queue.popleft()
            for near in domain.members(domain.reach[domain.bit[place]]):
                if near != barred and near not in distance:
                    distance[near] = distance[place] + 1
                    queue.append(near)
        return distance


class Script:
    """Reads from a YAML file where the obstacle is after each turn; after its end the obstacle stays.

    The file holds ``{format: 1, kind: obstacle-script, positions_m: [[x, y], ...]}`` (docs/formats.md). Where a
    standing robot is in the way, the obstacle waits, and the rest of the script comes that much later.

    Args:
        path: the file.
        grid: the coarse grid.
        domain: where the obstacle may be.
        start: where it starts.

    Raises:
        InputError: if the file is no such script, or asks for a move that the rules forbid.
    """

    def __init__(self, path: Path, grid: CoarseGrid, domain: ObstacleDomain, start: int) -> None:
        places = _read_script(path, grid)
        for number, (before, after) in enumerate(pairwise((start, *(cell for cell, _ in places)))):
            allowed = domain.members(domain.reach[domain.bit[before]])
            if after not in allowed:
                names = ", ".join(str(tuple(grid.cell(cell))) for cell in allowed)
                raise InputError(
                    f"the obstacle cannot go from {tuple(grid.cell(before))} to {tuple(grid.cell(after))}; "
                    f"allowed are {names}",
                    source=path,
                    line=places[number][1],
                    key=f"positions_m[{number}]",
                )
        self._left = deque(cell for cell, _ in places)

    def __call__(self, situation: Situation) -> int:
        """Return the next cell."""
        if self._left and self._left[0] in situation.legal:
            return self._left.popleft()
        return situation.truth


def _read_script(path: Path, grid: CoarseGrid) -> tuple[tuple[int, int | None], ...]:
    """Return the cells of a script, each with its line."""
    document = read_yaml(path)
    if document.problems:
        raise document.problems[0]
    content = document.value
    known = {"format": 1, "kind": "obstacle-script"}
    if not isinstance(content, dict) or {key: content.get(key) for key in known} != known:
        raise InputError("must be a mapping with format: 1, kind: obstacle-script and positions_m", source=path)
    positions = content.get("positions_m")
    if set(content) - {*known, "positions_m"} or not isinstance(positions, tuple):
        raise InputError("the keys are format, kind and positions_m, a list of [x, y] in metres", source=path)
    lines = [document.lines.get(("positions_m", number)) for number in range(len(positions))]
    return tuple(
        (_script_cell(path, grid, position, number, line), line)
        for number, (position, line) in enumerate(zip(positions, lines, strict=True))
    )


def _script_cell(path: Path, grid: CoarseGrid, position: object, number: int, line: int | None) -> int:
    """Return the cell of one position of a script."""
    key = f"positions_m[{number}]"
    numbers = [value for value in position if type(value) in (int, float)] if isinstance(position, tuple) else []
    if (
        not isinstance(position, tuple)
        or len(position) != 2
        or len(numbers) != 2
        or max(map(abs, numbers)) > FARTHEST_M
    ):
        raise InputError(f"must be [x, y] in metres, at most {FARTHEST_M:g}", source=path, line=line, key=key)
    cell = grid.cell_at((float(numbers[0]), float(numbers[1])))
    if cell is None or not grid.is_free(cell):
        raise InputError("lies in no free cell", source=path, line=line, key=key)
    return grid.index(cell)

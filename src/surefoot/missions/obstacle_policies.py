"""How simulated obstacles move: at random, against the robot, or by a script."""

from __future__ import annotations

import random
from collections import deque
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import yaml

from surefoot.errors import InputError
from surefoot.frames import Direction
from surefoot.navigation import CoarseMap, ObstacleDomain, Order
from surefoot.world import CoarseGrid

PATIENCE_TURNS = 20
"""Within so many turns of waiting an adversary makes way (assumption (c))."""


@dataclass(frozen=True, slots=True)
class Situation:
    """What an obstacle knows when it moves: everything.

    Attributes:
        turn: number of the turn.
        cell: the robot's cell before the turn.
        heading: its heading.
        order: the order that it carries out.
        truth: the obstacle's cell.
        legal: cells that the obstacle may move to, staying included.
    """

    turn: int
    cell: int
    heading: Direction
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

    It walks the shortest way to the cell that the robot wants to enter next and stays there. While the robot waits
    for a move, the
    adversary counts; just in time to be gone within PATIENCE_TURNS it walks to a cell in the robot's view that
    does not
    threaten the move, if it can reach one (docs/rules.md 4, assumption (c)).

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


def scripted_policy(path: Path, grid: CoarseGrid) -> Policy:
    """Return a policy that reads where to be after each turn from a YAML file; after its end the obstacle stays.

    The file holds ``{format: 1, kind: obstacle-script, positions_m: [[x, y], ...]}``. An obstacle that would walk
    into a standing
    robot stays where it is.

    Raises:
        InputError: if the file is no such script, or, when played, asks for a move that the rules forbid.
    """
    places = _read_script(path, grid)

    def policy(situation: Situation) -> int:
        wanted = places[situation.turn] if situation.turn < len(places) else situation.truth
        if wanted in situation.legal:
            return wanted
        if situation.order.waits and wanted == situation.cell:
            return situation.truth
        allowed = ", ".join(str(tuple(grid.cell(cell))) for cell in situation.legal)
        here, there = tuple(grid.cell(situation.truth)), tuple(grid.cell(wanted))
        raise InputError(
            f"the obstacle cannot go from {here} to {there}; allowed are {allowed}",
            source=path,
            key=f"positions_m[{situation.turn}]",
        )

    return policy


def _read_script(path: Path, grid: CoarseGrid) -> tuple[int, ...]:
    try:
        if path.stat().st_size > 1_000_000:
            raise InputError("is larger than 1 MB", source=path)
        content = yaml.safe_load(path.read_text())
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as problem:
        raise InputError(f"cannot be read as YAML: {problem}".splitlines()[0], source=path) from problem
    known = {"format": 1, "kind": "obstacle-script"}
    if not isinstance(content, dict) or {key: content.get(key) for key in known} != known:
        raise InputError("must be a mapping with format: 1, kind: obstacle-script and positions_m", source=path)
    positions = content.get("positions_m")
    if set(content) - {*known, "positions_m"} or not isinstance(positions, list):
        raise InputError("the keys are format, kind and positions_m, a list of [x, y] in metres", source=path)
    cells = []
    for number, position in enumerate(positions):
        key = f"positions_m[{number}]"
        if not (
            isinstance(position, list) and len(position) == 2 and all(isinstance(v, int | float) for v in position)
        ):
            raise InputError("must be [x, y] in metres", source=path, key=key)
        cell = grid.cell_at((float(position[0]), float(position[1])))
        if cell is None or not grid.is_free(cell):
            raise InputError("lies in no free cell", source=path, key=key)
        cells.append(grid.index(cell))
    return tuple(cells)

"""How simulated obstacles move: at random, against the robot, or by a script."""

from __future__ import annotations

import random
from collections.abc import Collection
from dataclasses import dataclass
from typing import Protocol

from surefoot.frames import Direction
from surefoot.missions.obstacles.bodies import Body
from surefoot.navigation import CoarseMap, Order

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
        legal: cells that the obstacle may move to, ascending, staying included.
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


def random_policies(seed: int, count: int) -> tuple[Policy, ...]:
    """Return policies that pick a legal cell with equal chances, one for each of ``count`` obstacles."""
    chance = random.Random(seed)  # noqa: S311 - a simulation, not a secret

    def choose(situation: Situation) -> int:
        return chance.choice(situation.legal)

    return (choose,) * count


class Adversary:
    """Hunts the robot and blocks its way, within the rules.

    It walks the shortest way to the cell that the robot wants to enter next and stays there. While the robot waits for
    a move, the adversary counts; just in time to be gone within PATIENCE_TURNS it walks to a cell that does not
    threaten the move, one in the robot's view if it can reach one (docs/rules.md 4, assumption (c)).

    Args:
        coarse: the map.
        body: the obstacle.
        seed: breaks ties.
    """

    def __init__(self, coarse: CoarseMap, body: Body, seed: int) -> None:
        self._coarse = coarse
        self._body = body
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
        refuge = self._refuge(situation.truth, cell, target)
        away = self._body.turns_to(refuge, barred=cell).get(situation.truth)
        if away is not None and self._waited + away + 1 >= PATIENCE_TURNS:
            return self._toward(refuge, situation, barred=cell)
        return self._toward({target}, situation, barred=cell)

    def _refuge(self, truth: int, cell: int, target: int) -> set[int]:
        """Return the cells from which neither the robot's cell nor its target can be entered next.

        Those in the robot's view, when the obstacle can walk to one of them.
        """
        free = {place for place in self._body.domain if not {cell, target} & set(self._body.next_cells(place))}
        seen = {place for place in free if self._coarse.sees[cell, place]}
        return seen if truth in self._body.turns_to(seen, barred=cell) else free

    def _toward(self, goals: Collection[int], situation: Situation, barred: int | None) -> int:
        """Return the legal cell nearest to the goals; where no way leads there, the nearest as the crow flies."""
        turns = self._body.turns_to(goals, barred)
        crow = self._coarse.grid

        def cost(place: int) -> tuple[float, float, float]:
            row, column = crow.cell(place)
            straight = min((abs(row - r) + abs(column - c) for r, c in map(crow.cell, goals)), default=0)
            return turns.get(place, float("inf")), straight, self._chance.random()

        return min(situation.legal, key=cost)


class Crowd:
    """The true obstacles, and how they move.

    Args:
        bodies: the obstacles.
        policies: what each of them does.
        lawless: whether they may break their assumptions.
    """

    def __init__(self, bodies: tuple[Body, ...], policies: tuple[Policy, ...], *, lawless: bool = False) -> None:
        self.cells = [body.start for body in bodies]
        self.lawless = lawless
        self._bodies, self._policies = bodies, policies

    def move(self, turn: int, cell: int, order: Order) -> None:
        """Let every obstacle move while the robot, from a cell, carries out an order."""
        barred = cell if order.waits else None
        for number, (body, policy) in enumerate(zip(self._bodies, self._policies, strict=True)):
            truth = self.cells[number]
            self.cells[number] = policy(Situation(turn, cell, order, truth, body.next_cells(truth, barred)))

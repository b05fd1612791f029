"""The obstacle as the robot knows it, transcribed from rules.md 4: images, abstraction, outcomes, assumption (c)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from surefoot.frames import Direction
from surefoot.verify.scene import Scene

MOST_CELLS_FOR_EXACT = 40


class Known(NamedTuple):
    """What is known of the obstacle.

    Attributes:
        visible: place of its cell in the domain, -1 when it is hidden.
        hidden: bit mask over the domain of where it may be while hidden.
    """

    visible: int
    hidden: int

    @property
    def possible(self) -> int:
        """Return the mask of where the obstacle may be."""
        return self.hidden if self.visible < 0 else 1 << self.visible


class Outcomes(NamedTuple):
    """What a turn may lead to: whether a move is lost, and what may be known after it."""

    lost: bool
    known: tuple[Known, ...]


class Obstacle:
    """The obstacle of a scene; masks count the cells of its domain in ascending order."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.exists = bool(scene.scenario.obstacles)
        self.domain = scene.domain
        self.place = {cell: bit for bit, cell in enumerate(scene.domain)}
        self.next_of = [self._next(cell) for cell in scene.domain]
        self.regions = [self.mask(region) for region in scene.regions]
        self._seen: dict[int, int] = {}
        self._images: dict[int, int] = {}
        self._outcomes: dict[tuple[int, int, int, int], Outcomes] = {}
        self._parts: dict[int, list[int]] = {}
        self._blocked: dict[tuple[int, int, Known], bool] = {}

    def mask(self, cells: frozenset[int]) -> int:
        """Return the mask of those cells that lie in the domain."""
        return sum(1 << self.place[cell] for cell in cells if cell in self.place)

    def cells(self, mask: int) -> list[int]:
        """Return the cells of a mask, ascending."""
        return [self.domain[bit] for bit in bits(mask)]

    def _next(self, cell: int) -> int:
        """Return the cells that an obstacle may be in after one turn, itself included."""
        home = self.scene.cell(cell)
        around = [cell]
        for move in Direction:
            row, column = self.scene.target(home, move)
            if 0 <= row < self.scene.frame.rows and 0 <= column < self.scene.frame.columns:
                around.append(self.scene.index((row, column)))
        return sum(1 << self.place[near] for near in around if near in self.place)

    def image(self, mask: int) -> int:
        """Return next of a set."""
        if mask not in self._images:
            found = 0
            for bit in bits(mask):
                found |= self.next_of[bit]
            self._images[mask] = found
        return self._images[mask]

    def seen_from(self, cell: int) -> int:
        """Return the cells of the domain that the robot sees from a cell."""
        if cell not in self._seen:
            row = self.scene.sees[cell]
            self._seen[cell] = sum(1 << bit for bit, other in enumerate(self.domain) if row[other])
        return self._seen[cell]

    def bit(self, cell: int) -> int:
        """Return the mask of one cell, 0 outside the domain."""
        return 1 << self.place[cell] if cell in self.place else 0

    def abstraction(self, hidden: int, viewer: int) -> int:
        """Return the belief that stands for a hidden image seen from a cell."""
        method = self.scene.scenario.belief
        if method == "by size":
            method = "exact" if len(self.domain) <= MOST_CELLS_FOR_EXACT else "single"
        if method == "exact":
            return hidden
        unseen = ((1 << len(self.domain)) - 1) & ~self.seen_from(viewer)
        if method == "single":
            return unseen
        touched = 0
        for region in self.regions:
            if region & hidden:
                touched |= region
        return touched & unseen

    def at_start(self, obstacle: int, robot: int) -> Known:
        """Return what is known at the start."""
        where = self.bit(obstacle)
        if where & self.seen_from(robot):
            return Known(self.place[obstacle], 0)
        return Known(-1, self.abstraction(where, robot))

    def outcomes(self, known: Known, robot: int, target: int, moves: bool) -> Outcomes:
        """Return the outcomes of one turn.

        Args:
            known: before the turn.
            robot: cell of the robot before the turn.
            target: cell that the robot moves to, or waits to move to.
            moves: whether it moves.
        """
        if not self.exists:
            return Outcomes(False, (Known(-1, 0),))
        after = target if moves else robot
        key = (known.possible, robot, after, int(moves))
        if key not in self._outcomes:
            self._outcomes[key] = self._turn(known.possible, robot, after, moves)
        return self._outcomes[key]

    def _turn(self, possible: int, robot: int, after: int, moves: bool) -> Outcomes:
        image = self.image(possible)
        lost = moves and bool(image & (self.bit(robot) | self.bit(after)))
        if not moves:
            image &= ~self.bit(robot)
        viewer = after if self.scene.scenario.view_post else robot
        seen = self.seen_from(viewer)
        known = [Known(bit, 0) for bit in bits(image & seen)]
        if image & ~seen:
            known.append(Known(-1, self.abstraction(image & ~seen, viewer)))
        return Outcomes(lost, tuple(known))

    def blocked(self, known: Known, robot: int, target: int) -> bool:
        """Return blocked_m of assumption (c), for the robot's cell and the target of m."""
        if not self.exists:
            return False
        key = (robot, target, known)
        if key not in self._blocked:
            self._blocked[key] = self._is_blocked(known, robot, target)
        return self._blocked[key]

    def _is_blocked(self, known: Known, robot: int, target: int) -> bool:
        near = self.bit(robot) | self.bit(target)
        threats = sum(1 << bit for bit, image in enumerate(self.next_of) if image & near)
        if not known.possible & threats:
            return False
        refuge = ((1 << len(self.domain)) - 1) & ~threats
        if known.visible < 0:
            refuge &= self.seen_from(robot)
        homes = known.possible
        for part in self._components(robot):
            if part & homes:
                if not part & refuge:
                    return False
                homes &= ~part
        return not homes

    def _components(self, robot: int) -> list[int]:
        """Return the connected components of the domain without the robot's cell."""
        if robot not in self._parts:
            rest = ((1 << len(self.domain)) - 1) & ~self.bit(robot)
            parts = []
            while rest:
                part, grown = 0, rest & -rest
                while grown != part:
                    part, grown = grown, self.image(grown) & ~self.bit(robot)
                parts.append(part)
                rest &= ~part
            self._parts[robot] = parts
        return self._parts[robot]


def bits(mask: int) -> Iterator[int]:
    """Yield the places of the ones of a mask, ascending."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low

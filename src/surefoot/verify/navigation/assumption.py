"""Assumption (c) of rules.md 4: the obstacles do not block the move that the robot waits for, for ever."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from surefoot.verify.navigation.belief import Known, Obstacles
from surefoot.verify.navigation.belief_turn import WORD, Ints, image


class Way(NamedTuple):
    """What one kind can do about the robot's waiting in a cell for a move, as sets of words.

    Attributes:
        threats: cells that threaten the move.
        leaves: cells whose component has a cell that is free for the move.
        shows: cells whose component has a free cell that the robot sees.
    """

    threats: Ints
    leaves: Ints
    shows: Ints


class Assumption:
    """Judges ``blocked_m`` for decisions to wait."""

    def __init__(self, obstacles: Obstacles) -> None:
        self.obstacles = obstacles
        self._ways: dict[tuple[int, int, int], Way] = {}
        self._parts: dict[tuple[int, int], list[Ints]] = {}

    def way(self, kind: int, robot: int, target: int) -> Way:
        """Return what the obstacles of a kind can do while the robot waits in a cell for a target."""
        key = (kind, robot, target)
        if key not in self._ways:
            field, nothing = self.obstacles.fields[kind], self.obstacles.words_of(())
            # Moves can be walked backwards: a cell's next holds s or t when it is in next of {s, t}.
            near = self.obstacles.words_of((robot, target)) & field.domain
            threats = image(field, near, -1)
            free, seen = field.domain & ~threats, self.obstacles.seen_from(robot)
            parts = self._components(kind, robot)
            leaves, shows = (
                np.bitwise_or.reduce([part for part in parts if (part & goal).any()] + [nothing])
                for goal in (free, free & seen)
            )
            self._ways[key] = Way(threats, leaves, shows)
        return self._ways[key]

    def _components(self, kind: int, robot: int) -> list[Ints]:
        """Return the connected components of a kind's domain without the robot's cell."""
        key = (kind, robot)
        if key not in self._parts:
            field, barred = self.obstacles.fields[kind], self.obstacles.place.get(robot, -1)
            rest = field.domain & ~self.obstacles.words_of((robot,))
            parts = []
            while rest.any():
                word = int(np.flatnonzero(rest)[0])
                part, grown = np.zeros_like(rest), np.zeros_like(rest)
                grown[word] = rest[word] & -rest[word]
                while (grown != part).any():
                    part, grown = grown, image(field, grown, barred)
                parts.append(part)
                rest = rest & ~part
            self._parts[key] = parts
        return self._parts[key]

    def blocked(self, known: Known, robot: int, target: int) -> bool:
        """Return ``blocked_m`` for the robot's cell, the target of m and what is known."""
        found = False
        for kind, part in enumerate(known):
            visible = np.full((1, self.obstacles.fields[kind].members), -1, np.int64)
            visible[0, : len(part.visible)] = [self.obstacles.place[cell] for cell in part.visible]
            hidden = self.obstacles.words_of(part.hidden)[None]
            found |= bool(blocked_rows(self.ways(kind, [(robot, target)]), np.zeros(1, np.int64), visible, hidden)[0])
        return found

    def ways(self, kind: int, waits: list[tuple[int, int]]) -> Way:
        """Return the ways of a kind for many (robot, target), stacked."""
        rows = [self.way(kind, robot, target) for robot, target in waits]
        threats, leaves, shows = (np.stack(parts) for parts in zip(*rows, strict=True))
        return Way(threats, leaves, shows)


def blocked_rows(ways: Way, number: Ints, visible: Ints, hidden: Ints) -> NDArray[np.bool_]:
    """Return for many decisions whether one kind blocks the move that is waited for.

    Args:
        ways: of the kind, stacked.
        number: (N,) row of each decision in them.
        visible: (N, members) places of visible obstacles, -1 for hidden ones.
        hidden: (N, words) where the hidden ones may be.
    """
    found = np.zeros(len(number), np.bool_)
    leaving = ways.threats & ways.leaves
    for column in range(visible.shape[1]):
        place = visible[:, column]
        found |= (place >= 0) & (leaving[number, place // WORD] >> (place % WORD) & 1 == 1)
    threatened = (hidden & ways.threats[number]).any(axis=1)
    shows = ~(hidden & ~ways.shows[number]).any(axis=1)
    return found | (threatened & shows)

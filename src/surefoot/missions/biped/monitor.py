"""Watches the assumptions: which of them an observation breaks, and what is known when none can be trusted.

The robot compares what it sees at the end of a turn with everything that the rules of the navigation game let happen
(docs/rules.md 4). What the rules cannot explain breaks an assumption (docs/formats.md 3, broken assumptions).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from surefoot.frames import Direction
from surefoot.navigation import CoarseMap, ObstacleKinds, ObstacleState, Order, Rules, allowed_orders

Seen = tuple[tuple[int, ...], ...]
"""For every kind the cells in which its obstacles are seen, ascending."""

VIOLATIONS = {
    "collides": "enters the cell in which the robot stands",
    "forbidden": "is in a cell that it must never enter",
    "jumps": "jumps farther than it can go",
    "appears": "appears where it could not be",
    "vanishes": "is missing where it ought to be seen",
}
"""What an obstacle does that breaks an assumption, in words."""


@dataclass(frozen=True, slots=True)
class Violation:
    """An assumption that a kind of obstacles broke.

    Attributes:
        violation: ``collides``, ``forbidden``, ``jumps``, ``appears`` or ``vanishes``.
        kind: index of the kind.
        cell: where an obstacle was seen; None when one that ought to be seen was not.
    """

    violation: Literal["collides", "forbidden", "jumps", "appears", "vanishes"]
    kind: int
    cell: int | None


def seen_of(coarse: CoarseMap, kinds: ObstacleKinds, truth: list[int], view: int) -> Seen:
    """Return what the robot sees of the true obstacles from a cell."""
    return tuple(
        tuple(sorted(truth[number] for number in kind.obstacles if coarse.sees[view, truth[number]])) for kind in kinds
    )


def explained(outcomes: tuple[ObstacleState, ...], seen: Seen) -> ObstacleState | None:
    """Return the outcome of a turn that has exactly what is seen, None when there is none."""
    return next((state for state in outcomes if state.visible == seen), None)


def violations(
    rules: Rules, cell: int, order: Order, before: ObstacleState, outcomes: tuple[ObstacleState, ...], seen: Seen
) -> tuple[Violation, ...]:
    """Return which assumptions an observation breaks, one for every kind that the rules cannot explain.

    Args:
        rules: of the game that the strategy plays.
        cell: the robot's cell before the turn.
        order: what it carried out.
        before: what it knew before.
        outcomes: what it may know after.
        seen: what it sees after.
    """
    standing = cell if order.waits else None
    unexplained = (
        number for number, cells in enumerate(seen) if not any(state.visible[number] == cells for state in outcomes)
    )
    return tuple(_violation(rules.kinds, number, standing, before, seen[number]) for number in unexplained)


def _violation(
    kinds: ObstacleKinds, number: int, standing: int | None, before: ObstacleState, seen: tuple[int, ...]
) -> Violation:
    kind = kinds.kinds[number]
    if standing in seen:
        return Violation("collides", number, standing)
    foreign = [cell for cell in seen if not kinds.mask((cell,)) & kind.within]
    if foreign:
        return Violation("forbidden", number, foreign[0])
    barred = 0 if standing is None else kinds.mask((standing,))
    image = kind.image(before.possible(kinds)[number], barred)
    strange = [cell for cell in seen if not kinds.mask((cell,)) & image]
    if strange:
        return Violation("appears" if before.hidden[number] else "jumps", number, strange[0])
    return Violation("vanishes", number, None)


def reset(kinds: ObstacleKinds, view: int, seen: Seen) -> tuple[int, ...]:
    """Return where the obstacles that are not seen may be when nothing else is known: a mask for every kind."""
    return tuple(
        kind.within & ~kinds.seen_from[view] if len(cells) < len(kind.obstacles) else 0
        for kind, cells in zip(kinds, seen, strict=True)
    )


def safe_order(coarse: CoarseMap, cell: int, heading: Direction) -> Order:
    """Return the order to stop, or on stairs, where the robot cannot, the order to go on."""
    orders = allowed_orders(coarse, cell, heading)
    waits = [order for order in orders if order.waits] or list(orders)
    return min(waits, key=lambda order: (order.direction is not heading, order.direction))

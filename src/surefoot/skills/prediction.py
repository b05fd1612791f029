"""How likely physics is to accept a primitive, judged by what it said about similar ones.

Four kinds of likeness are weighed: the mirror image (left and right are the same for a symmetric robot), the same two
classes in other directions, and any move out of, or into, one of the two classes. A prediction orders questions; it
answers none.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from functools import cache

from surefoot.skills.values import CheckResult, Direction, Physics, Primitive, Turn, Way

_MIRROR: dict[Way, Way] = {
    Direction.LEFT: Direction.RIGHT,
    Direction.RIGHT: Direction.LEFT,
    Turn.LEFT: Turn.RIGHT,
    Turn.RIGHT: Turn.LEFT,
}
_WEIGHTS = (8.0, 2.0, 0.25)
"""Of an answer about the mirror image, about the same two classes, and about one of them."""
_PRIOR = 0.5
_MOST = 0.99


def predictor(known: Iterable[CheckResult]) -> Callable[[Primitive], float]:
    """Return the cost of asking about a primitive: how many questions it takes, at these odds, to get a yes.

    The result lies between 1 (surely feasible) and some hundreds (surely not), so that a detour of several likely
    primitives is preferred to one that hardly stands a chance.
    """
    answers = [result for result in known if result.verdict is not Physics.UNKNOWN]

    @cache
    def cost(primitive: Primitive) -> float:
        yes, all_of_them = _PRIOR, 2 * _PRIOR
        for result in answers:
            weight = _likeness(primitive, result.primitive)
            yes += weight * (result.verdict is Physics.FEASIBLE)
            all_of_them += weight
        return math.exp(4 * (1 - min(yes / all_of_them, _MOST)))

    return cost


def _likeness(one: Primitive, other: Primitive) -> float:
    if isinstance(one.direction, Turn) is not isinstance(other.direction, Turn):
        return 0.0
    same_classes = (one.here, one.next) == (other.here, other.next)
    if same_classes and _MIRROR.get(one.direction) is other.direction:
        return _WEIGHTS[0]
    if same_classes:
        return _WEIGHTS[1]
    return _WEIGHTS[2] * ((one.here == other.here) + (one.next == other.next))

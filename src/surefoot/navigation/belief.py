"""Belief: what an unseen obstacle's whereabouts are abstracted to, and how knowledge evolves in a turn."""

from __future__ import annotations

from collections.abc import Callable
from functools import reduce
from itertools import product
from operator import or_
from typing import Literal

from surefoot.navigation.obstacles import ObstacleDomain, ObstacleState, bits

BeliefKind = Literal["exact", "regions", "single"]
Abstraction = Callable[[int, int], int]
"""From the hidden image (mask) and the viewing cell to the belief (mask that contains it)."""


def abstraction(kind: BeliefKind, domain: ObstacleDomain, regions: tuple[frozenset[int], ...] = ()) -> Abstraction:
    """Return the belief abstraction of a kind.

    Args:
        kind: "exact" keeps the hidden image itself; "regions" the union of the regions that it touches, "single" the
            whole domain, both without what is seen.
        domain: the obstacle domain.
        regions: disjoint sets of cells; the rest of the domain is one more region.

    Source: Shamsah et al., T-RO 2023, VI-E; the reduction by what is seen keeps every set smaller and still sound.
    """
    if kind == "exact":
        return lambda image, _view: image
    if kind == "single":
        return lambda _image, view: domain.everywhere & ~domain.seen_from[view]
    named = [domain.mask(region) for region in regions]
    parts = [*named, domain.everywhere & ~reduce(or_, named, 0)]

    def by_regions(image: int, view: int) -> int:
        touched = reduce(or_, (part for part in parts if part & image), 0)
        return touched & ~domain.seen_from[view]

    return by_regions


def first_knowledge(domain: ObstacleDomain, abstract: Abstraction, view: int, starts: tuple[int, ...]) -> ObstacleState:
    """Return what the robot knows at the start, where every obstacle's cell is told (rules.md 4, start)."""
    in_view = domain.seen_from[view]
    hidden = domain.mask(starts) & ~in_view
    visible = tuple(sorted(cell for cell in starts if in_view >> domain.bit[cell] & 1))
    return ObstacleState(visible, abstract(hidden, view) if hidden else 0)


def observe(
    domain: ObstacleDomain,
    abstract: Abstraction,
    state: ObstacleState,
    count: int,
    view: int,
    standing: int | None,
) -> tuple[ObstacleState, ...]:
    """Return everything that the robot may know after the obstacles have moved.

    The four classes of belief transition of the paper are the four cases of: visible or hidden before, visible or
    hidden after. One observation can match several combinations of moves; their hidden images are united, so that a
    belief always contains the truth.

    Args:
        domain: the obstacle domain.
        abstract: the belief abstraction.
        state: knowledge before.
        count: number of obstacles.
        view: the cell from which the robot judges what it sees.
        standing: the robot's cell when it stands there in this turn, which no obstacle enters (assumption (a));
            else None.

    Source: Shamsah et al., T-RO 2023, VI-E and VI-F.
    """
    barred = 0 if standing is None else domain.mask((standing,))
    in_view = domain.seen_from[view]
    images = [domain.reach[domain.bit[cell]] & ~barred for cell in state.visible]
    images += [domain.image(state.hidden) & ~barred] * (count - len(state.visible))
    choices = [
        [*((bit, 0) for bit in bits(image & in_view)), *([(-1, image & ~in_view)] if image & ~in_view else [])]
        for image in images
    ]
    hidden_after: dict[tuple[int, ...], int] = {}
    for combination in product(*choices):
        visible = tuple(sorted(domain.cells[bit] for bit, _ in combination if bit >= 0))
        hidden_after[visible] = reduce(or_, (mask for _, mask in combination), hidden_after.get(visible, 0))
    return tuple(
        ObstacleState(visible, abstract(mask, view) if mask else 0) for visible, mask in sorted(hidden_after.items())
    )


def collision_image(domain: ObstacleDomain, state: ObstacleState) -> int:
    """Return the mask of all cells that some obstacle may be in after its next move."""
    return domain.image(state.possible(domain))

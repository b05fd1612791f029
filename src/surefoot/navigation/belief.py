"""Belief: what an unseen obstacle's whereabouts are abstracted to, and how knowledge evolves in a turn."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from itertools import combinations_with_replacement, product
from operator import or_
from typing import Literal

from surefoot.navigation.obstacles import ObstacleKind, ObstacleKinds, ObstacleState, bits

BeliefKind = Literal["exact", "regions", "single", "unnarrowed"]


@dataclass(frozen=True, slots=True)
class Abstraction:
    """From the hidden image to the belief, a set that contains it: the union of the parts that it touches.

    Attributes:
        parts: disjoint masks that cover the domains together.
        narrowed: whether what is seen is taken out again.
    """

    parts: tuple[int, ...]
    narrowed: bool = True

    def __call__(self, kinds: ObstacleKinds, kind: ObstacleKind, image: int, view: int) -> int:
        """Return the belief for a hidden image that is not empty, seen from a cell."""
        touched = reduce(or_, (part for part in self.parts if part & image), 0) & kind.within
        return touched & ~kinds.seen_from[view] if self.narrowed else touched


def abstraction(belief: BeliefKind, kinds: ObstacleKinds, regions: tuple[frozenset[int], ...] = ()) -> Abstraction:
    """Return the belief abstraction of a name.

    Args:
        belief: "exact" keeps the hidden image itself; "regions" the union of the regions that it touches, "single" the
            whole domain, both without what is seen; "unnarrowed" the whole domain, whatever is seen.
        kinds: the obstacles.
        regions: disjoint sets of cells; the rest of the domains is one more region.

    Source: Shamsah et al., T-RO 2023, VI-E; the reduction by what is seen keeps every set smaller and still sound.
    """
    everywhere = (1 << len(kinds.cells)) - 1
    if belief == "exact":
        return Abstraction(tuple(1 << bit for bit in range(len(kinds.cells))))
    if belief != "regions":
        return Abstraction((everywhere,), narrowed=belief == "single")
    named = [kinds.mask(region) for region in regions]
    rest = everywhere & ~reduce(or_, named, 0)
    return Abstraction(tuple(part for part in (*named, rest) if part))


def first_knowledge(kinds: ObstacleKinds, abstract: Abstraction, view: int, starts: tuple[int, ...]) -> ObstacleState:
    """Return what the robot knows at the start, where every obstacle's cell is told (rules.md 4, start)."""
    visible, beliefs = [], []
    for kind in kinds:
        places = [starts[obstacle] for obstacle in kind.obstacles]
        seen = [cell for cell in places if kinds.seen_from[view] >> kinds.bit[cell] & 1]
        hidden = kinds.mask(places) & ~kinds.mask(seen)
        visible.append(tuple(sorted(seen)))
        beliefs.append(abstract(kinds, kind, hidden, view) if hidden else 0)
    return ObstacleState(tuple(visible), tuple(beliefs))


def observe(
    kinds: ObstacleKinds, abstract: Abstraction, state: ObstacleState, view: int, standing: int | None
) -> tuple[ObstacleState, ...]:
    """Return everything that the robot may know after the obstacles have moved.

    The game's own exploration does the same, compiled (``_game_kernels``); this is the rule in its readable form.

    Args:
        kinds: the obstacles.
        abstract: the belief abstraction.
        state: knowledge before.
        view: the cell from which the robot judges what it sees.
        standing: the robot's cell when it stands there in this turn, which no obstacle enters (assumption (a));
            else None.

    Source: Shamsah et al., T-RO 2023, VI-E and VI-F; docs/rules.md 4, observation.
    """
    outcomes = [
        _observe_kind(kinds, kind, abstract, seen, hidden, view, standing)
        for kind, seen, hidden in zip(kinds, state.visible, state.hidden, strict=True)
    ]
    return tuple(
        ObstacleState(tuple(seen for seen, _ in together), tuple(hidden for _, hidden in together))
        for together in product(*outcomes)
    )


def _observe_kind(
    kinds: ObstacleKinds,
    kind: ObstacleKind,
    abstract: Abstraction,
    seen: tuple[int, ...],
    hidden: int,
    view: int,
    standing: int | None,
) -> list[tuple[tuple[int, ...], int]]:
    """Return the visible cells and the belief of one kind after a turn.

    The four classes of belief transition of the paper are the four cases of: visible or hidden before, visible or
    hidden after. One observation can match several combinations of moves; their hidden images are united, so that a
    belief always contains the truth.
    """
    barred = 0 if standing is None else kinds.mask((standing,))
    in_view = kinds.seen_from[view]

    def choices(image: int) -> list[tuple[int, int]]:
        unseen = image & ~in_view
        return [*((kinds.cells[bit], 0) for bit in bits(image & in_view)), *([(-1, unseen)] if unseen else [])]

    moved = [choices(kind.image(1 << kinds.bit[cell], barred)) for cell in seen]
    unseen_before = len(kind.obstacles) - len(seen)
    appearing = combinations_with_replacement(choices(kind.image(hidden, barred)), unseen_before)
    hidden_after: dict[tuple[int, ...], int] = {}
    for others in appearing:
        for combination in product(*moved):
            visible = tuple(sorted(cell for cell, _ in (*combination, *others) if cell >= 0))
            image = reduce(or_, (mask for _, mask in (*combination, *others)), 0)
            hidden_after[visible] = hidden_after.get(visible, 0) | image
    return [
        (visible, abstract(kinds, kind, mask, view) if mask else 0) for visible, mask in sorted(hidden_after.items())
    ]

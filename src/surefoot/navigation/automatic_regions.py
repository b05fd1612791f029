"""Belief regions chosen from the map: small around what occludes, coarse elsewhere (docs/navigation.md).

Any partition of the cells is sound; this one spends its regions where a hidden obstacle matters soonest.
"""

from __future__ import annotations

from functools import reduce
from operator import or_

from surefoot.navigation.coarse import CoarseMap
from surefoot.navigation.obstacles import Obstacle, ObstacleKinds, bits, obstacle_kinds

PRECISION = 0.25


def automatic_regions(
    coarse: CoarseMap, obstacles: tuple[Obstacle, ...], precision: float = PRECISION
) -> tuple[frozenset[int], ...]:
    """Return belief regions, as sets of cells that cover the obstacles' domains.

    A cell weighs ``1 / (1 + d)^2``, where d is how many moves an obstacle that is hidden there needs to be beside a
    robot that does not see the cell: near what occludes, d is small. Neighbouring regions are merged, the lightest
    pair first, as long as none gets heavier than ``total^(1 - precision) * lightest^precision``.

    Args:
        coarse: the map.
        obstacles: what moves there.
        precision: 0 makes one region of each connected domain, 1 one of each cell.
    """
    kinds = obstacle_kinds(coarse, obstacles)
    if not kinds.cells:
        return ()
    weight = [1 / (1 + distance) ** 2 for distance in _surprise(coarse, kinds)]
    most = sum(weight) * (min(weight) / sum(weight)) ** precision
    regions = _merged(kinds, weight, most)
    return tuple(frozenset(kinds.members(region)) for region in regions)


def _surprise(coarse: CoarseMap, kinds: ObstacleKinds) -> list[int]:
    """Return for every bit how many moves bring an obstacle from there beside a robot that does not see it there."""
    near = _neighbours(kinds)
    beside_robot = {
        cell: kinds.mask((cell, *coarse.target[cell][coarse.target[cell] >= 0].tolist()))
        for cell in range(len(coarse.target))
        if (coarse.target[cell] >= 0).any()
    }
    distances = []
    for bit in range(len(kinds.cells)):
        blind = (mask for cell, mask in beside_robot.items() if not kinds.seen_from[cell] >> bit & 1)
        distances.append(_moves(near, 1 << bit, reduce(or_, blind, 0)))
    return distances


def _neighbours(kinds: ObstacleKinds) -> list[int]:
    """Return for every bit the mask of the cells that some kind of obstacle can go to from there."""
    return [reduce(or_, masks) for masks in zip(*(kind.beside for kind in kinds), strict=True)]


def _moves(near: list[int], mask: int, goal: int) -> int:
    """Return how many moves lead from one set to another; where none do, more than any way has."""
    moves = 0
    while not mask & goal:
        grown = reduce(or_, (near[bit] for bit in bits(mask)), mask)
        if grown == mask:
            return len(near)
        mask, moves = grown, moves + 1
    return moves


def _merged(kinds: ObstacleKinds, weight: list[float], most: float) -> list[int]:
    """Return the regions, as masks, that merging of neighbours leaves."""
    near = _neighbours(kinds)
    regions = {bit: 1 << bit for bit in range(len(weight))}
    weights = dict(enumerate(weight))
    beside = {bit: {other for other in bits(mask) if other != bit} for bit, mask in enumerate(near)}
    while True:
        pairs = ((weights[a] + weights[b], a, b) for a in regions for b in beside[a] if a < b)
        total, kept, gone = min(pairs, default=(float("inf"), 0, 0))
        if total > most:
            return list(regions.values())
        regions[kept] |= regions.pop(gone)
        weights[kept] = total
        for other in beside.pop(gone):
            beside[other].discard(gone)
            if other != kept:
                beside[other].add(kept)
                beside[kept].add(other)

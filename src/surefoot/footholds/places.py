"""Boxes of footholds: polygons cut into pieces, finest where a foot is expected and along the way that is travelled."""

from __future__ import annotations

import heapq
from dataclasses import dataclass

import numpy as np

from surefoot.footholds.problem import Problem
from surefoot.footholds.rows import Array

_NEAR_M = 0.15
_ANYWAY_M = 0.05
_FINEST_M = 0.004


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """Boxes that together hold every foothold of a foot.

    Attributes:
        low: corners, shape (B, 3).
        high: shape (B, 3).
        polygon: of which polygon each is a piece, shape (B,).
    """

    low: Array
    high: Array
    polygon: Array


def places_of(problem: Problem, foot: int, budget: int) -> Places:
    """Cut the polygons into at most so many pieces (or one per polygon, if there are more of these)."""
    travel = np.abs(problem.goal_m - problem.start_m)[:2] + _ANYWAY_M
    path = problem.foot_reference_m[:, foot]
    heap: list[tuple[float, int, int, Array]] = []
    for number, one in enumerate(problem.polygons):
        heapq.heappush(heap, (-_worth(one.vertices_m, travel, path), len(heap), number, one.vertices_m))
    count = len(heap)
    while len(heap) < budget and -heap[0][0] > 0:
        _, _, number, corners = heapq.heappop(heap)
        for piece in _halves(corners, travel):
            if len(piece) >= 3:
                count += 1
                heapq.heappush(heap, (-_worth(piece, travel, path), count, number, piece))
    pieces = sorted((number, order, corners) for _, order, number, corners in heap)
    return Places(
        np.array([corners.min(axis=0) for _, _, corners in pieces]),
        np.array([corners.max(axis=0) for _, _, corners in pieces]),
        np.array([number for number, _, _ in pieces], dtype=np.int64),
    )


def _worth(corners: Array, travel: Array, path: Array) -> float:
    """Return how much a cut of this piece sharpens the bound: its width along the way, less where it is far away."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    widths = (high - low)[:2] * travel
    if (high - low)[int(widths.argmax())] < 2 * _FINEST_M:
        return 0.0
    apart = np.maximum(np.maximum(low - path, path - high), 0.0)[:, :2]
    near = float(np.sqrt((apart**2).sum(axis=1)).min())
    return float(widths.max()) / (1.0 + (near / _NEAR_M) ** 2)


def _halves(corners: Array, travel: Array) -> tuple[Array, Array]:
    low, high = corners.min(axis=0), corners.max(axis=0)
    axis = int(((high - low)[:2] * travel).argmax())
    middle = (low[axis] + high[axis]) / 2
    return _below(corners, axis, middle), -_below(-corners, axis, -middle)


def _below(corners: Array, axis: int, limit: float) -> Array:
    """Return the part of a convex polygon with a coordinate of at most the limit."""
    kept: list[Array] = []
    for here, there in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        inside, next_inside = here[axis] <= limit, there[axis] <= limit
        if inside:
            kept.append(here)
        if inside != next_inside:
            part = (limit - here[axis]) / (there[axis] - here[axis])
            kept.append(here + part * (there - here))
    return np.array(kept)

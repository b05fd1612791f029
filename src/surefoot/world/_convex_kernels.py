"""Compiled loops of the convex pieces: rings that are convex as they are, and outlines without needless points."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_STRAIGHT = 1e-5
_EPS = 1e-9


@njit(cache=True)
def convex_ring(points: Floats, nearest: float) -> Floats:
    """Return a simple ring counter-clockwise without repeated points if it is convex, else an empty one.

    Args:
        points: (n, 2), the first not repeated at the end.
        nearest: points this near to the one before count as repeated.
    """
    count = len(points)
    area, kept = 0.0, 0
    ring = np.empty((count, 2))
    for k in range(count):
        x, y = points[k]
        if kept > 0 and math.hypot(x - ring[kept - 1, 0], y - ring[kept - 1, 1]) <= nearest:
            continue
        ring[kept, 0], ring[kept, 1] = x, y
        kept += 1
    while kept > 1 and math.hypot(ring[kept - 1, 0] - ring[0, 0], ring[kept - 1, 1] - ring[0, 1]) <= nearest:
        kept -= 1
    if kept < 3:
        return ring[:0]
    ring = ring[:kept]
    for k in range(kept):
        area += ring[k - 1, 0] * ring[k, 1] - ring[k, 0] * ring[k - 1, 1]
    if area < 0:
        ring = ring[::-1].copy()
    for k in range(kept):
        x, y = ring[k]
        px, py = ring[k - 1]
        qx, qy = ring[(k + 1) % kept]
        if (x - px) * (qy - y) - (y - py) * (qx - x) < 0.0:
            return ring[:0]
    return ring


@njit(cache=True)
def without_straight(points: Floats) -> Floats:
    """Return a convex ring without the points that lie on its edges, the straightest left out first."""
    count = len(points)
    x, y = points[:, 0].copy(), points[:, 1].copy()
    size = max(x.max() - x.min(), y.max() - y.min())
    while count > 3:
        least, worst = math.inf, -1
        for k in range(count):
            before, after = (k - 1 if k else count - 1), (k + 1 if k + 1 < count else 0)
            turn = (x[k] - x[before]) * (y[after] - y[k]) - (y[k] - y[before]) * (x[after] - x[k])
            height = turn / max(math.hypot(x[after] - x[before], y[after] - y[before]), _EPS)
            if height < least:
                least, worst = height, k
        if least > _STRAIGHT * size:
            break
        for k in range(worst, count - 1):
            x[k], y[k] = x[k + 1], y[k + 1]
        count -= 1
    out = np.empty((count, 2))
    out[:, 0], out[:, 1] = x[:count], y[:count]
    return out


@njit(cache=True)
def merged_faces(corners: Floats, start: Ints, edges: Ints, twins: Ints) -> tuple[Floats, Ints]:
    """Return the rings of convex faces that are left of triangles, and where each begins, the end included.

    Diagonals are removed in the order given, as long as the corners at both ends stay convex.

    Args:
        corners: (n, 2) positions.
        start: (3 t,) the corner where every directed edge starts, three a triangle, counter-clockwise.
        edges: (d,) one of the two directed edges of every diagonal.
        twins: (d,) the other one.
    """
    count = len(start)
    after, before = np.empty(count, np.int64), np.empty(count, np.int64)
    for k in range(count):
        after[k] = k - 2 if k % 3 == 2 else k + 1
        before[k] = k + 2 if k % 3 == 0 else k - 1
    there = np.ones(count, np.bool_)
    for d in range(len(edges)):
        edge, twin = edges[d], twins[d]
        if _spare(corners, start, after, before, edge, twin) and _spare(corners, start, after, before, twin, edge):
            after[before[edge]], before[after[twin]] = after[twin], before[edge]
            after[before[twin]], before[after[edge]] = after[edge], before[twin]
            there[edge] = there[twin] = False
    rings, begins = np.empty((count, 2)), np.zeros(count // 3 + 1, np.int64)
    points, faces = 0, 0
    for first in range(count):
        k = first
        while there[k]:
            there[k] = False
            rings[points] = corners[start[k]]
            points += 1
            k = after[k]
        if points - begins[faces] >= 3:
            faces += 1
            begins[faces] = points
        points = begins[faces]
    return rings[:points], begins[: faces + 1]


@njit(cache=True)
def _spare(corners: Floats, start: Ints, after: Ints, before: Ints, edge: int, twin: int) -> bool:
    """Return whether the corner where an edge starts stays convex without it."""
    px, py = corners[start[before[edge]]]
    x, y = corners[start[edge]]
    qx, qy = corners[start[after[after[twin]]]]
    turn = (x - px) * (qy - y) - (y - py) * (qx - x)
    return bool(turn >= -1e-7 * math.hypot(x - px, y - py) * math.hypot(qx - x, qy - y))

"""Nodes on the polygons of a plan that stand for all footholds.

A foothold is a mean of the corners of its grid cell, taken as independent draws. Costs are quadratic in the footholds
of a foot, so that the mean cost of the draws exceeds the cost of the footholds by half the second derivatives times the
variances only, and these are at most a quarter of the squared sides: some corners cost no more than that above it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.verify.footholds.file import Array
from surefoot.verify.footholds.rows import Surface

_GRADE = 0.3
_EPS_M = 1e-6
_AHEAD = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """Nodes; the last one is the start foothold.

    Attributes:
        points: shape (B, 3).
        spread: largest variance of a foothold drawn from the corners of a cell, shape (B,).
        low: least coordinates of all footholds that may be drawn to this node, shape (B, 3).
        high: largest ones, shape (B, 3).
    """

    points: Array
    spread: Array
    low: Array
    high: Array


def grid_of(ground: list[Surface], path: Array, start: Array, spacing_m: tuple[float, float]) -> Grid:
    """Return nodes for a foot, so far apart along and across its expected path, and wider where that is far away."""
    parts = [_nodes(one, path, spacing_m) for one in ground]
    return Grid(
        np.concatenate([*(part[0] for part in parts), start[None]]),
        np.concatenate([*(part[1] for part in parts), np.zeros(1)]),
        np.concatenate([*(part[2] for part in parts), start[None]]),
        np.concatenate([*(part[3] for part in parts), start[None]]),
    )


def _nodes(one: Surface, path: Array, spacing_m: tuple[float, float]) -> tuple[Array, Array, Array, Array]:
    """Return the corners of all grid cells that touch a polygon, and how far and how wide their cells spread."""
    edges = np.roll(one.corners, -1, axis=0) - one.corners
    along = edges[int((edges**2).sum(axis=1).argmax())]
    frame = np.stack([along / np.linalg.norm(along), np.cross(one.normal, along / np.linalg.norm(along))])
    origin = one.corners[0]
    corners, way = (one.corners - origin) @ frame.T, (path - origin) @ frame.T
    ahead = np.abs(way[-1] - way[0])
    lines = [_lines(corners[:, k], way[:, k], spacing_m[int(ahead[k] < _AHEAD * ahead.max())]) for k in (0, 1)]
    touched = _touched(corners, lines)
    sides = [np.diff(line) for line in lines]
    variance = (sides[0][:, None] ** 2 + sides[1] ** 2) / 4
    spread = np.full((len(lines[0]), len(lines[1])), -np.inf)
    for i, j in ((0, 0), (0, 1), (1, 0), (1, 1)):
        part = spread[i : i + len(sides[0]), j : j + len(sides[1])]
        np.maximum(part, np.where(touched, variance, -np.inf), out=part)
    used = np.isfinite(spread)
    flat = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1)[used]
    around = _around(lines)[used]
    wide = origin + around @ frame
    return origin + flat @ frame, spread[used], wide.min(axis=1), wide.max(axis=1)


def _around(lines: list[Array]) -> Array:
    """Return the corners of the rectangle of all cells about every node, shape (n, m, 4, 2)."""
    before = [np.concatenate([line[:1], line[:-1]]) for line in lines]
    after = [np.concatenate([line[1:], line[-1:]]) for line in lines]
    sides = ((before[0], before[1]), (before[0], after[1]), (after[0], before[1]), (after[0], after[1]))
    return np.stack([np.stack(np.meshgrid(*pair, indexing="ij"), axis=-1) for pair in sides], axis=2)


def _lines(corners: Array, way: Array, spacing_m: float) -> Array:
    """Cut an interval in halves until its parts are short for how far they are from the path."""
    low, high = float(corners.min()) - _EPS_M, float(corners.max()) + _EPS_M
    near, far = float(way.min()), float(way.max())
    pending, found = [(low, high)], [high]
    while pending:
        a, b = pending.pop()
        away = max(a - far, near - b, 0.0)
        if b - a > spacing_m + _GRADE * away:
            pending += [(a, (a + b) / 2), ((a + b) / 2, b)]
        else:
            found.append(a)
    return np.array(sorted(found))


def _touched(corners: Array, lines: list[Array]) -> np.ndarray:
    """Return which cells are not wholly beyond a side of the polygon, by cell."""
    turn = np.roll(corners, -1, axis=0) - corners
    outward = np.stack([turn[:, 1], -turn[:, 0]], axis=1)
    centre = corners.mean(axis=0)
    outward *= np.sign(((corners - centre) * outward).sum(axis=1))[:, None]
    limit = (outward * corners).sum(axis=1)
    nodes = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1)
    beyond = nodes @ outward.T - limit > _EPS_M * np.linalg.norm(outward, axis=1)
    whole = beyond[:-1, :-1] & beyond[1:, :-1] & beyond[:-1, 1:] & beyond[1:, 1:]
    return np.asarray(~whole.any(axis=-1))

"""Compiled sweeps of the outlines: contours of a region's cells, the cells beside it, edges fitted to a contour.

Positions are (x, y) = (column, row), whole numbers at the centres of cells.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

UNSURE_CELLS = 0.5
"""A scan knows an edge to half a cell."""
SURE_POINTS = 10
_AHEAD_X, _AHEAD_Y = (1, 0, -1, 0), (0, 1, 0, -1)
_OUT_X, _OUT_Y = (0, 1, 0, -1), (-1, 0, 1, 0)


@njit(cache=True)
def framed(mask: Flags) -> Flags:
    """Return a mask with two empty cells around it."""
    rows, columns = mask.shape
    wide = np.zeros((rows + 4, columns + 4), np.bool_)
    wide[2 : rows + 2, 2 : columns + 2] = mask
    return wide


@njit(cache=True)
def contours(wide: Flags, whole: Flags) -> tuple[Floats, Ints]:
    """Return the closed contours of a framed mask, and where each begins among the points, the end included.

    Points lie halfway between a cell inside and its neighbour outside. The region lies to the left (y down as if it
    were up); cells that only touch at a corner are not joined.

    Args:
        wide: the mask.
        whole: cells outside whose corners are not cut, of the same shape.
    """
    rows, columns = wide.shape
    sides = 0
    for r in range(1, rows - 1):
        for c in range(1, columns - 1):
            if wide[r, c]:
                sides += (not wide[r - 1, c]) + (not wide[r, c + 1]) + (not wide[r + 1, c]) + (not wide[r, c - 1])
    points, begins = np.empty((2 * sides, 2)), np.zeros(sides // 4 + 2, np.int64)
    seen = np.zeros(wide.shape, np.bool_)
    count, rings = 0, 0
    for row in range(1, rows - 1):
        for column in range(1, columns - 1):
            if not wide[row, column] or wide[row - 1, column] or seen[row, column]:
                continue
            r, c, side = row, column, 0
            while not (side == 0 and seen[r, c]):
                if side == 0:
                    seen[r, c] = True
                points[count, 0] = c - 2 + 0.5 * _OUT_X[side]
                points[count, 1] = r - 2 + 0.5 * _OUT_Y[side]
                count += 1
                ahead_r, ahead_c = r + _AHEAD_Y[side], c + _AHEAD_X[side]
                if not wide[ahead_r, ahead_c]:
                    side = (side + 1) % 4
                elif wide[ahead_r + _OUT_Y[side], ahead_c + _OUT_X[side]]:
                    if whole[r + _OUT_Y[side], c + _OUT_X[side]]:
                        points[count, 0] = points[count - 1, 0] + 0.5 * _AHEAD_X[side]
                        points[count, 1] = points[count - 1, 1] + 0.5 * _AHEAD_Y[side]
                        count += 1
                    r, c = ahead_r + _OUT_Y[side], ahead_c + _OUT_X[side]
                    side = (side + 3) % 4
                else:
                    r, c = ahead_r, ahead_c
            rings += 1
            begins[rings] = count
    return points[:count], begins[: rings + 1]


@njit(cache=True)
def beside(wide: Flags, most: int) -> tuple[Floats, Flags]:
    """Return the centres of the cells that touch a framed region from outside, and which have many neighbours in it.

    Many are at least ``most``, counted over corners too.
    """
    rows, columns = wide.shape
    found = 0
    count = np.zeros(wide.shape, np.int8)
    for r in range(1, rows - 1):
        for c in range(1, columns - 1):
            if wide[r, c]:
                continue
            near = 0
            for i in range(r - 1, r + 2):
                for j in range(c - 1, c + 2):
                    near += wide[i, j]
            count[r, c] = near
            found += near > 0
    centres, tips = np.empty((found, 2)), np.zeros(found, np.bool_)
    k = 0
    for r in range(1, rows - 1):
        for c in range(1, columns - 1):
            if count[r, c] > 0:
                centres[k, 0], centres[k, 1] = c - 2, r - 2
                tips[k] = count[r, c] >= most
                k += 1
    return centres, tips


@njit(cache=True)
def opened(ring: Floats) -> Floats:
    """Return a ring that begins and ends with its point farthest from the middle of all."""
    count = len(ring)
    x, y, farthest, start = ring[:, 0].mean(), ring[:, 1].mean(), -1.0, 0
    for k in range(count):
        away = (ring[k, 0] - x) ** 2 + (ring[k, 1] - y) ** 2
        if away > farthest:
            farthest, start = away, k
    points = np.empty((count + 1, 2))
    points[: count - start], points[count - start : count] = ring[start:], ring[:start]
    points[count] = ring[start]
    return points


@njit(cache=True)
def corners_of(closed: Floats, kept: Floats) -> Ints:
    """Return where the points of a simplified closed ring stand in the whole one, first and last included."""
    found = np.empty(len(kept), np.int64)
    place = 0
    for k in range(len(kept) - 1):
        while closed[place, 0] != kept[k, 0] or closed[place, 1] != kept[k, 1]:
            place += 1
        found[k] = place
    found[len(kept) - 1] = len(closed) - 1
    return found


@njit(cache=True)
def fitted(points: Floats, corners: Ints) -> Floats:
    """Return a ring whose edges are lines through the points between its corners.

    Args:
        points: a closed contour, the first point repeated at the end.
        corners: indices of points, first and last included.
    """
    edges = len(corners) - 1
    lines = np.empty((edges, 4))
    for k in range(edges):
        lines[k] = _line(points[corners[k] : corners[k + 1] + 1])
    out, count = np.empty((2 * edges, 2)), 0
    for k in range(edges):
        px, py, ux, uy = lines[k - 1]
        qx, qy, vx, vy = lines[k]
        cx, cy = points[corners[k], 0], points[corners[k], 1]
        cross = ux * vy - uy * vx
        if abs(cross) > 0.2:
            t = ((qx - px) * vy - (qy - py) * vx) / cross
            x, y = px + t * ux, py + t * uy
            if math.hypot(x - cx, y - cy) <= 2.0:
                out[count, 0], out[count, 1] = x, y
                count += 1
                continue
        s, t = (cx - px) * ux + (cy - py) * uy, (cx - qx) * vx + (cy - qy) * vy
        ax, ay, bx, by = px + s * ux, py + s * uy, qx + t * vx, qy + t * vy
        if math.hypot(ax - bx, ay - by) < 0.6:
            out[count, 0], out[count, 1] = (ax + bx) / 2, (ay + by) / 2
            count += 1
        else:
            out[count, 0], out[count, 1], out[count + 1, 0], out[count + 1, 1] = ax, ay, bx, by
            count += 2
    return out[:count]


@njit(cache=True)
def _line(points: Floats) -> Floats:
    """Return a point (x, y) and the unit direction of the line through some points in order.

    Short and crooked lines are moved inward, towards the innermost of their points.
    """
    last = len(points) - 1
    first, end = (1, last) if len(points) > 5 else (0, last + 1)
    chosen = points[first:end]
    count = len(chosen)
    ux, uy = points[last, 0] - points[0, 0], points[last, 1] - points[0, 1]
    if count > 3:
        x, y = chosen[:, 0].mean(), chosen[:, 1].mean()
        xx = xy = yy = 0.0
        for k in range(count):
            dx, dy = chosen[k, 0] - x, chosen[k, 1] - y
            xx, xy, yy = xx + dx * dx, xy + dx * dy, yy + dy * dy
        angle = 0.5 * math.atan2(2 * xy, xx - yy)
        sign = 1.0 if math.cos(angle) * ux + math.sin(angle) * uy >= 0 else -1.0
        ux, uy = sign * math.cos(angle), sign * math.sin(angle)
    else:
        x, y = (points[0, 0] + points[last, 0]) / 2, (points[0, 1] + points[last, 1]) / 2
        length = math.hypot(ux, uy)
        ux, uy = ux / length, uy / length
    depth = (chosen[:, 1] - y) * ux - (chosen[:, 0] - x) * uy
    shift = depth.max() if count < SURE_POINTS else np.sort(depth)[int(0.9 * count)] - UNSURE_CELLS
    shift = max(shift, 0.0)
    return np.array([x - shift * uy, y + shift * ux, ux, uy])

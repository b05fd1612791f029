"""Which of many equal squares come near an occupied pixel, exactly and for any rotation."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

_STRIPS_AT_ONCE = 500_000


def meets(
    solid: NDArray[np.bool_], centers: NDArray[np.float64], *, half_side: float, angle_rad: float, reach: float
) -> NDArray[np.bool_]:
    """Return which squares come nearer than a reach to a solid pixel (overlap it, when the reach is 0).

    Let K be the square grown by a disc of the reach. Every row of pixels is a horizontal strip, and what K and the
    strip have in common is convex; so K meets exactly those pixels of the row that lie in the common part's range of x.
    The ends of this range are found among the discs at the square's vertices and the square's sides moved outward by
    the reach. Per square and row that leaves one question to the running sums of the row.

    Args:
        solid: (rows, columns) of pixels.
        centers: (squares, 2) centres in pixels, to the right of and down from the upper-left corner of the picture.
        half_side: half the side of a square, in pixels.
        angle_rad: how far the squares are turned, from right toward down.
        reach: distance in pixels.
    """
    sums = np.zeros((solid.shape[0], solid.shape[1] + 1), np.int32)
    np.cumsum(solid, axis=1, dtype=np.int32, out=sums[:, 1:])
    vertices = _vertices(half_side, angle_rad)
    extent = float(np.abs(vertices[:, 1]).max()) + reach
    strips = min(math.ceil(2 * extent) + 2, solid.shape[0])
    result = np.zeros(len(centers), np.bool_)
    chunk = max(1, _STRIPS_AT_ONCE // strips)
    for start in range(0, len(centers), chunk):
        part = slice(start, start + chunk)
        result[part] = _meets(sums, centers[part], vertices, reach, extent, strips)
    return result


def _meets(
    sums: NDArray[np.int32],
    centers: NDArray[np.float64],
    vertices: NDArray[np.float64],
    reach: float,
    extent: float,
    strips: int,
) -> NDArray[np.bool_]:
    """Return which squares meet a solid pixel in one of the rows that they can reach."""
    rows, columns = sums.shape[0], sums.shape[1] - 1
    first = np.clip(np.floor(centers[:, 1] - extent), 0, rows - strips)
    row = first[:, np.newaxis] + np.arange(strips)
    left, right = _range_of_x(row - centers[:, 1:], vertices, reach)
    left, right = left + centers[:, :1], right + centers[:, :1]
    begin = np.clip(np.floor(left), 0, columns).astype(np.intp)
    end = np.clip(np.ceil(right), 0, columns).astype(np.intp)
    row = row.astype(np.intp)
    some = (end > begin) & (sums[row, np.maximum(begin, end)] > sums[row, begin])
    return np.asarray(some.any(axis=1))


def _range_of_x(
    top: NDArray[np.float64], vertices: NDArray[np.float64], reach: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the least and the greatest x that the grown square has in strips of height 1.

    Args:
        top: upper ends of the strips, relative to the square's centre.
        vertices: (4, 2) of the square, in order.
        reach: how far the square is grown.

    Returns:
        Arrays of the shape of ``top``; inf and -inf where the square does not reach the strip.
    """
    left, right = np.full(top.shape, np.inf), np.full(top.shape, -np.inf)
    for x, y in vertices:
        away = np.maximum(np.maximum(top - y, y - top - 1), 0)
        half = np.sqrt(np.maximum(reach**2 - away**2, 0))
        touched = away <= reach
        np.minimum(left, np.where(touched, x - half, np.inf), out=left)
        np.maximum(right, np.where(touched, x + half, -np.inf), out=right)
    for begin, end in zip(vertices, np.roll(vertices, -1, axis=0), strict=True):
        along = end - begin
        if along[1] == 0:
            continue
        outward = np.array([along[1], -along[0]]) / math.hypot(*along) * reach
        for line in (top, top + 1):
            share = (line - begin[1] - outward[1]) / along[1]
            x = begin[0] + outward[0] + share * along[0]
            on = (share >= 0) & (share <= 1)
            np.minimum(left, np.where(on, x, np.inf), out=left)
            np.maximum(right, np.where(on, x, -np.inf), out=right)
    return left, right


def _vertices(half_side: float, angle_rad: float) -> NDArray[np.float64]:
    """Return the vertices of a square about the origin, turned from right toward down."""
    cos, sin = math.cos(angle_rad) * half_side, math.sin(angle_rad) * half_side
    return np.array(
        [[cos - sin, sin + cos], [-cos - sin, -sin + cos], [-cos + sin, -sin - cos], [cos + sin, sin - cos]]
    )

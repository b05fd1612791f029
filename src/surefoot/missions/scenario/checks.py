"""Checks of a scenario that need more than one of its keys, but no map."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from pydantic import BaseModel
from pydantic_core import PydanticCustomError

Rectangle = tuple[float, float, float, float]
Problem = tuple[tuple[str | int, ...], str]
_TOLERANCE_M = 1e-6


def several(problems: Sequence[Problem]) -> None:
    """Raise the given problems, each a place and a sentence, as one validation error, if there are any."""
    if problems:
        text = "; ".join(message for _, message in problems)
        raise PydanticCustomError("several", "{text}", {"text": text, "problems": tuple(problems)})


def rectangle_problems(value: object, loc: tuple[str | int, ...], rotation_rad: float) -> list[Problem]:
    """Return the rectangles somewhere in a block that have no area once their sides are parallel to the grid."""
    return [
        (place, "has no area: its two corners must differ along both axes of the grid")
        for place, rectangle in _rectangles(value, loc)
        if min(_size(_in_grid(rectangle, (0.0, 0.0), rotation_rad))) <= _TOLERANCE_M
    ]


def region_problems(
    regions: Sequence[Any], cell_size_m: float, origin_m: tuple[float, float], rotation_rad: float
) -> list[Problem]:
    """Return the pairs of belief regions that overlap: some cell would have its centre in both."""
    in_grid = [[_in_grid(rectangle, origin_m, rotation_rad) for rectangle in region.rectangles_m] for region in regions]
    return [
        (("belief_regions", second), f"overlaps belief_regions[{first}]: a cell's centre may lie in one region only")
        for second in range(len(regions))
        for first in range(second)
        if any(_share_a_centre(a, b, cell_size_m) for a in in_grid[first] for b in in_grid[second])
    ]


def _rectangles(value: object, loc: tuple[str | int, ...]) -> Iterator[tuple[tuple[str | int, ...], Rectangle]]:
    """Yield every rectangle below a value, with its place."""
    if isinstance(value, BaseModel):
        for name in type(value).model_fields:
            inner = getattr(value, name)
            if name == "rectangle_m":
                yield (*loc, name), inner
            elif name == "rectangles_m":
                yield from (((*loc, name, index), rectangle) for index, rectangle in enumerate(inner))
            else:
                yield from _rectangles(inner, (*loc, name))
    elif isinstance(value, tuple):
        for index, inner in enumerate(value):
            yield from _rectangles(inner, (*loc, index))


def _in_grid(corners: Rectangle, origin_m: tuple[float, float], rotation_rad: float) -> Rectangle:
    """Return [least x, least y, greatest x, greatest y] in the grid's frame."""
    c, s = math.cos(rotation_rad), math.sin(rotation_rad)
    points = [(x - origin_m[0], y - origin_m[1]) for x, y in (corners[:2], corners[2:])]
    (ax, ay), (bx, by) = [(c * x + s * y, c * y - s * x) for x, y in points]
    return min(ax, bx), min(ay, by), max(ax, bx), max(ay, by)


def _size(rectangle: Rectangle) -> tuple[float, float]:
    return rectangle[2] - rectangle[0], rectangle[3] - rectangle[1]


def _share_a_centre(a: Rectangle, b: Rectangle, cell_size_m: float) -> bool:
    """Return whether a cell's centre lies inside both rectangles, not only on their borders."""
    return all(_has_centre(max(a[axis], b[axis]), min(a[axis + 2], b[axis + 2]), cell_size_m) for axis in range(2))


def _has_centre(low: float, high: float, cell_size_m: float) -> bool:
    """Return whether (k + 1/2) cells, for some whole k, lies strictly between two positions along an axis."""
    least = math.floor((low + _TOLERANCE_M) / cell_size_m - 0.5) + 1
    return (least + 0.5) * cell_size_m < high - _TOLERANCE_M

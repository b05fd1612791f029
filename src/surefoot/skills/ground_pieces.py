"""From plates and bars to the convex polygons that a foot may stand on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely  # type: ignore[import-untyped]
import shapely.affinity  # type: ignore[import-untyped]

from surefoot.skills.patches import BAR_M, Rectangle
from surefoot.world.convex_pieces import convex_pieces

_BAR_MARGIN_M = 0.01
_SKEW_M = 0.01


@dataclass(frozen=True, slots=True)
class Plate:
    """A level piece of ground."""

    outline: Rectangle
    height_m: float
    yaw_rad: float = 0.0


def walkable(plates: Sequence[Plate], margin_m: float) -> list[list[list[float]]]:
    """Return corners of convex polygons: plates of one height that touch are one, and margins come off their edges."""
    found = []
    for height in sorted({plate.height_m for plate in plates}):
        level = [_outline(plate) for plate in plates if plate.height_m == height]
        joined = shapely.union_all(level).buffer(-margin_m, join_style="mitre")
        for part in shapely.get_parts(joined):
            found += [[[round(float(x), 5), round(float(y), 5), height] for x, y in p] for p in convex_pieces(part)]
    return found


def _outline(plate: Plate) -> shapely.Polygon:
    one = plate.outline
    return shapely.affinity.rotate(
        shapely.box(one.west, one.south, one.east, one.north), plate.yaw_rad, use_radians=True
    )


def bar_corners(
    begin_m: tuple[float, float], end_m: tuple[float, float], rng: np.random.Generator
) -> list[list[float]]:
    """Return the walkable corners of a bar, a little skew: only 1 cm comes off its edges, as it is 3 cm wide."""
    begin, end = np.array(begin_m), np.array(end_m)
    along = (end - begin) / np.linalg.norm(end - begin)
    across = np.array([-along[1], along[0]])
    begin, end = begin + across * rng.uniform(-_SKEW_M, _SKEW_M), end + across * rng.uniform(-_SKEW_M, _SKEW_M)
    half = (BAR_M / 2 - _BAR_MARGIN_M) * across
    return [
        [round(float(v), 5) for v in (*point, 0.0)] for point in (begin - half, end - half, end + half, begin + half)
    ]

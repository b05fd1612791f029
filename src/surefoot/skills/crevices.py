"""Low ground between higher ground, over which a robot steps: to a mission it is a gap.

A scan shows the floor between stepping stones too. Taken as ground it makes every cell uneven, although nobody has to
go down there. So low polygons are left out that the higher ground around them closes: discs as wide as the widest gap
that the classes step over as a matter of course do not fit in between.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely  # type: ignore[import-untyped]

from surefoot.footholds.terrain import Polygon

_HIGHER_M = 0.05
_REACH_M = 0.11
"""Half of the widest gap: 0.22 m between stones."""
_CLOSED_SHARE = 0.95


def crevices(polygons: Sequence[Polygon], margin_m: float) -> frozenset[int]:
    """Return which polygons lie in crevices: at least 5 cm below ground that closes over them.

    Args:
        polygons: where a foot may stand.
        margin_m: what was taken off their edges.
    """
    outlines = [shapely.Polygon(one.vertices_m[:, :2]) for one in polygons]
    plates = shapely.buffer(outlines, margin_m, join_style="mitre")
    heights = np.array([float(one.vertices_m[:, 2].mean()) for one in polygons])
    tree = shapely.STRtree(plates)
    who, near = tree.query(shapely.buffer(outlines, 2 * _REACH_M), predicate="intersects")
    higher = heights[near] >= heights[who] + _HIGHER_M
    found = []
    for number in np.unique(who[higher]).tolist():
        above = shapely.union_all(plates[near[higher & (who == number)]])
        closed = above.buffer(_REACH_M).buffer(-_REACH_M)
        if outlines[number].intersection(closed).area >= _CLOSED_SHARE * outlines[number].area:
            found.append(number)
    return frozenset(found)

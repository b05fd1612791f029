"""What Algorithm 1 minimises."""

from __future__ import annotations

from typing import NamedTuple

from numba import njit


class Aim(NamedTuple):
    """Desired values and weights; ``dy1_m`` and ``dy2_m`` are magnitudes on the side of the next foot.

    Attributes:
        dy1_m: lateral apex CoM minus waypoint.
        dy2_m: lateral foot minus apex CoM.
        duration_s: of the step, T_d.
        width_m: between the feet, W_d.
        c1: weight of dy1.
        c2: weight of dy2.
        c3: weight of the duration.
        c4: weight of the width.
        fine_cell_m: one cell of correction.
    """

    dy1_m: float
    dy2_m: float
    duration_s: float
    width_m: float
    c1: float
    c2: float
    c3: float
    c4: float
    fine_cell_m: float


@njit(cache=True)
def step_cost(aim: Aim, side: float, dy1_m: float, dy2_m: float, duration_s: float, width_m: float) -> float:
    """Return the cost of a candidate; the desired dy1 and dy2 carry the sign of the next foot.

    Args:
        aim: desired values and weights.
        side: of the next foot, left +1.
        dy1_m: of the next apex.
        dy2_m: of the next apex.
        duration_s: of the step, or 0 when the weights c3 and c4 are not meant.
        width_m: between the feet.

    Source: Shamsah et al., T-RO 2023, Algorithm 1, line 6.
    """
    cost = aim.c1 * abs(side * aim.dy1_m - dy1_m) + aim.c2 * abs(side * aim.dy2_m - dy2_m)
    if duration_s > 0:
        cost += aim.c3 * abs(aim.duration_s - duration_s) + aim.c4 * abs(aim.width_m - abs(width_m))
    return cost

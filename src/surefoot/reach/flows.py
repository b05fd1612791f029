"""The pendulum over one sample with a held omega, and its image boxes under a bounded disturbance.

With c = cosh(omega tau) and s = sinh(omega tau) the flow about a foot is
x' = x_foot + c (x - x_foot) + s/omega v, v' = omega s (x - x_foot) + c v, and rates that stay within D1 and D2 move it
by at most s/omega D1 + (c - 1)/omega^2 D2 and (c - 1) D1 + s/omega D2. Source: Shamsah et al., T-RO 2023, Eq. (2) and
Appendix A.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.reach._sweep import Images
from surefoot.reach.lattice import Lattice
from surefoot.reach.parameters import Disturbance, Reading

INDEX_SLACK = 1e-9
"""In cells, outward: rounding of an index is below 1e-12, so a box that touches a cell is never missed."""

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Flow:
    """The flow of every omega over one sample: arrays with one entry per omega.

    Attributes:
        omegas: [rad/s].
        c: cosh(omega tau).
        s_over: sinh(omega tau) / omega.
        s_times: omega sinh(omega tau).
        radius_x: how far the disturbance moves the position at most.
        radius_v: how far it moves the velocity at most.
    """

    omegas: Floats
    c: Floats
    s_over: Floats
    s_times: Floats
    radius_x: Floats
    radius_v: Floats


def flow(omegas_radps: Sequence[float], tau_s: float, disturbance: Disturbance) -> Flow:
    """Return the flow over one sample for every omega."""
    w = np.asarray(omegas_radps, np.float64)
    c, s = np.cosh(w * tau_s), np.sinh(w * tau_s)
    s_over, lever = s / w, (c - 1) / w**2
    if disturbance.reading is Reading.JUMP:
        radius_x, radius_v = np.full_like(w, disturbance.first), np.full_like(w, disturbance.second)
    else:
        d1, d2 = rate_bounds(disturbance, w)
        radius_x, radius_v = s_over * d1 + lever * d2, (c - 1) * d1 + s_over * d2
    return Flow(w, c, s_over, w * s, radius_x, radius_v)


def rate_bounds(disturbance: Disturbance, omegas: Floats) -> tuple[Floats, Floats]:
    """Return the bounds of the equivalent rates for every omega (not defined for jumps)."""
    if disturbance.reading is Reading.INSIDE_PHI:
        return np.full_like(omegas, disturbance.second), omegas**2 * disturbance.first
    return np.full_like(omegas, disturbance.first), np.full_like(omegas, disturbance.second)


def images(cells: Lattice, foot_m: float, step: Flow) -> Images:
    """Return the image boxes of all cells about a foot, in units of cells."""
    dx, dv = cells.x_step_m, cells.v_step_mps
    x = foot_m + step.c * (cells.x0_m - foot_m) + step.s_over * cells.v0_mps
    v = step.s_times * (cells.x0_m - foot_m) + step.c * cells.v0_mps
    return Images(
        x=(x - cells.x0_m) / dx + 0.5,
        xi=step.c,
        xj=step.s_over * dv / dx,
        xr=(0.5 * (step.c * dx + step.s_over * dv) + step.radius_x) / dx + INDEX_SLACK,
        v=(v - cells.v0_mps) / dv + 0.5,
        vi=step.s_times * dx / dv,
        vj=step.c,
        vr=(0.5 * (step.s_times * dx + step.c * dv) + step.radius_v) / dv + INDEX_SLACK,
    )


def least_advance(cells: Lattice, won: NDArray[np.bool_], foot_m: float, step: Flow) -> float:
    """Return how far a sample that starts in a winning cell moves the position at least, over all omegas [m]."""
    i, j = np.nonzero(won)
    if i.size == 0:
        return np.inf
    lowest = np.full(cells.columns, np.inf)
    np.minimum.at(lowest, i, cells.v_edges()[0][j])
    columns = np.nonzero(np.isfinite(lowest))[0]
    x = cells.x_edges()[0][columns, None] - foot_m
    return float(((step.c - 1) * x + step.s_over * lowest[columns, None] - step.radius_x).min())

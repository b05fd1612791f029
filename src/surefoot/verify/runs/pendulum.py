"""The linear inverted pendulum, integrated numerically: nothing here knows its closed form."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def runge_kutta(
    x: Array, v: Array, foot: Array, omega_squared: float, step_s: Array | float, steps: int
) -> tuple[Array, Array]:
    """Integrate x'' = omega^2 (x - x_foot) with the classical Runge-Kutta method; return positions and velocities."""
    h = step_s
    for _ in range(steps):
        a1 = omega_squared * (x - foot)
        v2 = v + h / 2 * a1
        a2 = omega_squared * (x + h / 2 * v - foot)
        v3 = v + h / 2 * a2
        a3 = omega_squared * (x + h / 2 * v2 - foot)
        v4 = v + h * a3
        a4 = omega_squared * (x + h * v3 - foot)
        x, v = x + h / 6 * (v + 2 * v2 + 2 * v3 + v4), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    return x, v

"""How the centre of mass moved, from a run log: the pendulum's closed form between logged states."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from surefoot.missions.run_log import Step

_SAMPLES = 12

Points = NDArray[np.float64]


def com_path_m(step: Step, samples: int = _SAMPLES) -> Points:
    """Return the plan-view path of the centre of mass during a step, shape (n, 2), in the world.

    Source: Shamsah et al., T-RO 2023, Eq. (1): x'' = omega^2 (x - x_foot) in both axes.
    """
    first, second = halves(step, samples)
    parts = [first[0], second[0]]
    if step.rise_com_m is not None:
        parts.insert(0, np.array([step.rise_com_m[:2]]))
    if step.rest_com_m is not None:
        parts.append(np.array([step.rest_com_m[:2]]))
    return np.concatenate(parts)


def halves(step: Step, samples: int) -> tuple[tuple[Points, Points], tuple[Points, Points]]:
    """Return positions and velocities, shape (samples, 2) each, before and after the switch of the stance foot."""
    before = orbit(step.com_m[:2], step.velocity_mps, step.foot_m[:2], step.omega_radps, step.first_half_s, samples)
    after = orbit(
        step.switch_m, step.switch_velocity_mps, step.next_foot_m[:2], step.omega_radps, step.second_half_s, samples
    )
    return before, after


def orbit(
    position_m: tuple[float, float],
    velocity_mps: tuple[float, float],
    foot_m: tuple[float, float],
    omega_radps: float,
    duration_s: float,
    samples: int,
) -> tuple[Points, Points]:
    """Return positions and velocities along the pendulum's orbit about a foot, from now until a duration has passed."""
    times = np.linspace(0.0, omega_radps * duration_s, samples)[:, None]
    away, speed = np.subtract(position_m, foot_m), np.asarray(velocity_mps) / omega_radps
    grown, swung = np.cosh(times), np.sinh(times)
    return foot_m + away * grown + speed * swung, omega_radps * (away * swung + speed * grown)


def local(step: Step, points_m: Points) -> Points:
    """Return world points in the frame of a step: origin at its waypoint, first axis along its heading."""
    return turned(step, np.asarray(points_m, np.float64) - step.waypoint_m[:2])


def turned(step: Step, vectors: Points) -> Points:
    """Return world vectors along the axes of a step's frame."""
    c, s = np.cos(step.yaw_rad), np.sin(step.yaw_rad)
    x, y = np.asarray(vectors)[..., 0], np.asarray(vectors)[..., 1]
    return np.stack((c * x + s * y, c * y - s * x), axis=-1)

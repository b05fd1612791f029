"""How the centre of mass moved, from a run log: the pendulum's closed form between logged states."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from surefoot.missions.biped.run_log import Step

_SAMPLES = 12
ARC_SAMPLES = 30

Points = NDArray[np.float64]
Piece = tuple[tuple[float, float], float, float, float | None]
"""Foot, duration, omega, and the omega of a law; None where no law holds one."""


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
    if step.push is not None:
        return _joined(step, before=True), _joined(step, before=False)
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


def arcs(step: Step) -> list[tuple[Points, Points, float | None]]:
    """Return positions and velocities along a step, piece by piece, each with its omega; None before a push."""
    push, start = step.push, (step.com_m[:2], step.velocity_mps)
    if push is None:
        pieces: list[Piece] = [(step.foot_m[:2], step.first_half_s, step.omega_radps, None)]
        pieces.append((step.next_foot_m[:2], step.second_half_s, step.omega_radps, None))
        return _in_a_row(start, pieces, None, (0.0, 0.0))
    first = push.planned.first_half_s
    foot, following = step.foot_m[:2], step.next_foot_m[:2]
    pieces = [(foot, min(first, push.time_s), step.omega_radps, None)]
    if push.time_s >= first:
        pieces.append((following, push.time_s - first, step.omega_radps, None))
    count = len(pieces)
    pieces += [(foot, duration, omega, omega) for duration, omega in push.omegas_before_switch]
    pieces += [(following, duration, omega, omega) for duration, omega in push.omegas_after_switch]
    cos, sin = np.cos(step.yaw_rad), np.sin(step.yaw_rad)
    ahead, left = push.jump_mps
    return _in_a_row(start, pieces, count, (float(cos * ahead - sin * left), float(sin * ahead + cos * left)))


def _in_a_row(
    state: tuple[tuple[float, float], tuple[float, float]],
    pieces: list[Piece],
    pushed: int | None,
    jump: tuple[float, float],
) -> list[tuple[Points, Points, float | None]]:
    """Return the orbits of pieces in a row; before the piece ``pushed`` the velocity jumps."""
    place, speed = state
    found: list[tuple[Points, Points, float | None]] = []
    for number, (foot, duration, omega, shown) in enumerate(pieces):
        if number == pushed:
            before, speed = speed, (speed[0] + jump[0], speed[1] + jump[1])
            found.append((np.array([place, place]), np.array([before, speed]), None))
        points, speeds = orbit(place, speed, foot, omega, duration, ARC_SAMPLES)
        found.append((points, speeds, shown))
        place, speed = (float(points[-1][0]), float(points[-1][1])), (float(speeds[-1][0]), float(speeds[-1][1]))
    return found


def _joined(step: Step, *, before: bool) -> tuple[Points, Points]:
    """Return positions and velocities of a pushed step before or after its switch."""
    switch_m, chosen = local(step, np.array([step.switch_m]))[0, 0], []
    for positions, speeds, _ in arcs(step):
        middle = local(step, positions)[len(positions) // 2, 0]
        if (middle <= switch_m) == before:
            chosen.append((positions, speeds))
    return np.concatenate([place for place, _ in chosen]), np.concatenate([speed for _, speed in chosen])

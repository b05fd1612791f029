"""Seeded problems whose gait is to be found: leaps over gaps, steps up and down, stones, and what cannot be done."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from surefoot.errors import InputError
from surefoot.footholds.gaits import FreeGait
from surefoot.footholds.problem import Array, Options, Problem, nominal_feet
from surefoot.footholds.terrain import Polygon, polygon
from surefoot.robots.quadruped import GO2

_HEIGHT_M = 0.29
_WIDE_M = 0.4


def gap_leap(seed: int) -> Problem:
    """Two grounds with a gap of 0.15 to 0.40 m between them."""
    rng = np.random.default_rng([seed, 11])
    gap, edge = rng.uniform(0.15, 0.40), rng.uniform(0.24, 0.36)
    ahead = edge + gap + rng.uniform(0.24, 0.34)
    return _problem([_ground(-0.6, edge), _ground(edge + gap, edge + gap + 1.2)], (ahead, 0.0, 0.0), _horizon_s(rng))


def height_step(seed: int) -> Problem:
    """A step of 0.05 to 0.25 m, up or down, with a crack of 4 cm."""
    rng = np.random.default_rng([seed, 12])
    rise, edge = rng.uniform(0.05, 0.25) * rng.choice([-1, 1]), rng.uniform(0.24, 0.4)
    ahead = edge + rng.uniform(0.28, 0.5)
    ground = [_ground(-0.6, edge), _ground(edge + 0.04, edge + 1.2, rise)]
    return _problem(ground, (ahead, 0.0, rise), _horizon_s(rng))


def mixed_stones(seed: int) -> Problem:
    """Ground, then two rows of stones of different sizes and heights with gaps of 0.08 to 0.2 m, then ground."""
    rng = np.random.default_rng([seed, 13])
    ground, ends = [_ground(-0.6, 0.24)], []
    for side in (1, -1):
        x = 0.24
        for _ in range(2):
            x += rng.uniform(0.08, 0.2)
            size, rise = rng.uniform(0.12, 0.22), rng.uniform(-0.05, 0.05)
            y = side * 0.1308 + rng.uniform(-0.03, 0.03)
            ground.append(_turned(x + size / 2, y, size, 0.18, rng.uniform(-0.2, 0.2), rise))
            x += size
        ends.append(x)
    last = max(ends) + rng.uniform(0.06, 0.15)
    ground.append(_ground(last, last + 1.2))
    return _problem(ground, (last + rng.uniform(0.24, 0.34), rng.uniform(-0.03, 0.03), 0.0), _horizon_s(rng))


def hopeless(seed: int) -> Problem:
    """What nobody can do: gaps of 1.2 to 2 m in a second, steps of more than a metre, goals above a hole, sprints."""
    rng = np.random.default_rng([seed, 14])
    kind = seed % 4
    if kind == 0:
        gap = rng.uniform(1.2, 2.0)
        return _problem([_ground(-0.6, 0.3), _ground(0.3 + gap, 1.5 + gap)], (0.6 + gap, 0.0, 0.0), 1.0)
    if kind == 1:
        rise = rng.uniform(1.3, 2.0)
        return _problem([_ground(-0.6, 0.3), _ground(0.34, 1.5, rise)], (0.7, 0.0, rise), _short_s(rng))
    if kind == 2:
        hole = rng.uniform(0.75, 0.9)
        return _problem([_ground(-0.6, 0.3), _ground(0.3 + hole, 2.0)], (0.3 + hole / 2, 0.0, 0.0), _horizon_s(rng))
    return _problem([_ground(-0.6, 8.0)], (rng.uniform(3.0, 6.0), 0.0, 0.0), _short_s(rng))


def _horizon_s(rng: np.random.Generator) -> float:
    return float(rng.choice([1.0, 1.2, 1.5, 1.8, 2.0]))


def _short_s(rng: np.random.Generator) -> float:
    return float(rng.choice([0.8, 1.0]))


def _ground(near: float, far: float, z: float = 0.0) -> Polygon:
    return polygon([[near, -_WIDE_M, z], [far, -_WIDE_M, z], [far, _WIDE_M, z], [near, _WIDE_M, z]])


def _turned(x: float, y: float, length: float, width: float, yaw: float, z: float) -> Polygon:
    corners: Array = np.array([[-length, -width], [length, -width], [length, width], [-length, width]]) / 2
    c, s = np.cos(yaw), np.sin(yaw)
    flat = corners @ np.array([[c, s], [-s, c]]) + [x, y]
    return polygon([[px, py, z] for px, py in flat])


def _problem(ground: list[Polygon], goal: tuple[float, float, float], horizon_s: float) -> Problem:
    start, level = np.array([0.0, 0.0, _HEIGHT_M]), np.zeros(3)
    return Problem(
        robot=GO2,
        gait=FreeGait(horizon_s),
        step_s=0.025,
        start_m=start,
        start_rpy_rad=level,
        feet_m=nominal_feet(GO2, start, level),
        goal_m=np.array([goal[0], goal[1], _HEIGHT_M + goal[2]]),
        goal_rpy_rad=level,
        polygons=tuple(ground),
        options=Options(gap=0.2, time_limit_s=15.0),
    )


FREE_FAMILIES: dict[str, Callable[[int], Problem]] = {
    "gap-leap": gap_leap,
    "height-step": height_step,
    "mixed-stones": mixed_stones,
    "hopeless": hopeless,
}


def free_problem_of(family: str, seed: int) -> Problem:
    """Return the problem of a family and a seed.

    Raises:
        InputError: there is no such family.
    """
    if family not in FREE_FAMILIES:
        raise InputError(f"there is no family {family!r}; there are: {', '.join(FREE_FAMILIES)}")
    return FREE_FAMILIES[family](seed)

"""Where a leg reaches: half-spaces inside the reach box whose points stretch no leg beyond its knee's limit.

The box of Eq. (16) knows nothing of legs: its lower corners are farther from the hip than the leg is long. A foot is no
farther than R from where the axes of hip abduction and hip pitch cross, with R^2 = (2 l cos(q / 2))^2 + a^2, l the
length of thigh and shank, q the knee's least bend and a the leg's offset. Below the hip that ball is z >= g(x, y) with
a convex g. Over each of four quarters of the box, g lies below its tangent at the middle, raised by the largest error
that any tangent has on its quarter; that error is largest in a corner.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import product

import numpy as np

from surefoot.errors import InputError
from surefoot.footholds.problem import Array
from surefoot.robots.legs import Legs, legs
from surefoot.robots.quadruped import Quadruped

_TRIED = 9
_AWAY_M = 1e-9


@lru_cache(maxsize=16)
def leg_cuts(robot: Quadruped) -> tuple[Array, Array]:
    """Return half-spaces ``normals @ foot <= bounds`` in the base frame, shapes (4, 4, 3) and (4, 4).

    Raises:
        InputError: a leg of this robot has other limits too in its reach box, which these half-spaces do not know.
    """
    own = legs(robot)
    parts = [_cuts(robot, own, foot) for foot in range(4)]
    normals, bounds = (np.array([part[k] for part in parts]) for k in (0, 1))
    _check(robot, own, normals, bounds)
    return normals, bounds


def _cuts(robot: Quadruped, own: Legs, foot: int) -> tuple[Array, Array]:
    middle, half = np.array(robot.feet_m[foot]) - own.hips_m[foot], np.array(robot.foot_reach_m)
    radius = float(own.stretch_m[foot])
    if np.linalg.norm(np.abs(middle[:2]) + half[:2]) >= radius:
        raise InputError("is for legs that are longer than the reach box is wide", key="options.joint_reach")
    normals, bounds, errors = [], [], []
    for signs in product((-1, 1), repeat=2):
        centre = middle[:2] + np.array(signs) * half[:2] / 2
        depth = float(np.sqrt(radius**2 - centre @ centre))
        corners = centre + np.array(list(product((-1, 1), repeat=2))) * half[:2] / 2
        errors += list((radius**2 - corners @ centre) / depth - np.sqrt(radius**2 - (corners**2).sum(axis=1)))
        normals.append([*centre / depth, -1.0])
        bounds.append(radius**2 / depth)
    rows = np.array(normals)
    limits: Array = np.array(bounds) - max(errors) + rows @ own.hips_m[foot]
    return rows, limits


def _check(robot: Quadruped, own: Legs, normals: Array, bounds: Array) -> None:
    """Refuse a robot whose other limits forbid places that box and cuts allow."""
    ticks = np.linspace(-1.0, 1.0, _TRIED)
    offsets = np.array(list(product(ticks, repeat=3))) * np.array(robot.foot_reach_m)
    feet = np.array(robot.feet_m)[None] + offsets[:, None]
    allowed = (np.einsum("jka,nja->njk", normals, feet) <= bounds).all(axis=2)
    if (own.joints_rad(feet)[1][allowed] > _AWAY_M).any():
        message = "is for robots whose legs reach all of the box of foot_reach_m but what is too far below"
        raise InputError(message, key="options.joint_reach")

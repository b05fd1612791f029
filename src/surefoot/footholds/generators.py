"""Seeded foothold problems: for benchmarks and tests, as the terrains of the paper are not public.

All have a 2 s trot of the Go2 over 0.8 m at 0.025 s (80 samples), unless said otherwise.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from surefoot.errors import InputError
from surefoot.footholds.gaits import NAMED
from surefoot.footholds.problem import Array, Options, Problem, nominal_feet
from surefoot.footholds.terrain import Polygon, polygon
from surefoot.robots.quadruped import GO2

_HEIGHT_M = 0.29
_MARGIN_M = 0.02
_TRACK_M = 0.1308
_FRONT_M = 0.1805


def stones_8(seed: int) -> Problem:
    """Eight stones of 0.25 m, four per side, jittered and turned."""
    return _stones(seed, per_side=4, spacing_m=0.386, size_m=0.25, jitter_m=0.03, yaw_rad=0.15)


def stones_12(seed: int) -> Problem:
    """Twelve stones of 0.17 m, six per side."""
    return _stones(seed, per_side=6, spacing_m=0.232, size_m=0.17, jitter_m=0.025, yaw_rad=0.15)


def sparse(seed: int) -> Problem:
    """Eight stones of 0.2 m with gaps of 0.18 to 0.2 m, turned by up to 0.3 rad."""
    return _stones(seed, per_side=4, spacing_m=0.39, size_m=0.2, jitter_m=0.01, yaw_rad=0.3)


def misaligned(seed: int) -> Problem:
    """The eight stones, with the goal 0.15 m to the side."""
    problem = _stones(seed, per_side=4, spacing_m=0.386, size_m=0.25, jitter_m=0.03, yaw_rad=0.15)
    rng = np.random.default_rng([seed, 3])
    return replace(problem, goal_m=problem.goal_m + np.array([0.0, 0.15 * rng.choice([-1, 1]), 0.0]))


def rebar(seed: int) -> Problem:
    """Eight bars of 3 cm across the way, 0.11 to 0.16 m apart; the goal is 0.6 m away."""
    return _rebar(seed, 0.0)


def rebar_rotated(seed: int) -> Problem:
    """The bars turned by up to 15 degrees."""
    rng = np.random.default_rng([seed, 5])
    return _rebar(seed, float(np.radians(rng.uniform(-15, 15))))


def step_up(seed: int) -> Problem:
    """A step of 6, 12 or 18 cm up, with collision avoidance: 2 polygons, 2 free regions, 30 windows, 256 binaries."""
    return _step(seed, up=True)


def step_down(seed: int) -> Problem:
    """The same step downwards."""
    return _step(seed, up=False)


def far(seed: int) -> Problem:
    """Stones, sparse stones or bars with the goal near the end of reach: about half of them are infeasible."""
    kind = (stones_8, stones_12, sparse, misaligned, rebar, rebar_rotated)[seed % 6]
    rng = np.random.default_rng([seed, 7])
    least, most = (0.6, 0.72) if kind in (rebar, rebar_rotated) else (0.9, 1.06)
    problem = kind(seed)
    return replace(problem, goal_m=np.array([rng.uniform(least, most), *problem.goal_m[1:]]))


def _problem(
    polygons: list[Polygon], *, feet: Array | None = None, goal_m: Array | None = None, start_z: float = _HEIGHT_M
) -> Problem:
    start, level = np.array([0.0, 0.0, start_z]), np.zeros(3)
    return Problem(
        robot=GO2,
        gait=NAMED["trot-2s"],
        step_s=0.025,
        start_m=start,
        start_rpy_rad=level,
        feet_m=nominal_feet(GO2, start, level) if feet is None else feet,
        goal_m=np.array([0.8, 0.0, _HEIGHT_M]) if goal_m is None else goal_m,
        goal_rpy_rad=level,
        polygons=tuple(polygons),
        options=Options(time_limit_s=60.0),
    )


def _feet_on(polygons: list[Polygon]) -> Array:
    """Return the nominal feet, moved to the nearest polygon where they would stand beside one."""
    nominal = nominal_feet(GO2, np.array([0.0, 0.0, _HEIGHT_M]), np.zeros(3))
    feet = []
    for foot in nominal:
        points = [one.nearest(foot) for one in polygons]
        feet.append(min(points, key=lambda point: float(np.linalg.norm(point - foot))))
    return np.array(feet)


def _stones(seed: int, *, per_side: int, spacing_m: float, size_m: float, jitter_m: float, yaw_rad: float) -> Problem:
    rng = np.random.default_rng(seed)
    stones = []
    for side in (1, -1):
        for k in range(per_side):
            x = -_FRONT_M + k * spacing_m + rng.uniform(-jitter_m, jitter_m)
            y = side * _TRACK_M + rng.uniform(-jitter_m, jitter_m)
            stones.append(_rectangle(x, y, size_m, size_m, rng.uniform(-yaw_rad, yaw_rad)))
    return _problem(stones, feet=_feet_on(stones))


def _rectangle(x: float, y: float, length: float, width: float, yaw: float, z: float = 0.0) -> Polygon:
    corners = np.array([[-length, -width], [length, -width], [length, width], [-length, width]]) / 2
    c, s = np.cos(yaw), np.sin(yaw)
    flat = corners @ np.array([[c, s], [-s, c]]) + [x, y]
    return polygon([[px, py, z] for px, py in flat])


def _rebar(seed: int, angle: float) -> Problem:
    rng = np.random.default_rng(seed)
    bars, x = [], -_FRONT_M - 0.01
    for _ in range(8):
        bars.append(_rectangle(x * np.cos(angle), x * np.sin(angle), 0.03, 1.2, angle))
        x += rng.uniform(0.11, 0.16)
    return _problem(bars, feet=_feet_on(bars), goal_m=np.array([0.6, 0.0, _HEIGHT_M]))


def _step(seed: int, *, up: bool) -> Problem:
    rng = np.random.default_rng(seed)
    height, edge = float(rng.choice([0.06, 0.12, 0.18])), float(rng.uniform(0.3, 0.5))
    near = _rectangle((edge - _MARGIN_M - 0.6) / 2, 0.0, edge - _MARGIN_M + 0.6, 1.2, 0.0, 0.0 if up else height)
    far = _rectangle((edge + _MARGIN_M + 1.6) / 2, 0.0, 1.6 - edge - _MARGIN_M, 1.2, 0.0, height if up else 0.0)
    above = (np.array([[0.0, 0.0, -1.0]]), np.array([-height]))
    before = (np.array([[1.0, 0.0, 0.0]]), np.array([edge - _MARGIN_M / 2]))
    beyond = (np.array([[-1.0, 0.0, 0.0]]), np.array([-edge - _MARGIN_M / 2]))
    start_z, goal_z = (0.0, height) if up else (height, 0.0)
    problem = _problem([near, far], goal_m=np.array([0.8, 0.0, _HEIGHT_M + goal_z]), start_z=_HEIGHT_M + start_z)
    options = replace(problem.options, collision=True)
    return replace(problem, options=options, free_regions=(before if up else beyond, above))


FAMILIES: dict[str, Callable[[int], Problem]] = {
    "stones-8": stones_8,
    "stones-12": stones_12,
    "sparse": sparse,
    "misaligned": misaligned,
    "rebar": rebar,
    "rebar-rotated": rebar_rotated,
    "far": far,
    "step-up": step_up,
    "step-down": step_down,
}


def problem_of(family: str, seed: int) -> Problem:
    """Return the problem of a family and a seed.

    Raises:
        InputError: there is no such family.
    """
    if family not in FAMILIES:
        raise InputError(f"there is no family {family!r}; there are: {', '.join(FAMILIES)}")
    return FAMILIES[family](seed)


def borderline(
    family: str, seed: int, feasible: Callable[[Problem], bool], *, steps: int = 10
) -> tuple[Problem, Problem]:
    """Return two problems that differ by less than a millimetre of goal: the first feasible, the second not.

    Args:
        family: one of ``FAMILIES``.
        seed: of the terrain.
        feasible: decides a problem.
        steps: halvings of the interval of goals, 0.4 m to 1.4 m away.
    """
    problem = problem_of(family, seed)

    def moved(x: float) -> Problem:
        return replace(problem, goal_m=np.array([x, *problem.goal_m[1:]]))

    near, far = 0.4, 1.4
    for _ in range(steps):
        middle = (near + far) / 2
        near, far = (middle, far) if feasible(moved(middle)) else (near, middle)
    return moved(near), moved(far)


def strips(
    seed: int,
    *,
    tilt: float = 0.0,
    friction: float = 0.6,
    goal_x_m: float | None = None,
    bands: int = 3,
    **options: object,
) -> Problem:
    """Return a small problem for comparison with enumeration: a 1 s trot at 0.05 s over bands across the way.

    Args:
        seed: of the bands.
        tilt: largest slope of a band.
        friction: of the first band; the others' is drawn unless it is below 0.3.
        goal_x_m: drawn from 0.2 to 0.5 by default.
        bands: how many; the first one carries the robot.
        options: of the problem, see ``Options``.
    """
    rng = np.random.default_rng(seed)
    ground = [polygon([[-0.5, -0.4, 0], [0.28, -0.4, 0], [0.28, 0.4, 0], [-0.5, 0.4, 0]], friction)]
    x = 0.28
    for _ in range(bands - 1):
        gap, width = rng.uniform(0.03, 0.12), rng.uniform(0.1, 0.2)
        rise, roll, height = rng.uniform(-tilt, tilt), rng.uniform(-tilt, tilt) * 0.3, rng.uniform(-tilt, tilt) * 0.1
        near, far = x + gap, x + gap + width
        flat = ((near, -0.4), (far, -0.4), (far, 0.4), (near, 0.4))
        corners = [[px, py, height + rise * (px - near) + roll * py] for px, py in flat]
        ground.append(polygon(corners, friction if friction < 0.3 else rng.uniform(0.3, 0.8)))
        x = far
    goal = rng.uniform(0.2, 0.5) if goal_x_m is None else goal_x_m
    problem = _problem(ground, goal_m=np.array([goal, 0.0, _HEIGHT_M]))
    return replace(problem, gait=NAMED["trot-1s"], step_s=0.05, options=replace(problem.options, **options))  # type: ignore[arg-type]

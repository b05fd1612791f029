"""Coarse maps and problems from pictures in characters: '#' is blocked, '.' is free."""

from __future__ import annotations

import numpy as np

from surefoot.frames import Direction
from surefoot.navigation import CoarseMap, NavigationProblem, Obstacle, coarse_map
from surefoot.world import CoarseGrid, Floor, Stairs, make_heights

CELL_M = 2.70351

TWO_ROOMS = """
############
####..##...#
####.......#
#......#...#
#..##..#...#
#......#####
############
"""
UPPER_ROOM = frozenset({20, 21, 22, 32, 33, 34, 44, 45, 46, 56, 57, 58})
STAIRS_AND_FRONT = frozenset({29, 30, 31})
TWO_ROOM_REGIONS = tuple(map(frozenset, ({37, 38, 49, 50}, {61, 62}, {39}, {63, 64}, {53, 54, 65, 66})))

OLDER = """
#############
#.#....##...#
#......##...#
#...#.......#
#......##...#
#...#..##...#
#############
"""
OLDER_FORBIDDEN = frozenset({22, 23, 24, 35, 36, 37, 48, 49, 50, 61, 62, 63, 74, 75, 76, 46, 47})
OLDER_REGIONS = (frozenset({55}), frozenset({44, 56, 57, 58, 70, 71}))


def grid_of(art: str) -> CoarseGrid:
    """Return a grid whose south-western corner is the origin."""
    free = np.array([[sign == "." for sign in line] for line in art.split()])
    rows, columns = free.shape
    return CoarseGrid(
        cell_size_m=CELL_M,
        origin_m=(0.0, 0.0),
        rotation_rad=0.0,
        rows=rows,
        columns=columns,
        north_west_m=(0.0, rows * CELL_M),
        free=free,
    )


UPPER_FLOOR = Floor(((8 * CELL_M, 2 * CELL_M, 11 * CELL_M, 6 * CELL_M),), 1.2)
STAIRS = Stairs((6 * CELL_M, 4 * CELL_M, 8 * CELL_M, 5 * CELL_M), Direction.EAST, 12, 0.1, 0.416, 0.208)


def coarse_of(
    art: str, *, corners: str = "visible", floors: tuple[Floor, ...] = (), stairs: tuple[Stairs, ...] = ()
) -> CoarseMap:
    """Return the coarse map of a picture; the robot sees four cells far."""
    grid = grid_of(art)
    return coarse_map(grid, make_heights(grid, 26, floors, stairs), 10.82, corners)


def crowd(
    starts: tuple[int, ...], forbidden: frozenset[int] = frozenset(), speed_cells: int = 1
) -> tuple[Obstacle, ...]:
    """Return equal obstacles."""
    return tuple(Obstacle(start, forbidden, speed_cells) for start in starts)


def two_rooms(
    *,
    corners: str = "visible",
    obstacle_starts: tuple[int, ...] = (61,),
    forbidden: frozenset[int] = UPPER_ROOM | STAIRS_AND_FRONT,
    **options: object,
) -> NavigationProblem:
    """Return the scene of seed Fig. 14."""
    problem = {
        "coarse": coarse_of(TWO_ROOMS, corners=corners, floors=(UPPER_FLOOR,), stairs=(STAIRS,)),
        "start": 56,
        "heading": Direction.EAST,
        "goals": (57, 49),
        "obstacles": crowd(obstacle_starts, forbidden),
        "regions": TWO_ROOM_REGIONS,
        **options,
    }
    return NavigationProblem(**problem)  # type: ignore[arg-type]


def older(
    *,
    extra_wall: bool = False,
    corners: str = "visible",
    obstacle_starts: tuple[int, ...] = (28,),
    forbidden: frozenset[int] = OLDER_FORBIDDEN,
    **options: object,
) -> NavigationProblem:
    """Return the 7 x 13 scene of the conference version, optionally with a static obstacle more."""
    lines = OLDER.split()
    if extra_wall:
        lines[1] = lines[1][:3] + "#" + lines[1][4:]
    problem = {
        "coarse": coarse_of("\n".join(lines), corners=corners),
        "start": 62,
        "heading": Direction.EAST,
        "goals": (37, 53),
        "obstacles": crowd(obstacle_starts, forbidden),
        "regions": OLDER_REGIONS,
        **options,
    }
    return NavigationProblem(**problem)  # type: ignore[arg-type]

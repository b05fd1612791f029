"""Floors and stairs: profiles, passable borders, and what is refused."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from world_scenes import CELL_M, TWO_ROOMS, grid_of, map_of

from surefoot.errors import InputError
from surefoot.frames import Cell, Direction
from surefoot.world import CoarseGrid, Floor, HeightMap, Profile, Rectangle, Stairs, make_grid, make_heights

C = CELL_M
UPPER = Floor(((8 * C, 2 * C, 11 * C, 6 * C),), 1.2)
FLIGHT = Stairs((6 * C, 4 * C, 8 * C, 5 * C), Direction.EAST, 12, 0.1, 0.416, 0.208)


def two_rooms() -> tuple[CoarseGrid, HeightMap]:
    grid = grid_of(TWO_ROOMS, C)
    return grid, make_heights(grid, 26, (UPPER,), (FLIGHT,))


def profile_at(heights: HeightMap, cell: tuple[int, int]) -> Profile:
    profile = heights.profile(Cell(*cell))
    assert profile is not None
    return profile


def one_flight(**changes: Any) -> tuple[CoarseGrid, HeightMap]:
    """Lay two risers of 0.15 m in the middle cell of three of 1 m, with an upper floor behind them."""
    grid = grid_of("...")
    stairs = replace(Stairs((1, 0, 2, 1), Direction.EAST, 2, 0.15, 0.4, 0.3), **changes)
    return grid, make_heights(grid, 10, (Floor(((2, 0, 3, 1),), 0.3),), (stairs,))


def test_two_rooms_rise_by_the_height_of_the_upper_floor() -> None:
    grid, heights = two_rooms()
    lower, upper = profile_at(heights, (2, 6)), profile_at(heights, (2, 7))
    assert lower.gain_m + upper.gain_m == pytest.approx(1.2)
    assert lower.gain_m == pytest.approx(0.6)
    assert heights.base_m[2, 6] == 0
    assert heights.base_m[2, 7] == pytest.approx(0.6)
    assert heights.base_m[2, 8] == heights.base_m[4, 9] == 1.2
    assert heights.profiles[0] is None
    assert sorted(set(heights.profile_of.ravel().tolist())) == [0, 1, 2]
    assert grid.index(Cell(2, 6)) == 30


def test_two_rooms_admit_feet_away_from_risers() -> None:
    _, heights = two_rooms()
    lower, upper = profile_at(heights, (2, 6)), profile_at(heights, (2, 7))
    # Risers stand at the fine columns 2, 6, 10, ..., 22 of cell 30 and, the seventh on the border, 0, 4, ..., 20 of 31.
    assert [index for index, ok in enumerate(lower.admissible) if ok] == [
        0,
        *(k for k in range(3, 25) if k % 4 in (0, 3)),
    ]
    assert [index for index, ok in enumerate(upper.admissible) if not ok] == [
        0,
        *(k for k in range(3, 21) if k % 4 in (0, 3)),
    ]
    assert lower.heights_m == pytest.approx([0.1 * ((index + 2) // 4) for index in range(26)])
    assert upper.heights_m == pytest.approx([0.1 * min(index // 4 + 1, 6) for index in range(26)])


def test_a_riser_on_the_border_belongs_to_the_upper_cell_in_both_directions() -> None:
    grid = grid_of("....")
    for up, first, last in ((Direction.EAST, 1, 2), (Direction.WEST, 2, 1)):
        stairs = Stairs((1, 0, 3, 1), up, 3, 0.1, 0.5, 0.5)
        far = Floor(((3, 0, 4, 1),) if up is Direction.EAST else ((0, 0, 1, 1),), 0.3)
        heights = make_heights(grid, 10, (far,), (stairs,))
        lower, upper = profile_at(heights, (0, first)), profile_at(heights, (0, last))
        assert lower.heights_m == pytest.approx([0] * 5 + [0.1] * 5)
        assert lower.admissible == (True, True, True, True, False, False, True, True, True, False)
        assert upper.heights_m == pytest.approx([0.1] * 5 + [0.2] * 5)
        assert upper.admissible == (False, True, True, True, False, False, True, True, True, True)
        assert (heights.base_m[0, last], upper.gain_m) == pytest.approx((0.1, 0.2))
        assert heights.passable(grid, Cell(0, first), up)
        assert heights.passable(grid, Cell(0, last), up.opposite)


def test_stairs_are_walked_along_their_axis_only() -> None:
    grid, heights = two_rooms()
    for cell in (Cell(2, 5), Cell(2, 6), Cell(2, 7)):
        assert heights.passable(grid, cell, Direction.EAST)
        assert heights.passable(grid, cell.neighbour(Direction.EAST), Direction.WEST)
    assert not heights.passable(grid, Cell(2, 6), Direction.SOUTH)
    assert not heights.passable(grid, Cell(3, 6), Direction.NORTH)
    assert not heights.passable(grid, Cell(1, 6), Direction.EAST)  # blocked
    assert not heights.passable(grid, Cell(2, 10), Direction.EAST)
    assert heights.passable(grid, Cell(2, 9), Direction.SOUTH)


@settings(max_examples=40, deadline=None)
@given(st.lists(st.sampled_from("..#"), min_size=20, max_size=20), st.lists(st.integers(0, 2), min_size=5, max_size=5))
def test_passable_both_ways_exactly_when_free_and_level(signs: list[str], floors_m: list[int]) -> None:
    drawing = " ".join("".join(signs[row : row + 5]) for row in range(0, 20, 5))
    grid = grid_of(drawing)
    floors = tuple(Floor(((k, 0, k + 1, 4),), float(height)) for k, height in enumerate(floors_m))
    heights = make_heights(grid, 10, floors)
    for cell in (grid.cell(number) for number in range(20)):
        for direction in Direction:
            target = cell.neighbour(direction)
            level = grid.has(target) and floors_m[cell.column] == floors_m[target.column]
            expected = grid.is_free(cell) and grid.is_free(target) and level
            assert heights.passable(grid, cell, direction) == expected
            assert heights.passable(grid, target, direction.opposite) == expected


def test_a_ledge_is_not_passable() -> None:
    grid = grid_of("..")
    heights = make_heights(grid, 10, (Floor(((1, 0, 2, 1),), 0.05),))
    assert not heights.passable(grid, Cell(0, 0), Direction.EAST)
    assert heights.height_at(grid, (1.5, 0.5)) == 0.05


@pytest.mark.parametrize("up", list(Direction))
def test_a_profile_is_told_along_its_axis(up: Direction) -> None:
    grid = grid_of("... ... ...")
    above = Cell(1, 1).neighbour(up)
    x, y = above.column, 2 - above.row
    stairs = Stairs((1, 1, 2, 2), up, 2, 0.15, 0.4, 0.3)
    floors = (Floor(((x, y, x + 1, y + 1),), 0.3),)
    heights = make_heights(grid, 10, floors, (stairs,))
    profile = profile_at(heights, (1, 1))
    assert profile.up is up
    assert profile.heights_m == pytest.approx([0] * 3 + [0.15] * 4 + [0.3] * 3)
    assert profile.gain_m == pytest.approx(0.3)
    assert profile.admissible == (True, True, False, False, True, True, False, False, True, True)
    assert heights.base_m[1, 1] == 0
    below = Cell(1, 1).neighbour(up.opposite)
    assert heights.passable(grid, Cell(1, 1), up)
    assert heights.passable(grid, below, up)
    assert heights.passable(grid, Cell(1, 1), up.opposite)
    assert not heights.passable(grid, Cell(1, 1), up.left)
    assert not heights.passable(grid, Cell(1, 1).neighbour(up.left), up.right)
    dy, dx = -up.offset[0], up.offset[1]
    climbed = [heights.height_at(grid, (1.5 + dx * t, 1.5 + dy * t)) for t in (-0.6, -0.3, 0, 0.3, 0.6)]
    assert climbed == pytest.approx([0, 0, 0.15, 0.3, 0.3])


def test_profiles_are_shared() -> None:
    grid = grid_of("........")
    flights = tuple(Stairs((at, 0, at + 2, 1), Direction.EAST, 4, 0.1, 0.5, 0.25) for at in (1, 5))
    floors = (Floor(((3, 0, 5, 1),), 0.4), Floor(((7, 0, 8, 1),), 0.8))
    heights = make_heights(grid, 10, floors, flights)
    assert heights.profile_of.tolist() == [[0, 1, 1, 0, 0, 1, 1, 0]]
    assert len(heights.profiles) == 2
    assert heights.base_m[0].tolist() == pytest.approx([0, 0, 0.2, 0.4, 0.4, 0.4, 0.6, 0.8])


def test_a_flight_may_begin_and_end_inside_cells() -> None:
    grid = grid_of("....")
    stairs = Stairs((0.5, 0, 2.5, 1), Direction.EAST, 3, 0.1, 0.7, 0.2)
    floors = (Floor(((2.5, 0, 4, 1),), 0.3),)
    heights = make_heights(grid, 10, floors, (stairs,))
    assert heights.profile_of.tolist() == [[1, 2, 3, 0]]
    assert profile_at(heights, (0, 0)).heights_m == pytest.approx([0] * 7 + [0.1] * 3)
    with pytest.raises(InputError, match="the flight meets it at"):
        make_heights(grid, 10, (), (stairs,))


def test_a_flight_starts_on_the_floor_before_it() -> None:
    grid = grid_of("...")
    floors = (Floor(((0, 0, 1, 1),), 1.0), Floor(((2, 0, 3, 1),), 1.3))
    stairs = Stairs((1, 0, 2, 1), Direction.EAST, 2, 0.15, 0.4, 0.3)
    heights = make_heights(grid, 10, floors, (stairs,))
    assert heights.base_m[0].tolist() == [1.0, 1.0, 1.3]
    assert heights.passable(grid, Cell(0, 0), Direction.EAST)
    assert heights.passable(grid, Cell(0, 2), Direction.WEST)


def test_a_floor_may_be_put_together_from_rectangles() -> None:
    grid = grid_of("..")
    halves = Floor(((1, 0, 1.5, 1), (1.5, 0, 2, 1)), 0.3)
    assert make_heights(grid, 10, (halves,)).base_m.tolist() == [[0, 0.3]]
    sloppy = Floor(((0.995, -0.2, 2.005, 0.995),), 0.3)
    assert make_heights(grid, 10, (sloppy,)).base_m.tolist() == [[0, 0.3]]
    ground = Floor(((0, 0, 0.5, 1),), 0.0)
    assert make_heights(grid, 10, (ground,)).base_m.tolist() == [[0, 0]]


def test_blocked_cells_and_the_outside_have_a_height_too() -> None:
    grid = grid_of("..#")
    heights = make_heights(grid, 10, (Floor(((1, 0, 2.6, 1),), 0.3),))
    assert heights.height_at(grid, (2.5, 0.5)) == 0.3
    assert heights.height_at(grid, (9, 9)) == 0.3
    assert heights.height_at(grid, (-9, 0)) == 0


def test_a_turned_grid() -> None:
    occupancy = map_of(np.zeros((9, 9), np.bool_), origin_m=(-4.5, -4.5))
    grid = make_grid(occupancy, cell_size_m=1, rotation_rad=math.pi / 2)
    (x0, y0), (x1, y1) = grid.to_world([(0, 0), (1, 1)]).tolist()
    heights = make_heights(grid, 10, (), (Stairs((x0, y0, x1, y1), Direction.NORTH, 1, 0.1, 0.3, 0.5),))
    (cell,) = zip(*np.nonzero(heights.profile_of), strict=True)
    assert grid.center_m(Cell(int(cell[0]), int(cell[1]))) == pytest.approx((-0.5, 0.5))
    assert heights.height_at(grid, (-0.1, 0.5)) == 0
    assert heights.height_at(grid, (-0.9, 0.5)) == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"rectangle_m": (1, 0, 2, 0.5)}, "span the cell"),
        ({"rectangle_m": (1, 0.2, 2, 1)}, "span the cell"),
        ({"rectangle_m": (1, 0, 1, 1)}, "no area"),
        ({"rectangle_m": (1, 0, math.nan, 1)}, "four finite numbers"),
        ({"rectangle_m": (5, 5, 6, 6)}, "no free cell"),
        ({"first_riser_m": 0.09}, "riser 0 stands 0.090 m from the border"),
        ({"first_riser_m": 0.55}, "riser 1 stands 0.050 m from the border"),
        ({"first_riser_m": 0.7}, "beyond the upper edge"),
        ({"first_riser_m": -0.1}, "first_riser_m"),
        ({"first_riser_m": math.inf}, "first_riser_m"),
        ({"risers": 0}, "risers has to be"),
        ({"risers": 10**9}, "risers has to be"),
        ({"riser_m": -0.1}, "riser_m and tread_m"),
        ({"tread_m": 0.0}, "riser_m and tread_m"),
        ({"tread_m": math.nan}, "riser_m and tread_m"),
    ],
)
def test_bad_stairs_are_refused(changes: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        one_flight(**changes)
    assert caught.value.key == "heights.stairs[0]"


def test_good_stairs_are_not() -> None:
    for changes in ({}, {"first_riser_m": 0.1}, {"first_riser_m": 0.5}, {"rectangle_m": (2, 1, 1, 0)}):
        grid, heights = one_flight(**changes)
        assert heights.passable(grid, Cell(0, 1), Direction.EAST)


def test_two_flights_in_one_cell_are_refused() -> None:
    one = Stairs((1, 0, 2, 1), Direction.EAST, 1, 0.15, 0.4, 0.3)
    with pytest.raises(InputError, match=r"a cell of heights.stairs\[0\]") as caught:
        make_heights(grid_of("..."), 10, (), (one, one))
    assert caught.value.key == "heights.stairs[1]"


def test_a_flight_with_several_floors_before_it_is_refused() -> None:
    wide = Stairs((1, 0, 2, 2), Direction.EAST, 1, 0.15, 0.4, 0.3)
    with pytest.raises(InputError, match=r"floor before the lower edge has several heights, 0, 0\.2 m") as caught:
        make_heights(grid_of("... ..."), 10, (Floor(((0, 0, 1, 1),), 0.2),), (wide,))
    assert caught.value.key == "heights.stairs[0]"


@pytest.mark.parametrize(
    ("rectangles", "height_m", "message"),
    [
        (((0, 0, 0.5, 1),), 0.3, r"flat cell \(0, 0\) .* several heights, 0, 0.3 m"),
        (((1.4, 0.4, 1.6, 0.6),), 0.3, r"flat cell \(0, 1\)"),
        (((0, 0, 0, 1),), 0.3, "no area"),
        (((0, 0, math.inf, 1),), 0.3, "four finite numbers"),
        (((0, 0, 1, 1),), math.nan, "height"),
    ],
)
def test_bad_floors_are_refused(rectangles: tuple[Rectangle, ...], height_m: float, message: str) -> None:
    good = Floor(((2, 0, 3, 1),), 0.5)
    with pytest.raises(InputError, match=message) as caught:
        make_heights(grid_of("..."), 10, (good, Floor(rectangles, height_m)))
    assert caught.value.key == "heights.floors[1]"


def test_overlapping_floors_of_two_heights_are_refused() -> None:
    floors = Floor(((0, 0, 1, 1),), 0.1), Floor(((0, 0, 1, 1),), 0.2)
    with pytest.raises(InputError, match=r"several heights, 0\.1, 0\.2 m"):
        make_heights(grid_of("."), 10, floors)


def test_floors_only_matter_where_the_robot_can_be() -> None:
    floors = (Floor(((0, 0, 1.5, 1),), 0.3),)
    assert make_heights(grid_of(".#."), 10, floors).base_m[0, 0] == 0.3


def test_fine_cells_have_to_be_positive() -> None:
    with pytest.raises(InputError) as caught:
        make_heights(grid_of("."), 0)
    assert caught.value.key == "walking.fine_cells"

"""The coarse grid: frames, cells, and which of them are free."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from world_scenes import CELL_M, SCENES, SHARED, TWO_ROOMS, grid_of, map_like, map_of, signs

from surefoot.errors import InputError
from surefoot.frames import Cell
from surefoot.world import CoarseGrid, OccupancyMap, Rectangle, make_grid, read_occupancy_map

ANGLES = st.one_of(st.sampled_from([0.0, math.pi / 2, -math.pi, 0.3]), st.floats(-7, 7))


def coordinates(most: float) -> st.SearchStrategy[tuple[float, float]]:
    return st.tuples(st.floats(-most, most), st.floats(-most, most))


@st.composite
def maps(draw: st.DrawFn) -> OccupancyMap:
    rows, columns = draw(st.integers(4, 12)), draw(st.integers(4, 12))
    pixels = draw(st.lists(st.sampled_from("...?#"), min_size=rows * columns, max_size=rows * columns))
    drawn = np.array(pixels).reshape(rows, columns)
    return map_of(
        drawn == "#",
        unknown=drawn == "?",
        resolution_m=draw(st.sampled_from([0.05, 0.37, 1.0])),
        origin_m=draw(coordinates(20)),
        yaw_rad=draw(ANGLES),
    )


@st.composite
def grids(draw: st.DrawFn) -> CoarseGrid:
    occupancy = draw(maps())
    # A larger cell may not fit into a turned map of four pixels.
    size_m = occupancy.resolution_m * draw(st.sampled_from([0.7, 1.0, 1.4]))
    return make_grid(occupancy, cell_size_m=size_m, origin_m=draw(coordinates(20)), rotation_rad=draw(ANGLES))


def free(occupancy: OccupancyMap, **choices: object) -> NDArray[np.bool_]:
    return make_grid(occupancy, **choices).free  # type: ignore[arg-type]


@pytest.mark.parametrize("scale", [1, 10])
def test_walls_on_cell_borders_block_only_their_own_cells(scale: int) -> None:
    walls = signs(TWO_ROOMS)
    pixels = np.kron(walls, np.ones((scale, scale), np.bool_))
    grid = make_grid(map_of(pixels, resolution_m=CELL_M / scale), cell_size_m=CELL_M)
    assert np.array_equal(grid.free, ~walls)
    assert len(grid.free_cells()) == 34
    assert grid.north_west_m == pytest.approx((0, 7 * CELL_M))


@pytest.mark.parametrize("quarters", [1, 2, 3])
def test_quarter_turns_of_map_and_grid_give_the_same_cells(quarters: int) -> None:
    walls = signs(TWO_ROOMS)
    turned = make_grid(map_of(walls), cell_size_m=1, rotation_rad=quarters * math.pi / 2)
    assert np.array_equal(turned.free, np.rot90(~walls, -quarters))
    back = map_of(walls, yaw_rad=quarters * math.pi / 2, origin_m=(3, -2))
    assert np.array_equal(free(back, cell_size_m=1, rotation_rad=quarters * math.pi / 2), ~walls)


def test_the_shipped_two_room_map_is_the_scene() -> None:
    grid = make_grid(read_occupancy_map(SCENES / "two_rooms.yaml"), cell_size_m=CELL_M)
    assert np.array_equal(grid.free, ~signs(TWO_ROOMS))
    assert grid.cell_at((22.97984, 6.75877)) == Cell(4, 8) == grid.cell(56)


def test_a_pixel_touches_or_meets() -> None:
    pixels = np.zeros((40, 40), np.bool_)
    pixels[19, 20] = True  # x in 2.0 .. 2.1, y in 2.0 .. 2.1
    occupancy = map_of(pixels, resolution_m=0.1)
    assert list(zip(*np.nonzero(~free(occupancy, cell_size_m=1)), strict=True)) == [(1, 2)]
    assert free(occupancy, cell_size_m=1, origin_m=(0.100002, 0)).sum() == 11  # two blocked, one column less
    assert free(occupancy, cell_size_m=1, origin_m=(0.1, 0)).sum() == 11
    assert free(occupancy, cell_size_m=1, origin_m=(0.0999, 0)).sum() == 10


def test_inflation_is_euclidean() -> None:
    pixels = np.zeros((5, 5), np.bool_)
    pixels[2, 2] = True
    occupancy = map_of(pixels)

    def blocked(reach_m: float) -> int:
        return int((~free(occupancy, cell_size_m=1, inflation_m=reach_m)).sum())

    reaches = [0, 1e-3, 1, 1.001, math.sqrt(2), 1.4143, 10]
    assert [blocked(reach) for reach in reaches] == [1, 9, 9, 21, 21, 25, 25]


def test_a_turned_cell_is_tested_by_its_true_square() -> None:
    pixels = np.zeros((9, 9), np.bool_)
    pixels[4, 7] = True
    occupancy = map_of(pixels, origin_m=(-4.5, -4.5))  # the pixel spans x 2.5 .. 3.5, y -0.5 .. 0.5
    side = 2 * math.sqrt(2)  # the diamond about (x, 0) reaches 2 m to the east

    def is_free(x: float, reach_m: float = 0.0) -> bool:
        grid = make_grid(
            occupancy,
            cell_size_m=side,
            origin_m=(x, -2.0),
            rotation_rad=math.pi / 4,
            inflation_m=reach_m,
        )
        cell = grid.cell_at((x, 0))
        assert cell is not None
        assert grid.center_m(cell) == pytest.approx((x, 0))
        return grid.is_free(cell)

    assert is_free(0.4999)
    assert not is_free(0.5001)
    assert is_free(0.4, 0.0999)
    assert not is_free(0.4, 0.1001)


def square(corner_m: NDArray[np.float64], side_m: float, yaw_rad: float) -> NDArray[np.float64]:
    """Return the vertices of a square that is turned about its lower-left corner."""
    ahead = side_m * np.array([math.cos(yaw_rad), math.sin(yaw_rad)])
    left = side_m * np.array([-math.sin(yaw_rad), math.cos(yaw_rad)])
    return np.array([corner_m, corner_m + ahead, corner_m + ahead + left, corner_m + left])


def distance_m(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """Return how far two squares are apart, negative when they overlap (by how much)."""
    gaps = []
    for sides in (one[1] - one[0], one[3] - one[0], other[1] - other[0], other[3] - other[0]):
        axis = sides / np.hypot(*sides)
        gaps.append(max((other @ axis).min() - (one @ axis).max(), (one @ axis).min() - (other @ axis).max()))
    if max(gaps) <= 0:
        return float(max(gaps))
    apart = math.inf
    for points, corners in ((one, other), (other, one)):
        for begin, end in zip(corners, np.roll(corners, 1, axis=0), strict=True):
            share = np.clip((points - begin) @ (end - begin) / ((end - begin) @ (end - begin)), 0, 1)
            apart = min(apart, np.hypot(*(points - begin - share[:, np.newaxis] * (end - begin)).T).min())
    return apart


@settings(max_examples=60, deadline=None)
@given(maps(), st.floats(0.6, 3), coordinates(20), ANGLES, st.sampled_from([0.0, 0.4, 2.3]))
def test_free_agrees_with_distances_between_squares(
    occupancy: OccupancyMap, cells: float, origin_m: tuple[float, float], rotation_rad: float, reach: float
) -> None:
    pixel_m, yaw_rad = occupancy.resolution_m, occupancy.yaw_rad
    choices = {"cell_size_m": cells * pixel_m, "origin_m": origin_m, "rotation_rad": rotation_rad}
    try:
        whole = make_grid(map_like(occupancy, np.zeros_like(occupancy.occupied)), **choices)  # type: ignore[arg-type]
    except InputError:
        return
    grid = make_grid(occupancy, unknown="free", inflation_m=reach * pixel_m, **choices)  # type: ignore[arg-type]
    last = occupancy.occupied.shape[0] - 1
    frame = square(np.array(occupancy.origin_m), pixel_m, yaw_rad)
    steps = np.stack((frame[1] - frame[0], frame[3] - frame[0]))
    pixels = [
        square(frame[0] + np.array([column, last - row]) @ steps, pixel_m, yaw_rad)
        for row, column in np.argwhere(occupancy.occupied)
    ]
    assert grid.north_west_m == whole.north_west_m
    assert not grid.free[~whole.free].any()
    for cell in whole.free_cells():
        vertices = square(np.array(grid.corner_m(Cell(cell.row + 1, cell.column))), grid.cell_size_m, rotation_rad)
        nearest = min((distance_m(vertices, pixel) for pixel in pixels), default=math.inf)
        if abs(nearest - reach * pixel_m) > 1e-5:
            assert grid.is_free(cell) == (nearest > reach * pixel_m)


@settings(max_examples=60, deadline=None)
@given(maps(), ANGLES, st.floats(0, 3), st.floats(0, 3))
def test_more_inflation_blocks_more(occupancy: OccupancyMap, rotation_rad: float, one: float, other: float) -> None:
    size_m = 1.3 * occupancy.resolution_m
    less, more = (
        free(occupancy, cell_size_m=size_m, rotation_rad=rotation_rad, inflation_m=reach * occupancy.resolution_m)
        for reach in sorted((one, other))
    )
    assert not (more & ~less).any()


@settings(max_examples=60, deadline=None)
@given(maps(), ANGLES)
def test_unknown_pixels_only_ever_block(occupancy: OccupancyMap, rotation_rad: float) -> None:
    size_m = 1.3 * occupancy.resolution_m
    strict = free(occupancy, cell_size_m=size_m, rotation_rad=rotation_rad)
    lenient = free(occupancy, cell_size_m=size_m, rotation_rad=rotation_rad, unknown="free")
    assert not (strict & ~lenient).any()


@settings(max_examples=60, deadline=None)
@given(grids(), coordinates(30))
def test_frames_are_each_others_inverse(grid: CoarseGrid, point_m: tuple[float, float]) -> None:
    assert grid.to_world(grid.to_grid(point_m)) == pytest.approx(point_m, abs=1e-9)
    assert grid.to_grid(grid.to_world([point_m, (0, 0)]))[0] == pytest.approx(point_m, abs=1e-9)
    assert grid.to_world((0, 0)) == pytest.approx(grid.origin_m)
    ahead = grid.to_world((1, 0)) - grid.to_world((0, 0))
    assert ahead == pytest.approx((math.cos(grid.rotation_rad), math.sin(grid.rotation_rad)), abs=1e-9)


@settings(max_examples=60, deadline=None)
@given(grids())
def test_every_cell_holds_its_centre(grid: CoarseGrid) -> None:
    for number in range(grid.rows * grid.columns):
        cell = grid.cell(number)
        assert grid.index(cell) == number
        assert grid.cell_at(grid.center_m(cell)) == cell
        corner, center = grid.to_grid(grid.corner_m(cell)), grid.to_grid(grid.center_m(cell))
        assert center - corner == pytest.approx((grid.cell_size_m / 2, -grid.cell_size_m / 2))
        lattice = corner / grid.cell_size_m
        assert lattice == pytest.approx(np.round(lattice), abs=1e-6)


def test_the_lattice_is_anchored_at_the_origin_in_all_directions() -> None:
    occupancy = map_of(np.zeros((10, 10), np.bool_), origin_m=(-4.5, -4.5))
    grid = make_grid(occupancy, cell_size_m=2, origin_m=(0.5, 0.5))
    assert (grid.rows, grid.columns) == (4, 4)
    assert grid.north_west_m == pytest.approx((-4, 4))
    points: list[tuple[float, float]] = [(0.6, 0.6), (0.4, 0.4), (-4.4, 0), (math.nan, 0)]
    assert [grid.cell_at(point) for point in points] == [(1, 2), (2, 1), None, None]


def test_a_cell_owns_its_northern_and_western_border() -> None:
    grid = grid_of(".. ..")
    points: list[tuple[float, float]] = [(1, 1), (0, 2), (2, 1), (1, 0)]
    assert [grid.cell_at(point) for point in points] == [(1, 1), (0, 0), None, None]


def test_cells_not_wholly_on_the_picture_are_blocked() -> None:
    occupancy = map_of(np.zeros((20, 20), np.bool_), origin_m=(-10, -10))
    grid = make_grid(occupancy, cell_size_m=2, rotation_rad=math.pi / 4)
    assert not grid.free[0, 0]
    assert grid.free.any(axis=0).all()
    assert grid.free.any(axis=1).all()
    for cell in grid.free_cells():
        corners = grid.to_world(grid.to_grid(grid.center_m(cell)) + np.array([[1, 1], [1, -1], [-1, 1], [-1, -1]]))
        assert np.abs(corners).max() <= 10


def test_off_the_grid_nothing_is_free() -> None:
    grid = grid_of("..# ...")
    assert not grid.is_free(Cell(-1, 0))
    assert not grid.has(Cell(0, 3))
    assert not grid.is_free(Cell(0, 2))
    assert grid.free_cells() == (Cell(0, 0), Cell(0, 1), Cell(1, 0), Cell(1, 1), Cell(1, 2))


@pytest.mark.parametrize(
    ("rectangle", "whole", "centered"),
    [
        ((0, 0, 2, 2), {(1, 0), (1, 1), (2, 0), (2, 1)}, {(1, 0), (1, 1), (2, 0), (2, 1)}),
        ((2, 2, 0, 0), {(1, 0), (1, 1), (2, 0), (2, 1)}, {(1, 0), (1, 1), (2, 0), (2, 1)}),
        ((0.009, 0, 1, 0.991), {(2, 0)}, {(2, 0)}),
        ((0.011, 0, 1, 1), set(), {(2, 0)}),
        ((0.5, 0.5, 1.4, 0.5), set(), {(2, 0)}),
        ((-9, 2, 9, 9), {(0, 0), (0, 1), (0, 2)}, {(0, 0), (0, 1), (0, 2)}),
        ((5, 5, 9, 9), set(), set()),
    ],
)
def test_rectangles(rectangle: Rectangle, whole: set[Cell], centered: set[Cell]) -> None:
    grid = grid_of("... .#. ...")
    assert grid.wholly_inside(rectangle) == whole
    assert grid.centered_in(rectangle) == centered


def test_rectangles_are_parallel_to_a_turned_grid() -> None:
    occupancy = map_of(np.zeros((20, 20), np.bool_), origin_m=(-10, -10))
    grid = make_grid(occupancy, cell_size_m=2, rotation_rad=0.6)
    x0, y0 = grid.to_world((-2, -4))
    x1, y1 = grid.to_world((2, 0))
    cells = grid.wholly_inside((float(x0), float(y0), float(x1), float(y1)))
    assert len(cells) == 4
    assert {tuple(np.round(grid.to_grid(grid.center_m(cell))).astype(int)) for cell in cells} == {
        (-1, -3), (-1, -1), (1, -3), (1, -1),
    }  # fmt: skip


@pytest.mark.parametrize(
    ("choices", "key"),
    [
        ({"cell_size_m": 0}, "grid.cell_size_m"),
        ({"cell_size_m": math.nan}, "grid.cell_size_m"),
        ({"cell_size_m": 11}, "grid.cell_size_m"),
        ({"cell_size_m": 1, "origin_m": (math.inf, 0)}, "grid.origin_m"),
        ({"cell_size_m": 1, "origin_m": (1e12, 0)}, "grid.origin_m"),
        ({"cell_size_m": 1, "rotation_rad": math.nan}, "grid.rotation_rad"),
        ({"cell_size_m": 1, "unknown": "maybe"}, "grid.unknown"),
        ({"cell_size_m": 1, "inflation_m": -1}, None),
        ({"cell_size_m": 1, "inflation_m": math.nan}, None),
        ({"cell_size_m": 0.01}, "grid.cell_size_m"),
    ],
)
def test_bad_values_are_refused(choices: dict[str, object], key: str | None) -> None:
    occupancy = map_of(np.zeros((10, 10) if choices["cell_size_m"] != 0.01 else (30, 30), np.bool_))
    with pytest.raises(InputError) as caught:
        make_grid(occupancy, **choices)  # type: ignore[arg-type]
    assert caught.value.key == key


@pytest.mark.skipif(not SHARED.is_dir(), reason="../shared/data is absent")
def test_maps_of_the_field() -> None:
    depot = read_occupancy_map(SHARED / "maps" / "depot.yaml")
    grid = make_grid(depot, cell_size_m=1, origin_m=(-7.14, -7.83 + 307 * 0.05))
    assert (grid.rows, grid.columns, len(grid.free_cells())) == (15, 30, 315)
    sandbox = read_occupancy_map(SHARED / "maps" / "tb3_sandbox.yaml")
    assert free(sandbox, cell_size_m=1).sum() == 0
    assert free(sandbox, cell_size_m=1, unknown="free").sum() == 329

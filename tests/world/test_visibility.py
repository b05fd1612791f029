"""Lines of sight between cells."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from world_scenes import CELL_M, TWO_ROOMS, grid_of

from surefoot.errors import InputError
from surefoot.frames import Cell
from surefoot.world import CoarseGrid, visible_pairs


@st.composite
def drawings(draw: st.DrawFn) -> str:
    rows, columns = draw(st.integers(1, 6)), draw(st.integers(1, 7))
    return "\n".join("".join(draw(st.sampled_from("...#")) for _ in range(columns)) for _ in range(rows))


def sees(grid: CoarseGrid, viewer: tuple[int, int], seen: tuple[int, int], corners: str = "visible") -> bool:
    pairs = visible_pairs(grid, 100, corners)
    return bool(pairs[grid.index(Cell(*viewer)), grid.index(Cell(*seen))])


def clear(grid: CoarseGrid, viewer: Cell, seen: Cell, grazed: bool) -> bool:
    """Clip the segment to every blocked square in fractions."""
    start = (Fraction(2 * viewer.row + 1, 2), Fraction(2 * viewer.column + 1, 2))
    step = (seen.row - viewer.row, seen.column - viewer.column)
    for blocked in np.argwhere(~grid.free).tolist():
        low, high, off = Fraction(0), Fraction(1), False
        for begin, along, edge in zip(start, step, blocked, strict=True):
            if along == 0:
                off = off or (not edge <= begin <= edge + 1 if grazed else not edge < begin < edge + 1)
                continue
            ends = sorted(((edge - begin) / along, (edge + 1 - begin) / along))
            low, high = max(low, ends[0]), min(high, ends[1])
        if not off and (low <= high if grazed else low < high):
            return False
    return True


@settings(max_examples=60, deadline=None)
@given(drawings(), st.sampled_from(["visible", "hidden"]), st.floats(0, 9))
def test_agrees_with_clipping_in_fractions(drawing: str, corners: str, range_m: float) -> None:
    grid = grid_of(drawing)
    pairs = visible_pairs(grid, range_m, corners)
    for one in (grid.cell(number) for number in range(grid.rows * grid.columns)):
        for other in (grid.cell(number) for number in range(grid.rows * grid.columns)):
            apart = np.hypot(one.row - other.row, one.column - other.column)
            if abs(apart - range_m) < 1e-6:
                continue
            expected = grid.is_free(one) and grid.is_free(other) and bool(apart <= range_m)
            expected = expected and clear(grid, one, other, corners == "hidden")
            assert pairs[grid.index(one), grid.index(other)] == expected


@settings(max_examples=60, deadline=None)
@given(drawings(), st.floats(0, 9))
def test_symmetric_reflexive_and_hidden_corners_hide(drawing: str, range_m: float) -> None:
    grid = grid_of(drawing)
    pairs = visible_pairs(grid, range_m)
    assert np.array_equal(pairs, pairs.T)
    assert np.array_equal(np.diag(pairs), grid.free.ravel())
    assert not (visible_pairs(grid, range_m, "hidden") & ~pairs).any()


def test_a_grazed_corner() -> None:
    grid = grid_of(".# ..")
    assert sees(grid, (0, 0), (1, 1))
    assert not sees(grid, (0, 0), (1, 1), "hidden")
    assert sees(grid, (0, 0), (1, 0), "hidden")


def test_between_two_corners_that_touch() -> None:
    grid = grid_of(".# #.")
    assert sees(grid, (0, 0), (1, 1))
    assert not sees(grid, (0, 0), (1, 1), "hidden")


def test_a_knights_move() -> None:
    assert not sees(grid_of(".#. ..."), (0, 0), (1, 2))
    assert sees(grid_of("..# ..."), (0, 0), (1, 2))
    assert sees(grid_of("..# ..."), (0, 0), (1, 2), "hidden")
    grid = grid_of("..#.. .....")
    assert not sees(grid, (0, 0), (1, 4))
    assert not sees(grid, (0, 0), (0, 4))
    assert sees(grid, (1, 0), (1, 4), "hidden")


def test_range_is_between_centres_and_includes_its_end() -> None:
    grid = grid_of(".....", 0.7)
    assert visible_pairs(grid, 2.1)[0].tolist() == [True] * 4 + [False]
    assert visible_pairs(grid, 2.1 - 1e-6)[0].sum() == 3
    assert visible_pairs(grid, 0)[0].sum() == 1
    assert visible_pairs(grid, float("inf")).all()


def test_two_rooms() -> None:
    grid = grid_of(TWO_ROOMS, CELL_M)
    pairs = visible_pairs(grid, 10.82)
    assert np.array_equal(pairs, pairs.T)
    seen = {number: set(np.flatnonzero(pairs[number]).tolist()) for number in map(grid.index, grid.free_cells())}
    assert 53 not in seen[50]  # the platform 51, 52 hides what is behind it
    assert 42 in seen[38]
    assert 42 not in seen[37]  # five cells away, the range is four
    upper = {20, 21, 22, 32, 33, 34, 44, 45, 46, 56, 57, 58}
    assert seen[57] == upper | {31}  # past the corner of the wall, 43
    assert {28, 29, 30, 31, 32, 33, 34} <= seen[32]
    hidden = visible_pairs(grid, 10.82, "hidden")
    assert set(np.flatnonzero(hidden[57]).tolist()) == upper
    assert not (hidden & ~pairs).any()
    assert (int(pairs.sum()), int(hidden.sum())) == (460, 404)


@pytest.mark.parametrize(
    ("range_m", "corners", "key"),
    [(-1, "visible", "sensor.range_m"), (float("nan"), "visible", "sensor.range_m"), (1, "both", "navigation.corners")],
)
def test_bad_values_are_refused(range_m: float, corners: str, key: str) -> None:
    with pytest.raises(InputError) as caught:
        visible_pairs(grid_of(".."), range_m, corners)
    assert caught.value.key == key


def test_too_many_cells_are_refused() -> None:
    with pytest.raises(InputError, match="at most 20,000"):
        visible_pairs(grid_of(" ".join(["." * 150] * 150)), 3)

from __future__ import annotations

import math
from collections.abc import Sequence

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surefoot.errors import InputError
from surefoot.footholds.terrain import polygon
from surefoot.skills.classes import class_set
from surefoot.skills.grid import LocalGrid, requests_of, terrain_set
from surefoot.skills.quadruped_terrain import QuadrupedTerrain
from surefoot.skills.terrains import generated
from surefoot.skills.values import OBSTACLE, TerrainState

SIDE = 0.8


def plates(heights: Sequence[Sequence[float | None]], grid: tuple[int, int] = (3, 3)) -> QuadrupedTerrain:
    """Return a map of level cells; rows from ahead to behind, None for nothing."""
    rules = class_set("unstructured-8")
    rows, columns = len(heights), len(heights[0])
    bare = QuadrupedTerrain("plates", "go2", rules, SIDE, grid, (0.0, 0.0), (rows, columns), (), 0.0)
    squares = [
        polygon(bare.square_m((r, c)).corners(height))
        for r in range(rows)
        for c in range(columns)
        if (height := heights[r][c]) is not None
    ]
    return QuadrupedTerrain("plates", "go2", rules, SIDE, grid, (0.0, 0.0), (rows, columns), tuple(squares), 0.0)


def column(terrain: QuadrupedTerrain, row: int) -> list[str]:
    return [labels[1] for labels in LocalGrid(terrain, terrain.centre_m((row, 1))).labels]


def test_heights_are_relative_to_where_the_robot_stands() -> None:
    terrain = plates([[0.24] * 3, [0.12] * 3, [0.12] * 3, [0.0] * 3, [0.0] * 3])
    assert column(terrain, 4) == ["flat", "flat", OBSTACLE]  # what lies behind is outside of the map
    assert column(terrain, 3) == ["high", "flat", "flat"]
    assert column(terrain, 2) == ["flat", "flat", "low"]
    assert column(terrain, 1) == ["high", "flat", "flat"]


def test_a_raised_neighbour_that_is_too_high_is_an_obstacle() -> None:
    assert column(plates([[0.2] * 3, [0.0] * 3, [0.0] * 3]), 1) == [OBSTACLE, "flat", "flat"]


def test_row_0_is_ahead_and_column_0_is_left() -> None:
    terrain = plates([[None, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.12]])
    labels = LocalGrid(terrain, terrain.centre_m((1, 1))).labels
    assert labels == ((OBSTACLE, "flat", "flat"), ("flat",) * 3, ("flat", "flat", "high"))
    x, y = terrain.centre_m((0, 0))
    assert x > terrain.centre_m((2, 0))[0]
    assert y > terrain.centre_m((0, 2))[1]


def test_turning_the_robot_turns_the_labels() -> None:
    terrain = plates([[None, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.12]])
    labels = LocalGrid(terrain, terrain.centre_m((1, 1))).labels
    facing_left = LocalGrid(terrain, terrain.centre_m((1, 1)), 1).labels
    assert facing_left == tuple(tuple(labels[2 - c][r] for c in range(3)) for r in range(3))
    assert facing_left[0][2] == OBSTACLE  # ahead and to the left lies now ahead and to the right
    assert LocalGrid(terrain, terrain.centre_m((1, 1)), 4).labels == labels


def test_turning_on_rebar_swaps_across_and_along() -> None:
    terrain = generated("rebar-14", 1)
    rules = terrain.classes
    centre = terrain.centre_m((4, 4))
    ahead, left = LocalGrid(terrain, centre).labels, LocalGrid(terrain, centre, 1).labels
    expected = tuple(tuple(rules.turned(ahead[2 - c][r], 1) for c in range(3)) for r in range(3))
    assert left == expected
    assert any(rules.turned(label, 1) != label for row in ahead for label in row)


@settings(max_examples=200, deadline=None)
@given(
    dx=st.floats(-1.19, 1.19),
    dy=st.floats(-1.19, 1.19),
    request_dx=st.floats(-1.19, 1.19),
    request_dy=st.floats(-1.19, 1.19),
    turns=st.integers(0, 3),
)
def test_grounding_and_its_inverse(dx: float, dy: float, request_dx: float, request_dy: float, turns: int) -> None:
    grid = LocalGrid(FIELD, FIELD.centre_m((2, 2)), turns)
    x, y = grid.centre_m
    robot, request = (x + dx, y + dy), (x + request_dx, y + request_dy)
    symbols = grid.abstract(robot, request)
    assert grid.holds(symbols, robot, request)
    assert grid.cell_at(grid.place_m(symbols.robot)) == symbols.robot
    others = [cell for cell in symbols.terrain.cells() if cell != symbols.robot]
    px, py = grid.place_m(symbols.robot)
    inside = max(abs(px - robot[0]), abs(py - robot[1])) < SIDE / 2 - 1e-6
    assert not inside or not any(_holds(grid, cell, robot) for cell in others)


FIELD = plates([[0.0] * 5 for _ in range(5)])


def _holds(grid: LocalGrid, cell: tuple[int, int], place: tuple[float, float]) -> bool:
    square = grid.square_m(cell)
    return square.west < place[0] < square.east and square.south < place[1] < square.north


def test_places_outside_of_the_grid_are_refused() -> None:
    grid = LocalGrid(FIELD, FIELD.centre_m((2, 2)))
    with pytest.raises(InputError, match="outside of the 3 x 3 grid"):
        grid.cell_at((FIELD.centre_m((2, 2))[0] + 1.3, 0.0))
    with pytest.raises(InputError, match="outside of the map"):
        FIELD.cell_at((9.0, 0.0))


def test_the_sweep_of_a_field_holds_every_way_of_being_near_a_side() -> None:
    states = terrain_set(FIELD)
    assert len(states.states) == 9
    assert len(set(states.states)) == 9
    open_field = TerrainState((("flat",) * 3,) * 3)
    assert open_field in states.states
    assert states.requests(open_field) == ((0, 0), (0, 1), (0, 2), (2, 0), (2, 2))
    ahead_is_outside = TerrainState(((OBSTACLE,) * 3, ("flat",) * 3, ("flat",) * 3))
    assert states.requests(ahead_is_outside) == ((2, 0), (2, 2))
    assert len(states.pairs()) == sum(len(requests_of(state)) for state in states.states)


def test_larger_grids_have_more_requests() -> None:
    wide = TerrainState((("flat",) * 5,) * 5)
    assert len(requests_of(wide)) == 7
    assert len(terrain_set(plates([[0.0] * 6] * 6, (5, 5))).states) == 25


def test_cells_where_the_robot_cannot_stand_are_left_out() -> None:
    holed = plates([[0.0, 0.0, 0.0], [0.0, None, 0.0], [0.0, 0.0, 0.0]])
    assert all(state.label(state.centre) != OBSTACLE for state in terrain_set(holed).states)
    with pytest.raises(InputError, match=r"own cell, about \(1.2, 1.2\), is an obstacle"):
        _ = LocalGrid(holed, holed.centre_m((1, 1))).state


def test_between_two_cells_the_ground_is_measured_anew() -> None:
    half = LocalGrid(FIELD, (FIELD.centre_m((2, 2))[0] + 0.3, FIELD.centre_m((2, 2))[1] - 0.25))
    assert half.state == TerrainState((("flat",) * 3,) * 3)
    x, y = FIELD.centre_m((0, 2))
    assert LocalGrid(FIELD, (x + 0.2, y)).labels[0] == (OBSTACLE,) * 3
    assert math.isclose(half.place_m((1, 1))[0], half.centre_m[0])

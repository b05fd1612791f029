"""Starting scenarios for maps."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from surefoot.errors import InputError, LimitExceeded
from surefoot.frames import Cell, Direction
from surefoot.missions._init_layout import distances, lay_out, looping_cells, quarters, square
from surefoot.missions.scenario.file import read_scenario
from surefoot.missions.scenario_init import init_scenario
from surefoot.world import CoarseGrid, make_grid, read_occupancy_map

SIZE_M = 2.70351


def write_map(folder: Path, rows: list[str], *, yaw_rad: float = 0.0, shift: int = 0) -> Path:
    """Write a map with ten pixels a cell, ``shift`` further pixels of wall around, and return its YAML file."""
    pixels = np.array([[0 if sign == "#" else 254 for sign in row] for row in rows], np.uint8)
    pixels = np.pad(np.kron(pixels, np.ones((10, 10), np.uint8)), shift)
    header = f"P5\n{pixels.shape[1]} {pixels.shape[0]}\n255\n".encode()
    (folder / "m.pgm").write_bytes(header + pixels.tobytes())
    (folder / "m.yaml").write_text(
        f"image: m.pgm\nmode: trinary\nresolution: {SIZE_M / 10}\norigin: [-3.0, 2.0, {yaw_rad}]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.25\n"
    )
    return folder / "m.yaml"


HALL = ["#######", "#.....#", "#.#.#.#", "#.....#", "#.....#", "#######"]
RING = ["######", "#....#", "#.##.#", "#....#", "######"]


@pytest.fixture
def planned(monkeypatch: pytest.MonkeyPatch) -> Callable[[list[bool]], list[str]]:
    """Let planning answer as told, and return the scenarios that it was asked about."""
    asked: list[str] = []

    def prepare(answers: list[bool]) -> list[str]:
        class Answer:
            def __init__(self, realizable: bool) -> None:
                self.realizable = realizable

        def plan(path: Path, *_: object, **__: object) -> Answer:
            asked.append(path.read_text())
            read_scenario(path)
            return Answer(answers[len(asked) - 1])

        monkeypatch.setattr("surefoot.missions.plans.planning.plan_mission", plan)
        return asked

    return prepare


def test_the_tutorial_map_gets_a_scenario_with_a_plan(scenes: Path, tmp_path: Path) -> None:
    made = init_scenario(scenes / "tutorial.yaml", tmp_path / "my.yaml")
    assert made.checked is True
    assert any("--cell-size 2.7" in note and "22 would be free" in note for note in made.notes)
    scenario = read_scenario(made.scenario)
    assert scenario.map_path.resolve() == (scenes / "tutorial.yaml").resolve()
    assert len(scenario.goals) == 2


def test_belief_regions_may_cover_blocked_cells(tmp_path: Path) -> None:
    made = init_scenario(write_map(tmp_path, HALL), tmp_path / "my.yaml")
    assert len(read_scenario(made.scenario).belief_regions) > 1
    assert made.checked is True


@pytest.mark.parametrize(("yaw_rad", "shift"), [(0.0, 0), (0.0, 3), (0.7, 4)])
def test_the_grid_is_found_wherever_the_map_lies(
    yaw_rad: float, shift: int, tmp_path: Path, planned: Callable[[list[bool]], list[str]]
) -> None:
    planned([True])
    made = init_scenario(write_map(tmp_path, RING, yaw_rad=yaw_rad, shift=shift), tmp_path / "my.yaml")
    scenario = read_scenario(made.scenario)
    occupancy = read_occupancy_map(scenario.map_path)
    grid = make_grid(
        occupancy,
        cell_size_m=SIZE_M,
        origin_m=scenario.grid.origin_m,
        rotation_rad=scenario.grid.rotation_rad,
    )
    assert scenario.grid.rotation_rad == yaw_rad
    assert len(looping_cells(grid)) == 10
    places = [scenario.start.position_m, *(goal.position_m for goal in scenario.goals)]
    cells = [grid.cell_at(place) for place in places]
    assert len(set(cells)) == 3
    assert all(cell is not None and grid.is_free(cell) for cell in cells)


def test_obstacles_are_tamed_until_there_is_a_plan(tmp_path: Path, planned: Callable[[list[bool]], list[str]]) -> None:
    asked = planned([False, False, True])
    made = init_scenario(write_map(tmp_path, RING), tmp_path / "my.yaml")
    assert len(asked) == 3
    assert made.obstacle
    assert made.checked is True
    scenario = read_scenario(made.scenario)
    assert scenario.obstacles[0].forbidden
    assert "# The obstacle keeps off start, goals and the cells beside them" in made.scenario.read_text()
    assert made.notes


def test_at_last_there_is_no_obstacle(tmp_path: Path, planned: Callable[[list[bool]], list[str]]) -> None:
    planned([False] * 4)
    made = init_scenario(write_map(tmp_path, RING), tmp_path / "my.yaml")
    assert (made.obstacle, made.checked) == (False, False)
    assert "# There is no obstacle" in made.scenario.read_text()
    assert read_scenario(made.scenario).obstacles == ()


def test_what_takes_too_long_is_left_open(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def plan(*_: object, **__: object) -> None:
        raise LimitExceeded("too long")

    monkeypatch.setattr("surefoot.missions.plans.planning.plan_mission", plan)
    made = init_scenario(write_map(tmp_path, RING), tmp_path / "my.yaml")
    assert made.checked is None
    assert made.scenario.is_file()


@pytest.mark.parametrize(
    ("rows", "size_m", "complaint"),
    [
        (["######", "#....#", "######"], SIZE_M, "has 4 free cells of 2.70351 m, none of them on a loop"),
        (["####", "####", "####"], SIZE_M, "has 0 free cells"),
        (RING, 5.0, "smaller cells would do: --cell-size"),
        (RING, 0.5, "cell"),
    ],
)
def test_maps_without_loops_are_refused(rows: list[str], size_m: float, complaint: str, tmp_path: Path) -> None:
    path = write_map(tmp_path, rows)
    with pytest.raises(InputError, match=complaint):
        init_scenario(path, tmp_path / "my.yaml", cell_size_m=size_m)
    assert not (tmp_path / "my.yaml").exists()


def test_nothing_is_overwritten_unasked(tmp_path: Path, planned: Callable[[list[bool]], list[str]]) -> None:
    planned([True, True])
    path = write_map(tmp_path, RING)
    init_scenario(path, tmp_path / "my.yaml")
    with pytest.raises(InputError, match="exists already"):
        init_scenario(path, tmp_path / "my.yaml")
    init_scenario(path, tmp_path / "my.yaml", replace=True)
    with pytest.raises(InputError, match="has to end in"):
        init_scenario(path, tmp_path / "my.txt")


def grid_of(free: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]) -> CoarseGrid:
    rows, columns = free.shape
    return CoarseGrid(1.0, (0.0, 0.0), 0.0, rows, columns, (0.0, float(rows)), free)


grids = arrays(np.bool_, st.tuples(st.integers(1, 7), st.integers(1, 7))).map(grid_of)


@given(grids)
def test_loops_are_connected_free_and_without_dead_ends(grid: CoarseGrid) -> None:
    loops = looping_cells(grid)
    assert all(grid.is_free(cell) for cell in loops)
    assert all(sum(cell.neighbour(way) in loops for way in Direction) >= 2 for cell in loops)
    assert not loops or set(distances(min(loops), loops)) == loops
    assert len(loops) == 0 or len(loops) >= 4


@given(grids)
def test_places_are_apart_and_the_robot_faces_a_way_on(grid: CoarseGrid) -> None:
    loops = looping_cells(grid)
    if not loops:
        return
    layout = lay_out(grid, loops)
    assert len({layout.start, *layout.goals}) == 3
    assert layout.start.neighbour(layout.heading) in loops
    assert layout.obstacle not in (layout.start, *layout.goals)


@given(grids, st.data())
def test_quarters_are_disjoint_and_hold_every_cell(grid: CoarseGrid, data: st.DataObject) -> None:
    cells = grid.free_cells()
    if not cells:
        return
    parts = [grid.centered_in(area) for area in quarters(grid, cells)]
    assert set(cells) <= set().union(*parts)
    assert sum(map(len, parts)) == len(set().union(*parts))
    cell = data.draw(st.sampled_from(cells))
    assert grid.wholly_inside(square(grid, cell)) == {Cell(*cell)}


def test_the_distance_is_counted_in_moves() -> None:
    grid = grid_of(np.array([[sign == "." for sign in row] for row in RING]))
    cells = frozenset(grid.free_cells())
    assert distances(Cell(1, 1), cells)[Cell(3, 4)] == 5
    assert math.isclose(len(looping_cells(grid)), 10)

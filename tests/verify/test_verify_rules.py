"""The transcribed rules, piece by piece: golden cases, and brute force where there is an algebra."""

from __future__ import annotations

import math
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from surefoot.frames import Direction
from surefoot.verify.graphs import can_reach, components, cyclic, reached_from
from surefoot.verify.plan.moves import booked
from surefoot.verify.runs.footing import outside_m
from surefoot.verify.runs.motion import integrated, may_turn
from surefoot.verify.scene.derived import derive_scene
from surefoot.verify.scene.grid import disc_is_free, free_cells, lay_grid
from surefoot.verify.scene.scenario import read_scenario
from surefoot.verify.scene.sight import sight
from surefoot.world.occupancy import OccupancyMap


def test_turns_book_what_the_facts_say() -> None:
    cell = 2.70351 / 26
    turn_a = booked(tuple(length / cell for length in (0.40555, 0.28, 0.40555, 0.31194)))
    turn_b = booked(tuple(length / cell for length in (0.28, 0.36494, 0.28, 0.51991)))
    assert turn_a.tolist() == [[4, 1], [2, 2], [1, 4], [0, 3]]
    assert turn_b.tolist() == [[2, 1], [3, 3], [1, 2], [0, 5]]


@given(st.lists(st.floats(0.5, 6), min_size=1, max_size=9))
def test_bookings_never_part_from_the_true_position(lengths: list[float]) -> None:
    angles = [math.pi / 2 * (step + 1) / len(lengths) for step in range(len(lengths))]
    ahead = np.cumsum([length * math.cos(angle) for length, angle in zip(lengths, angles, strict=True)])
    aside = np.cumsum([length * math.sin(angle) for length, angle in zip(lengths, angles, strict=True)])
    gap = np.abs(np.cumsum(booked(tuple(lengths)), axis=0) - np.stack([ahead, aside], axis=1))
    assert gap.max() <= 0.5 + 1e-9


Edges = list[tuple[int, int]]
GRAPHS = st.integers(1, 9).flatmap(
    lambda n: st.tuples(st.just(n), st.lists(st.tuples(st.integers(0, n - 1), st.integers(0, n - 1)), max_size=20))
)


def reached(nodes: int, edges: Edges) -> NDArray[np.bool_]:
    """Return which node reaches which, in no or more steps."""
    matrix = np.eye(nodes, dtype=bool)
    for source, target in edges:
        matrix[source, target] = True
    for _ in range(nodes):
        matrix = matrix @ matrix
    return matrix


def rows(nodes: int, edges: Edges) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    first = np.cumsum([0, *(sum(source == node for source, _ in edges) for node in range(nodes))])
    targets = [target for node in range(nodes) for source, target in edges if source == node]
    return first.astype(np.int64), np.array(targets, np.int64)


@settings(deadline=None)
@given(GRAPHS)
def test_components_are_mutual_reachability(graph: tuple[int, Edges]) -> None:
    nodes, edges = graph
    first, targets = rows(nodes, edges)
    use = np.ones(len(targets), bool)
    component = components(first, targets, use)
    mutual = reached(nodes, edges) & reached(nodes, edges).T
    assert ((component[:, None] == component[None, :]) == mutual).all()
    loops = cyclic(first, targets, use, component)
    for node in range(nodes):
        on_loop = any(s == node and mutual[node, t] for s, t in edges) or mutual[node].sum() > 1
        assert loops[component[node]] == on_loop


@settings(deadline=None)
@given(GRAPHS, st.sets(st.integers(0, 8)))
def test_can_reach_is_backward_reachability(graph: tuple[int, Edges], goals: set[int]) -> None:
    nodes, edges = graph
    first, targets = rows(nodes, edges)
    wanted = np.array([node in goals for node in range(nodes)])
    expected = (reached(nodes, edges) & wanted[None, :]).any(axis=1)
    assert (can_reach(first, targets, wanted) == expected).all()


@settings(deadline=None)
@given(GRAPHS)
def test_reached_from_is_forward_reachability(graph: tuple[int, Edges]) -> None:
    nodes, edges = graph
    assert (reached_from(*rows(nodes, edges), 0) == reached(nodes, edges)[0]).all()


def hides(eye: tuple[int, int], target: tuple[int, int], wall: tuple[int, int], closed: bool) -> bool:
    """Clip the segment between two centres to a square, in exact fractions."""
    low, high = Fraction(0), Fraction(1)
    for axis in range(2):
        start, along = Fraction(2 * eye[axis] + 1, 2), Fraction(target[axis] - eye[axis])
        near, far = wall[axis] - start, wall[axis] + 1 - start
        if along == 0:
            if not (near <= 0 <= far if closed else near < 0 < far):
                return False
            continue
        ends = sorted((near / along, far / along))
        low, high = max(low, ends[0]), min(high, ends[1])
    return low <= high if closed else low < high


@settings(max_examples=60)
@given(st.integers(1, 5), st.integers(1, 5), st.data())
def test_sight_is_the_exact_segment_test(height: int, width: int, data: st.DataObject) -> None:
    flat = data.draw(st.lists(st.booleans(), min_size=height * width, max_size=height * width))
    range_m, closed = data.draw(st.sampled_from([0.5, 1.0, 1.5, 2.9, 9.0])), data.draw(st.booleans())
    free = np.array(flat).reshape(height, width)
    seen = sight(free, 1.0, range_m, closed)
    walls = [(int(r), int(c)) for r, c in np.argwhere(~free)]
    for eye in np.ndindex(height, width):
        for target in np.ndindex(height, width):
            expected = bool(free[eye] and free[target] and math.dist(eye, target) <= range_m + 1e-9)
            expected = expected and not any(hides(eye, target, wall, closed) for wall in walls)
            assert seen[eye[0] * width + eye[1], target[0] * width + target[1]] == expected


def picture(height: int, width: int, dots: list[tuple[int, int]], yaw_rad: float = 0.0) -> OccupancyMap:
    occupied = np.zeros((height, width), bool)
    for dot in dots:
        occupied[dot] = True
    return OccupancyMap(occupied, np.zeros_like(occupied), 0.1, (0.0, 0.0), yaw_rad, Path("map"), Path("map"))


def test_touching_an_occupied_pixel_is_no_meeting() -> None:
    floor = picture(20, 20, [(5, 10)])
    frame, on_map = lay_grid(floor, 1.0, (0.0, 0.0), 0.0)
    assert (frame.rows, frame.columns, frame.north_west_m) == (2, 2, (0.0, 2.0))
    assert free_cells(floor, frame, on_map, True, 0.0).tolist() == [[True, False], [True, True]]


def test_inflation_is_the_distance_of_squares() -> None:
    floor = picture(20, 20, [(5, 12)])
    frame, on_map = lay_grid(floor, 1.0, (0.0, 0.0), 0.0)
    assert free_cells(floor, frame, on_map, True, 0.2).tolist() == [[True, False], [True, True]]
    assert free_cells(floor, frame, on_map, True, 0.21).tolist() == [[False, False], [True, True]]
    assert free_cells(floor, frame, on_map, True, 0.41).tolist() == [[False, False], [True, False]]


def test_grid_follows_its_origin_and_covers_whole_cells_only() -> None:
    floor = picture(20, 20, [])
    frame, on_map = lay_grid(floor, 0.9, (0.5, 0.5), 0.0)
    assert (frame.rows, frame.columns) == (1, 1)
    frame, on_map = lay_grid(floor, 0.5, (0.1, 0.2), math.pi / 2)
    assert on_map.all()
    assert on_map.shape == (3, 3)


@settings(max_examples=40)
@given(st.floats(-1.5, 1.5), st.tuples(st.integers(0, 19), st.integers(0, 19)), st.floats(0, 0.3))
def test_turned_grid_blocks_what_is_near_a_pixel(rotation: float, dot: tuple[int, int], inflation: float) -> None:
    floor = picture(20, 20, [dot])
    frame, on_map = lay_grid(floor, 0.31, (0.97, 1.03), rotation)
    free = free_cells(floor, frame, on_map, True, inflation)
    spread = np.linspace(0, 0.1, 9)
    pixel = np.stack(np.meshgrid(dot[1] * 0.1 + spread, 2.0 - dot[0] * 0.1 - spread), axis=-1).reshape(-1, 2)
    for row, column in np.argwhere(on_map):
        west, south, east, north = frame.square(int(row), int(column))
        points = frame.to_grid(pixel)
        gaps = np.maximum(np.maximum([west, south] - points, points - [east, north]), 0)
        nearest = float(np.hypot(*gaps.T).min())
        # samples bound the distance of the squares from above, and by at most the spacing from below
        if nearest < inflation - 1e-5 or (nearest == 0 and inflation == 0):
            inside = np.minimum(points - [west, south], [east, north] - points).min(axis=1).max()
            assert not free[row, column] or inside < 1e-5
        if nearest > inflation + 0.02:
            assert free[row, column]


def test_disc_may_touch_but_not_meet() -> None:
    floor = picture(20, 20, [(9, 10)])
    solid = floor.occupied
    assert disc_is_free(floor, solid, (0.9, 1.05), 0.1)
    assert not disc_is_free(floor, solid, (0.9, 1.05), 0.11)
    assert not disc_is_free(floor, solid, (0.05, 0.5), 0.1)


def test_two_rooms_have_the_stairs_of_the_scenario(scenes: Path) -> None:
    scene = derive_scene(read_scenario(scenes / "two_rooms_mission.yaml"))
    assert (scene.frame.rows, scene.frame.columns) == (7, 12)
    assert len(scene.kinds) == 34
    lower, upper = scene.terrain.profiles[2, 6], scene.terrain.profiles[2, 7]
    assert lower.up is Direction.EAST
    assert lower.gain_m == pytest.approx(0.6)
    assert upper.gain_m == pytest.approx(0.6)
    assert lower.admissible[:6] == (True, False, False, True, True, False)
    assert scene.terrain.passable((2, 7), Direction.EAST)
    assert not scene.terrain.passable((2, 6), Direction.NORTH)
    assert [len(kind.domain) for kind in scene.obstacle_kinds] == [19]


def test_theorem_iv_2_is_the_worked_example() -> None:
    def turns(angle: float, speed: float, foot: float) -> bool:
        change, omega = np.array([math.radians(angle)]), np.array([3.15585])
        return bool(may_turn(np.array([speed]), np.array([foot]), np.array([1.0]), change, omega)[0])

    assert turns(24.3, 0.2, 0.14)
    assert not turns(24.4, 0.2, 0.14)
    assert turns(-32.2, 0.7, 0.14)
    assert not turns(-32.3, 0.7, 0.14)
    assert turns(0.0, 0.01, -0.14)


@given(st.floats(-0.3, 0.3), st.floats(-0.8, 0.8), st.floats(0.05, 1.2))
def test_integration_is_the_closed_form(gap: float, speed: float, lasts: float) -> None:
    omega = 3.15585
    com, velocity = np.array([[gap, 0.0, 1.0]]), np.array([[speed, 0.0]])
    position, after = integrated(com, velocity, np.zeros((1, 3)), np.array([lasts]), omega**2)
    swing, swell = math.cosh(omega * lasts), math.sinh(omega * lasts)
    assert position[0, 0] == pytest.approx(gap * swing + speed / omega * swell, abs=1e-6)
    assert after[0, 0] == pytest.approx(gap * omega * swell + speed * swing, abs=1e-6)


def test_hull_of_feet() -> None:
    corners = np.array([[0, 0], [2, 0], [2, 1], [0, 1], [1, 0.5]], float)
    assert outside_m(np.array([[1.0, 0.5], [2.0, 1.0], [0.0, 0.3]]), corners) == 0
    assert outside_m(np.array([[1.0, 1.25]]), corners) == pytest.approx(0.25)

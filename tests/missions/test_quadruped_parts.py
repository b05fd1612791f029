"""Parts of a quadruped's mission: the two timelines, ways over the map, the world, turned grids."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import shapely  # type: ignore[import-untyped]
from hypothesis import given, settings
from hypothesis import strategies as st

from quadruped_field import write_field
from surefoot.footholds.gaits import FreeGait, Gait
from surefoot.footholds.terrain import polygon
from surefoot.missions.quadruped.ahead import looked_ahead
from surefoot.missions.quadruped.crossing import OnlineLimits, cross, crossing
from surefoot.missions.quadruped.route import Routes, in_grid, offset_on_map, on_map
from surefoot.missions.quadruped.skills import SkillBook
from surefoot.missions.quadruped.stance import stance_about
from surefoot.missions.quadruped.timeline import delay_of, delays, timeline
from surefoot.missions.quadruped.world import World, cut
from surefoot.robots.quadruped import quadruped
from surefoot.skills import LocalGrid, generated, read_terrain
from surefoot.skills.headings import turning_of
from surefoot.skills.patches import Rectangle
from surefoot.skills.values import OBSTACLE, CheckResult, Direction, Physics, Primitive, TerrainState

TERRAIN = generated("unstructured-4", 0, grid=(5, 5))
SECONDS = st.floats(0, 10)


def test_the_two_cases_of_the_paper() -> None:
    first, a, b = timeline([0.5, 1.0, 3.0], [2.0, 2.0, 2.0])
    assert (first.start_s, first.idle_s) == (0.5, 0.0)
    assert (a.plan_start_s, a.sent_s, a.start_s, a.idle_s, a.case) == (0.5, 1.5, 2.5, 0.0, "a")
    assert (b.plan_start_s, b.sent_s, b.start_s, b.idle_s, b.case) == (2.5, 5.5, 5.5, 1.0, "b")


@given(st.lists(st.tuples(SECONDS, st.floats(0.5, 3)), min_size=1, max_size=20))
def test_nothing_overlaps_and_idle_is_what_is_left(pairs: list[tuple[float, float]]) -> None:
    planning, horizons = zip(*pairs, strict=True)
    slots = timeline(planning, horizons)
    for before, after in pairwise(slots):
        assert after.plan_start_s >= before.start_s - 1e-9
        assert after.start_s >= max(before.end_s, after.sent_s) - 1e-9
        assert after.idle_s == pytest.approx(after.start_s - before.end_s, abs=1e-9)
        assert (after.case == "a") == (after.idle_s == 0)
    total = slots[0].start_s + sum(horizons) + sum(slot.idle_s for slot in slots)
    assert slots[-1].end_s == pytest.approx(total)


def test_delays_take_turns() -> None:
    assert [delay_of(delays("0,1,2"), k) for k in range(5)] == [0, 1, 2, 0, 1]
    assert delays(None) == (0.0,)


@given(st.integers(0, 3), st.tuples(st.integers(0, 4), st.integers(0, 4)))
def test_turned_grids_agree_with_the_places_of_their_cells(turns: int, local: tuple[int, int]) -> None:
    cell, terrain = (5, 3), TERRAIN
    grid = LocalGrid(terrain, terrain.centre_m(cell), turns)
    target = on_map(cell, local, turns, (5, 5))
    assert np.allclose(terrain.centre_m(target), grid.place_m(local))
    assert in_grid(cell, target, turns, (5, 5)) == local


def test_four_quarters_are_none() -> None:
    assert all(offset_on_map(one.offset, 4) == one.offset for one in Direction)


@given(st.integers(-999, 999), st.integers(-999, 999), st.integers(50, 999), st.integers(50, 999))
@settings(max_examples=50)
def test_a_cut_leaves_what_is_outside(x_mm: int, y_mm: int, width_mm: int, height_mm: int) -> None:
    x, y, width, height = x_mm / 1e3, y_mm / 1e3, width_mm / 1e3, height_mm / 1e3
    corners = [[-0.5, -0.4, 0.0], [0.6, -0.3, 0.0], [0.4, 0.5, 0.0], [-0.3, 0.4, 0.0]]
    one, hole = polygon(corners), Rectangle(x, y, x + width, y + height)
    pieces = [shapely.Polygon(piece.vertices_m[:, :2]) for piece in cut(one, hole)]
    left = shapely.Polygon(one.vertices_m[:, :2]).difference(shapely.box(x, y, x + width, y + height))
    assert shapely.union_all(pieces).area == pytest.approx(left.area, abs=1e-4)
    assert sum(piece.area for piece in pieces) == pytest.approx(left.area, abs=1e-4)


@pytest.fixture
def world(tmp_path: Path) -> World:
    return World(read_terrain(write_field(tmp_path / "field.yaml")))


def test_what_appears_is_an_obstacle_wherever_it_touches(world: World) -> None:
    blocked = world.with_obstacle(Rectangle(1.5, 1.0, 1.7, 1.2))
    state = blocked.state((3, 1))
    assert state is not None
    assert state.label((0, 1)) == OBSTACLE
    assert state.label((0, 0)) == "flat"
    assert blocked.state((2, 1)) is None
    before = world.state((3, 1))
    assert before is not None
    assert before.label((0, 1)) == "flat"


def test_measures_after_a_hole_are_those_of_the_new_ground(world: World) -> None:
    changed = world.without_ground(Rectangle(0.9, 0.1, 1.3, 0.7))
    terrain = changed.terrain
    for cell, measured in terrain.measured.items():
        fresh = terrain.ground.measure(terrain.square_m(cell))
        assert fresh.values == pytest.approx(measured.values)
    assert changed.state((2, 2)) != world.state((2, 2))


def test_ways_are_shortest_and_avoid_what_is_closed(world: World) -> None:
    routes = Routes(world, (0, 1), 0, (), set())
    assert routes.left[3, 1] == 3
    assert routes.route((3, 1)) is not None
    closed = {(((2, 1), 0), ((1, 1), 0)), (((2, 0), 0), ((1, 0), 0))}
    assert Routes(world, (0, 1), 0, (), closed).left[3, 1] == 5
    assert Routes(world, (0, 1), 0, (), {*closed, (((2, 2), 0), ((1, 2), 0))}).route((3, 1)) is None
    refused = {Primitive(Direction.FORWARD, "flat", "dense")}
    assert Routes(world, (0, 1), 0, refused, set()).left[3, 1] == 5


def test_way_points_come_nearer_to_the_goal(world: World) -> None:
    routes = Routes(world, (0, 1), 0, (), set())
    state = world.state((3, 1))
    assert state is not None
    wishes = routes.wishes((3, 1), state, None)
    assert wishes[0] == (0, 1)
    assert all(routes.left[on_map((3, 1), one, 0, (3, 3))] < routes.left[3, 1] for one in wishes)


class Answers:
    """Physics that says yes but for some primitives, and remembers what it was asked."""

    def __init__(self, *refused: str) -> None:
        self.refused, self.asked = refused, list[str]()

    def __call__(self, primitives: Sequence[Primitive]) -> Iterator[CheckResult]:
        for one in primitives:
            self.asked.append(one.name)
            verdict = Physics.INFEASIBLE if one.name in self.refused else Physics.FEASIBLE
            yield CheckResult(one, verdict, "trot-2s", "", 0.0)


def test_what_the_way_needs_is_made_ahead(world: World, tmp_path: Path) -> None:
    physics = Answers("forward flat->dense")
    book = SkillBook(None, physics, tmp_path)
    made = list(looked_ahead(world, book, ((3, 1), 0), (0, 1)))
    asked = [result.primitive.name for one in made for result in one.checked]
    assert asked == physics.asked
    assert len(asked) == len(set(asked))
    assert "forward flat->flat" in asked
    physics.asked.clear()
    assert not any(one.checked for one in looked_ahead(world, book, ((3, 1), 0), (0, 1)))
    assert physics.asked == []


TURNING = turning_of(TERRAIN.classes, (Direction.FORWARD, Direction.BACKWARD))
NARROW = TerrainState((("obstacle", "dense", "obstacle"), ("obstacle", "flat", "obstacle"), ("obstacle",) * 3))


@pytest.mark.parametrize("refused", [(), ("forward flat->dense",)])
def test_a_step_ahead_is_worth_a_question(tmp_path: Path, refused: tuple[str, ...]) -> None:
    known = Answers("forward flat->dense")
    quick = Answers(*refused)
    book = SkillBook(None, known, tmp_path, TURNING, quick)
    at_hand = ("turn-left flat->flat", "backward flat->dense", "turn-left dense->dense")
    book.knowledge = book.knowledge.extended(known([Primitive.parse(name) for name in at_hand]))
    assert len(_followed(book)) == 3
    asked = book.short_cuts(NARROW, (0, 1))
    assert [one.primitive.name for one in asked] == ["forward flat->dense"]
    assert len(_followed(book)) == (3 if refused else 1)
    assert book.short_cuts(NARROW, (0, 1)) == ()
    assert book.knowledge.refused == {}


def _followed(book: SkillBook) -> list[str]:
    """Return what a strategy does from the start on."""
    ways, pose, done = book.strategy(NARROW, (0, 1), ()).ways, (NARROW.centre, 0), list[str]()
    while (way := ways[pose]) is not None:
        done.append(way)
        pose = TURNING.after(pose, way)
    return done


def test_a_gait_is_found_on_the_real_polygons(world: World) -> None:
    robot = quadruped("go2")
    stance = stance_about(robot, world, world.terrain.centre_m((3, 1)), 0)
    assert stance is not None
    problem = crossing(robot, world, stance, (2, 1), 0, FreeGait(2.0), OnlineLimits())
    crossed = cross(problem, None, OnlineLimits())
    assert crossed.reason == ""
    assert isinstance(crossed.problem.gait, Gait)
    assert crossed.problem.gait.horizon_s == pytest.approx(2.0)
    hurried = cross(problem, None, OnlineLimits(time_limit_s=0.0))
    assert hurried.reason.startswith("limit:")
    assert not hurried.infeasible


def test_nobody_stands_outside_of_the_map(world: World) -> None:
    assert stance_about(quadruped("go2"), world, (-3.0, 1.0), 0) is None
    assert not world.holds(np.array([-3.0, 1.0, 0.0]))
    assert world.holds(np.array([0.4, 0.4, 0.0]))
    nothing = world.without_ground(Rectangle(-9, -9, 9, 9))
    assert all(nothing.state(cell) is None for cell in nothing.terrain.measured)

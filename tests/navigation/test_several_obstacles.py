"""Several obstacles: kinds, speeds, observations; the compiled game against the readable rules."""

from __future__ import annotations

import random
from dataclasses import replace

import numpy as np
import pytest
from art import OLDER_FORBIDDEN, STAIRS_AND_FRONT, UPPER_ROOM, coarse_of, crowd, older, two_rooms
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from naive_graph import built_turns, naive_turns, true_situations

from surefoot.errors import LimitExceeded
from surefoot.frames import Cell, Direction
from surefoot.games import solve
from surefoot.navigation import (
    NavigationProblem,
    Obstacle,
    ObstacleState,
    Order,
    Rules,
    allowed_orders,
    build_navigation_game,
    obstacle_kinds,
    solve_navigation,
)
from surefoot.navigation import _exploration as exploration
from surefoot.navigation._strategy_kernels import met, stalled

FORBIDDEN = UPPER_ROOM | STAIRS_AND_FRONT


@pytest.mark.parametrize(
    ("starts", "tracking", "decisions"),
    [((61, 62), "joint", 7040), ((61, 62), "separate", 14903), ((61, 62, 63), "joint", 35958)],
)
def test_two_rooms_with_several_obstacles(starts: tuple[int, ...], tracking: str, decisions: int) -> None:
    game = build_navigation_game(two_rooms(obstacle_starts=starts, belief_tracking=tracking))
    assert game.decisions == decisions
    verdict, strategy = solve_navigation(game)
    assert verdict, verdict.witness
    assert strategy is not None
    assert strategy.size > 0


def test_kinds_are_equal_domains_and_speeds() -> None:
    coarse = two_rooms().coarse
    obstacles = (Obstacle(61), Obstacle(62, FORBIDDEN), Obstacle(63), Obstacle(64, frozenset(), 2))
    joint = obstacle_kinds(coarse, obstacles)
    assert [kind.obstacles for kind in joint] == [(0, 2), (1,), (3,)]
    separate = obstacle_kinds(coarse, obstacles, "separate")
    assert [kind.obstacles for kind in separate] == [(0,), (1,), (2,), (3,)]


def test_speed_is_the_number_of_moves() -> None:
    coarse = coarse_of("#######\n#.....#\n#######")
    place = [coarse.grid.index(Cell(1, column)) for column in range(7)]
    for speed in (1, 2, 3):
        kinds = obstacle_kinds(coarse, (Obstacle(place[3], speed_cells=speed),))
        reached = kinds.reach(kinds.kinds[0], place[3])
        assert set(reached) == set(place[max(1, 3 - speed) : min(5, 3 + speed) + 1])
        # a robot that stands is neither entered nor passed through
        assert set(kinds.reach(kinds.kinds[0], place[3], standing=place[2])) == set(place[3 : min(5, 3 + speed) + 1])


def test_a_fast_obstacle_threatens_from_farther_away() -> None:
    coarse = coarse_of("########\n#......#\n########")
    robot, far = coarse.grid.index(Cell(1, 1)), coarse.grid.index(Cell(1, 4))
    lost = []
    for speed in (1, 2):
        problem = NavigationProblem(coarse, robot, Direction.EAST, (robot,), (Obstacle(far, speed_cells=speed),))
        rules = Rules(problem)
        lost.append(rules.is_lost(robot, Order(Direction.EAST, False), rules.start()))
    assert lost == [False, True]


def test_one_observation_can_match_several_hidden_sets() -> None:
    """Two obstacles around the corners of a crossing; one comes out in the middle: which one? Both may still hide."""
    art = """
    #######
    ###.###
    #.....#
    ###.###
    ###.###
    #######
    """
    coarse = coarse_of(art)
    grid = coarse.grid
    robot, north, south = grid.index(Cell(2, 1)), grid.index(Cell(1, 3)), grid.index(Cell(3, 3))
    problem = NavigationProblem(
        coarse, robot, Direction.EAST, (robot,), crowd((north, south)), belief="exact", belief_tracking="joint"
    )
    rules = Rules(problem)
    middle = grid.index(Cell(2, 3))
    outcomes = rules.outcomes(robot, robot, Order(Direction.EAST, True), rules.start())
    (seen,) = [state for state in outcomes if state.visible == ((middle,),)]
    assert {north, south} <= set(rules.kinds.members(seen.hidden[0]))


@st.composite
def small_problems(draw: st.DrawFn) -> NavigationProblem:
    """Return random maps of a few cells with one to three obstacles."""
    rows, columns = draw(st.integers(2, 3)), draw(st.integers(3, 4))
    signs = draw(st.lists(st.sampled_from("...#"), min_size=rows * columns, max_size=rows * columns))
    lines = ["".join(signs[row * columns : (row + 1) * columns]) for row in range(rows)]
    edge = "#" * (columns + 2)
    coarse = coarse_of(
        "\n".join([edge, *(f"#{line}#" for line in lines), edge]), corners=draw(st.sampled_from(["visible", "hidden"]))
    )
    free = [coarse.grid.index(cell) for cell in coarse.grid.free_cells()]
    assume(len(free) >= 4)
    robot, goal = draw(st.sampled_from(free)), draw(st.sampled_from(free))
    obstacles = []
    for _ in range(draw(st.sampled_from([1, 2, 2, 3]))):
        start = draw(st.sampled_from([cell for cell in free if cell != robot]))
        forbidden = draw(st.sampled_from([frozenset(), frozenset({goal}), frozenset(free[:2])])) - {start}
        obstacles.append(Obstacle(start, forbidden, draw(st.sampled_from([1, 1, 1, 2, 3]))))
    return NavigationProblem(
        coarse,
        robot,
        draw(st.sampled_from(list(Direction))),
        (goal,),
        tuple(obstacles),
        regions=(frozenset(free[: len(free) // 2]),),
        belief=draw(st.sampled_from(["exact", "regions", "single", "unnarrowed"])),
        view=draw(st.sampled_from(["post", "pre"])),
        belief_tracking=draw(st.sampled_from(["joint", "separate"])),
    )


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])
@given(problem=small_problems())
def test_the_compiled_game_is_the_readable_one(problem: NavigationProblem) -> None:
    game = build_navigation_game(problem)
    assume(game.arena.edges < 5000)
    assert built_turns(game) == naive_turns(problem)


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])
@given(problem=small_problems(), seed=st.integers(0, 2**32))
def test_beliefs_contain_every_true_obstacle(problem: NavigationProblem, seed: int) -> None:
    """Robot and obstacles move at random; what is seen matches exactly one outcome, which contains the truth."""
    chance = random.Random(seed)
    rules = Rules(problem)
    kinds, state = rules.kinds, rules.start()
    cell, heading = problem.start, problem.heading
    truth = {number: obstacle.start for number, obstacle in enumerate(problem.obstacles)}
    for _ in range(15):
        orders = [
            order for order in allowed_orders(problem.coarse, cell, heading) if not rules.is_lost(cell, order, state)
        ]
        if not orders:
            break
        order = chance.choice(orders)
        arrival, facing = rules.arrival(cell, heading, order)
        standing = cell if order.waits else None
        truth = {
            number: chance.choice(kinds.reach(kinds.kind_of(number), at, standing)) for number, at in truth.items()
        }
        assert order.waits or not {cell, arrival} & set(truth.values())
        view = arrival if problem.view == "post" else cell
        visible = tuple(
            tuple(sorted(truth[one] for one in kind.obstacles if problem.coarse.sees[view, truth[one]]))
            for kind in kinds
        )
        (state,) = [after for after in rules.outcomes(cell, arrival, order, state) if after.visible == visible]
        for kind, hidden in zip(kinds, state.hidden, strict=True):
            unseen = [truth[one] for one in kind.obstacles if not problem.coarse.sees[view, truth[one]]]
            assert set(unseen) <= set(kinds.members(hidden))
            assert bool(unseen) == bool(hidden)
        cell, heading = arrival, facing


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])
@given(problem=small_problems())
def test_the_true_obstacles_never_leave_the_robot_without_a_way(problem: NavigationProblem) -> None:
    """Check (2) by walking the product of strategy, belief and all true obstacles; rules.md 4 proves it in general."""
    game = build_navigation_game(problem)
    assume(game.arena.edges < 3000)
    verdict, strategy = solve_navigation(game)
    if strategy is not None:
        _, stuck = true_situations(problem, strategy.decide)
        assert not stuck
    else:
        assert verdict.witness is not None
        assert "assumption (c)" not in verdict.witness.reason


def test_the_true_product_of_two_obstacles() -> None:
    problem = older(obstacle_starts=(28, 32), forbidden=OLDER_FORBIDDEN | {14, 17, 18}, belief="single")
    _, strategy = solve_navigation(build_navigation_game(problem))
    assert strategy is not None
    situations, stuck = true_situations(problem, strategy.decide)
    assert situations > 1000
    assert not stuck


def test_a_strategy_that_waits_for_ever_is_noticed() -> None:
    """Of every decision where a wait is not in vain, take it: no goal, and nothing that obstacles promised to end."""
    game = build_navigation_game(two_rooms())
    arena, solution = game.arena, solve(game.arena)
    choice = solution.choice.copy()
    for node in np.flatnonzero(arena.system & solution.winning):
        turns = arena.successors_of(int(node))
        idle = np.flatnonzero((game.order[turns] >= 4) & (game.blocked[turns] < 0))
        if len(idle):
            choice[:, node] = idle[0]
    graph = (arena.first, arena.successors, game.order, arena.goals)
    for chosen, noticed in ((solution.choice, False), (choice, True)):
        walked = met(*graph, chosen, 0)
        assert (stalled(*graph, game.blocked, solution.rank, chosen, *walked) >= 0) is noticed


def test_a_game_that_is_too_large_says_what_to_change(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exploration, "MOST_EDGES", 10_000)
    with pytest.raises(LimitExceeded, match=r"sensor\.range_m"):
        build_navigation_game(two_rooms(obstacle_starts=(61, 62)))


def test_too_many_equal_obstacles_are_a_limit() -> None:
    with pytest.raises(LimitExceeded, match="62 bits"):
        build_navigation_game(two_rooms(obstacle_starts=(61,) * 16))


def test_strategies_come_back_from_their_arrays(tmp_path: object) -> None:
    from pathlib import Path

    from surefoot.navigation import load_navigation_strategy, save_arrays

    obstacles = (Obstacle(61, FORBIDDEN), Obstacle(62, FORBIDDEN), Obstacle(63, FORBIDDEN | {61}, 2))
    problem = replace(two_rooms(), obstacles=obstacles, belief="single")
    game = build_navigation_game(problem)
    _, strategy = solve_navigation(game)
    assert strategy is not None
    assert strategy.kinds == ((0, 1), (2,))
    path = Path(str(tmp_path)) / "navigation.npz"
    save_arrays(path, strategy.arrays())
    again = load_navigation_strategy(path, strategy.goals, strategy.kinds)
    assert again.first_order() == strategy.first_order()
    for row in range(0, strategy.size, 97):
        asked = (
            int(strategy.cell[row]),
            Direction(int(strategy.heading[row])),
            strategy.states[strategy.state[row]],
            int(strategy.goal[row]),
        )
        assert again.decide(*asked) == strategy.decide(*asked) == Order.of(int(strategy.order[row]))
    with pytest.raises(KeyError):
        again.decide(0, Direction.NORTH, ObstacleState(((), ()), (0, 0)), 0)

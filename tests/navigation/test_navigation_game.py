"""The navigation game's verdicts, against measured ones and by property."""

from __future__ import annotations

from itertools import pairwise

import pytest
from art import OLDER_FORBIDDEN, STAIRS_AND_FRONT, coarse_of, older, two_rooms

from surefoot.frames import Cell, Direction
from surefoot.navigation import (
    NavigationProblem,
    Order,
    Rules,
    allowed_orders,
    build_navigation_game,
    solve_navigation,
)

BELIEFS = ("exact", "regions", "single")
SCENES = {
    "two rooms": two_rooms,
    "older": older,
    "older with a wall": lambda **options: older(extra_wall=True, **options),
}


@pytest.mark.parametrize("belief", BELIEFS)
@pytest.mark.parametrize("view", ["post", "pre"])
@pytest.mark.parametrize("corners", ["visible", "hidden"])
@pytest.mark.parametrize("scene", SCENES)
def test_realizable_in_all_scenes_of_the_papers(scene: str, corners: str, view: str, belief: str) -> None:
    """With the collision guarantee, turns after a stop and declared waiting every combination is realizable."""
    game = build_navigation_game(SCENES[scene](corners=corners, view=view, belief=belief))
    verdict, strategy = solve_navigation(game)
    assert verdict, verdict.witness
    assert strategy is not None


@pytest.mark.parametrize(("belief", "known"), [("exact", 446), ("regions", 155), ("single", 44)])
def test_number_of_obstacle_states_in_the_two_rooms(belief: str, known: int) -> None:
    """A measured study counted them; the start's may come on top."""
    game = build_navigation_game(two_rooms(belief=belief))
    assert len(game.states) in (known, known + 1)


@pytest.mark.parametrize("belief", BELIEFS)
def test_unrealizable_when_only_the_stairs_are_forbidden_to_the_obstacle(belief: str) -> None:
    game = build_navigation_game(two_rooms(belief=belief, forbidden=frozenset({30, 31})))
    verdict, strategy = solve_navigation(game)
    assert not verdict
    assert strategy is None
    assert verdict.witness is not None
    assert verdict.witness.reason


def test_unrealizable_names_the_goal_in_a_dead_end() -> None:
    art = """
    ########
    #......#
    #.##.###
    #......#
    ########
    """
    coarse = coarse_of(art)
    dead_end = coarse.grid.index(Cell(1, 6))
    problem = NavigationProblem(coarse, coarse.grid.index(Cell(1, 1)), Direction.EAST, (dead_end,))
    verdict, _ = solve_navigation(build_navigation_game(problem))
    assert verdict.witness is not None
    assert verdict.witness.failing_goals == (0,)
    assert "(1, 6)" in verdict.witness.reason


def test_without_obstacles_the_shortest_tour_is_walked() -> None:
    problem = two_rooms(obstacle_starts=(), forbidden=frozenset())
    verdict, strategy = solve_navigation(build_navigation_game(problem))
    assert verdict
    assert strategy is not None
    orders = [Order.of(code) for code in strategy.order.tolist()]
    assert not any(order.waits for order in orders)


def test_no_u_turn_and_straight_on_over_stairs() -> None:
    coarse = two_rooms().coarse
    place = coarse.grid.index(Cell(3, 2))
    directions = {order.direction for order in allowed_orders(coarse, place, Direction.EAST)}
    assert Direction.WEST not in directions
    assert directions == {Direction.NORTH, Direction.EAST, Direction.SOUTH} & directions


def test_collision_is_lost_for_old_and_new_cell_but_not_while_waiting() -> None:
    problem = two_rooms()
    rules = Rules(problem)
    state = rules.start()
    beside = problem.coarse.grid.index(Cell(4, 1))
    assert rules.is_lost(beside, Order(Direction.NORTH, False), state)
    assert not rules.is_lost(beside, Order(Direction.NORTH, True), state)


def test_coarser_beliefs_contain_finer_ones() -> None:
    rules = [Rules(two_rooms(belief=belief)) for belief in (*BELIEFS, "unnarrowed")]
    kinds = rules[0].kinds
    (kind,) = kinds.kinds
    for view in rules[0].problem.coarse.grid.free_cells():
        cell = rules[0].problem.coarse.grid.index(view)
        for bit in range(len(kinds.cells)):
            image = (1 << bit) & ~kinds.seen_from[cell]
            if image:
                beliefs = [rule.abstract(kinds, kind, image, cell) for rule in rules]
                assert all(fine & ~coarse == 0 for fine, coarse in pairwise(beliefs))


def test_obstacles_outside_the_way_are_ignored() -> None:
    """An obstacle that is locked away in forbidden surroundings never makes the robot wait."""
    problem = older(obstacle_starts=(14,), forbidden=OLDER_FORBIDDEN | STAIRS_AND_FRONT | frozenset({27, 28, 29}))
    game = build_navigation_game(problem)
    assert solve_navigation(game)[0]


def test_an_unrealizable_scene_shows_how_the_obstacle_wins() -> None:
    game = build_navigation_game(two_rooms(forbidden=frozenset({30, 31})))
    verdict, _ = solve_navigation(game)
    assert verdict.witness is not None
    play = verdict.witness.play
    assert play is not None
    assert (play.turns[0].turn, play.turns[0].cell, play.turns[0].heading) == (0, (4, 8), "east")
    assert [turn.order is None for turn in play.turns] == [False] * (len(play.turns) - 1) + [True]
    told = play.lines()
    assert told[0].startswith("turn 0: the robot in (4, 8), heading east; an obstacle out of sight, in one of ")
    assert told[-2].endswith("no order is safe")
    assert told[-1] == "the robot has no safe order left"


def test_a_robot_that_is_shut_out_for_ever_sees_its_play_repeat() -> None:
    """The obstacle may never leave the corridor that the robot has to pass; no assumption makes it go."""
    art = """
    #########
    #.......#
    #########
    """
    coarse = coarse_of(art)
    ends = coarse.grid.index(Cell(1, 1)), coarse.grid.index(Cell(1, 7))
    problem = NavigationProblem(coarse, ends[0], Direction.EAST, (ends[1],))
    verdict, _ = solve_navigation(build_navigation_game(problem))
    assert verdict.witness is not None
    assert verdict.witness.play is not None
    assert verdict.witness.play.ending == "the robot has no safe order left"

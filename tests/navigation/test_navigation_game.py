"""The navigation game's verdicts, against measured ones and by property."""

from __future__ import annotations

import pytest
from art import OLDER_FORBIDDEN, STAIRS_AND_FRONT, coarse_of, older, two_rooms
from hypothesis import given, settings
from hypothesis import strategies as st

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
    orders = [Order.of(code) for code in strategy.orders.values()]
    assert not any(order.waits for order in orders)


def test_no_u_turn_and_straight_on_over_stairs() -> None:
    coarse = two_rooms().coarse
    place = coarse.grid.index(Cell(3, 2))
    directions = {order.direction for order in allowed_orders(coarse, place, Direction.EAST)}
    assert Direction.WEST not in directions
    assert directions == {Direction.NORTH, Direction.EAST, Direction.SOUTH} & directions


def test_collision_is_lost_for_old_and_new_cell_but_not_while_waiting() -> None:
    problem = two_rooms()
    rules = Rules(problem, problem.domain)
    state = rules.start()
    beside = problem.coarse.grid.index(Cell(4, 1))
    assert rules.is_lost(beside, Order(Direction.NORTH, False), state)
    assert not rules.is_lost(beside, Order(Direction.NORTH, True), state)


@settings(max_examples=60, deadline=None)
@given(
    seed=st.randoms(use_true_random=False),
    belief=st.sampled_from(BELIEFS),
    view=st.sampled_from(["post", "pre"]),
    scene=st.sampled_from(list(SCENES)),
)
def test_belief_always_contains_the_true_obstacle(seed: object, belief: str, view: str, scene: str) -> None:
    """Robot and obstacle move at random; whatever is seen matches exactly one outcome, which contains the truth."""
    problem = SCENES[scene](belief=belief, view=view)
    domain = problem.domain
    rules = Rules(problem, domain)
    state, truth = rules.start(), problem.obstacle_starts[0]
    cell, heading = problem.start, problem.heading
    for _ in range(25):
        orders = allowed_orders(problem.coarse, cell, heading)
        if not orders:
            break
        order = seed.choice(orders)  # type: ignore[attr-defined]
        arrival, facing = rules.arrival(cell, heading, order)
        reach = domain.reach[domain.bit[truth]]
        if order.waits:
            reach &= ~domain.mask((cell,))
        if not reach:
            break  # a robot that had walked into the obstacle: excluded by the collision guarantee
        truth = seed.choice(domain.members(reach))  # type: ignore[attr-defined]
        seen = problem.coarse.sees[arrival if view == "post" else cell, truth]
        outcomes = rules.outcomes(cell, arrival, order, state)
        matching = [after for after in outcomes if after.visible == ((truth,) if seen else ())]
        assert len(matching) == 1
        state, cell, heading = matching[0], arrival, facing
        assert state.possible(domain) & domain.mask((truth,))


def test_coarser_beliefs_contain_finer_ones() -> None:
    problems = [two_rooms(belief=belief) for belief in BELIEFS]
    domain = problems[0].domain
    abstractions = [Rules(problem, domain).abstract for problem in problems]
    for view in problems[0].coarse.grid.free_cells():
        cell = problems[0].coarse.grid.index(view)
        for bit in range(len(domain.cells)):
            image = (1 << bit) & ~domain.seen_from[cell]
            if image:
                exact, regions, single = (abstract(image, cell) for abstract in abstractions)
                assert exact & ~regions == 0
                assert regions & ~single == 0


def test_obstacles_outside_the_way_are_ignored() -> None:
    """An obstacle that is locked away in forbidden surroundings never makes the robot wait."""
    problem = older(obstacle_starts=(14,), forbidden=OLDER_FORBIDDEN | STAIRS_AND_FRONT | frozenset({27, 28, 29}))
    game = build_navigation_game(problem)
    assert solve_navigation(game)[0]

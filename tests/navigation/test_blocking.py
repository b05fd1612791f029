"""Assumption (c): when do obstacles block a waiting robot although they could make way?"""

from __future__ import annotations

import pytest
from art import coarse_of, crowd, two_rooms
from naive_graph import naive_blocked

from surefoot.frames import Cell, Direction
from surefoot.navigation import CoarseMap, NavigationProblem, Obstacle, build_navigation_game

CROSSING = """
########
###.####
###.####
#......#
###.####
###.####
########
"""


def waits_in_vain(coarse: CoarseMap, robot: Cell, obstacles: tuple[Obstacle, ...]) -> bool:
    """Return whether the first wait for the east counts as blocked."""
    start = coarse.grid.index(robot)
    problem = NavigationProblem(coarse, start, Direction.EAST, (start,), obstacles, belief="exact")
    game = build_navigation_game(problem)
    waits = [node for node in game.arena.successors_of(0).tolist() if game.order[node] == 4 + Direction.EAST]
    return bool(game.blocked[waits[0]] == Direction.EAST)


def all_but(coarse: CoarseMap, *allowed: Cell) -> frozenset[int]:
    grid = coarse.grid
    return frozenset(map(grid.index, grid.free_cells())) - set(map(grid.index, allowed))


def test_an_obstacle_that_can_step_aside_blocks() -> None:
    coarse = coarse_of(CROSSING)
    assert waits_in_vain(coarse, Cell(3, 1), (Obstacle(coarse.grid.index(Cell(3, 3))),))


def test_an_obstacle_that_cannot_leave_does_not_count() -> None:
    """In a dead end there is no cell from which it would not threaten: the robot must not rely on it to leave."""
    coarse = coarse_of(CROSSING)
    shut_in = Obstacle(coarse.grid.index(Cell(3, 2)), all_but(coarse, Cell(3, 1), Cell(3, 2)))
    assert not waits_in_vain(coarse, Cell(3, 1), (shut_in,))


def test_one_obstacle_that_can_step_aside_blocks_beside_one_that_cannot() -> None:
    coarse = coarse_of(CROSSING)
    shut_in = Obstacle(coarse.grid.index(Cell(3, 2)), all_but(coarse, Cell(3, 1), Cell(3, 2)))
    able = Obstacle(coarse.grid.index(Cell(3, 3)))
    assert waits_in_vain(coarse, Cell(3, 1), (shut_in, able))


def test_an_obstacle_far_away_does_not_block_unless_it_is_fast() -> None:
    coarse = coarse_of(CROSSING)
    far = coarse.grid.index(Cell(3, 4))
    assert not waits_in_vain(coarse, Cell(3, 1), (Obstacle(far),))
    assert waits_in_vain(coarse, Cell(3, 1), (Obstacle(far, speed_cells=2),))


def test_a_hidden_threat_blocks_only_if_it_can_show_itself() -> None:
    coarse = coarse_of(CROSSING)
    assert not coarse.sees[coarse.grid.index(Cell(3, 2)), coarse.grid.index(Cell(1, 3))]
    hidden = coarse.grid.index(Cell(1, 3))
    assert waits_in_vain(coarse, Cell(3, 2), (Obstacle(hidden, speed_cells=2),))
    shut_in = Obstacle(hidden, all_but(coarse, Cell(1, 3)), speed_cells=2)
    assert not waits_in_vain(coarse, Cell(3, 2), (shut_in,))


@pytest.mark.parametrize(
    "problem",
    [
        two_rooms(),
        two_rooms(belief="exact", view="pre", corners="hidden"),
        two_rooms(obstacle_starts=(61, 62)),
        two_rooms(obstacle_starts=(61, 62), belief_tracking="separate", belief="single"),
        two_rooms(obstacles=(*crowd((61,), frozenset({29, 30, 31}), 2), *crowd((62,)))),
    ],
    ids=["one", "exact, pre, corners hide", "joint", "separate", "two kinds"],
)
def test_as_the_definition_says(problem: NavigationProblem) -> None:
    """Every few dozen waits of a game, judged by the words of rules.md 4."""
    game = build_navigation_game(problem)
    waits = [node for node in range(game.arena.nodes) if 4 <= game.order[node] < 8]
    judged = waits[:: max(1, len(waits) // 400)]
    says = [
        naive_blocked(problem, int(game.cell[node]), Direction(game.order[node] - 4), game.states[game.knowledge[node]])
        for node in judged
    ]
    assert says == [game.blocked[node] >= 0 for node in judged]
    assert any(says)
    assert not all(says)

"""Assumption (c): when does an obstacle block a waiting robot although it could make way?"""

from __future__ import annotations

from art import coarse_of

from surefoot.frames import Cell, Direction
from surefoot.navigation import ObstacleState, obstacle_domain
from surefoot.navigation.obstacles import Blocking, components

CROSSING = """
#######
###.###
###.###
#.....#
###.###
###.###
#######
"""


def test_an_obstacle_that_can_step_aside_blocks() -> None:
    coarse = coarse_of(CROSSING)
    domain = obstacle_domain(coarse, frozenset())
    blocked = Blocking(coarse, domain)
    robot = coarse.grid.index(Cell(3, 1))
    in_the_way = coarse.grid.index(Cell(3, 3))
    assert blocked(robot, Direction.EAST, ObstacleState((in_the_way,), 0))


def test_an_obstacle_that_cannot_leave_does_not_count() -> None:
    """In a dead end there is no cell from which it would not threaten: the robot must not rely on it to leave."""
    coarse = coarse_of(CROSSING)
    allowed = {coarse.grid.index(Cell(3, column)) for column in (1, 2)}
    forbidden = frozenset(coarse.grid.index(cell) for cell in coarse.grid.free_cells()) - allowed
    domain = obstacle_domain(coarse, forbidden)
    robot = coarse.grid.index(Cell(3, 1))
    obstacle = coarse.grid.index(Cell(3, 2))
    assert not Blocking(coarse, domain)(robot, Direction.EAST, ObstacleState((obstacle,), 0))


def test_an_obstacle_far_away_does_not_block() -> None:
    coarse = coarse_of(CROSSING)
    domain = obstacle_domain(coarse, frozenset())
    robot = coarse.grid.index(Cell(3, 1))
    far = coarse.grid.index(Cell(3, 5))
    assert not Blocking(coarse, domain)(robot, Direction.EAST, ObstacleState((far,), 0))


def test_a_hidden_threat_blocks_only_if_it_can_show_itself() -> None:
    coarse = coarse_of(CROSSING)
    robot = coarse.grid.index(Cell(3, 1))
    near = coarse.grid.index(Cell(2, 3))
    domain = obstacle_domain(coarse, frozenset())
    hidden = ObstacleState((), domain.mask((near, coarse.grid.index(Cell(4, 3)))))
    assert Blocking(coarse, domain)(coarse.grid.index(Cell(3, 2)), Direction.EAST, hidden)
    shut_in = obstacle_domain(
        coarse,
        frozenset(coarse.grid.index(cell) for cell in coarse.grid.free_cells())
        - {near, coarse.grid.index(Cell(1, 3)), robot},
    )
    hidden = ObstacleState((), shut_in.mask((near,)))
    assert not Blocking(coarse, shut_in)(coarse.grid.index(Cell(3, 2)), Direction.EAST, hidden)


def test_components_partition_the_domain() -> None:
    coarse = coarse_of(CROSSING)
    domain = obstacle_domain(coarse, frozenset())
    without_middle = domain.everywhere & ~domain.mask((coarse.grid.index(Cell(3, 3)),))
    parts = list(components(domain, without_middle))
    assert len(parts) == 4
    assert sum(parts) == without_middle

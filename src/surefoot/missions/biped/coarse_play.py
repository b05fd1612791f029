"""A plan played cell by cell: orders, obstacles and belief, without a single walking step."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from surefoot.frames import Cell, Direction
from surefoot.missions.biped.navigator import Navigator
from surefoot.missions.obstacles.bodies import bodies_of
from surefoot.missions.obstacles.policies import Crowd, random_policies
from surefoot.missions.run_writer import RunWriter
from surefoot.missions.scenario.scene import BipedScene
from surefoot.navigation import NavigationStrategy, Order

MOST_TURNS = 400


@dataclass(frozen=True, slots=True)
class PlayTurn:
    """A turn of a play.

    Attributes:
        cell, heading: of the robot before the turn.
        goal: index of the goal that it pursues.
        obstacles: cells of the obstacles before the turn.
        order: what the strategy orders.
    """

    cell: Cell
    heading: Direction
    goal: int
    obstacles: tuple[Cell, ...]
    order: Order


@dataclass(frozen=True, slots=True)
class Play:
    """A play of a plan against obstacles that move at random.

    Attributes:
        turns: in order.
        end: where the robot is after them.
        finished: whether every goal was reached, and the first one again, within the most turns.
    """

    turns: tuple[PlayTurn, ...]
    end: Cell
    finished: bool


def coarse_play(scene: BipedScene, strategy: NavigationStrategy, seed: int, most_turns: int = MOST_TURNS) -> Play:
    """Play a strategy until every goal has been reached, and then the first one again.

    Args:
        scene: the scenario on its map.
        strategy: of its plan.
        seed: of the obstacles' choices.
        most_turns: after which the play ends in any case.
    """
    bodies, grid = bodies_of(scene.problem), scene.coarse.grid
    crowd = Crowd(bodies, random_policies(seed, len(bodies)))
    turns: list[PlayTurn] = []
    with TemporaryDirectory() as folder, RunWriter(Path(folder)) as writer:
        navigator = Navigator(scene, strategy, crowd, writer, lambda _: None)
        while len(turns) < most_turns and not _round(navigator.goals_reached):
            cell, heading, goal = grid.cell(navigator.cell), navigator.heading, navigator.goal
            obstacles = tuple(grid.cell(one) for one in crowd.cells)
            order = navigator.decide(float(len(turns)), standing=True)
            turns.append(PlayTurn(cell, heading, goal, obstacles, order))
            if not order.waits:
                target = int(scene.coarse.target[navigator.cell, order.direction])
                navigator.arrive(target, order.direction, 0)
            navigator.finish_turn(order)
        return Play(tuple(turns), grid.cell(navigator.cell), _round(navigator.goals_reached))


def _round(reached: list[int]) -> bool:
    """Return whether every goal was reached, and then the first one again."""
    return all(reached) and reached[0] > 1

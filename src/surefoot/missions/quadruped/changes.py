"""What a change of the world means for a robot that stands on it: its own cell, and a motion that has not begun.

Source: Zhou et al. 2025, VII-B; docs/quadruped.md, "When the world changes".
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from surefoot.missions.quadruped.crossing import Crossed
from surefoot.missions.quadruped.route import Pose, on_map
from surefoot.missions.quadruped.stance import Stance, stance_about
from surefoot.missions.quadruped.world import World
from surefoot.robots.quadruped import Quadruped
from surefoot.skills.values import Cell, Direction

LEAVE = "leave"
"""Begins the name of a motion out of a cell that has become an obstacle; a direction follows."""
_ABOUT = (3, 3)
_FAR = 1_000_000_000


def ways_out(world: World, pose: Pose, left: Mapping[Cell, int]) -> tuple[tuple[Direction, Cell], ...]:
    """Return the neighbouring cells that a robot may go to from a cell that has become an obstacle, best first.

    Args:
        world: the map.
        pose: where the robot is.
        left: moves from cells to the goal; cells that are not there come last.
    """
    if not math.isfinite(world.height_m(pose[0])):
        return ()
    found = [(way, cell) for way, cell in _neighbours(world, pose) if world.state(cell, pose[1]) is not None]
    return tuple(sorted(found, key=lambda one: left.get(one[1], _FAR)))


def _neighbours(world: World, pose: Pose) -> Iterator[tuple[Direction, Cell]]:
    cell, turns = pose
    for way in world.terrain.directions:
        there = on_map(cell, way.of((1, 1)), turns, _ABOUT)
        if world.inside(there):
            yield way, there


def still_fits(crossed: Crossed, world: World) -> bool:
    """Return whether a motion that was planned before the world changed has ground below all its footholds."""
    assert crossed.solution is not None
    assert crossed.solution.plan is not None
    feet_m = crossed.solution.plan.feet_m
    touched = [feet_m[step.touch, step.foot] for step in crossed.problem.footsteps]
    return all(map(world.holds, [*touched, *feet_m[-1]]))


def pushed(
    robot: Quadruped, world: World, stance: Stance, push_m: tuple[float, float], *, joint_reach: bool
) -> Stance | None:
    """Return how the robot stands after a push; None where it cannot, so that nothing moves."""
    x, y = (float(stance.base_m[k]) + push_m[k] for k in (0, 1))
    return stance_about(robot, world, (x, y), stance.quarter_turns, joint_reach=joint_reach)

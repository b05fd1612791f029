"""What a strategy does next: the skill for where the robot is and which way it faces."""

from __future__ import annotations

from dataclasses import dataclass

from surefoot.errors import InputError
from surefoot.skills.headings import FACING, HEADINGS, Turning
from surefoot.skills.manager import PairAnswer
from surefoot.skills.values import Cell, Primitive


@dataclass(frozen=True, slots=True)
class NextSkill:
    """A step of a strategy.

    Attributes:
        primitive: what to do, with classes and direction as the robot sees them.
        cell: where it leads.
        heading: the heading after it; a translational skill keeps it, as a turn keeps the cell.
    """

    primitive: Primitive
    cell: Cell
    heading: int


def next_skill(turning: Turning, answer: PairAnswer, cell: Cell, heading: int) -> NextSkill | None:
    """Return what the strategy of a pair does in a pose; None: it stays, the request is fulfilled.

    Args:
        turning: of the library, or the one that the pair was handled with.
        answer: of a pair.
        cell: where the robot is, in the grid of the pair.
        heading: in quarter turns, counter-clockwise from ahead in that grid; any whole number, as it wraps around.

    Raises:
        InputError: the strategy does not win from there.
    """
    pose = cell, heading % HEADINGS
    if pose not in answer.poses:
        raise InputError(f"there is no way to {answer.request} from {cell} facing {FACING[pose[1]]}")
    way = answer.poses[pose]
    primitive = None if way is None else turning.primitive(answer.state, pose, way)
    if way is None:
        return None
    if primitive is None:
        raise InputError(f"the strategy to {answer.request} leads from {cell} into an obstacle, or out of the grid")
    return NextSkill(primitive, *turning.after(pose, way))


def steps(turning: Turning, answer: PairAnswer) -> tuple[NextSkill, ...]:
    """Return all that the strategy of a pair does from the start on, until it stays.

    Raises:
        InputError: see ``next_skill``; or it goes round in circles.
    """
    pose, found = turning.start(answer.state), list[NextSkill]()
    while (step := next_skill(turning, answer, *pose)) is not None:
        found.append(step)
        pose = step.cell, step.heading
        if len(found) > len(answer.poses):
            raise InputError(f"the strategy to {answer.request} goes round in circles")
    return tuple(found)

"""The action game's rules as tables: contexts, turn displacements, height profiles (docs/rules.md, section 5)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from surefoot.frames import Direction
from surefoot.navigation.coarse import CoarseMap
from surefoot.navigation.navigation_rules import Order
from surefoot.walking import StepLibrary, TurnTemplate

STOP_ORDER = 4
"""The order stop, beside the four directions."""


class Mode(IntEnum):
    """How the robot walks; from LEFT_A on it is in the middle of a turn."""

    STANDING = 0
    WALKING = 1
    READY = 2
    LEFT_A = 3
    RIGHT_A = 4
    LEFT_B = 5
    RIGHT_B = 6


class Action(IntEnum):
    """What the robot does in one step; STRAIGHT + i walks ``straight_cells[i]`` cells."""

    CONTINUE = 0
    STOP = 1
    STAY = 2
    START = 3
    PRE_STEP = 4
    TURN = 5
    STRAIGHT = 6


class Context(NamedTuple):
    """An order with the height profiles of the cells that it joins; order is a direction or STOP_ORDER."""

    here: int
    order: int
    there: int


class Tables(NamedTuple):
    """The rules as arrays, for compiled code.

    Attributes:
        cells: fine cells per side.
        turn_steps: steps of a quarter turn.
        band: side band in fine cells.
        sagittal: largest sagittal deviation.
        lateral: largest lateral deviation.
        length: (actions,) fine cells of a straight action, 0 for the others.
        turn: (2 types, 2 sides, 4 headings, turn_steps, 2) displacement (rows, columns) of every turn step; type A
            is 0, left is 0.
        here, order, there: (contexts,) the contexts.
        next_first, next_context: contexts that may follow, by 4 * profile + last direction.
        axis: (profiles,) direction in which the stairs rise, -1 for flat.
        height: (profiles, cells) along the axis.
        gain: (profiles,) height gained over the cell.
        admissible: (profiles, cells) whether a foot may stand there.
        height_max: largest height change of a step.
    """

    cells: int
    turn_steps: int
    band: int
    sagittal: int
    lateral: int
    length: NDArray[np.int64]
    turn: NDArray[np.int64]
    here: NDArray[np.int64]
    order: NDArray[np.int64]
    there: NDArray[np.int64]
    next_first: NDArray[np.int64]
    next_context: NDArray[np.int64]
    axis: NDArray[np.int64]
    height: NDArray[np.float64]
    gain: NDArray[np.float64]
    admissible: NDArray[np.bool_]
    height_max: float


def order_context(coarse: CoarseMap, cell: int, order: Order) -> Context:
    """Return the context of an order in a cell."""
    here = coarse.profile(cell)
    if order.waits:
        return Context(here, STOP_ORDER, here)
    return Context(here, int(order.direction), coarse.profile(int(coarse.target[cell, order.direction])))


@dataclass(frozen=True, slots=True)
class ActionRules:
    """The rules of the action game on one map.

    Attributes:
        library: the steps.
        contexts: orders that the map can give.
        tables: the same for compiled code.
    """

    library: StepLibrary
    contexts: tuple[Context, ...]
    tables: Tables

    @property
    def cells(self) -> int:
        """Return the number of fine cells per side of a coarse cell."""
        return int(self.library.parameters.fine_cells)


def action_rules(coarse: CoarseMap, library: StepLibrary) -> ActionRules:
    """Return the action game's rules for a map and a step library."""
    parameters = library.parameters
    contexts = map_contexts(coarse)
    profiles = coarse.heights.profiles
    cells = parameters.fine_cells
    flat = (0.0,) * cells
    following = [
        _following(contexts, profile, last, is_flat=profiles[profile] is None)
        for profile in range(len(profiles))
        for last in Direction
    ]
    straight = (0, parameters.stop_cells, 0, parameters.stop_cells, parameters.pre_step_cells, 0)
    tables = Tables(
        cells=cells,
        turn_steps=parameters.turn_steps,
        band=parameters.side_band_cells,
        sagittal=parameters.sagittal_outcomes_cells,
        lateral=parameters.lateral_outcomes_cells,
        length=np.array([*straight, *parameters.straight_cells], np.int64),
        turn=np.array([_displacements(turn) for turn in (library.turn_a, library.turn_b)], np.int64),
        here=np.array([context.here for context in contexts], np.int64),
        order=np.array([context.order for context in contexts], np.int64),
        there=np.array([context.there for context in contexts], np.int64),
        next_first=np.cumsum([0, *map(len, following)], dtype=np.int64),
        next_context=np.array([context for choices in following for context in choices], np.int64),
        axis=np.array([-1 if profile is None else int(profile.up) for profile in profiles], np.int64),
        height=np.array([flat if profile is None else profile.heights_m for profile in profiles]),
        gain=np.array([0.0 if profile is None else profile.gain_m for profile in profiles]),
        admissible=np.array([(True,) * cells if profile is None else profile.admissible for profile in profiles]),
        height_max=parameters.max_step_height_m,
    )
    return ActionRules(library, contexts, tables)


def map_contexts(coarse: CoarseMap) -> tuple[Context, ...]:
    """Return one context for every kind of passable move on the map, and stop for flat cells."""
    kinds = {Context(0, STOP_ORDER, 0)}
    for cell, direction in zip(*np.nonzero(coarse.target >= 0), strict=True):
        target = int(coarse.target[cell, direction])
        kinds.add(Context(coarse.profile(int(cell)), int(direction), coarse.profile(target)))
    return tuple(sorted(kinds))


def _following(contexts: tuple[Context, ...], profile: int, last: Direction, *, is_flat: bool) -> list[int]:
    """Return the contexts that may follow when the robot is in a cell of a profile after moving in a direction."""
    return [
        number
        for number, (here, order, _) in enumerate(contexts)
        if here == profile and (is_flat if order == STOP_ORDER else order != last.opposite)
    ]


def _displacements(turn: TurnTemplate) -> list[list[list[list[int]]]]:
    """Return the displacements (rows, columns) of a turn's steps by side (left, right) and original heading."""
    return [
        [[_along(heading, side, *booked) for booked in turn.booked] for heading, side in sides]
        for sides in (
            [(heading, heading.left) for heading in Direction],
            [(heading, heading.right) for heading in Direction],
        )
    ]


def _along(heading: Direction, side: Direction, forward: int, sideways: int) -> list[int]:
    """Return the displacement (rows, columns) of some cells along a heading and some toward a side."""
    return [forward * heading.offset[axis] + sideways * side.offset[axis] for axis in (0, 1)]

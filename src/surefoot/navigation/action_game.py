"""The action game: walking steps on the fine cells of one representative coarse cell (docs/rules.md, section 5)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from surefoot.frames import Direction
from surefoot.games import Arena
from surefoot.navigation import _action_graph as graph
from surefoot.navigation import _action_moves as moves
from surefoot.navigation.action_rules import ActionRules, Context, Mode, Tables


class FineState(NamedTuple):
    """Where the robot is inside its coarse cell, and what it is about to do.

    Attributes:
        row: fine row, 0 in the north.
        column: fine column, 0 in the west.
        heading: clockwise from north.
        stance: 0 when the left foot carries the robot, 1 when the right one does.
        mode: see Mode.
        context: index of the order's context.
    """

    row: int
    column: int
    heading: int
    stance: int
    mode: int
    context: int


@dataclass(frozen=True, slots=True)
class ActionGame:
    """The game graph with the meaning of its nodes.

    Attributes:
        rules: what it was built from.
        arena: the game graph.
        kind: (nodes,) 0 state (the robot picks an action), 1 action (the environment picks the outcome), 2 boundary
            (an order was achieved, the environment picks the next one).
        code: (nodes,) number of the state or boundary; of an action node the action.
        starts: (rows, columns) the state node of every fine cell in which the robot may stand at the start, -1
            elsewhere.
    """

    rules: ActionRules
    arena: Arena
    kind: NDArray[np.int8]
    code: NDArray[np.int64]
    starts: NDArray[np.int32]

    @property
    def states(self) -> int:
        """Return the number of states of the robot."""
        return int((self.kind == graph.STATE).sum())


def build_action_game(rules: ActionRules, heading: Direction, first_context: Context) -> ActionGame:
    """Explore the action game from every fine cell in which the robot can stand at the start.

    Args:
        rules: contexts, steps and profiles.
        heading: the robot's heading at the start, standing in a flat cell with the left foot as stance foot.
        first_context: context of the first order.

    Source: Shamsah et al., T-RO 2023, VI-B, VI-C, VI-D; docs/rules.md 5.
    """
    tables = rules.tables
    across = np.arange(tables.cells)
    band = (across >= tables.band) & (across < tables.cells - tables.band)
    # The side band binds the index across the heading.
    may_stand = np.broadcast_to(band[None, :] if heading % 2 == 0 else band[:, None], (tables.cells, tables.cells))
    outer = rules.contexts.index(first_context)
    starts = np.full((tables.cells, tables.cells), -1, np.int32)
    places = np.argwhere(may_stand)
    codes = np.array(
        [
            graph.encode(tables, row, column, int(heading) * tables.turn_steps, 0, int(Mode.STANDING), outer)
            for row, column in places.tolist()
        ],
        np.int64,
    )
    starts[places[:, 0], places[:, 1]] = np.arange(len(places))
    kind, code, first, successors = graph.explore(tables, codes)
    arena = Arena(
        system=kind == graph.STATE,
        first=first,
        successors=successors,
        lost=np.zeros(len(kind), np.bool_),
        goals=(kind == graph.BOUNDARY)[None, :],
        justices=np.zeros((0, len(kind)), np.bool_),
    )
    return ActionGame(rules, arena, kind, code, starts)


class Moved(NamedTuple):
    """What a labelled outcome of an action leads to.

    Attributes:
        state: the next state; its context is still the old one when the order was achieved.
        achieved: whether the order was achieved.
        height_change_m: of the step.
    """

    state: FineState
    achieved: bool
    height_change_m: float


class Deviations(NamedTuple):
    """The largest deviations from its nominal outcome that an action may have, in fine cells."""

    sagittal: int
    lateral: int


def deviations(tables: Tables, state: FineState, action: int) -> Deviations:
    """Return by how much an action may deviate in a state."""
    return Deviations(*moves.deviations(tables, *state[:3], *state[4:], action))


def apply_action(tables: Tables, state: FineState, action: int, sagittal: int, lateral: int) -> Moved:
    """Return where an action with a labelled outcome leads.

    Args:
        tables: the rules.
        state: before.
        action: code of an allowed action.
        sagittal: deviation along the heading in fine cells.
        lateral: deviation to the left in fine cells.

    Raises:
        ValueError: if the outcome is not one that the game admits.
    """
    most = deviations(tables, state, action)
    if abs(sagittal) > most.sagittal or abs(lateral) > most.lateral:
        raise ValueError(
            f"outcome ({sagittal}, {lateral}) is not among those of action {action}: at most {most.sagittal} fine "
            f"cells along the heading and {most.lateral} sideways"
        )
    status, row, column, heading, stance, mode, change = moves.move(tables, *state, action, sagittal, lateral)
    if status == moves.LOST:
        raise ValueError(f"action {action} with outcome ({sagittal}, {lateral}) is lost in {state}")
    return Moved(FineState(row, column, heading, stance, mode, state.context), status == moves.ACHIEVED, float(change))


def displace_action(
    tables: Tables, state: FineState, action: int, outcome: tuple[int, int], moved: tuple[int, int], *, put_off: bool
) -> Moved | None:
    """Return where an action leads when a push displaces its waypoint; None where the rules of the game forbid it.

    Args:
        tables: the rules.
        state: before.
        action: code of an allowed action.
        outcome: sagittal and lateral deviation, whether the game admits it or not.
        moved: rows and columns by which the waypoint moves besides.
        put_off: a stop that is not carried out; the robot walks on.
    """
    rows, columns, heading, mode = moves.displacement(
        tables, state.heading, state.mode, state.context, action, *outcome
    )
    where = (rows + moved[0], columns + moved[1], heading, Mode.WALKING if put_off else mode)
    status, row, column, heading, stance, mode, change = moves.arrive(
        tables, state.row, state.column, state.stance, state.context, action, *map(int, where)
    )
    if status == moves.LOST:
        return None
    return Moved(FineState(row, column, heading, stance, mode, state.context), status == moves.ACHIEVED, float(change))


def standing_start(rules: ActionRules, row: int, column: int, heading: Direction, context: int) -> FineState:
    """Return the first state of a mission: standing, the left foot as stance foot."""
    return FineState(row, column, int(heading) * rules.tables.turn_steps, 0, int(Mode.STANDING), context)


def decode_states(rules: ActionRules, codes: NDArray[np.int64]) -> NDArray[np.int16]:
    """Return (states, 6) row, column, heading, stance, mode, context of state numbers."""
    tables = rules.tables
    rest, column = np.divmod(codes, tables.cells)
    rest, row = np.divmod(rest, tables.cells)
    rest, heading = np.divmod(rest, 4 * tables.turn_steps)
    rest, stance = np.divmod(rest, 2)
    context, mode = np.divmod(rest, 7)
    return np.stack([row, column, heading, stance, mode, context], axis=1).astype(np.int16)

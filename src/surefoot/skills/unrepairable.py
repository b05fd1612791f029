"""Why a request cannot be reached: obstacles, moves that failed here, or what physics refused, with its reasons."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from surefoot.skills.skill_game import CELLS, Frame, Move, S
from surefoot.skills.values import OBSTACLE, Cell, CheckResult, Physics, Primitive, TerrainState


class Cause(StrEnum):
    """What stands in the way."""

    OBSTACLE = "obstacle"
    DISALLOWED = "disallowed"
    PHYSICS = "physics"
    LIMIT = "limit"


@dataclass(frozen=True, slots=True)
class Explanation:
    """Why a pair is unrepairable.

    Attributes:
        cause: obstacles; moves disallowed at run time; physics; or a limit of the checks, so that nothing is proved.
        text: a sentence.
        primitives: refused ones, one of which every way would need; empty unless physics or a limit is the cause.
    """

    cause: Cause
    text: str
    primitives: tuple[Primitive, ...] = ()


def explain(
    state: TerrainState,
    request: Cell,
    refused: Mapping[Primitive, CheckResult],
    disallowed: Collection[tuple[Any, Any]] = (),
    frame: Frame[Any] = CELLS,
) -> Explanation:
    """Return why no way leads from the centre to a request.

    Args:
        state: classes of the cells.
        request: the cell that cannot be reached.
        refused: primitives that are not available, with the answer of physics.
        disallowed: moves that failed at run time.
        frame: what the robot's states are.
    """
    if state.label(request) == OBSTACLE:
        return Explanation(Cause.OBSTACLE, f"the requested cell {request} is an obstacle")
    every, start, goals = frame.moves(state), frame.start(state), frame.goals(request)
    if goals.isdisjoint(_reached(every, {start})):
        return Explanation(Cause.OBSTACLE, f"obstacles cut the requested cell {request} off from {state.centre}")
    allowed = [move for move in every if (move.source, move.targets[0]) not in disallowed]
    if goals.isdisjoint(_reached(allowed, {start})):
        edges = ", ".join(f"{source}->{target}" for source, target in sorted(disallowed))
        return Explanation(Cause.DISALLOWED, f"every way to {request} needs a move that failed here: {edges}")
    cut = _cut(allowed, start, goals, refused)
    unproved = [one for one in cut if refused[one].verdict is Physics.UNKNOWN]
    reasons = "; ".join(f"{one.name}: {refused[one].explanation or refused[one].verdict}" for one in cut)
    if unproved:
        return Explanation(Cause.LIMIT, f"every way to {request} needs one of these, not all decided: {reasons}", cut)
    return Explanation(Cause.PHYSICS, f"every way to {request} needs one of these, all infeasible: {reasons}", cut)


def _cut(
    moves: Iterable[Move[S]], start: S, goals: Collection[S], refused: Collection[Primitive]
) -> tuple[Primitive, ...]:
    """Return refused primitives that close every way: those around what the start reaches, or what reaches the request.

    Of the two sets the one with fewer primitives; it holds only such as the start could come to, and lead on.
    """
    every = list(moves)
    left = [move for move in every if move.skill not in refused]
    near, towards = _reached(left, {start}), _reached(_reversed(left), goals)
    onward, upto = _reached(_reversed(every), goals), _reached(every, {start})
    out = {move.skill for move in every if move.source in near and move.targets[0] in onward - near}
    into = {move.skill for move in every if move.targets[0] in towards and move.source in upto - towards}
    return tuple(sorted(out if len(out) <= len(into) else into))


def _reversed(moves: Iterable[Move[S]]) -> list[Move[S]]:
    return [Move(move.targets[0], move.skill, (move.source,)) for move in moves]


def _reached(moves: Iterable[Move[S]], start: Iterable[S]) -> set[S]:
    after: dict[S, list[S]] = {}
    for move in moves:
        after.setdefault(move.source, []).append(move.targets[0])
    seen = set(start)
    stack = list(seen)
    while stack:
        for place in after.get(stack.pop(), ()):
            if place not in seen:
                seen.add(place)
                stack.append(place)
    return seen

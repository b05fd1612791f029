"""Why a request cannot be reached: obstacles, moves that failed here, or what physics refused, with its reasons."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum

from surefoot.skills.encoding import Edge
from surefoot.skills.skill_game import Move, every_move
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
    disallowed: Collection[Edge] = (),
) -> Explanation:
    """Return why no way leads from the centre to a request.

    Args:
        state: classes of the cells.
        request: the cell that cannot be reached.
        refused: primitives that are not available, with the answer of physics.
        disallowed: moves that failed at run time.
    """
    if state.label(request) == OBSTACLE:
        return Explanation(Cause.OBSTACLE, f"the requested cell {request} is an obstacle")
    every = every_move(state)
    if request not in _reached(every, state.centre):
        return Explanation(Cause.OBSTACLE, f"obstacles cut the requested cell {request} off from {state.centre}")
    allowed = [move for move in every if (move.source, move.targets[0]) not in disallowed]
    if request not in _reached(allowed, state.centre):
        edges = ", ".join(f"{source}->{target}" for source, target in sorted(disallowed))
        return Explanation(Cause.DISALLOWED, f"every way to {request} needs a move that failed here: {edges}")
    cut = _cut(allowed, state.centre, request, refused)
    unproved = [one for one in cut if refused[one].verdict is Physics.UNKNOWN]
    reasons = "; ".join(f"{one.name}: {refused[one].explanation or refused[one].verdict}" for one in cut)
    if unproved:
        return Explanation(Cause.LIMIT, f"every way to {request} needs one of these, not all decided: {reasons}", cut)
    return Explanation(Cause.PHYSICS, f"every way to {request} needs one of these, all infeasible: {reasons}", cut)


def _cut(
    moves: Iterable[Move[Cell]], start: Cell, request: Cell, refused: Collection[Primitive]
) -> tuple[Primitive, ...]:
    """Return refused primitives that close every way: those around what the start reaches, or what reaches the request.

    Of the two sets the one with fewer primitives; it holds only such as the start could come to, and lead on.
    """
    every = list(moves)
    left = [move for move in every if move.skill not in refused]
    near, towards = _reached(left, start), _reached(_reversed(left), request)
    onward, upto = _reached(_reversed(every), request), _reached(every, start)
    out = {move.skill for move in every if move.source in near and move.targets[0] in onward - near}
    into = {move.skill for move in every if move.targets[0] in towards and move.source in upto - towards}
    return tuple(sorted(out if len(out) <= len(into) else into))


def _reversed(moves: Iterable[Move[Cell]]) -> list[Move[Cell]]:
    return [Move(move.targets[0], move.skill, (move.source,)) for move in moves]


def _reached(moves: Iterable[Move[Cell]], start: Cell) -> set[Cell]:
    after: dict[Cell, list[Cell]] = {}
    for move in moves:
        after.setdefault(move.source, []).append(move.targets[0])
    seen, stack = {start}, [start]
    while stack:
        for cell in after.get(stack.pop(), ()):
            if cell not in seen:
                seen.add(cell)
                stack.append(cell)
    return seen

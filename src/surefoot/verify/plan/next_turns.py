"""The heading changes that may be commanded after a step: derived from rules.md 5, compared with what a log lists."""

from __future__ import annotations

import math

from surefoot.verify.findings import Ledger
from surefoot.verify.navigation.claims import Claims
from surefoot.verify.plan.action import Core
from surefoot.verify.plan.moves import CONTINUE, READY, STRAIGHT, TURN, Rules, allowed, order_side
from surefoot.verify.scene.derived import STOP, Cell, Context, Scene

TOLERANCE_RAD = 1e-6


def contexts_after(scene: Scene, claims: Claims, cell: Cell, last: int) -> list[int]:
    """Return the contexts that may come when an order has been achieved (rules.md 5, next context).

    Args:
        scene: the scene.
        claims: names the contexts.
        cell: where the robot is.
        last: the direction of its last move; after a stop its heading.
    """
    kind = claims.kinds[cell]
    moves = [move for move in scene.moves(cell) if move != (last + 2) % 4]
    found = [(kind, int(move), claims.kinds[scene.target(cell, move)]) for move in moves]
    found += [(0, STOP, 0)] if kind == 0 else []
    return [_number(claims, context) for context in found if context in claims.contexts]


def _number(claims: Claims, context: Context) -> int:
    return claims.contexts.index(context)


def heading_changes_rad(rules: Rules, core: Core, contexts: list[int]) -> tuple[float, ...]:
    """Return the heading changes, left positive, that the action game allows in a state with any of some contexts."""
    angle_rad, found = math.pi / 2 / int(rules.sizes[2]), set()
    _, _, heading, stance, mode = core
    for context in contexts:
        order = int(rules.order[context])
        for action in range(STRAIGHT + len(rules.straight)):
            if not allowed(rules, heading, stance, mode, order, action):
                continue
            right = mode % 2 == 0 if mode > READY else order_side(rules, heading, order) == 1
            found.add((-angle_rad if right else angle_rad) if action in (TURN, CONTINUE) else 0.0)
    return tuple(sorted(found))


def check_listed(
    listed: tuple[float, ...], needed: tuple[float, ...], turn_steps: int, line: int, ledger: Ledger
) -> None:
    """Check the list of heading changes of one step.

    Args:
        listed: what the log says.
        needed: what the action game allows next.
        turn_steps: of a quarter turn.
        line: of the log.
        ledger: takes the findings.
    """
    rule, where = "formats.md 3, next_heading_changes_rad", f"run.jsonl line {line}"
    angle_rad = math.pi / 2 / turn_steps
    strange = [value for value in listed if not _among(value, (0.0, angle_rad, -angle_rad))]
    if strange:
        ledger.refuse(rule, f"lists {strange[0]:g}, which is neither 0 nor the turn angle to a side", where)
    missing = [value for value in needed if not _among(value, listed)]
    if missing:
        ledger.refuse(rule, f"lacks {missing[0]:g}, which the action game may command next", where)


def _among(value: float, others: tuple[float, ...]) -> bool:
    return any(abs(value - other) <= TOLERANCE_RAD for other in others)

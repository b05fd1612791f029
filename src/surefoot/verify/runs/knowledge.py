"""What the robot knows from turn to turn of a run: rules.md 4, and formats.md 3 where assumptions are broken."""

from __future__ import annotations

from collections.abc import Sequence

from surefoot.frames import Direction
from surefoot.verify.navigation.belief import KindKnown, Known, Obstacles
from surefoot.verify.navigation.claims import Claims
from surefoot.verify.navigation.decisions import WAIT, Decision
from surefoot.verify.scene.derived import ObstacleKind, Scene

COLLIDES, FORBIDDEN, JUMPS, APPEARS, VANISHES = VIOLATIONS = ("collides", "forbidden", "jumps", "appears", "vanishes")
Seen = tuple[tuple[int, ...], ...]


def seen_obstacles(scene: Scene, truths: Sequence[int], viewer: int) -> Seen:
    """Return for every kind the cells in which its obstacles are seen, ascending.

    Args:
        scene: the scene.
        truths: the true cell of every obstacle.
        viewer: the view cell.
    """
    sees = scene.sees[viewer]
    return tuple(
        tuple(sorted(truths[member] for member in kind.members if sees[truths[member]]))
        for kind in scene.obstacle_kinds
    )


def learnt(obstacles: Obstacles, before: Decision, after: int, seen: Seen, *, waits: bool) -> list[KindKnown | None]:
    """Return what is known of every kind after a turn; None where no outcome has the visible cells that are seen.

    Args:
        obstacles: of the game that is played.
        before: the decision of the turn.
        after: the robot's cell after it.
        seen: the cells seen from the view cell.
        waits: whether the robot stood.
    """
    turned = obstacles.turn(before.known, before.cell, after, waits=waits)
    return [
        next((option for option in options if option.visible == cells), None)
        for options, cells in zip(turned.kinds, seen, strict=True)
    ]


def breach(
    obstacles: Obstacles, kind: int, before: Decision, seen: Sequence[int], *, waits: bool
) -> tuple[str, int | None]:
    """Return which assumption a kind has broken when its visible cells have no explanation, and where that is seen."""
    if waits and before.cell in seen:
        return COLLIDES, before.cell
    outside = [cell for cell in seen if cell not in obstacles.kinds[kind].domain]
    if outside:
        return FORBIDDEN, outside[0]
    known, barred = before.known[kind], before.cell if waits else None
    near = {cell for home in known.visible + known.hidden for cell in obstacles.next_of(kind, home, barred)}
    strange = [cell for cell in seen if cell not in near]
    if strange:
        return (APPEARS if known.hidden else JUMPS), strange[0]
    return VANISHES, None


def reset(scene: Scene, viewer: int, seen: Seen) -> Known:
    """Return what is known when nothing is assumed of the past: what is seen, and everything out of sight."""
    found = []
    for kind, cells in zip(scene.obstacle_kinds, seen, strict=True):
        unseen = tuple(cell for cell in kind.domain if not scene.sees[viewer, cell])
        found.append(KindKnown(cells, unseen if len(cells) < len(kind.members) else ()))
    return tuple(found)


def unexplained(scene: Scene, known: Known) -> bool:
    """Return whether an obstacle is out of sight although its whole domain is seen: no game can begin so."""
    return any(
        len(part.visible) < len(kind.members) and not part.hidden
        for kind, part in zip(scene.obstacle_kinds, known, strict=True)
    )


def enlarged(scene: Scene, seen: Seen) -> tuple[ObstacleKind, ...]:
    """Return the kinds with the domains of a game that is planned anew: with the cells where obstacles are seen."""
    return tuple(
        ObstacleKind(kind.members, tuple(sorted({*kind.domain, *cells})), kind.speed_cells)
        for kind, cells in zip(scene.obstacle_kinds, seen, strict=True)
    )


def order_without_strategy(scene: Scene, claims: Claims, cell: int, heading: int) -> int:
    """Return the order that stops the robot, or leads it off the stairs, while no strategy decides."""
    where, ahead = scene.cell(cell), Direction(heading)
    if claims.kinds[where] != 0:
        return heading
    moves = [move for move in (ahead, *Direction) if move != ahead.opposite and move in scene.moves(where)]
    return WAIT + int(moves[0] if moves else ahead)

"""The obstacles' turn by brute force: every assignment of rules.md 4, one after the other, with sets of cells."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import product

from surefoot.frames import Direction
from surefoot.verify.navigation.belief import Abstraction, KindKnown, Known, Obstacles, Turned
from surefoot.verify.scene.derived import ObstacleKind, Scene

Cells = frozenset[int]


def next_cells(scene: Scene, kind: ObstacleKind, cell: int, barred: int | None) -> Cells:
    """Return where one obstacle may be after a turn."""
    found = {cell}
    for _ in range(kind.speed_cells):
        found |= {other for home in found for other in _beside(scene, kind, home) if other != barred}
    return frozenset(found - {barred})


def _beside(scene: Scene, kind: ObstacleKind, cell: int) -> Iterator[int]:
    """Yield the neighbours of a cell in a kind's domain."""
    rows, columns = scene.frame.rows, scene.frame.columns
    for move in Direction:
        row, column = scene.target(scene.cell(cell), move)
        if 0 <= row < rows and 0 <= column < columns and row * columns + column in kind.domain:
            yield row * columns + column


def widened(scene: Scene, belief: Abstraction, kind: ObstacleKind, hidden: Cells, seen: Cells) -> Cells:
    """Return the belief abstraction of a hidden image."""
    if belief.method == "exact" or not hidden:
        return hidden
    domain = frozenset(kind.domain)
    if belief.method == "single":
        return domain - seen
    rest = frozenset(scene.index(cell) for cell in scene.kinds).difference(*belief.regions)
    touched = [region for region in (*belief.regions, rest) if region & hidden]
    return domain.intersection(frozenset().union(*touched)) - seen


def outcomes_of_kind(
    scene: Scene, belief: Abstraction, kind: ObstacleKind, part: KindKnown, viewer: int, barred: int | None
) -> dict[tuple[int, ...], list[Cells]]:
    """Return for every observation of some assignment the hidden image of each assignment that fits."""
    seen = frozenset(cell for cell in kind.domain if scene.sees[viewer, cell])
    hidden = frozenset().union(*(next_cells(scene, kind, cell, barred) for cell in part.hidden))
    images = [next_cells(scene, kind, cell, barred) for cell in part.visible]
    images += [hidden] * (len(kind.members) - len(part.visible))
    found: dict[tuple[int, ...], list[Cells]] = {}
    for choice in product(*([*sorted(image & seen), *([-1] if image - seen else [])] for image in images)):
        out_of_sight = [image - seen for image, cell in zip(images, choice, strict=True) if cell < 0]
        visible = tuple(sorted(cell for cell in choice if cell >= 0))
        found.setdefault(visible, []).append(frozenset().union(*out_of_sight))
    return found


class PureObstacles(Obstacles):
    """Obstacles whose turns are worked out by brute force; ``merge`` says what becomes of several hidden images."""

    def __init__(self, scene: Scene, belief: Abstraction, kinds: tuple[ObstacleKind, ...] | None = None) -> None:
        super().__init__(scene, belief, kinds)
        self.belief = belief

    def merge(self, images: Iterable[Cells]) -> Cells:
        """Return the hidden image of one observation."""
        return frozenset().union(*images)

    def turn(self, known: Known, robot: int, after: int, *, waits: bool) -> Turned:
        """Return the outcomes of one turn."""
        viewer, barred = after if self.scene.scenario.view_post else robot, robot if waits else None
        lost, kinds = False, []
        for kind, part in zip(self.kinds, known, strict=True):
            seen = frozenset(cell for cell in kind.domain if self.scene.sees[viewer, cell])
            found = outcomes_of_kind(self.scene, self.belief, kind, part, viewer, barred)
            entered = {
                cell for home in part.visible + part.hidden for cell in next_cells(self.scene, kind, home, barred)
            }
            lost |= not waits and bool(entered & {robot, after})
            hidden = {v: widened(self.scene, self.belief, kind, self.merge(h), seen) for v, h in found.items()}
            kinds.append(tuple(KindKnown(visible, tuple(sorted(cells))) for visible, cells in hidden.items()))
        return Turned(lost, tuple(kinds))

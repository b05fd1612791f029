"""Scripts of obstacles: YAML files that say where each is after every turn (docs/formats.md, section 3)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from surefoot.documents import Loc, is_format, read_yaml, unknown_key
from surefoot.errors import InputError
from surefoot.missions.obstacles.bodies import Body
from surefoot.missions.obstacles.policies import Situation
from surefoot.world import CoarseGrid

FARTHEST_M = 1e6
TURNS_ROUND_AFTER = 3
_KIND = "obstacle-script"
_FLAGS = ("repeat", "breaks_assumptions")
_KEYS = ("format", "kind", "positions_m", *_FLAGS)


_Lines = dict[Loc, int]


@dataclass(frozen=True, slots=True)
class Script:
    """Where obstacles are after each turn.

    Attributes:
        tours: cells of every obstacle.
        repeat: whether the tours begin again after their ends.
        breaks_assumptions: whether the obstacles do as written, whatever the rules say.
    """

    tours: tuple[tuple[int, ...], ...]
    repeat: bool
    breaks_assumptions: bool

    def policies(self) -> tuple[Follower, ...]:
        """Return what each obstacle does."""
        return tuple(Follower(tour, repeat=self.repeat, lawless=self.breaks_assumptions) for tour in self.tours)


class Follower:
    """Follows a tour; where a standing robot is in the way it waits, and the rest comes that much later.

    On a tour that repeats it turns round when it has waited for TURNS_ROUND_AFTER turns, and goes on backwards:
    otherwise the robot, which waits for it, and it would wait for each other for ever (docs/rules.md 4, (c)).

    Args:
        tour: cells after turn 0, 1, ...
        repeat: whether the tour begins again after its end; else the obstacle stays there.
        lawless: whether it goes where it wants.
    """

    def __init__(self, tour: tuple[int, ...], *, repeat: bool, lawless: bool) -> None:
        self._tour, self._repeat, self._lawless = tour, repeat, lawless
        self._place, self._way, self._waited = -1, 1, 0

    def __call__(self, situation: Situation) -> int:
        """Return the next cell."""
        place = self._place + self._way
        if self._repeat and self._tour:
            place %= len(self._tour)
        if not 0 <= place < len(self._tour):
            return situation.truth
        wanted = self._tour[place]
        if not self._lawless and wanted not in situation.legal:
            self._waited += 1
            if self._repeat and self._waited >= TURNS_ROUND_AFTER and self._place >= 0:
                self._way, self._waited = -self._way, 0
            return situation.truth
        self._place, self._waited = place, 0
        return wanted


def read_script(path: Path, grid: CoarseGrid, bodies: tuple[Body, ...]) -> Script:
    """Read a script and check every move in it.

    Args:
        path: the file.
        grid: the coarse grid.
        bodies: the obstacles, in the order of the scenario.

    Raises:
        InputError: if the file is no such script, or asks for a move that the rules forbid.
    """
    document = read_yaml(path)
    if document.problems:
        raise document.problems[0]
    content, lines = document.value, document.lines
    if not isinstance(content, dict) or content.get("kind") != _KIND or not is_format(content.get("format")):
        raise InputError("must be a mapping with format: 1, kind: obstacle-script and positions_m", source=path)
    strange = next((key for key in content if key not in _KEYS), None)
    if strange is not None:
        raise InputError(unknown_key(strange, _KEYS), source=path, line=lines.get((strange,)), key=strange)
    positions = content.get("positions_m")
    if not isinstance(positions, tuple):
        message = "has to be a list of [x, y] in metres, or a list of such lists"
        raise InputError(message, source=path, line=lines.get(("positions_m",)), key="positions_m")
    repeat, breaks = (_flag(path, content, lines, name) for name in _FLAGS)
    tours = _tours(path, grid, positions, lines, len(bodies))
    script = Script(tuple(tuple(cell for cell, _ in tour) for tour in tours), repeat, breaks)
    if not breaks:
        for body, tour in zip(bodies, tours, strict=True):
            _check_moves(path, grid, body, tour, repeat=repeat)
    return script


def _flag(path: Path, content: dict[object, object], lines: _Lines, name: str) -> bool:
    value = content.get(name, False)
    if not isinstance(value, bool):
        raise InputError("must be true or false", source=path, line=lines.get((name,)), key=name)
    return value


_Tour = list[tuple[int, tuple[int | None, str]]]
"""Cells, each with its line and key in the file."""


def _tours(path: Path, grid: CoarseGrid, positions: tuple[object, ...], lines: _Lines, count: int) -> list[_Tour]:
    """Return a tour for every obstacle."""
    several = any(isinstance(part, tuple) and (not part or isinstance(part[0], tuple)) for part in positions)
    lists = positions if several else (positions,)
    if len(lists) != count:
        raise InputError(
            f"holds positions of {len(lists)} obstacle{'s' * (len(lists) != 1)}; the scenario has {count}",
            source=path,
            line=lines.get(("positions_m",)),
            key="positions_m",
        )
    tours = []
    for number, tour in enumerate(lists):
        place: Loc = ("positions_m", number) if several else ("positions_m",)
        if not isinstance(tour, tuple) or not tour:
            message = "must be a list of [x, y] in metres, of at least one"
            raise InputError(message, source=path, line=lines.get(place), key=_dotted(place))
        stops = [(*place, index) for index in range(len(tour))]
        tours.append(
            [
                (_cell(path, grid, position, _dotted(stop), lines.get(stop)), (lines.get(stop), _dotted(stop)))
                for position, stop in zip(tour, stops, strict=True)
            ]
        )
    return tours


def _dotted(place: Loc) -> str:
    return str(place[0]) + "".join(f"[{index}]" for index in place[1:])


def _check_moves(path: Path, grid: CoarseGrid, body: Body, tour: _Tour, *, repeat: bool) -> None:
    """Refuse a move that an obstacle cannot make in a turn."""
    again = [tour[0]] if repeat and tour else []
    before = body.start
    for cell, (line, key) in [*tour, *again]:
        allowed = body.next_cells(before)
        if cell not in allowed:
            names = ", ".join(str(tuple(grid.cell(near))) for near in allowed)
            raise InputError(
                f"the obstacle cannot go from {tuple(grid.cell(before))} to {tuple(grid.cell(cell))}; "
                f"allowed are {names}",
                source=path,
                line=line,
                key=key,
            )
        before = cell


def _cell(path: Path, grid: CoarseGrid, position: object, key: str, line: int | None) -> int:
    """Return the cell of one position of a script."""
    numbers = [value for value in position if type(value) in (int, float)] if isinstance(position, tuple) else []
    if (
        not isinstance(position, tuple)
        or len(position) != 2
        or len(numbers) != 2
        or max(map(abs, numbers)) > FARTHEST_M
    ):
        raise InputError(f"must be [x, y] in metres, at most {FARTHEST_M:g}", source=path, line=line, key=key)
    cell = grid.cell_at((float(numbers[0]), float(numbers[1])))
    if cell is None or not grid.is_free(cell):
        raise InputError("lies in no free cell", source=path, line=line, key=key)
    return grid.index(cell)

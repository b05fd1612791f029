"""Follows the automaton of a quadruped's run: every request's strategy, and every move that a segment makes."""

from __future__ import annotations

from collections.abc import Iterator

from surefoot.compute import sha256_of
from surefoot.verify.findings import Ledger
from surefoot.verify.quadruped.claims import LEAVE
from surefoot.verify.quadruped.file import QuadrupedRun
from surefoot.verify.skills.plans import TURNS, WAYS, Motion
from surefoot.verify.terrain.cell_classes import on_map
from surefoot.verify.terrain.map import Cell
from surefoot.verify.values import Fields

Labels = tuple[tuple[str, ...], ...]
Pose = tuple[Cell, int]
OBSTACLE = "obstacle"
_SOURCES = ("library", "synthesis", "repair")
_WINNING = ("realizable", "repaired")
_VERDICTS = ("feasible", "infeasible", "unknown")


class Automaton:
    """The strategy in force, and where the robot is in it.

    Args:
        run: as it was read.
        ledger: takes the findings.
        grid: rows and columns of a local grid.
    """

    def __init__(self, run: QuadrupedRun, ledger: Ledger, grid: Cell) -> None:
        self.run, self.ledger, self.grid = run, ledger, grid
        checks = () if run.library is None else run.library.mappings("checks")
        self.certified = {one.text("primitive") for one in checks if one.text("verdict") == "feasible"}
        self.unavailable = {one.text("primitive") for one in checks} - self.certified
        self.pairs = frozenset() if run.library is None else frozenset(_pairs(run.library))
        self.requests = 0
        self.labels: Labels = ()
        self.turned: dict[str, str] | None = None
        if run.library is not None and run.library.has("headings"):
            names = run.library.mapping("headings").mapping("turned")
            self.turned = {name: names.text(name) for name in names.values}
        self.strategy: dict[Pose, str | None] = {}
        self.local: Pose | None = None
        self.lost: set[tuple[Pose, Pose]] = set()
        self.given_up: set[tuple[Cell, Cell]] = set()

    def _refuse(self, rule: str, message: str, place: str) -> None:
        self.ledger.refuse(f"quadruped, {rule}", message, place)

    def request(self, record: Fields, place: str, cell: Cell, turns: int) -> Labels:
        """Take over the strategy of a request, after following it from where the robot is."""
        if record.whole("number") != self.requests:
            self._refuse("request", f"has number {record.whole('number')}, not {self.requests}", place)
        self.requests += 1
        self.labels = self._labels(record)
        if record.cell("cell") != cell or record.whole("quarter_turns") % 4 != turns % 4:
            self._refuse("request", f"is made in another place than {cell}, where the robot is", place)
        if (
            record.text("source", among=_SOURCES) == "library"
            and (self.labels, record.cell("request")) not in self.pairs
        ):
            self._refuse("request", "is said to be from the library, which has no strategy for it", place)
        self.certify(record, place)
        self._check_answer(record, (cell, turns), place)
        self.strategy = dict(self._row(record, row) for row in record.items("strategy"))
        self.local = None
        if record.text("outcome") in _WINNING:
            self.local = (self.grid[0] // 2, self.grid[1] // 2), 0
            self._follow(record.cell("request"), (cell, turns), place)
        return self.labels

    def _check_answer(self, record: Fields, looked: Pose, place: str) -> None:
        """Check that a reason is given if and only if there is no strategy, and which moves were not to be used."""
        reasoned = record.get("why") is not None and bool(record.text("why"))
        if reasoned == (record.text("outcome") in _WINNING):
            self._refuse("request", "gives a reason with a strategy, or none without", place)
        given = record.lists_of_cells("disallowed")
        rows, columns = self.grid
        cells = [(row, column) for row in range(rows) for column in range(columns)]
        local = {self._on_map(looked, (cell, heading)): cell for cell in cells for heading in range(4)}
        lost = {(local[a], local[b]) for a, b in self.lost if a in local and b in local}
        if set(given) != lost:
            self._refuse("request", "disallowed moves are not those that failed in this grid", place)

    def withdrawn(self, record: Fields, place: str) -> None:
        """Check that a motion that was withdrawn is what the strategy does here, if that is still in force."""
        name, way = record.get("primitive"), None if self.local is None else self.strategy.get(self.local)
        if name is None or record.text("primitive").startswith(LEAVE):
            return
        if self.local is not None and (
            way is None or name != self._primitive(self.local, _after(self.local, way), way)
        ):
            self._refuse("withdrawn", f"{name} is not what the strategy does here", place)

    def _row(self, record: Fields, row: object) -> tuple[Pose, str | None]:
        """Return a row of a strategy: cell and way, or cell, heading and way."""
        if isinstance(row, list) and len(row) in (3, 4) and (row[-1] is None or row[-1] in (*WAYS, *TURNS)):
            return ((row[0], row[1]), row[2] if len(row) == 4 else 0), row[-1]
        ways = ", ".join((*WAYS, *TURNS))
        raise record.wrong("strategy", f"has to be a list of [row, column, (heading,) one of {ways} or null]")

    def _labels(self, record: Fields) -> Labels:
        rows = record.items("labels")
        if len(rows) != self.grid[0] or not all(isinstance(row, list) and len(row) == self.grid[1] for row in rows):
            raise record.wrong("labels", f"has to be a grid of {self.grid[0]} x {self.grid[1]}")
        return tuple(tuple(map(str, row)) for row in rows if isinstance(row, list))

    @property
    def refused(self) -> set[str]:
        """Return the skills that physics was asked for in vain."""
        return self.unavailable - self.certified

    def certify(self, record: Fields, place: str) -> None:
        """Add the skills that were found, before the robot set out or for a request, and those that were not."""
        answers = [(one.text("primitive"), one.text("verdict", among=_VERDICTS)) for one in record.mappings("asked")]
        found = {name for name, verdict in answers if verdict == "feasible"}
        self.unavailable |= {name for name, _ in answers} - found
        if found != {new.text("primitive") for new in record.mappings("new")}:
            self._refuse("skill", "new skills are not those that physics was asked for and found", place)
        for new in record.mappings("new"):
            self._certify(new, place)

    def _certify(self, new: Fields, place: str) -> None:
        """Add a skill that was found on the way, if its certificate holds."""
        named = new.mapping("plan")
        path = self.run.folder / named.text("path")
        if not path.resolve().is_relative_to(self.run.folder.resolve()) or not path.is_file():
            raise named.wrong("path", "has to be a file inside the run folder")
        primitive = new.text("primitive")
        way = primitive.split(" ")[0]
        if way not in (*WAYS, *TURNS):
            raise new.wrong("primitive", f"has to begin with one of {', '.join((*WAYS, *TURNS))}")
        changed = sha256_of(path) != named.text("sha256")
        problem = "was changed" if changed else Motion.of(path).misses(way, self.run.ground.cell_m / 2)
        if problem:
            self._refuse("skill", f"the certificate of {primitive} does not hold: it {problem}", place)
        else:
            self.certified.add(primitive)

    def _label(self, cell: Cell) -> str:
        inside = 0 <= cell[0] < self.grid[0] and 0 <= cell[1] < self.grid[1]
        return self.labels[cell[0]][cell[1]] if inside else OBSTACLE

    def _follow(self, request: Cell, looked: Pose, place: str) -> None:
        """Check that a strategy comes to its request by certified moves, none of which has failed here."""
        local = self.local
        assert local is not None
        for _ in range(4 * self.grid[0] * self.grid[1]):
            way = self.strategy.get(local, "missing")
            if way is None or way == "missing":
                break
            after = _after(local, way)
            self._check_move(local, after, way, looked, place)
            local = after
        if local[0] != request or self.strategy.get(local, "missing") is not None:
            self._refuse("strategy", f"does not come to {request} and stay there", place)

    def _primitive(self, local: Pose, after: Pose, way: str) -> str:
        return f"{way} {self._seen(local)}->{self._seen(after)}"

    def _seen(self, local: Pose) -> str:
        """Return the class of a cell as a robot with a heading in the grid sees it."""
        return self.named(self._label(local[0]), local[1])

    def named(self, label: str, heading: int) -> str:
        """Return what a robot with a heading in the grid calls a class."""
        if heading % 2 == 0:
            return label
        if self.turned is None and self.run.ground.rules.bars:
            across, dash, along = label.partition("-")
            return f"{along}-{across}" if dash else label
        return (self.turned or {}).get(label, label)

    def closed(self, here: Pose, there: Pose) -> bool:
        """Return whether a move failed on this ground, or was given up since the world last changed."""
        return (here, there) in self.lost or (here[0], there[0]) in self.given_up

    def _check_move(self, local: Pose, after: Pose, way: str, looked: Pose, place: str) -> None:
        primitive = self._primitive(local, after, way)
        if OBSTACLE in (self._label(local[0]), self._label(after[0])):
            self._refuse("strategy", f"goes {way} from {local[0]}, out of the grid or into an obstacle", place)
        elif primitive not in self.certified:
            self._refuse("strategy", f"goes {way} from {local[0]}, and {primitive} is no certified skill", place)
        ends = self._on_map(looked, local), self._on_map(looked, after)
        if ends in self.lost:
            self._refuse("disallowed", f"goes from {ends[0][0]} to {ends[1][0]}, which has failed in this run", place)

    def _on_map(self, looked: Pose, local: Pose) -> Pose:
        offset = local[0][0] - self.grid[0] // 2, local[0][1] - self.grid[1] // 2
        return on_map(looked[0], offset, looked[1]), (looked[1] + local[1]) % 4

    def failed(self, record: Fields, place: str, here: Cell, there: Cell, turns: int) -> None:
        """Remember a move that failed: it must not be asked for again, and its strategy is over."""
        before, after = record.wholes("quarter_turns", 2)
        if record.text("primitive").startswith(LEAVE):
            self._leave(record, place, (here, turns), (there, after))
        else:
            self._as_ordered(record, place, (here, turns), (there, after))
        self.lost.add(((here, before % 4), (there, after % 4)))
        self.local = None

    def interrupted(self) -> None:
        """Drop the strategy when the robot finds itself elsewhere: it may not be followed any more."""
        self.local = None

    def move(self, record: Fields, place: str, here: Cell, there: Cell, turns: int) -> int:
        """Check that a segment does what the strategy says; return the heading after it."""
        before, after_turns = record.wholes("quarter_turns", 2)
        if before % 4 != turns % 4:
            self._refuse("heading", f"begins with {before} quarter turns, but the robot has {turns}", place)
        if record.get("primitive") is None:
            if (here, before) != (there, after_turns):
                self._refuse("move", f"goes from {here} to {there}, or turns, without a skill", place)
            return turns
        if record.text("primitive").startswith(LEAVE):
            self._leave(record, place, (here, turns), (there, after_turns))
            self.local = None
        else:
            self.local = self._as_ordered(record, place, (here, turns), (there, after_turns))
        return after_turns % 4

    def _as_ordered(self, record: Fields, place: str, here: Pose, there: Pose) -> Pose | None:
        """Check that a move is what the strategy does here; return where it leads in the grid."""
        primitive = record.text("primitive")
        local, after = record.cells("move")
        way = None if self.local is None else self.strategy.get(self.local)
        if self.local is None or way is None or local != self.local[0] or _after(self.local, way)[0] != after:
            self._refuse("move", f"{primitive} is not what the strategy does here", place)
            return self.local
        target = _after(self.local, way)
        if primitive != self._primitive(self.local, target, way):
            self._refuse("move", f"{primitive} is not the move from {local} {way}", place)
        if _after((here[0], here[1] % 4), way) != (there[0], there[1] % 4):
            self._refuse("move", f"goes from {here[0]} to {there[0]}, which is not {way}", place)
        return target

    def _leave(self, record: Fields, place: str, here: Pose, there: Pose) -> None:
        """Check that a motion out of a cell that has become an obstacle goes one cell, as the robot may walk."""
        primitive = record.text("primitive")
        way = primitive.removeprefix(LEAVE)
        if record.get("move") is not None or way not in self.run.ground.directions:
            self._refuse("leave", f"{primitive} is no way for this robot, or has a place in a strategy", place)
        elif _after((here[0], here[1] % 4), way) != (there[0], there[1] % 4):
            self._refuse("leave", f"goes from {here[0]} to {there[0]}, which is not {way}", place)


def _pairs(library: Fields) -> Iterator[tuple[Labels, Cell]]:
    """Yield the terrain states and requests that a library has strategies for."""
    states = [tuple(tuple(map(str, row)) for row in rows) for rows in library.items("states") if isinstance(rows, list)]
    for pair in library.mappings("pairs"):
        if pair.text("outcome") in _WINNING:
            yield states[pair.whole("state", least=0, most=len(states) - 1)], pair.cell("request")


def _after(local: Pose, way: str) -> Pose:
    cell, heading = local
    if way in TURNS:
        return cell, (heading + TURNS[way]) % 4
    return on_map(cell, WAYS[way], heading), heading

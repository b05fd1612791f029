"""Checks a library of skills: certificates, strategies, and every pair that is said to have none.

Written from formats.md, section "Library of skills". It shares nothing with the synthesis: a strategy is followed cell
by cell on the grid, the plan of every skill goes through the checker of foothold plans, and where no strategy is said
to exist, a search over all moves that physics did not refuse must not reach the request. Where the terrain file is at
hand, the classes of its cells are measured again.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from surefoot.compute import sha256_of
from surefoot.verify.artefacts import read_fields
from surefoot.verify.findings import Ledger
from surefoot.verify.skills.claims import check_claims
from surefoot.verify.skills.moves import (
    FACING,
    OBSTACLE,
    Cell,
    Headings,
    Labels,
    Place,
    Primitive,
    inside,
    label_at,
    led,
    moves,
    primitive_at,
)
from surefoot.verify.skills.plans import TURNS, WAYS, Motion, certificate_problem
from surefoot.verify.skills.states import check_states
from surefoot.verify.values import Fields

_VERDICTS = ("feasible", "infeasible", "unknown")
_OUTCOMES = ("realizable", "repaired", "unrepairable", "undecided")
_CAUSES = ("obstacle", "disallowed", "physics", "limit")


def check_library(path: Path, ledger: Ledger) -> None:
    """Check ``library.json`` and the plans that it names.

    Raises:
        InputError: a file cannot be read, or the terrain file is another one than the library was made for.
    """
    fields = read_fields(path, "skill-library")
    terrain = _terrain_file(fields.mapping("terrain"), path.parent)
    classes = tuple(_text(name, fields, "classes") for name in fields.items("classes"))
    headings = Headings.of(fields, classes)
    verdicts = _check_physics(fields, classes, headings, ledger)
    states = [_labels(value, fields, classes) for value in fields.items("states")]
    if terrain is not None:
        check_states(terrain, fields, states, headings, ledger)
    pairs = [_Pair.of(pair, states, headings) for pair in fields.mappings("pairs")]
    _check_complete(pairs, states, fields.mapping("terrain"), ledger)
    for pair in pairs:
        pair.check(verdicts, ledger)
    if fields.mapping("answer").whole("terrain_states") != len(states):
        ledger.refuse("skills, counts", f"there are {len(states)} terrain states", "answer.terrain_states")
    _check_counts(fields.mapping("answer"), pairs, verdicts, ledger)
    check_claims(fields, {" ".join((way, f"{a}->{b}")): verdict for (way, a, b), verdict in verdicts.items()}, ledger)
    ledger.counts.update(terrain_states=len(states), pairs=len(pairs), checks=len(verdicts))


def _terrain_file(terrain: Fields, folder: Path) -> Path | None:
    """Return the terrain file, or None if it is not there; refuse one that has changed."""
    file = folder / terrain.text("path") if terrain.has("path") else None
    if file is None or not file.is_file():
        return None
    if sha256_of(file) != terrain.text("sha256"):
        raise terrain.wrong("sha256", f"does not fit {file.name}: the library was made from another version of it")
    return file


def _check_physics(
    fields: Fields, classes: Collection[str], headings: Headings | None, ledger: Ledger
) -> dict[Primitive, str]:
    """Check every certificate, and return the verdict of every primitive; a skill without one is not feasible."""
    verdicts: dict[Primitive, str] = {}
    certified = 0
    known: dict[str, Motion] = {}
    cell_m = fields.mapping("made_with").number("cell_m", least=1e-3)
    for check in fields.mappings("checks"):
        name = check.text("primitive")
        primitive = _primitive(name, classes, headings)
        if primitive is None or primitive in verdicts:
            ledger.refuse("skills, primitive", f"{name} is no primitive of these classes, or stands twice", check.place)
            continue
        verdict = check.text("verdict", among=_VERDICTS)
        for key in ("horizon_s", "cost", "time_s"):
            check.number(key, least=0.0)
        if verdict == "feasible":
            problem = certificate_problem(check, primitive[0], cell_m, known)
            certified += not problem
            if problem:
                ledger.refuse("skills, certificate", f"{name} {problem}", f"{check.place}.plan")
                verdict = "unknown"
        verdicts[primitive] = verdict
    ledger.counts.update(skills=certified)
    return verdicts


@dataclass(frozen=True, slots=True)
class _Pair:
    """A terrain state with a request, and what is said about it."""

    labels: Labels
    request: Cell
    outcome: str
    strategy: Mapping[Place, str | None]
    headings: Headings | None
    why: Fields | None
    place: str

    @classmethod
    def of(cls, fields: Fields, states: list[Labels], headings: Headings | None) -> _Pair:
        labels = states[fields.whole("state", least=0, most=len(states) - 1)]
        request = fields.cell("request")
        if not inside(labels, request):
            raise fields.wrong("request", "is outside of the grid")
        strategy = dict(_strategy_row(row, fields, headings) for row in fields.items("strategy"))
        why = None if fields.get("why") is None else fields.mapping("why")
        return cls(labels, request, fields.text("outcome", among=_OUTCOMES), strategy, headings, why, fields.place)

    @property
    def start(self) -> Place:
        return len(self.labels) // 2, len(self.labels[0]) // 2, 0

    def check(self, verdicts: Mapping[Primitive, str], ledger: Ledger) -> None:
        """Check the strategy from every cell that it has, and that there is none where none is claimed."""
        if label_at(self.labels, self.start) == OBSTACLE:
            ledger.refuse("skills, state", "the robot stands in an obstacle", self.place)
        problem = self._strategy_problem(verdicts)
        if problem:
            ledger.refuse("skills, strategy", problem, self.place)
        handled = self.outcome in ("realizable", "repaired")
        if handled and self.start not in self.strategy:
            begin = self.named(self.start)
            ledger.refuse("skills, strategy", f"has no move in {begin}, where the robot begins", self.place)
        if not handled:
            self._check_refusal(verdicts, ledger)

    def _strategy_problem(self, verdicts: Mapping[Primitive, str]) -> str:
        after: dict[Place, Place] = {}
        for place, way in self.strategy.items():
            if label_at(self.labels, place) == OBSTACLE:
                return f"has a move in {self.named(place)}, which is outside of the grid or an obstacle"
            if way is None:
                after[place] = place
                continue
            primitive = primitive_at(self.labels, place, way, self.headings)
            if primitive is None:
                return f"goes {way} from {self.named(place)}, out of the grid, into an obstacle, or not as it may"
            if verdicts.get(primitive) != "feasible":
                return f"goes {way} from {self.named(place)}, and {' '.join(primitive)} is no certified skill"
            after[place] = led(place, way)
        for place in self.strategy:
            for _ in self.strategy:
                place = after.get(place, place)
            if place[:2] != self.request or after.get(place) != place:
                return f"does not come to {self.request} and stay there from every cell that it has"
        return ""

    def named(self, place: Place) -> str:
        return f"{place[:2]}" if self.headings is None else f"{place[:2]} facing {FACING[place[2]]}"

    def _check_refusal(self, verdicts: Mapping[Primitive, str], ledger: Ledger) -> None:
        """Search among all moves that were not refused; then among those that the reason leaves."""
        refused = {one for one, verdict in verdicts.items() if verdict != "feasible"}
        if self._reachable(refused):
            ledger.refuse("skills, unrepairable", f"{self.request} can be reached without any refused move", self.place)
        if self.why is None:
            ledger.refuse("skills, unrepairable", "comes without a reason", self.place)
            return
        named = {_primitive(_text(name, self.why, "primitives")) for name in self.why.items("primitives")}
        unproved = {one for one in named if one is not None and verdicts.get(one) == "unknown"}
        cause = self.why.text("cause", among=_CAUSES)
        expected = "obstacle" if not named else "limit" if unproved else "physics"
        if not named <= refused or self._reachable(named & refused) or cause != expected:
            ledger.refuse("skills, unrepairable", f"is not explained by {cause}: {self.why.text('text')}", self.place)
        if (self.outcome == "undecided") != (cause == "limit"):
            ledger.refuse("skills, unrepairable", f"is {self.outcome}, although the cause is {cause}", self.place)

    def _reachable(self, without: Collection[Primitive | None]) -> bool:
        after: dict[Place, list[Place]] = {}
        for place, target, primitive in moves(self.labels, self.headings):
            if primitive not in without:
                after.setdefault(place, []).append(target)
        seen, stack = {self.start}, [self.start]
        while stack:
            for target in after.get(stack.pop(), ()):
                if target not in seen:
                    seen.add(target)
                    stack.append(target)
        reached = any(place[:2] == self.request for place in seen)
        return reached and self.labels[self.request[0]][self.request[1]] != OBSTACLE


def _check_complete(pairs: list[_Pair], states: list[Labels], terrain: Fields, ledger: Ledger) -> None:
    """Check that every state has all its requests, each once: the front row, the rear corners, or those of the file."""
    asked = None if terrain.get("requests") is None else terrain.cells("requests")
    expected = [(labels, cell) for labels in states for cell in _requests(labels, asked)]
    found = [(pair.labels, pair.request) for pair in pairs]
    if len(set(states)) != len(states) or sorted(found) != sorted(expected):
        missing = sorted({*expected} - {*found})
        what = f"{missing[0][1]} is not handled in one of them" if missing else "some stand twice, or are not asked for"
        ledger.refuse("skills, pairs", f"terrain states and requests are not complete: {what}", "pairs")


def _requests(labels: Labels, asked: tuple[Cell, ...] | None) -> Iterator[Cell]:
    last_row, last_column = len(labels) - 1, len(labels[0]) - 1
    front = [(0, column) for column in range(last_column + 1)]
    cells = dict.fromkeys([*front, (last_row, 0), (last_row, last_column)] if asked is None else asked)
    yield from (cell for cell in cells if inside(labels, cell) and labels[cell[0]][cell[1]] != OBSTACLE)


def _check_counts(answer: Fields, pairs: list[_Pair], verdicts: Mapping[Primitive, str], ledger: Ledger) -> None:
    expected = {outcome: sum(pair.outcome == outcome for pair in pairs) for outcome in _OUTCOMES}
    expected |= {f"checks_{verdict}": [*verdicts.values()].count(verdict) for verdict in _VERDICTS}
    expected |= {"pairs": len(pairs)}
    for name, count in expected.items():
        if answer.whole(name) != count:
            ledger.refuse("skills, counts", f"{count} were counted, not {answer.whole(name)}", f"answer.{name}")


def _strategy_row(row: object, fields: Fields, headings: Headings | None) -> tuple[Place, str | None]:
    """Return a place and where the strategy goes from it."""
    ways = tuple(WAYS) if headings is None else (*WAYS, *TURNS)
    numbers = 2 if headings is None else 3
    place = "row, column" if headings is None else "row, column, heading from 0 to 3"
    wrong = fields.wrong("strategy", f"has to be a list of [{place}, one of {', '.join(ways)} or null]")
    if not isinstance(row, list) or len(row) != numbers + 1 or row[-1] not in (*ways, None):
        raise wrong
    heading = 0 if headings is None else row[2]
    if not all(type(one) is int for one in row[:numbers]) or heading not in range(4):
        raise wrong
    return (row[0], row[1], heading), row[-1]


def _primitive(name: str, classes: Collection[str] | None = None, headings: Headings | None = None) -> Primitive | None:
    """Return the parts of a name; a turn leads to what the same class is called after it."""
    way, _, rest = name.partition(" ")
    here, _, there = rest.partition("->")
    if classes is not None and not (here in classes and there in classes):
        return None
    turns = way in TURNS and (classes is None or (headings is not None and headings.turned[here] == there))
    return (way, here, there) if (way in WAYS or turns) and here and there else None


def _labels(value: object, fields: Fields, classes: Collection[str]) -> Labels:
    rows = value if isinstance(value, list) else []
    sizes = {len(row) if isinstance(row, list) else 0 for row in rows}
    if len(sizes) != 1 or 0 in sizes:
        raise fields.wrong("states", "has to be a list of grids, each a list of rows of one length")
    labels = tuple(tuple(_text(label, fields, "states") for label in row) for row in rows)
    if len(labels) % 2 == 0 or len(labels[0]) % 2 == 0:
        raise fields.wrong("states", "has to hold grids with a centre: odd numbers of rows and of columns")
    strange = {label for row in labels for label in row} - {*classes, OBSTACLE}
    if strange:
        raise fields.wrong("states", f"holds {min(strange)!r}, which is no class; there are: {', '.join(classes)}")
    return labels


def _text(value: object, fields: Fields, name: str) -> str:
    if not isinstance(value, str):
        raise fields.wrong(name, "has to hold texts")
    return value

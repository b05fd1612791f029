"""Skills with headings as a specification: what ``encoding`` has, with the robot's heading among the inputs.

Inputs besides: ``h0`` to ``h3``, the heading (one-hot, 0 faces row 0, counter-clockwise), and ``rh0`` to ``rh3``, which
headings fulfil the request. A translational skill has the full pose in its preconditions and the position in its
postconditions, a rotational one heading and the class of the ground in the former and the heading in the latter. What
a skill does not set, the two frame conditions keep: no translational skill, no new position; no rotational skill, no
new heading. As exactly one of all skills runs, or none, each keeps what the other changes.

Source: Zhou et al., 2025, Sec. VI-B and IX-F; docs/skills.md, "Headings".
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

from surefoot.errors import InputError
from surefoot.games.partial import partial_evaluation
from surefoot.logic.building import TRUE, conjunction, disjunction
from surefoot.logic.syntax import Atom, Comparison, Expression, Implies, Integer, Not, Specification, Variable
from surefoot.skills.encoding import Vocabulary, check_pair, exactly_one, literal, section, terrain_name, unchanged
from surefoot.skills.headings import HEADINGS, Pose, PoseEdge, Turning
from surefoot.skills.values import OBSTACLE, Cell, Direction, Primitive, TerrainState, Turn

_HEADING = [f"h{heading}" for heading in range(HEADINGS)]
_REQUESTED = [f"rh{heading}" for heading in range(HEADINGS)]


def heading_specification(
    words: Vocabulary,
    turning: Turning,
    *,
    disallowed: Iterable[PoseEdge] = (),
    forbidden: Collection[Primitive] = (),
) -> Specification:
    """Return the specification over any terrain and any request.

    Args:
        words: grid, classes and skills.
        turning: how the robot sees the grid, and which way it may walk.
        disallowed: moves between poses that failed at run time; the negated transitions are hard guarantees.
        forbidden: primitives that physics refused; no repair may create them.
    """
    return _Writing(words, turning, tuple(disallowed), frozenset(forbidden)).specification()


def heading_pair_specification(
    state: TerrainState,
    request: Cell,
    turning: Turning,
    primitives: Iterable[Primitive],
    *,
    disallowed: Iterable[PoseEdge] = (),
    forbidden: Collection[Primitive] = (),
) -> Specification:
    """Return what is left once terrain and request are known: the robot's pose, and the skills that can be used.

    Raises:
        InputError: see ``check_pair``; or a class is none that the turning has.
    """
    check_pair(state, request)
    classes = tuple(name for name, _ in turning.turned)
    unknown = {name for row in state.labels for name in row} - {*classes, OBSTACLE}
    if unknown:
        raise InputError(f"{min(unknown)!r} is no terrain class; there are: {', '.join(classes)}, {OBSTACLE}")
    words = Vocabulary(state.rows, state.columns, classes, tuple(primitives))
    known: dict[str, int | bool] = {terrain_name(cell): words.number(state.label(cell)) for cell in words.cells()}
    for names, place in zip(words.request, request, strict=True):
        known |= {name: index == place for index, name in enumerate(names)}
    known |= {name: heading in turning.facing for heading, name in enumerate(_REQUESTED)}
    usable = {move.skill for move in turning.moves(state)}
    known |= {words.skill_name(one): False for one in words.primitives if one not in usable}
    spec = heading_specification(words, turning, disallowed=disallowed, forbidden=forbidden)
    return partial_evaluation(spec, known)


@dataclass(frozen=True, slots=True)
class _Writing:
    """What the sections are written from."""

    words: Vocabulary
    turning: Turning
    disallowed: tuple[PoseEdge, ...]
    forbidden: frozenset[Primitive]

    def specification(self) -> Specification:
        words = self.words
        position, request = words.position, words.request
        inputs = [Variable(name) for names in (*position, _HEADING) for name in names]
        inputs += [Variable(terrain_name(cell), 0, len(words.classes)) for cell in words.cells()]
        inputs += [Variable(name) for names in (*request, _REQUESTED) for name in names]
        return Specification(
            inputs=tuple(inputs),
            outputs=tuple(Variable(words.skill_name(primitive)) for primitive in words.primitives),
            env_init=section("ENV_INIT", self.begins()),
            sys_init=section("SYS_INIT", (Not(words.skill(primitive)) for primitive in words.primitives)),
            env_trans=section("ENV_TRANS", (line for one in words.primitives for line in self.posts(one))),
            env_trans_hard=section("ENV_TRANS_HARD", self.environment_keeps()),
            sys_trans=section("SYS_TRANS", (self.pre(primitive) for primitive in words.primitives)),
            sys_trans_hard=section("SYS_TRANS_HARD", self.system_keeps()),
            sys_liveness=section("SYS_LIVENESS", [self.at_request()]),
            change_cons=section("CHANGE_CONS", self.changes()),
            not_allowed_repair=section("NOT_ALLOWED_REPAIR", self.no_repair()),
        )

    def poses(self) -> list[Pose]:
        return [(cell, heading) for cell in self.words.cells() for heading in range(HEADINGS)]

    def at(self, pose: Pose, *, primed: bool = False) -> list[Expression]:
        return [*self.words.at(pose[0], primed=primed), Atom(_HEADING[pose[1]], primed)]

    def pre_states(self, primitive: Primitive) -> Iterator[tuple[Pose, Pose]]:
        """Yield the poses in which a skill could run, with those that it leads to, whatever the terrain is."""
        cells = set(self.words.cells())
        if isinstance(primitive.direction, Direction) and primitive.direction not in self.turning.directions:
            return
        for pose in self.poses():
            target = self.turning.after(pose, primitive.direction)
            if target[0] in cells:
                yield pose, target

    def pre_state(self, primitive: Primitive, pose: Pose, target: Pose, *, primed: bool = False) -> list[Expression]:
        """Return pose and classes; the grid calls a class as the robot sees it, or by its name after a quarter turn."""
        seen = (self.turning.seen(primitive.here, pose[1]), self.turning.seen(primitive.next, target[1]))
        found = self.at(pose, primed=primed)
        pairs = zip((pose[0], target[0]), seen, strict=True)
        return found + [self.words.is_class(cell, name, primed=primed) for cell, name in dict.fromkeys(pairs)]

    def post(self, primitive: Primitive, target: Pose) -> list[Expression]:
        """Return the part of the pose that a skill sets, with everything else in it denied."""
        if isinstance(primitive.direction, Turn):
            return [literal(name, True, heading == target[1]) for heading, name in enumerate(_HEADING)]
        return self.words.only_at(target[0], primed=True)

    def begins(self) -> Iterator[Expression]:
        yield from self.words.only_at((self.words.rows // 2, self.words.columns // 2))
        yield from (literal(name, False, heading == 0) for heading, name in enumerate(_HEADING))
        for names in self.words.request:
            yield from exactly_one(names, primed=False)
        yield disjunction([Atom(name) for name in _REQUESTED])

    def posts(self, primitive: Primitive) -> Iterator[Expression]:
        """Yield (17) for both kinds of skills."""
        for pose, target in self.pre_states(primitive):
            pre = [self.words.skill(primitive), *self.pre_state(primitive, pose, target)]
            yield Implies(conjunction(pre), conjunction(self.post(primitive, target)))

    def pre(self, primitive: Primitive) -> Expression:
        """Return (19): a skill may run next only if one of its pre-states holds next."""
        pairs = self.pre_states(primitive)
        states = [conjunction(self.pre_state(primitive, pose, target, primed=True)) for pose, target in pairs]
        return Implies(self.words.skill(primitive, primed=True), disjunction(states))

    def environment_keeps(self) -> Iterator[Expression]:
        """Yield assumptions that no repair changes: one pose; terrain and request stay; what no skill sets stays."""
        for primed in (False, True):
            for names in (*self.words.position, _HEADING):
                yield from exactly_one(names, primed=primed)
        for cell in self.words.cells():
            name = terrain_name(cell)
            yield Comparison("=", Integer(name, primed=True), Integer(name))
        yield from (unchanged(name) for names in (*self.words.request, _REQUESTED) for name in names)
        position = [name for names in self.words.position for name in names]
        for kind, names in ((Direction, position), (Turn, _HEADING)):
            running = [one for one in self.words.primitives if isinstance(one.direction, kind)]
            idle = conjunction([Not(self.words.skill(primitive)) for primitive in running])
            yield self.stays(names) if idle is TRUE else Implies(idle, self.stays(names))

    @staticmethod
    def stays(names: Iterable[str]) -> Expression:
        return conjunction([unchanged(name) for name in names])

    def system_keeps(self) -> Iterator[Expression]:
        """Yield guarantees that no repair changes: one skill at a time, no obstacle now or next, no disallowed move."""
        for one, other in combinations(self.words.primitives, 2):
            yield Not(conjunction([self.words.skill(one, primed=True), self.words.skill(other, primed=True)]))
        for cell in self.words.cells():
            for primed in (False, True):
                inside = [*self.words.at(cell, primed=primed), self.words.is_class(cell, OBSTACLE, primed=primed)]
                yield Not(conjunction(inside))
        yield from self.never(self.disallowed)

    def at_request(self) -> Expression:
        cells = self.words.cells()
        places = [conjunction([*self.words.at(c), Atom(f"rx{c[0]}"), Atom(f"ry{c[1]}")]) for c in cells]
        headings = [conjunction([Atom(h), Atom(wanted)]) for h, wanted in zip(_HEADING, _REQUESTED, strict=True)]
        return conjunction([disjunction(places), disjunction(headings)])

    def changes(self) -> Iterator[Expression]:
        """Yield what a repaired state has to keep: one pose, in which either the cell or the heading is another one."""
        for names in (*self.words.position, _HEADING):
            yield from exactly_one(names, primed=True)
        cell, heading = self.stays(name for names in self.words.position for name in names), self.stays(_HEADING)
        yield Not(conjunction([cell, heading]))
        yield disjunction([cell, heading])

    def no_repair(self) -> Iterator[Expression]:
        """Yield what every transition that a repair creates has to keep: a skill could do it, and may."""
        poses, ways = set(self.poses()), (*self.turning.directions, *Turn)
        for pose in self.poses():
            targets = [target for way in ways if (target := self.turning.after(pose, way)) in poses]
            possible = disjunction([conjunction(self.at(target, primed=True)) for target in targets])
            yield Implies(conjunction(self.at(pose)), possible)
        yield from self.never(self.disallowed)
        for primitive in sorted(self.forbidden):
            for pose, target in self.pre_states(primitive):
                yield Not(conjunction([*self.pre_state(primitive, pose, target), *self.at(target, primed=True)]))

    def never(self, edges: Sequence[PoseEdge]) -> Iterator[Expression]:
        for pose, target in edges:
            yield Not(conjunction([*self.at(pose), *self.at(target, primed=True)]))

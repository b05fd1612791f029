"""What the robot knows how to do: the library, and what the runtime repair adds to it while the mission runs.

Source: Zhou et al. 2025, VII-B; docs/quadruped.md, "Runtime repair".
"""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from surefoot.compute import sha256_of, write_text_whole
from surefoot.errors import InputError
from surefoot.footholds import Gait
from surefoot.footholds.problem import rotations_of
from surefoot.missions.quadruped.crossing import Certificate
from surefoot.skills.headings import Pose, Turning
from surefoot.skills.library import SkillLibrary
from surefoot.skills.manager import Knowledge, Outcome, PairAnswer, handle
from surefoot.skills.skill_game import CELLS, Frame, directions_of, framed_game, solve_game, ways_of
from surefoot.skills.values import Cell, CheckResult, Physics, PhysicsCheck, Primitive, TerrainState, Way

LARGEST_PLAN_BYTES = 64_000_000


@dataclass(frozen=True, slots=True)
class Handled:
    """A strategy for a pair, and where it came from.

    Attributes:
        answer: the strategy, or why there is none.
        source: ``library`` (looked up), ``synthesis`` (from skills at hand) or ``repair`` (physics was asked).
        symbolic_ms: processor time without physics.
        checked: what physics was asked.
    """

    answer: PairAnswer
    source: str
    symbolic_ms: float
    checked: tuple[CheckResult, ...] = ()

    @property
    def ways(self) -> dict[Pose, Way | None]:
        """The strategy over local poses; None: stay."""
        cells: dict[Pose, Way | None] = {(cell, 0): way for cell, way in self.answer.strategy.items()}
        return cells or dict(self.answer.poses)

    @property
    def winning(self) -> bool:
        """Return whether there is a strategy from where the robot is."""
        return self.answer.outcome in (Outcome.REALIZABLE, Outcome.REPAIRED)


@dataclass(slots=True)
class SkillBook:
    """All skills of a mission; grows when the runtime repair finds new ones.

    Attributes:
        library: what was made offline; None: nothing was.
        physics: answers about what is not known.
        quick: the same with the gaits of the first skills only, for short cuts; None: none are looked for.
        folder: of the run, where certificates of new skills go.
        turning: how a robot that turns sees a grid; None for one that does not.
        knowledge: all answers of physics.
        new_plans: files of the certificates of new skills, by primitive.
    """

    library: SkillLibrary | None
    physics: PhysicsCheck
    folder: Path
    turning: Turning | None = None
    quick: PhysicsCheck | None = None
    knowledge: Knowledge = field(default_factory=Knowledge)
    new_plans: dict[Primitive, dict[str, str]] = field(default_factory=dict)
    _certificates: dict[Primitive, Certificate] = field(default_factory=dict)
    _no_short_cut: set[Primitive] = field(default_factory=set)

    def __post_init__(self) -> None:
        """Begin with what the library knows."""
        if self.library is not None:
            self.knowledge = self.library.knowledge

    def strategy(self, state: TerrainState, request: Cell, disallowed: Iterable[tuple[Pose, Pose]]) -> Handled:
        """Return a strategy: looked up where the pair is known and nothing is disallowed, else synthesized or repaired.

        Args:
            state: classes of the cells about the robot.
            request: the cell to reach.
            disallowed: moves between local poses that failed on this ground.
        """
        frame = self._frame
        edges: frozenset[tuple[Any, Any]] = frozenset(disallowed)
        if self.turning is None:
            edges = frozenset((one[0], other[0]) for one, other in edges)
        begin_s = time.process_time()
        known = None if self.library is None else self.library.pairs.get((state, request))
        if known is not None and not edges and known.outcome in (Outcome.REALIZABLE, Outcome.REPAIRED):
            return Handled(self._shortened(known), "library", 1e3 * (time.process_time() - begin_s))
        asked: list[CheckResult] = []

        def recorded(primitives: Sequence[Primitive]) -> Iterable[CheckResult]:
            for result in self.physics(primitives):
                asked.append(result)
                yield result

        answer, self.knowledge = handle(state, request, self.knowledge, recorded, disallowed=edges, frame=frame)
        for result in asked:
            self._keep(result)
        took_ms = 1e3 * (answer.symbolic_s if asked else time.process_time() - begin_s)
        return Handled(answer, "repair" if asked else "synthesis", took_ms, tuple(asked))

    @property
    def _frame(self) -> Frame[Any]:
        return CELLS if self.turning is None else self.turning

    def _shortened(self, known: PairAnswer) -> PairAnswer:
        """Return a strategy of the library, or a shorter one with skills that were found after it was made."""
        state, request = known.state, known.request
        length = _length(known, self._frame)
        if length <= abs(request[0] - state.centre[0]) + abs(request[1] - state.centre[1]):
            return known
        best = solve_game(framed_game(self._frame, state, request, self.knowledge.skills))
        if len(best.used(self._frame.start(state))) >= length:
            return known
        if self.turning is None:
            return replace(known, strategy=directions_of(best))
        return replace(known, poses=ways_of(best))

    def short_cuts(self, state: TerrainState, request: Cell) -> tuple[CheckResult, ...]:
        """Ask quick physics about skills with which a request would be reached in fewer steps; return the answers."""
        found: list[CheckResult] = []
        while self.quick is not None and (wanted := self._short_cut(state, request)):
            results = tuple(self.quick(wanted))
            found += results
            self._no_short_cut |= {one.primitive for one in results if one.verdict is not Physics.FEASIBLE}
            for result in results:
                self._keep(result)
            self.knowledge = self.knowledge.extended(one for one in results if one.verdict is Physics.FEASIBLE)
        return tuple(found)

    def _short_cut(self, state: TerrainState, request: Cell) -> tuple[Primitive, ...]:
        """Return the skills that a shorter way would need beside those at hand; none where there is none."""
        frame, skills = self._frame, self.knowledge.skills
        hopeless = self._no_short_cut | set(self.knowledge.refused)
        every = {move.skill for move in frame.moves(state)} - hopeless
        now, best = (
            solve_game(framed_game(frame, state, request, known)).used(frame.start(state)) for known in (skills, every)
        )
        new = dict.fromkeys(one.skill for one in best if one.skill not in skills)
        return tuple(new) if len(best) < len(now) else ()

    def _keep(self, result: CheckResult) -> None:
        """Put the certificate of a new skill into the run folder."""
        if result.plan is None:
            return
        sha256 = hashlib.sha256(result.plan.encode()).hexdigest()
        name = f"skills/{result.primitive.name.replace(' ', '_').replace('->', '_')}-{sha256[:12]}.json"
        write_text_whole(self.folder / name, result.plan)
        self.new_plans[result.primitive] = {"path": name, "sha256": sha256}
        self._certificates[result.primitive] = certificate_of(json.loads(result.plan))

    def certificate(self, primitive: Primitive) -> Certificate:
        """Return gait and footholds of a skill's offline plan.

        Raises:
            InputError: the plan of the library cannot be read, or has changed.
        """
        if primitive not in self._certificates:
            assert self.library is not None
            self._certificates[primitive] = read_certificate(self.library, primitive)
        return self._certificates[primitive]


def _length(known: PairAnswer, frame: Frame[Any]) -> int:
    """Return how many steps a strategy takes from the start."""
    ways: Mapping[Any, Way | None] = known.poses or known.strategy
    after = {(move.source, move.skill.direction): move.targets[0] for move in frame.moves(known.state)}
    place, count = frame.start(known.state), 0
    while (way := ways[place]) is not None:
        place, count = after[place, way], count + 1
    return count


def read_certificate(library: SkillLibrary, primitive: Primitive) -> Certificate:
    """Read what a skill of a library brings along.

    Raises:
        InputError: its plan is missing, too large, or another one than the library says.
    """
    path = library.plan_path(primitive)
    if path is None:
        raise InputError(f"has no plan for {primitive.name}", source=library.folder)
    try:
        if path.stat().st_size > LARGEST_PLAN_BYTES or sha256_of(path) != library.plans[primitive].sha256:
            raise InputError("is another plan than the library says", source=path)
        return certificate_of(json.loads(path.read_bytes()))
    except OSError as problem:
        raise InputError(f"cannot be read: {problem.strerror}", source=path) from problem
    except (ValueError, KeyError, TypeError, IndexError) as problem:
        raise InputError(f"is no whole foothold plan: {problem}", source=path) from problem


def certificate_of(plan: Mapping[str, Any]) -> Certificate:
    """Return gait and footholds of a plan file's object (docs/formats.md, section 6)."""
    values, motion = plan["values"], plan["motion"]
    gait = Gait(tuple(map(str, values["gait"]["modes"])), tuple(map(float, values["gait"]["switching_times_s"])))
    start, goal = (np.array(values[end]["position_m"], dtype=float) for end in ("start", "goal"))
    yaws = [float(values[end]["rpy_rad"][2]) for end in ("start", "goal")]
    feet = np.array(motion["feet_m"], dtype=float)
    places = []
    for step in motion["footsteps"]:
        part = step["touch"] / (len(feet) - 1)
        from_base = feet[step["touch"], step["foot"]] - (start + part * (goal - start))
        turned = rotations_of(np.array([[0.0, 0.0, yaws[0] + part * (yaws[1] - yaws[0])]]))[0]
        places.append(turned.T @ from_base)
    return Certificate(gait, np.array(places).reshape(-1, 3), tuple(map(int, motion["window_regions"])))

"""The manager: every pair of a terrain state and a request, one after another, with physics in the loop.

Only feasible primitives become skills. What physics refuses is remembered and never suggested again; what it leaves
open is treated as refused, and counted apart. Both facts only grow, so an answer stays true whatever comes after it.

Source: Zhou et al., 2025, Sec. VI-C, and VII-B for ``disallowed``; docs/skills.md, "Repair".
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from surefoot.errors import BackendFailed
from surefoot.skills.headings import Pose, Turning
from surefoot.skills.prediction import predictor
from surefoot.skills.repair import CostAwareOrder, Order, RandomOrder, greedily_reduced, repair
from surefoot.skills.shortest import fewest_new
from surefoot.skills.skill_game import CELLS, Frame, SkillGame, Solved, directions_of, framed_game, solve_game, ways_of
from surefoot.skills.unrepairable import Cause, Explanation, explain
from surefoot.skills.values import Cell, CheckResult, Direction, Physics, PhysicsCheck, Primitive, TerrainState, Way

Pair = tuple[TerrainState, Cell]
SuggestionOrder = Callable[["Knowledge", int], Order]


class Outcome(StrEnum):
    """What became of a pair."""

    REALIZABLE = "realizable"
    REPAIRED = "repaired"
    UNREPAIRABLE = "unrepairable"
    UNDECIDED = "undecided"


@dataclass(frozen=True, slots=True)
class Knowledge:
    """What physics has said so far.

    Attributes:
        results: its answers.
    """

    results: Mapping[Primitive, CheckResult] = field(default_factory=dict)

    @property
    def skills(self) -> frozenset[Primitive]:
        """What the robot can do."""
        return frozenset(one for one, result in self.results.items() if result.verdict is Physics.FEASIBLE)

    @property
    def refused(self) -> dict[Primitive, CheckResult]:
        """What it cannot do, or is not known to be able to do."""
        return {one: result for one, result in self.results.items() if result.verdict is not Physics.FEASIBLE}

    def count(self, verdict: Physics) -> int:
        """Return how many answers there are of one kind."""
        return sum(result.verdict is verdict for result in self.results.values())

    def extended(self, results: Iterable[CheckResult]) -> Knowledge:
        """Return what is known after more answers."""
        return Knowledge({**self.results, **{result.primitive: result for result in results}})


@dataclass(frozen=True, slots=True)
class PairAnswer:
    """What became of one pair.

    Attributes:
        state: classes of the cells.
        request: the cell to reach.
        outcome: realizable with the skills at hand; repaired; unrepairable; or undecided, because physics was.
        strategy: the direction to take in every winning cell; None: stay, the request is reached. Empty with headings.
        new: feasible primitives that the repair added.
        asked: all that physics was asked about.
        fewest: with fewer new primitives the pair would not be realizable, given all others and what was refused.
        why: of an unrepairable or undecided pair.
        symbolic_s: time without physics [s].
        poses: with headings, where to go or turn in every winning pose; None: stay (``planned_skill``).
    """

    state: TerrainState
    request: Cell
    outcome: Outcome
    strategy: Mapping[Cell, Direction | None]
    new: tuple[Primitive, ...] = ()
    asked: tuple[Primitive, ...] = ()
    fewest: int = 0
    why: Explanation | None = None
    symbolic_s: float = 0.0
    poses: Mapping[Pose, Way | None] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Synthesis:
    """What became of all pairs.

    Attributes:
        knowledge: every answer of physics.
        start: primitives that were checked first, whatever the pairs need.
        pairs: the answers, in the order of handling.
        time_s: for all of it [s].
    """

    knowledge: Knowledge
    start: tuple[Primitive, ...]
    pairs: tuple[PairAnswer, ...]
    time_s: float

    def count(self, outcome: Outcome) -> int:
        """Return how many pairs had one outcome."""
        return sum(pair.outcome is outcome for pair in self.pairs)


def cost_aware(knowledge: Knowledge, attempt: int) -> Order:
    """Return the order that asks for what is likely to be feasible; nothing is random."""
    del attempt
    return CostAwareOrder(predictor(knowledge.results.values()))


def paper_order(seed: int = 9) -> SuggestionOrder:
    """Return the paper's random order; every attempt draws with the next seed."""
    return lambda _, attempt: RandomOrder(seed + attempt)


def handle(
    state: TerrainState,
    request: Cell,
    knowledge: Knowledge,
    physics: PhysicsCheck,
    *,
    order: SuggestionOrder = cost_aware,
    disallowed: Iterable[tuple[Any, Any]] = (),
    frame: Frame[Any] = CELLS,
) -> tuple[PairAnswer, Knowledge]:
    """Find a strategy for a pair, and if need be the skills that it lacks; offline and at run time.

    Args:
        state: classes of the cells around the robot.
        request: the cell to reach.
        knowledge: what physics has said so far.
        physics: answers about primitives that it has not been asked about.
        order: of suggestions.
        disallowed: moves between cells (with headings: poses) that failed here; they say nothing about other places.
        frame: what the robot's states are: cells, or poses with a ``Turning``.

    Returns:
        the answer, and what is known after it.

    Raises:
        InputError: the robot stands in an obstacle, or the request is outside of the grid.
    """
    pairs = [(state, request)]
    (answer,), after = handle_all(pairs, knowledge, physics, order=order, disallowed=disallowed, frame=frame)
    return answer, after


def handle_all(
    pairs: Iterable[Pair],
    knowledge: Knowledge,
    physics: PhysicsCheck,
    *,
    order: SuggestionOrder = cost_aware,
    disallowed: Iterable[tuple[Any, Any]] = (),
    at_once: int = 1,
    say: Callable[[str], None] = lambda _: None,
    frame: Frame[Any] = CELLS,
) -> tuple[tuple[PairAnswer, ...], Knowledge]:
    """Handle pairs in their order; see ``handle`` and ``synthesize_library``."""
    edges = frozenset(disallowed)
    questions = [_Question(state, request, frame) for state, request in pairs]
    answers: dict[int, PairAnswer] = {}
    while len(answers) < len(questions):
        wanted: dict[Primitive, None] = {}
        for number, question in enumerate(questions):
            if number not in answers and len(wanted) < at_once:
                found = _considered(question, knowledge, tuple(wanted), order, edges)
                if not isinstance(found, PairAnswer):
                    wanted |= dict.fromkeys(found)
                    continue
                answers[number] = found
                if found.outcome is not Outcome.REALIZABLE:
                    say(_told(found))
        knowledge = knowledge.extended(_answered(physics, tuple(wanted)))
    return tuple(answers[number] for number in range(len(questions))), knowledge


def synthesize_library(
    pairs: Iterable[Pair],
    start: Sequence[Primitive],
    physics: PhysicsCheck,
    *,
    start_physics: PhysicsCheck | None = None,
    order: SuggestionOrder = cost_aware,
    at_once: int = 1,
    say: Callable[[str], None] = lambda _: None,
    frame: Frame[Any] = CELLS,
) -> Synthesis:
    """Handle every pair; whatever one of them adds is at hand for the next.

    Args:
        pairs: terrain states with requests.
        start: primitives to check before anything is asked for, to begin with some skills.
        physics: answers about what the repair suggests.
        start_physics: answers about the primitives of the start, with fewer gaits, so that only its yes counts; None:
            the same physics.
        order: of suggestions.
        at_once: physics is asked about at least so many primitives together, if later pairs have suggestions too. These
            are made as if everything that is being asked about were feasible, so that none is asked for in vain
            unless that turns out wrong. 1: as in the paper, one pair after the other.
        say: is told of every pair that needed more than the skills at hand.
        frame: what the robot's states are: cells, or poses with a ``Turning``.

    Raises:
        InputError: see ``handle``.
    """
    begin_s = time.perf_counter()
    first = _answered(start_physics or physics, start)
    known = Knowledge().extended(one for one in first if not start_physics or one.verdict is Physics.FEASIBLE)
    answers, knowledge = handle_all(pairs, known, physics, order=order, at_once=at_once, say=say, frame=frame)
    return Synthesis(knowledge, tuple(start), answers, time.perf_counter() - begin_s)


@dataclass(slots=True)
class _Question:
    """A pair while it is being handled."""

    state: TerrainState
    request: Cell
    frame: Frame[Any]
    asked: list[Primitive] = field(default_factory=list)
    attempts: int = 0
    symbolic_s: float = 0.0

    def game(self, skills: Iterable[Primitive], edges: frozenset[tuple[Any, Any]]) -> SkillGame[Any]:
        """Return the game with some skills."""
        return framed_game(self.frame, self.state, self.request, skills, disallowed=edges)


def _considered(
    question: _Question,
    knowledge: Knowledge,
    hoped: Sequence[Primitive],
    order: SuggestionOrder,
    edges: frozenset[tuple[Any, Any]],
) -> PairAnswer | tuple[Primitive, ...]:
    """Answer a question, or return what physics has to be asked for it beside what is hoped to be feasible already."""
    begin_s = time.perf_counter()
    skills, start = knowledge.skills, question.frame.start(question.state)
    solved = solve_game(question.game(skills, edges))
    wanted: tuple[Primitive, ...] = ()
    if start not in solved.winning:
        skills = skills.union(hoped)
        with_hope = solve_game(question.game(skills, edges)) if hoped else solved
        if start in with_hope.winning:
            return ()
        wanted = _wanted(question, skills, knowledge, order, edges)
    question.attempts += 1
    question.asked += wanted
    question.symbolic_s += time.perf_counter() - begin_s
    return wanted or _answer(question, solved, knowledge, edges)


def _wanted(
    question: _Question,
    skills: frozenset[Primitive],
    knowledge: Knowledge,
    order: SuggestionOrder,
    edges: frozenset[tuple[Any, Any]],
) -> tuple[Primitive, ...]:
    """Return primitives, none of them refused, with which the pair would be realizable; none if there are none."""
    refused, game = knowledge.refused, question.game(skills, edges)
    every = question.frame.moves(question.state)
    inventable = (move for move in every if move.skill not in refused and move.skill not in skills)
    suggestion = repair(game, inventable, order(knowledge, question.attempts))
    if suggestion is None:
        return ()

    def wins_with(primitives: Sequence[Primitive]) -> bool:
        more = question.game(skills.union(primitives), edges)
        return game.start in solve_game(more).winning

    return greedily_reduced(suggestion.primitives, wins_with)


def _answered(physics: PhysicsCheck, wanted: Sequence[Primitive]) -> list[CheckResult]:
    results = list(physics(wanted)) if wanted else []
    missing = {*wanted} - {result.primitive for result in results}
    if missing:
        raise BackendFailed(f"physics gave no answer about {min(missing).name}", wanted)
    return results


def _answer(
    question: _Question, solved: Solved[Any], knowledge: Knowledge, edges: frozenset[tuple[Any, Any]]
) -> PairAnswer:
    state, request, frame, asked = question.state, question.request, question.frame, tuple(question.asked)
    new = tuple(one for one in asked if one in knowledge.skills)
    if frame.start(state) in solved.winning:
        outcome, why = Outcome.REPAIRED if new else Outcome.REALIZABLE, None
    else:
        why = explain(state, request, knowledge.refused, edges, frame)
        outcome = Outcome.UNDECIDED if why.cause is Cause.LIMIT else Outcome.UNREPAIRABLE
    others, repaired = knowledge.skills.difference(asked), outcome is Outcome.REPAIRED
    fewest = fewest_new(state, request, others, knowledge.refused, edges, frame) if repaired else 0
    turns = isinstance(frame, Turning)
    cells, poses = {} if turns else directions_of(solved), ways_of(solved) if turns else {}
    return PairAnswer(state, request, outcome, cells, new, asked, fewest or 0, why, question.symbolic_s, poses)


def _told(answer: PairAnswer) -> str:
    what = ", ".join(one.name for one in answer.new) if answer.why is None else answer.why.text
    return f"{answer.outcome}: to {answer.request}, {what}"

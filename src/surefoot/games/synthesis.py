"""One question about a specification: can the system win, and how; both engines behind one door."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal, get_args

from surefoot.compute import Deadline
from surefoot.errors import LimitExceeded
from surefoot.games.bits import bit_game
from surefoot.games.diagrams import Backend
from surefoot.games.minimise import minimised
from surefoot.games.solution import FOREVER, EnvDeadEnd
from surefoot.logic.syntax import Conjunct, Specification
from surefoot.logic.transducer import Semantics as Semantics
from surefoot.logic.transducer import Transducer
from surefoot.verdict import Verdict

if TYPE_CHECKING:
    from surefoot.games.portfolio import Solved
    from surefoot.logic.ranking import Ranking

EngineName = Literal["auto", "explicit", "symbolic"]
StrategyForm = Literal["auto", "listed", "ranking"]
LISTING_LIMIT_S = 300.0
"""How long a strategy may take to list, once the verdict is known."""


@dataclass(frozen=True, slots=True)
class Vacuity:
    """A way in which an answer may be empty.

    Attributes:
        kind: ``env_dead_end``, ``false_initial``, ``falsified_assumption`` or ``no_strategy``.
        message: a sentence.
        lines: the lines responsible.
    """

    kind: str
    message: str
    lines: tuple[Conjunct, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class SynthesisAnswer:
    """The answer and how it was found.

    Attributes:
        verdict: realizable, unrealizable (the witness says from where), or unknown (the limit says why).
        engine: ``explicit`` or ``symbolic``.
        why_engine: why this one.
        states: how many states plays can reach, in the bits that matter for what comes; None when not counted.
        solve_s: processor seconds of reading the rules and solving.
        strategy_s: processor seconds of making the strategy or counter-strategy.
        warnings: ways in which the answer may be empty.
        strategy: of the system, when realizable and asked for, state by state.
        ranking: of the system, when the strategy is too large to list.
        counter_strategy: of the environment, when unrealizable and asked for.
    """

    verdict: Verdict[str]
    engine: str
    why_engine: str
    states: int | None = None
    solve_s: float = 0.0
    strategy_s: float = 0.0
    warnings: tuple[Vacuity, ...] = ()
    strategy: Transducer | None = None
    ranking: Ranking | None = None
    counter_strategy: Transducer | None = None


def synthesize(
    spec: Specification,
    *,
    semantics: Semantics = "slugs",
    engine: EngineName = "auto",
    env_dead_end: EnvDeadEnd = "wins",
    deadline: Deadline = FOREVER,
    node_limit: int | None = None,
    realizability_only: bool = False,
    backend: Backend = "oxidd",
    form: StrategyForm = "auto",
) -> SynthesisAnswer:
    """Decide a specification, and return a strategy of whoever wins.

    Args:
        spec: the specification.
        semantics: ``slugs``: for every initial input there is a good initial output; ``robotics``: every initial
            state is good.
        engine: ``explicit``, ``symbolic``, or ``auto`` to choose by the number of reachable states.
        env_dead_end: who wins where the environment has no move, the system ("wins") or not ("loses").
        deadline: when to give up; the verdict is then unknown.
        node_limit: the most decision diagram nodes alive at once.
        realizability_only: no strategy.
        backend: the decision diagram library.
        form: of a strategy of the system: ``listed`` state by state, a ``ranking``, or ``auto``: listed if it is small.

    Raises:
        ValueError: for an unknown option.
        BackendMissing: if the back end is not installed.
    """
    _check(semantics, engine, env_dead_end, form)
    question = _Question(spec, semantics == "robotics", env_dead_end, deadline, node_limit, backend, form)
    try:
        return _answer(question, engine, realizability_only)
    except LimitExceeded as limit:
        return SynthesisAnswer(Verdict.unknown(str(limit)), engine if engine != "auto" else "symbolic", "")


@dataclass(frozen=True, slots=True, eq=False)
class _Question:
    spec: Specification
    robotics: bool
    env_dead_end: EnvDeadEnd
    deadline: Deadline
    node_limit: int | None
    backend: Backend
    form: StrategyForm

    @property
    def options(self) -> dict[str, Any]:
        """All but the specification and the form of the strategy."""
        return {
            "robotics": self.robotics,
            "env_dead_end": self.env_dead_end,
            "deadline": self.deadline,
            "node_limit": self.node_limit,
            "backend": self.backend,
        }


def _check(semantics: str, engine: str, env_dead_end: str, form: str) -> None:
    for name, value, allowed in (
        ("semantics", semantics, get_args(Semantics)),
        ("engine", engine, get_args(EngineName)),
        ("env_dead_end", env_dead_end, get_args(EnvDeadEnd)),
        ("form", form, get_args(StrategyForm)),
    ):
        if value not in allowed:
            raise ValueError(f"{name} is one of {', '.join(allowed)}, not {value!r}")


def _answer(question: _Question, engine: EngineName, realizability_only: bool) -> SynthesisAnswer:
    from surefoot.games.attempts import watched

    return watched(lambda: _solve(question, engine, realizability_only), question.deadline)


def _solve(question: _Question, engine: EngineName, realizability_only: bool) -> SynthesisAnswer:
    from surefoot.games.portfolio import solve_by

    begin_s = time.process_time()
    solved = solve_by(bit_game(question.spec), engine, keep_layers=not realizability_only, **question.options)
    verdict: Verdict[str] = (
        Verdict.true() if solved.realizable else Verdict.false("the environment wins from an initial state")
    )
    answer = SynthesisAnswer(
        verdict, solved.engine, solved.why, states=solved.states, solve_s=time.process_time() - begin_s
    )
    return answer if realizability_only else _with_machine(answer, solved, question)


def _with_machine(answer: SynthesisAnswer, solved: Solved, question: _Question) -> SynthesisAnswer:
    begin_s = time.process_time()
    try:
        answer = _with_strategy(answer, solved, question)
    except LimitExceeded as limit:
        warning = Vacuity("no_strategy", f"no strategy was written out: {limit}")
        answer = replace(answer, warnings=(*answer.warnings, warning))
    return replace(answer, strategy_s=time.process_time() - begin_s)


def _with_strategy(answer: SynthesisAnswer, solved: Solved, question: _Question) -> SynthesisAnswer:
    """Return the answer with a strategy of whoever wins; one of the system that is too long to list is a ranking."""
    auto = question.form == "auto"
    if not solved.realizable or question.form != "ranking":
        soon = Deadline.after(LISTING_LIMIT_S)
        from surefoot.games.machines import FEW_EDGES, MOST_EDGES  # numba, which reading a specification does not need

        edges = FEW_EDGES if auto and solved.realizable else MOST_EDGES
        try:
            machine = solved.machine(
                robotics=question.robotics, deadline=min(question.deadline, soon, key=_end_s), most_edges=edges
            )
        except LimitExceeded:
            if not (auto and solved.realizable):
                raise
        else:
            machine = None if machine is None else minimised(machine)
            if not solved.realizable:
                return replace(answer, counter_strategy=machine)
            return replace(answer, strategy=machine, warnings=_vacuities(question, machine))
    ranking, stuck = solved.ranking(question.options)
    dead_ends = Vacuity("env_dead_end", "the environment may get where it has no move, and then the system has won")
    return replace(answer, ranking=ranking, warnings=(dead_ends,) if stuck else ())


def _end_s(deadline: Deadline) -> float:
    return deadline.end_s


def _vacuities(question: _Question, strategy: Transducer | None) -> tuple[Vacuity, ...]:
    from surefoot.games.vacuity import vacuities

    if strategy is None:
        return ()
    return tuple(Vacuity(*found) for found in vacuities(question.spec, strategy, deadline=question.deadline))

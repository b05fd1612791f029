"""One question about a specification: can the system win, and how; both engines behind one door."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import Literal, get_args

from surefoot.compute import Deadline
from surefoot.errors import LimitExceeded
from surefoot.games.bits import BitGame, bit_game
from surefoot.games.diagrams import Backend
from surefoot.games.solution import FOREVER, EnvDeadEnd
from surefoot.logic.syntax import Conjunct, Specification
from surefoot.logic.transducer import Transducer
from surefoot.verdict import Verdict

Semantics = Literal["slugs", "robotics"]
EngineName = Literal["auto", "explicit", "symbolic"]


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
        strategy: of the system, when realizable and asked for.
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
    counter_strategy: Transducer | None = None

"""What the commands about specifications share: options, solving, and conjuncts for people and for JSON."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from surefoot.cli.failures import ExitCode
from surefoot.verdict import Answer

if TYPE_CHECKING:
    from surefoot.games.synthesis import SynthesisAnswer, Vacuity
    from surefoot.logic import Conjunct, Specification

WORDS = {Answer.TRUE: "realizable", Answer.FALSE: "unrealizable", Answer.UNKNOWN: "unknown"}
CODES = {Answer.TRUE: ExitCode.YES, Answer.FALSE: ExitCode.NO, Answer.UNKNOWN: ExitCode.UNKNOWN}


class Semantics(StrEnum):
    """Who picks the initial outputs."""

    SLUGS = "slugs"
    ROBOTICS = "robotics"


class DeadEnd(StrEnum):
    """Whether the system wins where the environment has no move."""

    WINS = "wins"
    LOSES = "loses"


class EngineName(StrEnum):
    """Which engine solves."""

    AUTO = "auto"
    EXPLICIT = "explicit"
    SYMBOLIC = "symbolic"


class StrategyForm(StrEnum):
    """How a strategy of the system is written."""

    AUTO = "auto"
    LISTED = "listed"
    RANKING = "ranking"


SemanticsOption = Annotated[
    Semantics,
    typer.Option(help="slugs: the system picks initial outputs; robotics: every allowed initial state has to win."),
]
DeadEndOption = Annotated[
    DeadEnd, typer.Option("--env-dead-end", help="Whether the system wins or loses where the environment has no move.")
]
EngineOption = Annotated[EngineName, typer.Option(help="Which engine solves; auto measures and chooses.")]
TimeLimit = Annotated[float | None, typer.Option("--time-limit", min=0.0, help="Give up after so many seconds.")]
NodeLimit = Annotated[int | None, typer.Option("--node-limit", min=1, help="Give up at so many BDD nodes.")]


def solve(
    specification: Specification,
    *,
    semantics: Semantics,
    engine: EngineName,
    env_dead_end: DeadEnd,
    time_limit: float | None,
    node_limit: int | None,
    realizability_only: bool = False,
    form: StrategyForm = StrategyForm.AUTO,
) -> SynthesisAnswer:
    """Solve a specification as the options say."""
    from surefoot.compute import Deadline
    from surefoot.games import synthesize

    return synthesize(
        specification,
        semantics=semantics.value,
        engine=engine.value,
        env_dead_end=env_dead_end.value,
        deadline=Deadline.after(time_limit),
        node_limit=node_limit,
        realizability_only=realizability_only,
        form=form.value,
    )


def kind_of(path: Path) -> str | None:
    """Return the kind that a file names among its first characters; None if it names none."""
    try:
        with path.open("rb") as stream:
            head = stream.read(200)
    except OSError:
        return None
    found = re.search(rb'"kind"\s*:\s*"([a-z0-9-]+)"', head)
    return None if found is None else found[1].decode()


def conjunct_object(conjunct: Conjunct) -> dict[str, object]:
    """Return a line of a specification for JSON."""
    return {
        "section": conjunct.section,
        "line": conjunct.line,
        "column": conjunct.column,
        "text": conjunct.text,
    }


def conjunct_line(conjunct: Conjunct) -> str:
    """Return a line of a specification for a person."""
    text = conjunct.text if len(conjunct.text) <= 90 else f"{conjunct.text[:87]}..."
    place = f"line {conjunct.line}" if conjunct.line else "limit"
    return f"{conjunct.section}, {place}: {text}"


def warning_objects(warnings: Iterable[Vacuity]) -> list[dict[str, object]]:
    """Return warnings for JSON."""
    return [
        {"kind": item.kind, "message": item.message, "lines": [conjunct_object(line) for line in item.lines]}
        for item in warnings
    ]


def warning_lines(warnings: Sequence[Vacuity]) -> list[str]:
    """Return warnings for a person."""
    lines: list[str] = []
    for item in warnings:
        lines.append(f"  warning: {item.message}")
        lines += [f"    {conjunct_line(line)}" for line in item.lines]
    return lines

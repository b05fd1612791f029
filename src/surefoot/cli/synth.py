"""``surefoot synth``: from a GR(1) specification to a verified strategy, or the answer that there is none."""

from __future__ import annotations

import json
import time
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated

import typer

from surefoot.cli.gr1 import (
    CODES,
    WORDS,
    DeadEnd,
    DeadEndOption,
    EngineName,
    EngineOption,
    NodeLimit,
    Semantics,
    SemanticsOption,
    StrategyForm,
    TimeLimit,
    solve,
    warning_lines,
    warning_objects,
)
from surefoot.cli.output import AsJson, facts, jsonable, progress, to_write

if TYPE_CHECKING:
    from surefoot.logic import Specification, Transducer
    from surefoot.logic.ranking import Ranking


@dataclass(frozen=True, slots=True)
class Certified:
    """What came of verifying a strategy.

    Attributes:
        verified: True when the checker accepted it; None when it reached a limit, or nothing was checked.
        note: the limit.
        verify_s: how long that took.
        files: where the strategy was saved.
    """

    verified: bool | None = None
    note: str | None = None
    verify_s: float = 0.0
    files: tuple[Path, ...] = ()


def synth(
    spec: Annotated[Path, typer.Argument(help="A slugsin or structuredslugs file.", show_default=False)],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", callback=to_write(".json"), help="The file for the strategy, JSON.")
    ] = None,
    semantics: SemanticsOption = Semantics.SLUGS,
    engine: EngineOption = EngineName.AUTO,
    env_dead_end: DeadEndOption = DeadEnd.WINS,
    time_limit: TimeLimit = None,
    node_limit: NodeLimit = None,
    form: Annotated[
        StrategyForm, typer.Option("--strategy", help="auto: listed state by state if short, otherwise a ranking.")
    ] = StrategyForm.AUTO,
    realizability_only: Annotated[bool, typer.Option(help="Answer yes or no, without a strategy.")] = False,
    as_json: AsJson = False,
) -> None:
    """Solve a GR(1) specification and save a strategy that has been verified.

    A strategy with more than 120,000 transitions is saved as a ranking: a few
    decision diagrams in an npz file beside it, executable and verified too.

    Unrealizable: the file holds the environment's counter-strategy, verified
    as well; see also surefoot explain.

    Examples:
      surefoot synth spec.structuredslugs -o strategy.json
      surefoot synth spec.slugsin --realizability-only --time-limit 60 --json

    Exit code 0: realizable; 1: unrealizable; 2: the specification cannot be
    used; 3: a limit was reached.
    """
    from surefoot.compute import peak_memory_mb
    from surefoot.logic import read_specification

    begun = time.process_time()
    specification = read_specification(spec)
    with progress() as say:
        say(f"solving {spec.name}")
        solved = solve(
            specification,
            semantics=semantics,
            engine=engine,
            env_dead_end=env_dead_end,
            time_limit=time_limit,
            node_limit=node_limit,
            realizability_only=realizability_only,
            form=form,
        )
        found_strategy = solved.strategy or solved.counter_strategy or solved.ranking
        certified = Certified()
        if found_strategy is not None:
            say(f"verifying a strategy {_size_in_words(found_strategy)}")
            certified = certify(specification, found_strategy, output, semantics, env_dead_end)
    found = {
        "verdict": WORDS[solved.verdict.answer],
        "engine": solved.engine,
        "why_engine": solved.why_engine,
        "states": solved.states,
        "strategy": _form_of(found_strategy),
        "strategy_states": getattr(found_strategy, "nodes", None),
        "strategy_rows": None if solved.ranking is None else len(solved.ranking.variable),
        "verified": certified.verified,
        "certificate": "full" if certified.verified else "none",
        "solve_s": solved.solve_s,
        "strategy_s": solved.strategy_s,
        "verify_s": certified.verify_s,
        "time_s": time.process_time() - begun,
        "peak_mb": peak_memory_mb(),
        "limit": solved.verdict.limit or certified.note,
        "files": [str(path) for path in certified.files],
    }
    if as_json:
        print(json.dumps(jsonable(found | {"warnings": warning_objects(solved.warnings)})))
    else:
        shown = {key: value for key, value in found.items() if key != "verdict" and value not in (None, [])}
        head = f"{spec}: {found['verdict']}" + (
            "" if solved.verdict.witness is None else f" ({solved.verdict.witness})"
        )
        print("\n".join([head, *facts(shown), *warning_lines(solved.warnings)]))
    raise typer.Exit(int(CODES[solved.verdict.answer]))


def _form_of(strategy: Transducer | Ranking | None) -> str | None:
    from surefoot.logic.ranking import Ranking

    if strategy is None:
        return None
    return "ranking" if isinstance(strategy, Ranking) else "listed"


def _size_in_words(strategy: Transducer | Ranking) -> str:
    from surefoot.logic.ranking import Ranking

    if isinstance(strategy, Ranking):
        return _counted(len(strategy.layers), "layer")
    return _counted(strategy.nodes, "state")


def _counted(number: int, what: str) -> str:
    return f"of {number} {what}{'s' * (number != 1)}"


def certify(
    specification: Specification,
    strategy: Transducer | Ranking,
    output: Path | None,
    semantics: Semantics,
    env_dead_end: DeadEnd,
) -> Certified:
    """Save a strategy, let the independent checker read the file, and keep it if it was not refused.

    Raises:
        CertificateRejected: the checker refused it, which is a bug; nothing is kept.
    """
    from surefoot.errors import CertificateRejected, LimitExceeded
    from surefoot.verify import verify_path

    begun = time.process_time()
    verified: bool | None = None
    note: str | None = None
    with TemporaryDirectory(prefix="surefoot-") as folder:
        draft = Path(folder) / "strategy.json"
        _save(draft, strategy, specification, semantics, env_dead_end)
        try:
            report = verify_path(draft, specification.source)
        except LimitExceeded as limit:
            note = f"not verified: {limit}"
        else:
            verified = report.accepted
            if not verified:
                raise CertificateRejected(f"the checker refused the strategy: {report.findings[0]}")
    verify_s = time.process_time() - begun
    files: tuple[Path, ...] = ()
    if output is not None:
        files = _save(output, strategy, specification, semantics, env_dead_end)
    return Certified(verified, note, verify_s, files)


def _save(
    path: Path, strategy: Transducer | Ranking, specification: Specification, semantics: Semantics, dead_end: DeadEnd
) -> tuple[Path, ...]:
    from surefoot.logic.ranking import Ranking
    from surefoot.logic.ranking_file import save_ranking
    from surefoot.logic.strategy_file import save_strategy

    if isinstance(strategy, Ranking):
        return save_ranking(path, strategy, specification, semantics=semantics.value, env_dead_end=dead_end.value)
    return save_strategy(path, strategy, specification, semantics=semantics.value, env_dead_end=dead_end.value)

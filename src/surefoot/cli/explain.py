"""``surefoot explain``: which lines make a specification unrealizable, and how the environment wins."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
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
    TimeLimit,
    conjunct_line,
    conjunct_object,
    solve,
    warning_lines,
    warning_objects,
)
from surefoot.cli.output import AsJson, jsonable, progress
from surefoot.verdict import Answer

if TYPE_CHECKING:
    from surefoot.games.synthesis import SynthesisAnswer
    from surefoot.logic import Conjunct, Specification


@dataclass(frozen=True, slots=True)
class Options:
    """How specifications are to be solved."""

    semantics: Semantics
    engine: EngineName
    env_dead_end: DeadEnd
    time_limit: float | None
    node_limit: int | None

    def solve(self, specification: Specification, *, realizability_only: bool = False) -> SynthesisAnswer:
        """Solve a specification."""
        return solve(
            specification,
            semantics=self.semantics,
            engine=self.engine,
            env_dead_end=self.env_dead_end,
            time_limit=self.time_limit,
            node_limit=self.node_limit,
            realizability_only=realizability_only,
        )


@dataclass(frozen=True, slots=True)
class Explained:
    """Why a specification is unrealizable.

    Attributes:
        core: lines that cannot be kept together.
        minimal: whether each of them is needed.
        play: how the environment wins, see ``play_in_words``.
        limit: what kept the core from being found.
    """

    core: tuple[Conjunct, ...] = ()
    minimal: bool = True
    play: dict[str, object] | None = None
    limit: str | None = None


def explain(
    spec: Annotated[Path, typer.Argument(help="A slugsin or structuredslugs file.", show_default=False)],
    semantics: SemanticsOption = Semantics.SLUGS,
    engine: EngineOption = EngineName.AUTO,
    env_dead_end: DeadEndOption = DeadEnd.WINS,
    time_limit: TimeLimit = None,
    node_limit: NodeLimit = None,
    as_json: AsJson = False,
) -> None:
    """Say why a specification is unrealizable, or what is vacuous about a realizable one.

    The core is a minimal set of lines of the system that cannot be kept
    together: without any one of them the rest is realizable. When the time
    limit ends the search, the smallest set so far is shown and marked. The
    play is a shortest one in which the environment wins.

    Examples:
      surefoot explain spec.slugsin
      surefoot explain spec.structuredslugs --semantics robotics --json

    Exit code 0: realizable; 1: unrealizable, and explained; 2: the
    specification cannot be used; 3: a limit was reached.
    """
    from surefoot.cli.play_in_words import play_words
    from surefoot.logic import read_specification

    specification = read_specification(spec)
    options = Options(semantics, engine, env_dead_end, time_limit, node_limit)
    explained = Explained()
    with progress() as say:
        say(f"solving {spec.name}")
        solved = options.solve(specification, realizability_only=True)
        if solved.verdict.answer is Answer.FALSE:
            say("searching for the lines responsible")
            explained = _explained(specification, options)
        elif solved.verdict.answer is Answer.TRUE:
            say("looking for vacuity")
            solved = options.solve(specification)
    core, play = explained.core, explained.play
    verdict = WORDS[solved.verdict.answer]
    if as_json:
        found = {
            "verdict": verdict,
            "core": [conjunct_object(conjunct) for conjunct in core],
            "core_minimal": explained.minimal,
            "play": play,
            "warnings": warning_objects(solved.warnings),
            "limit": solved.verdict.limit or explained.limit,
        }
        print(json.dumps(jsonable(found)))
    else:
        lines = [f"{spec}: {verdict}" + (f" ({solved.verdict.limit})" if solved.verdict.limit else "")]
        if core:
            more = "" if explained.minimal else ", perhaps more than needed"
            lines += ["", f"Lines that cannot be kept together{more}:", *(f"  {conjunct_line(c)}" for c in core)]
        if explained.limit:
            lines.append(f"  ({explained.limit})")
        if play is not None:
            lines += ["", "How the environment wins:", *play_words(specification, play)]
        print("\n".join([*lines, *warning_lines(solved.warnings)]))
    raise typer.Exit(int(CODES[solved.verdict.answer]))


def _explained(specification: Specification, options: Options) -> Explained:
    """Return a core, and a play against a system that promises no more than the core."""
    from surefoot.cli.play_in_words import play_object
    from surefoot.compute import Deadline
    from surefoot.errors import LimitExceeded
    from surefoot.games import Core, unrealizable_core

    try:
        core = unrealizable_core(
            specification,
            semantics=options.semantics.value,
            env_dead_end=options.env_dead_end.value,
            deadline=Deadline.after(options.time_limit),
        )
    except LimitExceeded as problem:
        core = Core((), minimal=False, limit=str(problem))
    for asked in (_reduced(specification, core.lines), specification) if core.lines else (specification,):
        solved = options.solve(asked)
        if solved.counter_strategy is not None:
            return Explained(core.lines, core.minimal, play_object(asked, solved.counter_strategy), core.limit)
    return Explained(core.lines, core.minimal, None, core.limit)


def _reduced(specification: Specification, core: tuple[Conjunct, ...]) -> Specification:
    """Return a specification with no lines of the system but the core, and without outputs that no line mentions."""
    from surefoot.games.cores import keeping, without_idle_outputs

    promises = specification.sys_init + specification.system_safety + specification.sys_liveness
    return without_idle_outputs(keeping(specification, core, promises))

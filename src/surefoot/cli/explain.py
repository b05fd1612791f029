"""``surefoot explain``: which lines make a specification unrealizable, and how the environment wins."""

from __future__ import annotations

import json
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
    from surefoot.logic import Conjunct


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
    together: without any one of them the rest is realizable. The play is a
    shortest one in which the environment wins.

    Examples:
      surefoot explain spec.slugsin
      surefoot explain spec.structuredslugs --semantics robotics --json

    Exit code 0: realizable; 1: unrealizable, and explained; 2: the
    specification cannot be used; 3: a limit was reached.
    """
    from surefoot.cli.play_in_words import play_object, play_words
    from surefoot.compute import Deadline
    from surefoot.games import unrealizable_core
    from surefoot.logic import read_specification

    specification = read_specification(spec)
    core: tuple[Conjunct, ...] = ()
    play: dict[str, object] | None = None
    with progress() as say:
        say(f"solving {spec.name}")
        solved = solve(
            specification,
            semantics=semantics,
            engine=engine,
            env_dead_end=env_dead_end,
            time_limit=time_limit,
            node_limit=node_limit,
        )
        if solved.verdict.answer is Answer.FALSE:
            say("searching for the lines responsible")
            core = unrealizable_core(
                specification,
                semantics=semantics.value,
                env_dead_end=env_dead_end.value,
                deadline=Deadline.after(time_limit),
            )
        if solved.counter_strategy is not None:
            play = play_object(specification, solved.counter_strategy)
    verdict = WORDS[solved.verdict.answer]
    if as_json:
        found = {
            "verdict": verdict,
            "core": [conjunct_object(conjunct) for conjunct in core],
            "play": play,
            "warnings": warning_objects(solved.warnings),
            "limit": solved.verdict.limit,
        }
        print(json.dumps(jsonable(found)))
    else:
        lines = [f"{spec}: {verdict}" + (f" ({solved.verdict.limit})" if solved.verdict.limit else "")]
        if core:
            lines += ["", "Lines that cannot be kept together:", *(f"  {conjunct_line(c)}" for c in core)]
        if play is not None:
            lines += ["", "How the environment wins:", *play_words(specification, play)]
        print("\n".join([*lines, *warning_lines(solved.warnings)]))
    raise typer.Exit(int(CODES[solved.verdict.answer]))

"""``surefoot export``: a saved strategy in the format of another tool."""

from __future__ import annotations

import json
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from surefoot.cli.gr1 import kind_of
from surefoot.cli.output import AsJson, apart, to_write
from surefoot.errors import InputError

if TYPE_CHECKING:
    from surefoot.logic import Transducer


class Format(StrEnum):
    """What strategies are exported to."""

    HOA = "hoa"
    DOT = "dot"
    SLUGS_JSON = "slugs-json"
    AIGER = "aiger"


def export(
    strategy: Annotated[Path, typer.Argument(help="A strategy file, from surefoot synth.", show_default=False)],
    to: Annotated[Format, typer.Option("--format", help="The format.", show_default=False)],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", callback=to_write(), help="The file; standard output if none.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Write a strategy as an automaton, a graph, slugs' JSON or a circuit.

    hoa: an automaton with the next values of all bits as labels. dot: a graph
    with integers as integers. slugs-json: as slugs prints explicit strategies.
    aiger: a circuit in ASCII, for strategies of the system. A ranking is listed
    first, if that takes at most 30000 moves of the environment.

    Examples:
      surefoot export strategy.json --format dot -o strategy.dot
      surefoot export strategy.json --format aiger > strategy.aag

    Exit code 0: written; 2: the strategy cannot be read or does not fit.
    """
    from surefoot.compute import write_text_whole
    from surefoot.logic.exports import export as exported

    apart(strategy, output)
    text = exported(_listed(strategy), to.value)
    if output is not None:
        write_text_whole(output, text)
    if as_json:
        found: dict[str, object] = {"format": to.value, "characters": len(text)}
        print(json.dumps(found | ({"text": text} if output is None else {"file": str(output)})))
    elif output is None:
        print(text, end="")
    else:
        print(f"{output}: {to.value}, {len(text)} characters")


def _listed(strategy: Path) -> Transducer:
    """Return a strategy as it was saved, or a ranking with its nodes listed."""
    from surefoot.logic.strategy_file import load_strategy

    if kind_of(strategy) != "gr1-ranking":
        return load_strategy(strategy).transducer
    from surefoot.games.ranking_listing import MOST_MOVES, listed
    from surefoot.logic.ranking_file import load_ranking

    saved = load_ranking(strategy)
    try:
        found = listed(saved.ranking, saved.origin.semantics)
    except ValueError as problem:
        raise InputError(f"cannot be listed: {problem}; check it with: surefoot verify", source=strategy) from problem
    if found is None:
        message = (
            f"is a ranking of more than {MOST_MOVES} moves, too many to list here; surefoot synth --strategy listed "
            "writes a strategy of up to 3 million transitions to export, and surefoot simulate plays this one"
        )
        raise InputError(message, source=strategy)
    return found

"""``surefoot skills synthesize|show``: what a quadruped can do where, found offline by physics and symbolic repair."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from surefoot.cli.failures import ExitCode
from surefoot.cli.output import AsJson, answer, facts, jsonable, progress

if TYPE_CHECKING:
    from surefoot.skills.library import SkillLibrary
    from surefoot.skills.manager import PairAnswer, SuggestionOrder
    from surefoot.skills.values import Cell

_Folder = Annotated[Path, typer.Argument(metavar="LIBRARY", help="The folder of a library.", show_default=False)]


class Order(StrEnum):
    """In which order missing skills are suggested."""

    COST_AWARE = "cost-aware"
    PAPER = "paper"


def synthesize(
    terrain: Annotated[Path, typer.Argument(help="A terrain file.", show_default=False)],
    output: Annotated[Path, typer.Option("-o", "--output", help="The folder of the library.", show_default=False)],
    order: Annotated[Order, typer.Option(help="Which suggestions come first: likely ones, or random ones.")] = (
        Order.COST_AWARE
    ),
    seed: Annotated[int, typer.Option(min=0, help="Of the random order.")] = 9,
    jobs: Annotated[int | None, typer.Option(min=1, help="Processes; one per core if not given.")] = None,
    time_limit: Annotated[
        float | None, typer.Option(min=0.1, help="Seconds for one search for a motion; what needs more is undecided.")
    ] = None,
    retry_unknown: Annotated[bool, typer.Option(help="Ask again about what was left undecided.")] = False,
    as_json: AsJson = False,
) -> None:
    """Find skills, and strategies for every terrain state and request.

    With `yaw: true` in the terrain file the robot turns in place too, and
    strategies know which way it faces.

    Every check of physics is on disk as soon as it is made. Interrupt the
    command as you like: given the same folder it goes on where it was.

    Examples:
      surefoot skills synthesize terrain.yaml -o library/
      surefoot skills synthesize terrain.yaml -o library/ --order paper --json

    Exit code 0: every pair has a strategy or a proof that there is none;
    2: the terrain or the folder cannot be used; 3: some pair is undecided.
    """
    import os

    from surefoot.compute import process_pool
    from surefoot.skills.grid import terrain_set
    from surefoot.skills.making import make_library
    from surefoot.skills.terrain_checks import terrain_checks
    from surefoot.skills.terrain_file import read_terrain

    read = read_terrain(terrain)
    workers = jobs or len(os.sched_getaffinity(0))
    with progress() as say, process_pool(workers) as executor:
        found = make_library(
            terrain_set(read),
            output,
            terrain_checks(read, executor, time_limit_s=time_limit),
            source=terrain,
            order=_order(order, seed),
            order_name=order.value if order is Order.COST_AWARE else f"{order.value}, seed {seed}",
            at_once=3 * workers if order is Order.COST_AWARE else 1,
            retry_unknown=retry_unknown,
            say=say,
        )
    print(json.dumps(jsonable(found)) if as_json else "\n".join([f"{output}: {_pairs(found)}", *facts(found)]))
    raise typer.Exit(int(ExitCode.UNKNOWN if found["undecided"] else ExitCode.YES))


def show(
    library: _Folder,
    state: Annotated[int | None, typer.Option(min=0, help="Show this terrain state, counted from 0.")] = None,
    request: Annotated[str | None, typer.Option(help="A requested cell of it, such as 0,1.")] = None,
    spec: Annotated[
        Path | None, typer.Option(help="Write the specification of that pair here (.structuredslugs, .slugsin).")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Show what the robot can do where, and why not.

    Examples:
      surefoot skills show library/
      surefoot skills show library/ --state 3
      surefoot skills show library/ --state 3 --request 0,1 --spec pair.structuredslugs

    Exit code 0: shown; 2: there is no such library, or it is not complete.
    """
    from surefoot.cli.skills_words import library_lines, library_object, state_lines
    from surefoot.skills.library import pair_object, read_library

    read = read_library(library)
    if state is None:
        if request is not None or spec is not None:
            raise typer.BadParameter("needs --state as well", param_hint="--spec" if request is None else "--request")
        lines = [f"{library}: {_pairs(read.answer)}", *library_lines(read)]
        answer(library_object(read), lines, yes=True, as_json=as_json)
    pairs = _chosen(read, state or 0, request)
    if spec is not None:
        _write_spec(read, pairs, spec)
    shown = read.states[state or 0]
    value = {
        "labels": shown.labels,
        "pairs": [pair_object(pair, state or 0) for pair in pairs],
        "files": [spec] if spec is not None else [],
    }
    answer(value, state_lines(shown, pairs, read.turning), yes=True, as_json=as_json)


def _order(order: Order, seed: int) -> SuggestionOrder:
    from surefoot.skills.manager import cost_aware, paper_order

    return cost_aware if order is Order.COST_AWARE else paper_order(seed)


def _pairs(found: Mapping[str, Any]) -> str:
    head = f"{found['pairs']} pairs of {found['terrain_states']} terrain states"
    kinds = ("realizable", "repaired", "unrepairable", "undecided")
    return f"{head}: {', '.join(f'{found[kind]} {kind}' for kind in kinds)}"


def _chosen(library: SkillLibrary, number: int, request: str | None) -> list[PairAnswer]:
    """Return the pairs of a terrain state, or the one that is asked for."""
    from surefoot.errors import InputError
    from surefoot.skills.encoding import check_pair

    states = library.states
    if number >= len(states):
        raise InputError(
            f"there is no terrain state {number}; they go from 0 to {len(states) - 1}", source=library.folder
        )
    of_state = {pair.request: pair for pair in library.pairs.values() if pair.state == states[number]}
    if request is None:
        return list(of_state.values())
    cell = _cell(request)
    check_pair(states[number], cell)
    if cell not in of_state:
        asked = " ".join(f"{row},{column}" for row, column in of_state)
        raise InputError(f"{request} is not requested in terrain state {number}; there are: {asked}", key="--request")
    return [of_state[cell]]


def _cell(text: str) -> Cell:
    from surefoot.errors import InputError

    parts = text.split(",")
    if len(parts) != 2 or not all(part.strip().isdecimal() and len(part) < 9 for part in parts):
        raise InputError("has to be row,column, such as 0,1", key="--request")
    return int(parts[0]), int(parts[1])


def _write_spec(library: SkillLibrary, pairs: Sequence[PairAnswer], path: Path) -> None:
    from surefoot.compute import write_text_whole
    from surefoot.errors import InputError
    from surefoot.logic import write_slugsin, write_structuredslugs
    from surefoot.skills.encoding import pair_specification
    from surefoot.skills.heading_encoding import heading_pair_specification

    writers = {".structuredslugs": write_structuredslugs, ".slugsin": write_slugsin}
    if len(pairs) != 1:
        raise InputError("needs one pair: give --request as well", key="--spec")
    if path.suffix not in writers:
        raise InputError(f"has to end in {' or '.join(writers)}", key="--spec", source=path)
    state, request, turning = pairs[0].state, pairs[0].request, library.turning
    skills, refused = sorted(library.knowledge.skills), library.knowledge.refused
    if turning is None:
        spec = pair_specification(state, request, library.classes, skills, forbidden=refused)
    else:
        spec = heading_pair_specification(state, request, turning, skills, forbidden=refused)
    write_text_whole(path, writers[path.suffix](spec))

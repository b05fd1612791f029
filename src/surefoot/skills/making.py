"""From a terrain to a library: abstraction, start skills, every pair, the folder on disk."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from surefoot.compute import sha256_of
from surefoot.errors import InputError
from surefoot.skills.grid import TerrainSet
from surefoot.skills.journal import Stage, open_journal
from surefoot.skills.library import LIBRARY, read_library, write_library
from surefoot.skills.manager import SuggestionOrder, cost_aware, synthesize_library
from surefoot.skills.skill_game import CELLS, Frame
from surefoot.skills.values import CheckResult, PhysicsCheck, Primitive

Say = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class Checks:
    """Who answers about primitives.

    Attributes:
        physics: about what the repair suggests.
        made_with: everything that answers depend on, in JSON values.
        start: primitives that are checked first, if they occur in the terrain at all.
        start_physics: about those, with fewer gaits; None: the same physics.
    """

    physics: PhysicsCheck
    made_with: Mapping[str, Any]
    start: Sequence[Primitive] = ()
    start_physics: PhysicsCheck | None = None


def make_library(
    states: TerrainSet,
    folder: Path,
    checks: Checks,
    *,
    source: Path | None = None,
    order: SuggestionOrder = cost_aware,
    order_name: str = "cost-aware",
    at_once: int = 1,
    retry_unknown: bool = False,
    say: Say = lambda _: None,
) -> dict[str, Any]:
    """Synthesize a library into a folder, or go on with one that was interrupted.

    Args:
        states: terrain states and requests.
        folder: of the library; every check is there as soon as it is made.
        checks: who answers.
        source: the file of the terrain.
        order: of suggestions.
        order_name: the order in words.
        at_once: about how many primitives physics is asked at once; see ``synthesize_library``.
        retry_unknown: ask again about what was left undecided.
        say: is told what is being done.

    Returns:
        the numbers of the synthesis.

    Raises:
        InputError: the folder was made with other rules or for another terrain, is in use, or is damaged.
    """
    terrain = _terrain(states, source, folder)
    with open_journal(folder, checks.made_with, retry_unknown=retry_unknown) as journal:
        _refuse_other_terrain(folder, terrain)
        if journal.results:
            say(f"going on with the {len(journal.results)} checks that are in {folder} already")
        first = checks.start_physics
        start_physics = None if first is None else journal.recording(first, Stage.START)
        frame: Frame[Any] = states.turning or CELLS
        occurring = {move.skill for state in states.states for move in frame.moves(state)}
        start = [primitive for primitive in checks.start if primitive in occurring]
        say(f"checking {len(start)} primitives to begin with")
        synthesis = synthesize_library(
            states.pairs(),
            start,
            _told(journal.recording(checks.physics, Stage.REPAIR), say),
            start_physics=start_physics,
            order=order,
            at_once=at_once,
            say=say,
            frame=frame,
        )
        return write_library(
            folder,
            synthesis,
            journal.plans,
            made_with=checks.made_with,
            terrain=terrain,
            classes=states.classes.names,
            states=states.states,
            order=order_name,
            turning=states.turning,
        )


def _told(physics: PhysicsCheck, say: Say) -> PhysicsCheck:
    def check(primitives: Sequence[Primitive]) -> Iterable[CheckResult]:
        say(f"asking physics about {', '.join(one.name for one in primitives)}")
        return physics(primitives)

    return check


def _terrain(states: TerrainSet, source: Path | None, folder: Path) -> dict[str, Any]:
    requests = None if states.asked is None else [list(cell) for cell in states.asked]
    grid = [states.states[0].rows, states.states[0].columns]
    value: dict[str, Any] = {"name": states.name, "cell_m": states.cell_m, "grid": grid, "requests": requests}
    if states.turning is not None:
        value["directions"] = [way.value for way in states.turning.directions]
    if source is not None:
        value |= {"path": os.path.relpath(source, folder), "sha256": sha256_of(source)}
    return value


def _refuse_other_terrain(folder: Path, terrain: Mapping[str, Any]) -> None:
    if not (folder / LIBRARY).is_file():
        return
    found = read_library(folder).terrain
    if {**found, "path": None} != {**terrain, "path": None}:
        other = "another version of" if found.get("name") == terrain["name"] else "another terrain than"
        message = (
            f"holds the library of {other} {terrain['name']}; choose another folder (checks.jsonl and plans/ may be "
            "copied there: the same checks are not made twice)"
        )
        raise InputError(message, source=folder)

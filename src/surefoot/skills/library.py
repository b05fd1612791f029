"""The library of skills on disk: what the robot can do where, and why not.

``library.json`` is written whole when every pair has been handled; until then there is only the journal.
"""

from __future__ import annotations

import datetime
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from surefoot import __version__
from surefoot.compute import write_text_whole
from surefoot.documents import is_format, read_json_object
from surefoot.errors import InputError
from surefoot.skills.headings import Turning, read_turning, read_way, turning_object
from surefoot.skills.journal import CHECKS, PlanFile, check_object, differing, read_check
from surefoot.skills.manager import Knowledge, Outcome, PairAnswer, Synthesis
from surefoot.skills.unrepairable import Cause, Explanation
from surefoot.skills.values import Cell, Direction, Physics, Primitive, Skill, TerrainState

LIBRARY = "library.json"
KIND = "skill-library"
FORMAT = 1
LARGEST_BYTES = 200_000_000


@dataclass(frozen=True, slots=True)
class SkillLibrary:
    """A library as it was read.

    Attributes:
        folder: where it is.
        made_with: what the answers of physics depend on: rules, robot, cell, gaits.
        terrain: what it was made for.
        classes: terrain classes.
        knowledge: every answer of physics.
        plans: certificates of the skills, files in the folder.
        start: primitives that were checked first.
        states: terrain states, in their order.
        pairs: every pair of a terrain state and a request, with its strategy.
        answer: the numbers of the synthesis.
        turning: how the robot sees a grid with every heading; None: it always faces ahead.
    """

    folder: Path
    made_with: Mapping[str, Any]
    terrain: Mapping[str, Any]
    classes: tuple[str, ...]
    knowledge: Knowledge
    plans: Mapping[Primitive, PlanFile]
    start: tuple[Primitive, ...]
    states: tuple[TerrainState, ...]
    pairs: Mapping[tuple[TerrainState, Cell], PairAnswer]
    answer: Mapping[str, Any]
    turning: Turning | None = None

    @property
    def skills(self) -> dict[Primitive, Skill]:
        """What the robot can do; the plan of a skill is a file of ``plans``."""
        feasible = (one for one in self.knowledge.results.values() if one.verdict is Physics.FEASIBLE)
        return {one.primitive: one.skill(self._sha256(one.primitive)) for one in feasible}

    def _sha256(self, primitive: Primitive) -> str | None:
        return self.plans[primitive].sha256 if primitive in self.plans else None

    def plan_path(self, primitive: Primitive) -> Path | None:
        """Return the certificate of a skill."""
        return self.folder / self.plans[primitive].path if primitive in self.plans else None


def write_library(
    folder: Path,
    synthesis: Synthesis,
    plans: Mapping[Primitive, PlanFile],
    *,
    made_with: Mapping[str, Any],
    terrain: Mapping[str, Any],
    classes: Sequence[str],
    states: Sequence[TerrainState],
    order: str,
    turning: Turning | None = None,
) -> dict[str, Any]:
    """Write ``library.json``; return the numbers of the synthesis, which stand in it as ``answer``.

    Args:
        folder: of the library.
        synthesis: what was found.
        plans: certificates of the skills.
        made_with: what the answers of physics depend on.
        terrain: what the library is for.
        classes: terrain classes, without the obstacle.
        states: all terrain states, those without a request too.
        order: of suggestions, in words.
        turning: of a robot that turns.
    """
    every = 4 * len(classes) ** 2 if turning is None else turning.exhaustive()
    answer = {"terrain_states": len(states), **numbers(synthesis, every)}
    place = {state: index for index, state in enumerate(states)}
    results = synthesis.knowledge.results.values()
    value = {
        "kind": KIND,
        "format": FORMAT,
        "surefoot": __version__,
        "made": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        "made_with": dict(made_with),
        "terrain": dict(terrain),
        "classes": list(classes),
        **({} if turning is None else {"headings": turning_object(turning)}),
        "order": order,
        "start": [primitive.name for primitive in synthesis.start],
        "checks": [check_object(result, plans.get(result.primitive)) for result in results],
        "states": [[list(row) for row in state.labels] for state in states],
        "pairs": [pair_object(pair, place[pair.state]) for pair in synthesis.pairs],
        "answer": answer,
    }
    write_text_whole(folder / LIBRARY, json.dumps(value) + "\n")
    return answer


def numbers(synthesis: Synthesis, every: int) -> dict[str, Any]:
    """Return the line of the paper's table, and beside its way of counting an honest one.

    Args:
        synthesis: all pairs.
        every: how many primitives there are.
    """
    knowledge = synthesis.knowledge
    repaired, unrepairable = synthesis.count(Outcome.REPAIRED), synthesis.count(Outcome.UNREPAIRABLE)
    undecided, pairs = synthesis.count(Outcome.UNDECIDED), len(synthesis.pairs)
    start_skills = sum(one in knowledge.skills for one in synthesis.start)
    suggested = [one for pair in synthesis.pairs for one in pair.asked]
    causes = [pair.why.cause for pair in synthesis.pairs if pair.why is not None]
    in_need = repaired + unrepairable + undecided
    return {
        "pairs": pairs,
        "start_skills": start_skills,
        "realizable": synthesis.count(Outcome.REALIZABLE),
        "repaired": repaired,
        "unrepairable": unrepairable,
        "undecided": undecided,
        "unrepairable_by_obstacles": causes.count(Cause.OBSTACLE),
        "unrepairable_by_physics": causes.count(Cause.PHYSICS),
        "checks_feasible": knowledge.count(Physics.FEASIBLE),
        "checks_infeasible": knowledge.count(Physics.INFEASIBLE),
        "checks_unknown": knowledge.count(Physics.UNKNOWN),
        "suggested": len(suggested),
        "suggested_feasible": sum(one in knowledge.skills for one in suggested),
        "fewest_new": sum(pair.fewest for pair in synthesis.pairs if pair.outcome is Outcome.REPAIRED),
        "exhaustive": every - start_skills,
        "handled_as_the_paper_counts": (pairs - unrepairable - undecided) / pairs if pairs else None,
        "repaired_of_those_in_need": repaired / in_need if in_need else None,
        "symbolic_s": round(sum(pair.symbolic_s for pair in synthesis.pairs), 4),
        "checks_s": round(sum(result.time_s for result in knowledge.results.values()), 3),
        "time_s": round(synthesis.time_s, 3),
    }


def read_library(folder: Path, *, made_with: Mapping[str, Any] | None = None) -> SkillLibrary:
    """Read a library that is complete.

    Args:
        folder: of the library.
        made_with: what it has to have been made with; None: whatever it was.

    Raises:
        InputError: there is none, its synthesis was interrupted, it is damaged, or was made with something else.
    """
    path = folder / LIBRARY
    if not path.is_file() and (folder / CHECKS).is_file():
        message = "its synthesis was interrupted; `surefoot skills synthesize` with the same folder goes on with it"
        raise InputError(message, source=folder)
    if not path.is_file():
        raise InputError(f"is no library of skills: it holds no {LIBRARY}", source=folder)
    value = read_json_object(path, LARGEST_BYTES)
    if value.get("kind") != KIND or not is_format(value.get("format"), FORMAT):
        raise InputError(f"is no library of kind {KIND}, format {FORMAT}", source=path)
    difference = None if made_with is None else differing(value.get("made_with"), made_with)
    if difference:
        raise InputError(f"this library was made with other rules: {difference}", source=path)
    try:
        return _library(folder, value)
    except (KeyError, TypeError, ValueError, IndexError, AttributeError, InputError) as problem:
        raise InputError(f"is no whole library (docs/formats.md): {problem}", source=path) from problem


def _library(folder: Path, value: Mapping[str, Any]) -> SkillLibrary:
    checks = [read_check(check, folder / LIBRARY) for check in value["checks"]]
    states = [TerrainState(tuple(tuple(map(str, row)) for row in labels)) for labels in value["states"]]
    turning = read_turning(value["headings"], value["classes"]) if "headings" in value else None
    pairs = [_pair(pair, states, turning) for pair in value["pairs"]]
    return SkillLibrary(
        folder=folder,
        made_with=dict(value["made_with"]),
        terrain=dict(value["terrain"]),
        classes=tuple(map(str, value["classes"])),
        knowledge=Knowledge().extended(result for result, _ in checks),
        plans={result.primitive: plan for result, plan in checks if plan is not None},
        start=_primitives(value["start"]),
        states=tuple(states),
        pairs={(pair.state, pair.request): pair for pair in pairs},
        answer=dict(value["answer"]),
        turning=turning,
    )


def pair_object(pair: PairAnswer, state: int) -> dict[str, Any]:
    """Return a pair as it stands in files (docs/formats.md).

    Args:
        pair: the answer.
        state: number of its terrain state.
    """
    why = pair.why
    return {
        "state": state,
        "request": list(pair.request),
        "outcome": pair.outcome.value,
        "strategy": _rows(pair),
        "new": [primitive.name for primitive in pair.new],
        "asked": [primitive.name for primitive in pair.asked],
        "fewest": pair.fewest,
        "why": None
        if why is None
        else {"cause": why.cause.value, "text": why.text, "primitives": [one.name for one in why.primitives]},
        "symbolic_s": round(pair.symbolic_s, 5),
    }


def _rows(pair: PairAnswer) -> list[list[Any]]:
    """Return a strategy in rows: cell and direction; with headings cell, heading, and direction or turn."""
    if pair.poses:
        return [[*cell, heading, way] for (cell, heading), way in sorted(pair.poses.items())]
    return [[*cell, move] for cell, move in sorted(pair.strategy.items())]


def _pair(value: Mapping[str, Any], states: Sequence[TerrainState], turning: Turning | None) -> PairAnswer:
    why, rows = value["why"], value["strategy"]
    row, column = value["request"]
    poses = {} if turning is None else {((int(r), int(c)), int(h)): read_way(way) for r, c, h, way in rows}
    cells = {} if turning else {(int(r), int(c)): None if way is None else Direction(way) for r, c, way in rows}
    return PairAnswer(
        state=states[value["state"]],
        request=(int(row), int(column)),
        outcome=Outcome(value["outcome"]),
        strategy=cells,
        new=_primitives(value["new"]),
        asked=_primitives(value["asked"]),
        fewest=int(value["fewest"]),
        why=None if why is None else Explanation(Cause(why["cause"]), str(why["text"]), _primitives(why["primitives"])),
        symbolic_s=float(value["symbolic_s"]),
        poses=poses,
    )


def _primitives(names: Sequence[str]) -> tuple[Primitive, ...]:
    return tuple(Primitive.parse(str(name)) for name in names)

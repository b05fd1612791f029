"""Every reader of a version takes the whole number 1, and nothing that Python holds to be equal to it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from surefoot.errors import InputError
from surefoot.footholds import read_problem
from surefoot.footholds.problem_file import read_robot
from surefoot.logic.strategy_file import load_strategy
from surefoot.missions.biped.run_log import read_run
from surefoot.missions.obstacles.scripts import read_script
from surefoot.missions.plans.document import read_plan_document
from surefoot.missions.pushes.source import read_pushes
from surefoot.missions.quadruped.events import read_events
from surefoot.missions.scenario.file import read_scenario
from surefoot.reach import load_region
from surefoot.skills.classes import read_classes
from surefoot.skills.library import read_library
from surefoot.skills.segmented import read_segmented
from surefoot.skills.terrain_file import read_terrain
from surefoot.verify import verify_path
from surefoot.verify.terrain.class_rules import rules_of
from surefoot.verify.terrain.map import read_map

Reader = Callable[[Path], Any]


def _folder_of(read: Reader) -> Reader:
    return lambda path: read(path.parent)


READERS: dict[str, tuple[str, str, Reader]] = {
    "problem": ("problem.yaml", "", read_problem),
    "robot": ("robot.yaml", "", read_robot),
    "scenario": ("scenario.yaml", "biped", read_scenario),
    "script of obstacles": ("script.yaml", "obstacle-script", lambda path: read_script(path, None, ())),  # type: ignore[arg-type]
    "script of pushes": ("pushes.yaml", "push-script", read_pushes),
    "events": ("events.yaml", "quadruped-events", read_events),
    "plan": ("plan.json", "biped-plan", _folder_of(read_plan_document)),
    "run": ("run.jsonl", "biped-run", _folder_of(read_run)),
    "region": ("step.json", "step-region", load_region),
    "classes": ("classes.yaml", "terrain-classes", read_classes),
    "terrain of a quadruped": ("terrain.yaml", "quadruped-terrain", read_terrain),
    "segmented terrain": ("terrain.json", "terrain", read_segmented),
    "library": ("library.json", "skill-library", _folder_of(read_library)),
    "strategy": ("strategy.json", "gr1-strategy", load_strategy),
    "checked strategy": ("strategy.json", "gr1-strategy", verify_path),
    "checked ranking": ("ranking.json", "gr1-ranking", verify_path),
    "checked plan": ("plan.json", "foothold-plan", verify_path),
    "checked terrain": ("terrain.json", "terrain", verify_path),
    "checked region": ("step.json", "step-region", verify_path),
    "checked map": ("map.yaml", "quadruped-terrain", read_map),
    "checked classes": ("classes.yaml", "terrain-classes", rules_of),
}


def _refusal(read: Reader, path: Path, kind: str, version: object) -> str:
    document: dict[str, object] = {"format": version, **({"kind": kind} if kind else {})}
    if kind == "quadruped-events":
        document["events"] = []
    path.write_text(json.dumps(document if path.suffix != ".jsonl" else {"record": "header", **document}) + "\n")
    try:
        read(path)
    except InputError as refused:
        return str(refused)
    return ""


@pytest.mark.parametrize("what", READERS)
def test_a_version_is_a_whole_number(what: str, tmp_path: Path) -> None:
    name, kind, read = READERS[what]
    right = _refusal(read, tmp_path / name, kind, 1)
    for version in (True, 1.0, "1", 2):
        wrong = _refusal(read, tmp_path / name, kind, version)
        assert "format" in wrong
        assert wrong != right

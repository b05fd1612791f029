"""The checker of foothold plans refuses every kind of tampering."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from surefoot.errors import InputError
from surefoot.footholds import solve, write_plan
from surefoot.footholds.generators import problem_of, strips
from surefoot.verify import verify_path


@pytest.fixture(scope="module")
def accepted(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    path = tmp_path_factory.mktemp("plan") / "plan.json"
    problem = strips(2, tilt=0.5, friction=0.2, goal_x_m=0.35)
    write_plan(path, problem, solve(problem, why=False))
    assert verify_path(path).accepted
    document: dict[str, Any] = json.loads(path.read_text())
    return document


def _shift(name: str, amount: float) -> Callable[[dict[str, Any]], None]:
    def change(document: dict[str, Any]) -> None:
        array = np.array(document["motion"][name])
        array[len(array) // 2] += amount
        document["motion"][name] = array.tolist()

    return change


def _step_into_the_gap(document: dict[str, Any]) -> None:
    for step in document["motion"]["footsteps"]:
        step["polygon"] = 1 - min(step["polygon"], 1)


def _claim_more(document: dict[str, Any]) -> None:
    document["answer"]["bound"] = document["answer"]["objective"] * 1.001


def _other_objective(document: dict[str, Any]) -> None:
    document["answer"]["objective"] *= 0.999


def _drop_a_branch(document: dict[str, Any]) -> None:
    splits = [node for node in document["proof"]["tree"] if "children" in node]
    splits[0]["children"] = splits[0]["children"][:1]


def _narrow_the_root(document: dict[str, Any]) -> None:
    root = document["proof"]["root"]
    place = max(range(len(root)), key=lambda k: len(root[k]))
    root[place] = root[place][:1]


def _no_multipliers(document: dict[str, Any]) -> None:
    document["proof"]["multipliers"] = [{} for _ in document["proof"]["multipliers"]]


def _pull_on_clearance(document: dict[str, Any]) -> None:
    for kept in document["proof"]["multipliers"]:
        kept["clearance"] = [[*row[:4], 5.0] for row in kept.get("clearance", [[4, 0, 0, 0, 1.0]])]


@pytest.mark.parametrize(
    ("change", "rule"),
    [
        (_shift("base_m", 1e-4), "integration"),
        (_shift("forces_n", 1.0), "dynamics"),
        (_shift("feet_m", 1e-4), "integration"),
        (_step_into_the_gap, "region"),
        (_claim_more, "bound"),
        (_other_objective, "objective"),
        (_drop_a_branch, "proof"),
        (_narrow_the_root, "proof"),
        (_no_multipliers, "bound"),
        (_pull_on_clearance, "proof"),
    ],
)
def test_refuses(accepted: dict[str, Any], tmp_path: Path, change: Callable[[dict[str, Any]], None], rule: str) -> None:
    document = json.loads(json.dumps(accepted))
    change(document)
    path = tmp_path / "changed.json"
    path.write_text(json.dumps(document))
    report = verify_path(path)
    assert not report.accepted
    assert any(rule in finding.rule for finding in report.findings), report.findings


def test_refuses_an_infeasibility_that_is_not_proved(tmp_path: Path) -> None:
    problem = strips(1, friction=0.1)
    solution = solve(problem, why=False)
    assert "Farkas" in solution.certificate
    path = tmp_path / "no.json"
    write_plan(path, problem, solution)
    assert verify_path(path).accepted
    document = json.loads(path.read_text())
    for one in document["values"]["polygons"]:
        one["friction"] = 0.8
    path.write_text(json.dumps(document))
    assert not verify_path(path).accepted


def test_refuses_files_that_are_not_whole(accepted: dict[str, Any], tmp_path: Path) -> None:
    document = json.loads(json.dumps(accepted))
    document["motion"]["feet_m"] = document["motion"]["feet_m"][:-1]
    path = tmp_path / "short.json"
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match="no whole foothold plan"):
        verify_path(path)


def test_accepts_plans_with_collision_avoidance(tmp_path: Path) -> None:
    problem = problem_of("step-up", 2)
    write_plan(tmp_path / "plan.json", problem, solve(problem, why=False))
    report = verify_path(tmp_path / "plan.json")
    assert report.accepted, report.findings

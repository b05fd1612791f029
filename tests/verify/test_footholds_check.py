"""The checker of foothold plans refuses every kind of tampering."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from surefoot.errors import InputError
from surefoot.footholds import read_problem, retarget, retargeted, solve, write_plan
from surefoot.footholds.gaits import NAMED
from surefoot.footholds.generators import problem_of, strips
from surefoot.verify import verify_path
from surefoot.verify.footholds.problem import differing_keys

PROBLEM = """
format: 1
robot: go2
gait: trot-1s
start: {position_m: [0, 0, 0.29], rpy_rad: [0, 0, 0.03]}
goal: {position_m: [0.1, 0, 0.29]}
polygons: [{vertices_m: [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]}]
"""


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


def _press(family: str, row: list[float]) -> Callable[[dict[str, Any]], None]:
    def change(document: dict[str, Any]) -> None:
        for kept in document["proof"]["multipliers"]:
            kept[family] = [*kept.get(family, []), row]

    return change


def _overflow(document: dict[str, Any]) -> None:
    _claim_more(document)
    for _ in range(3):
        _press("reach", [5, 0, 0, 0, 1e308])(document)


def _turn_before_the_start(document: dict[str, Any]) -> None:
    document["proof"]["turning"].append([-12, 2, 1e-3])


@pytest.mark.parametrize(
    ("change", "rule"),
    [
        (_overflow, "proof"),
        (_turn_before_the_start, "proof"),
        (_press("friction", [-1, 0, 0.0, 0.0, -1e-3]), "proof"),
        (_press("torque", [5, -1, 0, 0, 1e-3]), "proof"),
        (_press("clearance", [True, 0, 0, 0, -1e-3]), "proof"),
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


def _set(*keys: str | int, to: object) -> Callable[[dict[str, Any]], None]:
    def change(document: dict[str, Any]) -> None:
        here: Any = document
        for key in keys[:-1]:
            here = here[key]
        here[keys[-1]] = to

    return change


@pytest.fixture
def of_a_file(tmp_path: Path) -> Path:
    (tmp_path / "problem.yaml").write_text(PROBLEM)
    problem = read_problem(tmp_path / "problem.yaml")
    write_plan(tmp_path / "plan.json", problem, solve(problem, why=False))
    assert verify_path(tmp_path / "plan.json").accepted
    return tmp_path / "plan.json"


@pytest.mark.parametrize(
    ("change", "where"),
    [
        (_set("values", "robot", "torque_max_nm", to=[500.0, 500.0, 500.0]), "values.robot"),
        (_set("values", "robot", "base_torque_max_nm", to=300.0), "values.robot"),
        (_set("values", "options", "tilt_max_rad", to=3.0), "values.options"),
        (_set("values", "weights", "force", to=0.2), "values.weights"),
        (_set("values", "gait", "modes", 0, to="STANCE"), "values.gait"),
        (_set("values", "goal", "rpy_rad", to=[0.0, 0.0, 0.3]), "values.goal"),
        (_set("values", "samples", to=3), "values.samples"),
        (_set("answer", "bound", to=None), "answer.gap"),
        (_set("answer", "net_gap", to=0.5), "answer.net_gap"),
    ],
)
def test_refuses_what_is_not_in_the_problem_file(
    of_a_file: Path, change: Callable[[dict[str, Any]], None], where: str
) -> None:
    document = json.loads(of_a_file.read_text())
    change(document)
    if where == "values.gait":
        document["motion"] = None
    of_a_file.write_text(json.dumps(document))
    report = verify_path(of_a_file)
    assert not report.accepted
    assert where in {finding.where for finding in report.findings}


def test_accepts_robot_and_gait_files(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text(
        "format: 1\nname: mine\nmass_kg: 1.2e1\ninertia_kgm2: [0.1, 0.3, 0.3]\nfoot_reference_m: [0.18, 0.13, -0.29]\n"
        "foot_reach_m: [0.15, 0.1, 0.15]\ntorque_max_nm: [20, 20, 40]\n"
    )
    (tmp_path / "gait.info").write_text(
        "modeSequence { [0] STANCE [1] LF_RF_LH [2] STANCE } switchingTimes { [0] 0 [1] 0.5 [2] 1 [3] 1.5 }"
    )
    path = tmp_path / "problem.yaml"
    path.write_text(
        PROBLEM.replace("go2", "mine.yaml").replace("trot-1s", "gait.info") + "options: {clearance_m: 3e-2}"
    )
    problem = read_problem(path)
    write_plan(tmp_path / "plan.json", problem, solve(problem, why=False))
    report = verify_path(tmp_path / "plan.json")
    assert report.accepted, report.findings
    (tmp_path / "mine.yaml").write_text((tmp_path / "mine.yaml").read_text().replace("20, 20", "2, 2"))
    assert {finding.where for finding in verify_path(tmp_path / "plan.json").findings} == {"values.robot"}


def test_refuses_polygons_that_do_not_exist(of_a_file: Path) -> None:
    document = json.loads(of_a_file.read_text())
    document["motion"]["footsteps"][0]["polygon"] = -1
    of_a_file.write_text(json.dumps(document))
    with pytest.raises(InputError, match="polygon has to count from 0 to 0"):
        verify_path(of_a_file)


def test_accepts_a_goal_that_was_retargeted(tmp_path: Path) -> None:
    (tmp_path / "high.yaml").write_text(PROBLEM.replace("[0.1, 0, 0.29]", "[0.1, 0, 0.5]"))
    problem = read_problem(tmp_path / "high.yaml")
    moved = retargeted(problem, retarget(problem))
    assert moved.goal_m[2] < 0.45
    write_plan(tmp_path / "plan.json", moved, solve(moved, why=False))
    assert verify_path(tmp_path / "plan.json").accepted


@pytest.mark.parametrize("name", list(NAMED))
def test_the_checker_knows_the_named_gaits(name: str, tmp_path: Path) -> None:
    path = tmp_path / "problem.yaml"
    path.write_text(PROBLEM.replace("trot-1s", name))
    problem = read_problem(path)
    write_plan(tmp_path / "plan.json", problem, solve(problem, why=False))
    values = json.loads((tmp_path / "plan.json").read_text())["values"]
    assert differing_keys(path, values, None) == []
    assert differing_keys(path, values, {"horizon_s": 1.0}) == ["gait"]

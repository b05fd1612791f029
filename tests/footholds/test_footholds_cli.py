from __future__ import annotations

import json
from pathlib import Path

import pytest

from surefoot.cli import main

PROBLEM = """\
format: 1
robot: go2
gait: trot-1s
step_s: 0.05
start: {position_m: [0, 0, 0.29]}
goal:  {position_m: [GOAL, 0, 0.29]}
polygons:
  - {vertices_m: [[-1, -1, 0], [0.3, -1, 0], [0.3, 1, 0], [-1, 1, 0]]}
  - {vertices_m: [[0.35, -1, 0], [2, -1, 0], [2, 1, 0], [0.35, 1, 0]]}
"""


def run(*arguments: str) -> int:
    try:
        code = main(list(arguments))
    except SystemExit as leaving:
        code = leaving.code  # type: ignore[assignment]
    return int(code or 0)


def write(folder: Path, goal: float) -> Path:
    path = folder / "problem.yaml"
    path.write_text(PROBLEM.replace("GOAL", str(goal)))
    return path


def test_solves_plots_animates_and_verifies(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plan, picture, film = tmp_path / "plan.json", tmp_path / "plan.png", tmp_path / "plan.gif"
    problem = write(tmp_path, 0.3)
    assert run("footholds", "solve", str(problem), "-o", str(plan), "--plot", str(picture), "--json") == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["verdict"] == "feasible"
    assert answer["max_residual"] < 1e-6
    assert answer["values"]["options"]["clearance_m"] == 0.05
    assert set(answer) >= {
        "objective", "bound", "gap", "net_gap", "solve_ms", "certify_ms", "nodes", "certificate", "explanation",
    }  # fmt: skip
    assert run("verify", str(plan)) == 0
    assert run("footholds", "animate", str(plan), "-o", str(film)) == 0
    assert picture.read_bytes()[:4] == b"\x89PNG"
    assert film.read_bytes()[:3] == b"GIF"


def test_answers_no_with_a_reason(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plan = tmp_path / "no.json"
    assert run("footholds", "solve", str(write(tmp_path, 0.9)), "-o", str(plan)) == 1
    assert "reach short by" in capsys.readouterr().out
    assert run("verify", str(plan)) == 0
    assert run("footholds", "animate", str(plan), "-o", str(tmp_path / "x.gif")) == 2


def test_answers_unknown_at_the_limit(tmp_path: Path) -> None:
    assert run("footholds", "solve", str(write(tmp_path, 0.3)), "--time-limit", "0.001") in {0, 3}


def test_the_time_limit_is_finite(tmp_path: Path) -> None:
    assert run("footholds", "solve", str(write(tmp_path, 0.3)), "--time-limit", "inf") == 2


def test_bad_input_is_one_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = write(tmp_path, 0.3)
    path.write_text(path.read_text().replace("go2", "go9"))
    assert run("footholds", "solve", str(path)) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "go9" in error
    assert "robot" in error


def test_prints_the_schema(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("footholds", "schema", "--json") == 0
    assert json.loads(capsys.readouterr().out)["title"].startswith("Surefoot foothold problem")

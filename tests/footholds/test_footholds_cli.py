from __future__ import annotations

import json
from pathlib import Path

import pytest

from calling import run
from surefoot.footholds.explain import in_digits

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


def test_a_gait_that_only_falls_is_refuted_with_a_reason(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, plan = write(tmp_path, 0.3), tmp_path / "falls.json"
    path.write_text(path.read_text().replace("trot-1s", "{modes: [FLY], switching_times_s: [0, 1]}"))
    assert run("footholds", "solve", str(path), "-o", str(plan)) == 1
    assert "the base falls" in capsys.readouterr().out
    assert run("verify", str(plan)) == 0


def test_one_push_from_the_ground_is_judged_by_where_it_leads(tmp_path: Path) -> None:
    path, plan = write(tmp_path, 0.3), tmp_path / "hop.json"
    gait = "{modes: [FLY, STANCE, FLY], switching_times_s: [0, 0.45, 0.5, 1]}"
    path.write_text(path.read_text().replace("trot-1s", gait))
    assert run("footholds", "solve", str(path), "-o", str(plan)) == 1
    assert run("verify", str(plan)) == 0


def test_a_motion_is_not_called_a_fall(tmp_path: Path) -> None:
    plan = tmp_path / "claimed.json"
    assert run("footholds", "solve", str(write(tmp_path, 0.3)), "-o", str(plan)) == 0
    document = json.loads(plan.read_text())
    document["answer"]["verdict"] = "infeasible"
    plan.write_text(json.dumps(document))
    assert run("verify", str(plan)) == 1


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("gait: trot-1s", "gait: 3", "gait: needs text, or a mapping with keys among modes, switching_times_s; not 3"),
        ("gait: trot-1s", "gait: free\nhorizon_s: 1\noptions: {min_dwell_cells: 9}", "is 9; allowed are 1 to 8"),
        ("format: 1", "format: true", "format: needs 1, not true"),
    ],
)
def test_what_does_not_fit_is_refused_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], old: str, new: str, says: str
) -> None:
    path = write(tmp_path, 0.3)
    path.write_text(path.read_text().replace(old, new))
    assert run("footholds", "solve", str(path)) == 2
    error = capsys.readouterr().err
    assert says in error
    assert error.count("\n") == 1


@pytest.mark.parametrize(
    ("option", "name", "says"),
    [
        ("-o", ".", ".: is a folder; name a file"),
        ("--gait", ".", ".: is a folder; name a file"),
        ("--plot", "plan.jpeg", "plan.jpeg: has to end with .png"),
        ("--plot", "", ".: is a folder; name a file"),
    ],
)
def test_files_are_looked_at_before_any_work(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], option: str, name: str, says: str
) -> None:
    assert run("footholds", "solve", str(tmp_path / "none.yaml"), option, name) == 2
    assert capsys.readouterr().err == f"error: {says}\n"


@pytest.mark.parametrize("option", ["-o", "--gait"])
def test_a_problem_is_not_replaced_by_what_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], option: str
) -> None:
    path = write(tmp_path, 0.3)
    same = path.rename(path.with_suffix(".json"))
    before = same.read_bytes()
    assert run("footholds", "solve", str(same), option, str(same)) == 2
    assert "is named twice" in capsys.readouterr().err
    assert same.read_bytes() == before


@pytest.mark.parametrize("name", ["plan.yaml", "plan"])
def test_a_plan_is_written_where_others_look_for_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    assert run("footholds", "solve", str(tmp_path / "none.yaml"), "-o", name) == 2
    assert capsys.readouterr().err == f"error: {name}: has to end with .json\n"


def test_long_ways_are_told_without_powers_of_ten() -> None:
    assert [in_digits(value, 2) for value in (0.25, 64.39, 99.6, 190.0, 1234.5)] == ["0.25", "64", "100", "190", "1234"]


def test_an_animation_is_a_gif(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("footholds", "animate", str(tmp_path / "none.json"), "-o", "film.mp4") == 2
    assert "film.mp4: has to end with .gif" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("goal", "ground", "says"),
    [
        ("[5, 0, 0.29]", "", "no polygon is within reach, wherever the base may be moved to: front left by 288 cm"),
        ("[0.6, 0, 0.6], rpy_rad: [0, -0.8, 0]", "slope", "or without friction"),
    ],
)
def test_retargeting_says_why_not(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], goal: str, ground: str, says: str
) -> None:
    path = write(tmp_path, 0.3)
    text = path.read_text().replace("[0.3, 0, 0.29]", goal)
    if ground:
        text += "  - {vertices_m: [[0, -1, 0], [2, -1, 2], [2, 1, 2], [0, 1, 0]]}\n"
    path.write_text(text)
    assert run("footholds", "retarget", str(path)) == 1
    assert says in capsys.readouterr().out
    assert run("footholds", "retarget", str(path), "--json") == 1
    assert says in json.loads(capsys.readouterr().out)["reason"]


def test_a_plan_without_a_bound_is_drawn(tmp_path: Path) -> None:
    path, picture = write(tmp_path, 0.3), tmp_path / "plan.png"
    text = path.read_text().replace("step_s: 0.05", "step_s: 0.025")
    free = "free\nhorizon_s: 0.6\noptions: {cell_s: 0.05, min_dwell_cells: 1}"
    path.write_text(text.replace("trot-1s", free).replace("[0.3, 0, 0.29]", "[0.05, 0, 0.29]"))
    plan = tmp_path / "plan.json"
    assert run("footholds", "solve", str(path), "--first", "-o", str(plan), "--plot", str(picture)) == 0
    assert json.loads(plan.read_text())["answer"]["gap"] is None
    assert picture.read_bytes()[:4] == b"\x89PNG"

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from surefoot.errors import InputError
from surefoot.footholds import problem_schema, read_problem

GOOD = """\
format: 1
robot: go2
gait: trot-2s
step_s: 0.025
start: {position_m: [0, 0, 0.29]}
goal:  {position_m: [0.6, 0, 0.29]}
polygons:
  - {vertices_m: [[-1, -1, 0], [2, -1, 0], [2, 1, 0], [-1, 1, 0]], friction: 0.6}
"""
SQUARE = "[[-1, -1, 0], [2, -1, 0], [2, 1, 0], [-1, 1, 0]]"


def write(folder: Path, text: str) -> Path:
    path = folder / "problem.yaml"
    path.write_text(text)
    return path


def test_reads_a_problem_and_fills_in_what_is_left_out(tmp_path: Path) -> None:
    problem = read_problem(write(tmp_path, GOOD))
    assert problem.samples == 80
    assert problem.feet_m[1] == pytest.approx([0.1805, -0.1308, 0.0])
    assert problem.options.clearance_m == 0.05
    assert problem.options.collision_windows == 30
    assert problem.weights.force == 0.1
    assert problem.start_rpy_rad == pytest.approx([0, 0, 0])


def test_reads_json_too(tmp_path: Path) -> None:
    document = {
        "format": 1,
        "robot": "chotu",
        "gait": {"modes": ["LF_RH", "STANCE"], "switching_times_s": [0, 0.5, 1.0]},
        "step_s": 0.05,
        "start": {"position_m": [0, 0, 0.3]},
        "goal": {"position_m": [0, 0, 0.3]},
        "polygons": [{"vertices_m": [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]}],
    }
    path = tmp_path / "problem.json"
    path.write_text(json.dumps(document))
    problem = read_problem(path)
    assert problem.robot.mass_kg == 20.0
    assert problem.samples == 20
    assert len(problem.footsteps) == 2


def test_reads_a_robot_file_and_a_gait_file_beside_the_problem(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text(
        "format: 1\nname: mine\nmass_kg: 12\ninertia_kgm2: [0.1, 0.3, 0.3]\nfoot_reference_m: [0.18, 0.13, -0.29]\n"
        "foot_reach_m: [0.15, 0.1, 0.15]\ntorque_max_nm: [20, 20, 40]\n"
    )
    (tmp_path / "gait.info").write_text(
        "modeSequence { [0] STANCE [1] LF_RF_LH [2] STANCE } switchingTimes { [0] 0 [1] 0.5 [2] 1 [3] 1.5 }"
    )
    text = GOOD.replace("go2", "mine.yaml").replace("trot-2s", "gait.info")
    problem = read_problem(write(tmp_path, text))
    assert problem.robot.mass_kg == 12
    assert problem.samples == 60


@pytest.mark.parametrize(
    ("old", "new", "line", "says"),
    [
        ("go2", "go3", 2, "there is no robot 'go3'"),
        ("trot-2s", "hop", 3, "there is no gait 'hop'"),
        ("0.025", "0.02", 3, "no multiple of step_s"),
        ("0.025", "-1", 4, "not below"),
        ("[0.6, 0, 0.29]", "[0.6, .nan, 0.29]", 6, "finite"),
        ("[0.6, 0, 0.29]", "[0.6, 0]", 6, "exactly 3"),
        ("friction: 0.6", "friction: -0.1", 8, "not below 0"),
        ("friction: 0.6", "grip: 0.6", 8, "not a known key"),
        (SQUARE, "[[-1, -1, 0], [2, -1, 0], [2, 1, 0.1], [-1, 1, 0]]", 8, "not planar"),
        (SQUARE, "[[-1, -1, 0], [2, 1, 0], [2, -1, 0], [-1, 1, 0]]", 8, "crosses itself"),
        (SQUARE, "[[-1, -1, 0], [2, -1, 0], [0, 0, 0], [-1, 1, 0]]", 8, "not convex"),
        (SQUARE, "[[-1, -1, 0], [2, -1, 0], [3, -1, 0]]", 8, "no area"),
        (SQUARE, "[[0.5, -1, 0], [2, -1, 0], [2, 1, 0], [0.5, 1, 0]]", 5, "outside every polygon"),
        (
            "[0, 0, 0.29]}",
            "[0, 0, 0.29], feet_m: [[0.5, 0.13, 0], [0.18, -0.13, 0], [-0.18, 0.13, 0], [-0.18, -0.13, 0]]}",
            5,
            "out of reach",
        ),
        ("format: 1", "format: 2", 1, "1"),
    ],
)  # fmt: skip
def test_refuses_with_file_line_and_sentence(tmp_path: Path, old: str, new: str, line: int, says: str) -> None:
    path = write(tmp_path, GOOD.replace(old, new, 1))
    with pytest.raises(InputError) as refused:
        read_problem(path)
    assert says in str(refused.value)
    assert f"{path}:{line}:" in str(refused.value)


def test_refused_polygons_are_counted_too(tmp_path: Path) -> None:
    with pytest.raises(InputError) as refused:
        read_problem(write(tmp_path, GOOD.replace(SQUARE, "[[0, 0, 0], [1, 0, 0]]")))
    assert str(refused.value).endswith("polygons[0].vertices_m: needs at least 3 items, not 2")
    assert "\n" not in str(refused.value)


def test_collision_needs_free_regions(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="needs at least one of free_regions"):
        read_problem(write(tmp_path, GOOD + "options: {collision: true}\n"))


def test_the_schema_names_every_key() -> None:
    schema: dict[str, Any] = problem_schema()
    assert {"robot", "gait", "step_s", "start", "goal", "polygons", "free_regions", "options"} <= set(
        schema["properties"]
    )


def test_polygons_are_kept_in_order(tmp_path: Path) -> None:
    more = "  - {vertices_m: [[3, 0, 0], [4, 0, 0], [4, 1, 0]]}\n"
    problem = read_problem(write(tmp_path, GOOD + more))
    assert np.abs(problem.polygons[1].vertices_m[:, 0]).min() == 3

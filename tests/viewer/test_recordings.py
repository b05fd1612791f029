"""MCAP recordings, read back by a library that did not write them."""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbag_reading import read
from scipy.spatial.transform import Rotation

from surefoot.cli import main
from surefoot.footholds import read_problem, solve, write_plan
from surefoot.robots import quadruped
from surefoot.robots.legs import JOINTS, legs
from surefoot.viewer.sources.timeline import read_timeline
from synthetic_run import CELL_M, HIDDEN, write_run


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_run(tmp_path_factory.mktemp("bag"), laps=1)


@pytest.fixture(scope="module")
def recorded(run_folder: Path) -> dict[str, list[tuple[float, Any]]]:
    assert main(["view", str(run_folder), "--mcap", str(run_folder / "run.mcap")]) == 0
    return read(run_folder / "run.mcap")


def test_the_map_has_the_walls_where_they_are(recorded: dict[str, list[tuple[float, Any]]]) -> None:
    ((_, grid),) = recorded["/map"]
    values = np.array(grid.data).reshape(grid.info.height, grid.info.width)
    assert grid.info.resolution == pytest.approx(CELL_M / 10)

    def at(x_m: float, y_m: float) -> int:
        return int(values[int(y_m / grid.info.resolution), int(x_m / grid.info.resolution)])

    assert at(1.5 * CELL_M, 3.5 * CELL_M) == 0
    assert at(2.5 * CELL_M, 2.5 * CELL_M) == 100
    assert at(0.5 * CELL_M, 0.5 * CELL_M) == 100


def test_path_and_frames_are_those_of_the_log(recorded: dict[str, list[tuple[float, Any]]], run_folder: Path) -> None:
    source, times = read_timeline(run_folder)
    ((_, path),) = recorded["/path"]
    assert len(path.poses) == len(recorded["/tf"]) == times.frames
    for number in (0, 100, times.frames - 1):
        stamp, place = path.poses[number].header.stamp, path.poses[number].pose.position
        assert stamp.sec + stamp.nanosec / 1e9 == pytest.approx(times.time_s[number], abs=1e-8)
        assert (place.x, place.y, place.z) == pytest.approx(tuple(times.com_m[number]))
    step = source.run.steps[7]
    moment_s, message = min(recorded["/tf"], key=lambda one: abs(one[0] - step.time_s))
    assert moment_s == pytest.approx(step.time_s, abs=1e-6)
    frames = {one.child_frame_id: one.transform for one in message.transforms}
    assert set(frames) == {"trunk", "left_foot", "right_foot"}
    stance = frames[f"{step.stance}_foot"].translation
    assert (stance.x, stance.y, stance.z) == pytest.approx(step.foot_m)
    turned = frames["trunk"].rotation
    assert 2 * math.atan2(turned.z, turned.w) == pytest.approx(step.yaw_rad, abs=0.5)


def test_belief_orders_and_obstacles_are_those_of_the_turns(
    recorded: dict[str, list[tuple[float, Any]]], run_folder: Path
) -> None:
    turns = read_timeline(run_folder)[0].run.turns
    assert [message.data for _, message in recorded["/order"]] == [f"{t.order}, to goal {t.goal}" for t in turns]
    for turn, (time_s, message) in zip(turns, recorded["/belief"], strict=True):
        assert time_s == pytest.approx(turn.time_s, abs=1e-8)
        (tiles,) = message.markers
        cells = sorted((4 - int(place.y // CELL_M), int(place.x // CELL_M)) for place in tiles.points)
        assert cells == sorted(tuple(cell) for cell in HIDDEN.get(turn.turn, []))
        assert tiles.action == (0 if cells else 2)
    _, obstacles = recorded["/obstacles"][0]
    place = obstacles.markers[0].pose.position
    assert (4 - int(place.y // CELL_M), int(place.x // CELL_M)) == tuple(turns[0].obstacles[0])
    assert len(recorded["/footprints"]) == len(read_timeline(run_folder)[0].run.steps)
    assert len(recorded["/goals"][0][1].markers) == 4


def test_a_foothold_plan_is_recorded(tmp_path: Path, request: pytest.FixtureRequest) -> None:
    plan = tmp_path / "plan.json"
    problem = read_problem(request.config.rootpath / "scenes" / "footholds" / "stones.yaml")
    write_plan(plan, problem, solve(problem))
    assert main(["view", str(plan), "--mcap", str(tmp_path / "plan.mcap"), "--json"]) == 0
    recorded, document = read(tmp_path / "plan.mcap"), json.loads(plan.read_text())
    motion, step_s = document["motion"], document["values"]["step_s"]
    assert len(recorded["/terrain"][0][1].markers) == len(document["values"]["polygons"])
    for sample, (time_s, message) in enumerate(recorded["/tf"]):
        assert time_s == pytest.approx(sample * step_s, abs=1e-8)
        frames = {one.child_frame_id: one.transform.translation for one in message.transforms}
        foot = frames["hind_right"]
        assert (foot.x, foot.y, foot.z) == pytest.approx(motion["feet_m"][sample][3])
    for sample, (_, message) in enumerate(recorded["/forces"]):
        for arrow, force in zip(message.markers, motion["forces_n"][sample], strict=True):
            rise_m = arrow.points[1].z - arrow.points[0].z if arrow.points else 0.0
            assert 300 * rise_m == pytest.approx(force[2], abs=1e-6)


def test_joint_states_put_the_feet_where_the_plan_has_them(
    tmp_path: Path, request: pytest.FixtureRequest, capsys: pytest.CaptureFixture[str]
) -> None:
    plan, leg = tmp_path / "plan.json", legs(quadruped("go2"))
    problem = read_problem(request.config.rootpath / "scenes" / "footholds" / "stones.yaml")
    write_plan(plan, problem, solve(problem))
    document = json.loads(plan.read_text())
    document["motion"]["feet_m"][10][2][2] -= 0.5  # no leg is as long as that
    plan.write_text(json.dumps(document))
    assert main(["view", str(plan), "--mcap", str(tmp_path / "plan.mcap"), "--json"]) == 0
    (remark,) = json.loads(capsys.readouterr().out)["remarks"]
    assert "are out of the legs' reach" in remark
    recorded, motion = read(tmp_path / "plan.mcap"), document["motion"]
    assert len(recorded["/joint_states"]) == len(motion["base_m"])
    for sample, (time_s, state) in enumerate(recorded["/joint_states"]):
        assert time_s == pytest.approx(sample * document["values"]["step_s"], abs=1e-8)
        assert tuple(state.name) == JOINTS
        frames = {one.child_frame_id: one.transform for one in recorded["/tf"][sample][1].transforms}
        turn, place = frames["base"].rotation, frames["base"].translation
        axes = Rotation.from_quat([turn.x, turn.y, turn.z, turn.w]).as_matrix()
        feet_m = leg.feet_m(np.array(state.position).reshape(1, 4, 3))[0] @ axes.T + (place.x, place.y, place.z)
        away_m = np.linalg.norm(feet_m - motion["feet_m"][sample], axis=1)
        assert np.flatnonzero(away_m > 1e-3).tolist() == ([2] if sample == 10 else [])


def test_without_the_packages_it_says_how_to_get_them(
    run_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "mcap_ros2.writer", None)
    assert main(["view", str(run_folder), "--mcap", str(tmp_path / "run.mcap")]) == 2
    assert "install it with: pip install 'surefoot[view]'" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []

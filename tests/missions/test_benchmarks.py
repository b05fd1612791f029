"""What benchmarks say about the numbers that they measure, and the scenes that they measure on."""

from __future__ import annotations

from pathlib import Path

import pytest

from surefoot.errors import InputError
from surefoot.missions.bench.biped import benchmarks
from surefoot.missions.bench.figures import Figure
from surefoot.missions.scenario.file import read_scenario
from surefoot.missions.scenario.shipped import copy_scene, scene_names, scene_path


def figure(measured: float, target: float | None, bound: str = "at most") -> Figure:
    return Figure("x", measured, "s", target, bound, "")  # type: ignore[arg-type]


def test_targets_are_met_or_missed() -> None:
    assert figure(0.2, 0.3).met is True
    assert figure(0.4, 0.3).met is False
    assert figure(0.4, None).met is None
    assert figure(2, 2, "at least").met is True
    assert figure(1, 2, "at least").met is False


def test_numbers_are_short() -> None:
    assert figure(0.12345, 0.3).measured_text == "0.123 s"
    assert figure(12345.6, 0.3).measured_text == "12346 s"
    assert figure(3, 0.3).target_text == "at most 0.3 s"
    assert figure(3, None).target_text == ""


def test_an_unknown_benchmark_is_refused_with_those_that_exist() -> None:
    with pytest.raises(InputError, match="there are all, walking, navigation, action, mission"):
        benchmarks("speed")


def test_the_scenes_of_the_repository_are_found(scenes: Path) -> None:
    assert "two_rooms" in scene_names()
    assert scene_path("two_rooms") == scenes / "two_rooms_mission.yaml"
    with pytest.raises(InputError, match=r"no scene 'moon'; there are .*two_rooms"):
        scene_path("moon")


def test_a_copied_scene_is_whole(tmp_path: Path) -> None:
    scenario = read_scenario(copy_scene("two_rooms", tmp_path))
    assert scenario.map_path.parent == tmp_path
    assert {path.name for path in tmp_path.iterdir()} == {"two_rooms_mission.yaml", "two_rooms.yaml", "two_rooms.pgm"}

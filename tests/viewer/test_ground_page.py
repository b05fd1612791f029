"""The page of a quadruped's run on its terrain: ground that changes, obstacles, way points, goal, skills."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browsing import Opened, browser
from rosbag_reading import read

from quadruped_field import write_field
from surefoot.cli import main
from surefoot.compute import sha256_of
from surefoot.errors import InputError
from surefoot.footholds import read_problem, solve, write_plan
from surefoot.viewer.sources.ground import read_run_ground

OBSTACLE_S, HOLE_S, SECOND_S = 3.5, 5.5, 6.0
EVENTS: tuple[dict[str, Any], ...] = (
    {"at_segment": 1, "obstacle_m": [[1.7, 1.0], [1.9, 1.4]]},
    {"at_s": HOLE_S, "hole_m": [[2.6, 1.0], [3.0, 1.4]]},
)


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Path:
    """Return a run of two segments; an obstacle appears and ground goes, and the robot asks for another cell."""
    folder = tmp_path_factory.mktemp("ground")
    field = write_field(folder / "field.yaml")
    problem = read_problem(request.config.rootpath / "scenes" / "footholds" / "stones.yaml")
    write_plan(folder / "segment.json", problem, solve(problem))
    plan = {"path": "segment.json", "sha256": sha256_of(folder / "segment.json")}
    head = {"origin_m": [0, 0], "cells": [4, 3], "cell_m": 0.8, "grid": [3, 3], "classes": "unstructured-4"}
    asked = {"record": "request", "cell": [3, 1], "quarter_turns": 0, "request": [0, 1]}
    walked = {"record": "segment", "plan": plan, "end_s": 9.0}
    records: list[dict[str, Any]] = [
        {
            "record": "header", "kind": "quadruped-run", "format": 1, **head,
            "terrain": {"path": "field.yaml", "sha256": sha256_of(field)}, "goal": {"place_m": [2.8, 1.2]},
        },
        asked,
        {**walked, "number": 0, "primitive": "forward flat->flat", "start_s": 1.0, "plan_start_s": 0.5},
        *(
            {"record": "event", "before_segment": 1, "seen_s": seen_s, "event": event, "stands": None}
            for seen_s, event in zip((OBSTACLE_S, HOLE_S), EVENTS, strict=True)
        ),
        {**asked, "cell": [2, 1], "quarter_turns": 1, "request": [0, 1]},
        {**walked, "number": 1, "primitive": "turn-left flat", "start_s": SECOND_S, "plan_start_s": OBSTACLE_S},
    ]  # fmt: skip
    (folder / "run.jsonl").write_text("".join(json.dumps(record) + "\n" for record in records))
    return folder


@pytest.fixture(scope="module")
def opened(run_folder: Path) -> Iterator[Opened]:
    assert main(["view", str(run_folder), "--html", str(run_folder / "run.html")]) == 0
    with browser() as one:
        one.open((run_folder / "run.html").as_uri(), "/robot/trunk")
        one.page.keyboard.press("Space")
        yield one


def shown(opened: Opened, time_s: float, below: str, depth: int = 2) -> set[str]:
    """Return the visible nodes with so many names below a node, at a moment of the log."""
    opened.go_to(time_s - 1.0)
    opened.wait("!window.__viserMutable.messageQueue?.length")
    return {name for name in opened.nodes(below) if name.count("/") == depth}


@pytest.mark.xdist_group("browser")
def test_an_obstacle_stands_there_from_the_moment_on_that_it_was_seen(opened: Opened) -> None:
    assert shown(opened, 1.5, "/obstacles/") == set()
    assert shown(opened, SECOND_S + 0.5, "/obstacles/") == {"/obstacles/0"}
    assert opened.place("/obstacles/0")[:2] == pytest.approx([1.8, 1.2])


@pytest.mark.xdist_group("browser")
def test_ground_that_is_cut_and_ground_that_goes_is_not_shown_any_more(opened: Opened) -> None:
    for time_s, phases in ((1.5, ("0-0", "0-1", "0-2")), (SECOND_S + 0.5, ("0-2", "1-2", "2-2"))):
        assert shown(opened, time_s, "/ground/", 3) == {f"/ground/{one}/5" for one in phases}
    assert "/ground/pit" in opened.nodes("/ground/")


@pytest.mark.xdist_group("browser")
def test_the_way_point_is_the_one_that_is_asked_for(opened: Opened) -> None:
    """Row 0, column 1 of a grid is the cell ahead: [2, 1] for [3, 1]; after a turn to the left, [2, 0] for [2, 1]."""
    assert shown(opened, 1.5, "/way_points/") == {"/way_points/0"}
    assert opened.place("/way_points/0")[:2] == pytest.approx([1.2, 1.2])
    assert shown(opened, SECOND_S + 0.5, "/way_points/") == {"/way_points/1"}
    assert opened.place("/way_points/1")[:2] == pytest.approx([1.2, 2.0])
    assert opened.place("/goal") == pytest.approx([2.8, 1.2, 0.0])


@pytest.mark.xdist_group("browser")
def test_the_skill_is_said_and_its_label_goes_with_the_robot(opened: Opened) -> None:
    for time_s, skill in ((1.5, "segment 0: forward flat->flat"), (SECOND_S + 0.5, "segment 1: turn-left flat")):
        shown(opened, time_s, "/skill")
        x, y, z = opened.place("/skill")
        assert (x, y, z - 0.24) == pytest.approx(opened.place("/robot/trunk"), abs=1e-3)
        opened.wait(f"document.querySelector('#surefoot-caption').textContent.startsWith('S{skill[1:]}')")
    assert opened.errors == []


def test_phases_are_the_world_after_each_event(run_folder: Path) -> None:
    ground = read_run_ground(run_folder)
    assert ground is not None
    assert [phase.begin_s for phase in ground.phases] == [0.0, OBSTACLE_S, HOLE_S]
    assert [len(phase.obstacles) for phase in ground.phases] == [0, 1, 1]
    for phase, place, free in ((1, (1.8, 1.2), False), (1, (2.8, 1.2), True), (2, (2.8, 1.2), False)):
        assert _on_ground(ground.phases[phase].polygons_m, place) is free


def _on_ground(polygons: tuple[Any, ...], place: tuple[float, float]) -> bool:
    """Return whether a place is inside the bounds of some polygon; all of the field's are upright rectangles."""
    return any(
        (one[:, :2].min(axis=0) <= place).all() and (np.array(place) <= one[:, :2].max(axis=0)).all()
        for one in polygons
    )


def test_the_recording_has_the_ground_of_every_phase(run_folder: Path) -> None:
    assert main(["view", str(run_folder), "--mcap", str(run_folder / "run.mcap")]) == 0
    ground, recorded = read_run_ground(run_folder), read(run_folder / "run.mcap")
    assert ground is not None
    assert [time_s for time_s, _ in recorded["/terrain"]] == pytest.approx([1.0, OBSTACLE_S, HOLE_S])
    for phase, (_, message) in zip(ground.phases, recorded["/terrain"], strict=True):
        assert sum(one.action == 0 for one in message.markers) == len(phase.polygons_m)
    places = [[one.pose.position for one in message.markers] for _, message in recorded["/obstacles"]]
    assert [[(round(place.x, 6), round(place.y, 6)) for place in some] for some in places] == [[], *[[(1.8, 1.2)]] * 2]
    words = [message.data for _, message in recorded["/skill"]]
    assert words[0] == "segment 0: forward flat->flat"
    obstacle, hole = words[1].partition("(before it: ")[2].removesuffix(")").split("; ")
    assert obstacle == "an obstacle appeared, x 1.7 to 1.9 m, y 1 to 1.4 m"
    assert hole == "a hole appeared, x 2.6 to 3 m, y 1 to 1.4 m"
    assert [time_s for time_s, _ in recorded["/way_point"]] == pytest.approx([1.0, SECOND_S])
    assert recorded["/goals"][0][1].markers[0].pose.position.x == pytest.approx(2.8)


def test_a_changed_terrain_is_said_and_what_the_plans_knew_is_shown(
    run_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("run.jsonl", "segment.json"):
        (tmp_path / name).write_bytes((run_folder / name).read_bytes())
    (tmp_path / "field.yaml").write_text((run_folder / "field.yaml").read_text() + "# another\n")
    assert main(["view", str(tmp_path), "--html", str(tmp_path / "r.html"), "--json"]) == 0
    (remark,) = json.loads(capsys.readouterr().out)["remarks"]
    assert remark.startswith("the terrain file of the run is missing or was changed")


def test_a_log_without_what_the_ground_needs_is_one_sentence(run_folder: Path, tmp_path: Path) -> None:
    (tmp_path / "field.yaml").write_bytes((run_folder / "field.yaml").read_bytes())
    (tmp_path / "run.jsonl").write_text((run_folder / "run.jsonl").read_text().replace('"goal"', '"gaol"'))
    with pytest.raises(InputError, match=r"run\.jsonl: lacks 'goal'"):
        read_run_ground(tmp_path)

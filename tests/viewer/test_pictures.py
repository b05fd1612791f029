"""Pictures of runs, plans and scenarios, drawn from a synthetic run."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from surefoot.errors import InputError
from surefoot.missions.biped.run_log import Run, Turn, read_run
from surefoot.viewer import view_folder, view_plan, view_run
from synthetic_run import write_run


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_run(tmp_path_factory.mktemp("scene"))


@pytest.fixture(scope="module")
def run(run_folder: Path) -> Run:
    return read_run(run_folder)


def ink(picture: Path) -> float:
    """Return the share of a picture that is not white."""
    with Image.open(picture) as image:
        return float((np.asarray(image.convert("L")) < 250).mean())


def test_a_run_has_four_pictures_with_something_on_them(run_folder: Path, tmp_path: Path) -> None:
    pictures = view_run(run_folder, tmp_path / "out")
    assert [picture.name for picture in pictures] == ["map.png", "belief.png", "phase_space.png", "keyframes.png"]
    assert all(ink(picture) > 0.02 for picture in pictures)


def test_pictures_lie_in_the_run_unless_said_otherwise(tmp_path: Path) -> None:
    folder = write_run(tmp_path, laps=1)
    assert {picture.parent for picture in view_folder(folder)} == {folder}
    assert (folder / "map.png").is_file()


def test_a_plan_has_one_picture(run_folder: Path, tmp_path: Path) -> None:
    (picture,) = view_plan(run_folder.parent / "plan", tmp_path)
    assert ink(picture) > 0.1


def test_a_run_that_ended_before_its_first_step_is_drawn(tmp_path: Path) -> None:
    folder = write_run(tmp_path)
    log = folder / "run.jsonl"
    log.write_text("".join(line + "\n" for line in log.read_text().splitlines()[:2]))
    assert [picture.name for picture in view_run(folder)] == ["map.png", "belief.png"]


def test_what_is_no_run_and_no_plan_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"is none of these: the folder of a run .* a scenario"):
        view_folder(tmp_path)
    with pytest.raises(InputError, match="does not exist"):
        view_folder(tmp_path / "none")


def test_broken_assumptions_and_new_plans_are_marked(tmp_path: Path) -> None:
    folder = write_run(tmp_path)
    (plain,) = (path.read_bytes() for path in view_run(folder) if path.name == "map.png")
    log = folder / "run.jsonl"
    lines = log.read_text().splitlines(keepends=True)
    broken = {"record": "violation", "turn": 1, "time_s": 1.0, "violation": "jumps", "kind": 0, "cell": None}
    log.write_text("".join([lines[0], json.dumps(broken) + "\n", *lines[1:]]))
    (marked,) = (path.read_bytes() for path in view_run(folder) if path.name == "map.png")
    assert marked != plain


def test_a_missing_plan_is_named(tmp_path: Path) -> None:
    folder = write_run(tmp_path)
    (tmp_path / "plan" / "plan.json").unlink()
    with pytest.raises(InputError, match=r"plan: holds no plan\.json"):
        view_run(folder)


def test_a_plan_for_another_scenario_is_refused(tmp_path: Path) -> None:
    folder = write_run(tmp_path)
    log = folder / "run.jsonl"
    header, *rest = log.read_text().splitlines(keepends=True)
    document = json.loads(header)
    document["scenario"]["sha256"] = "1" * 64
    log.write_text("".join([json.dumps(document) + "\n", *rest]))
    with pytest.raises(InputError, match="another scenario"):
        view_run(folder)


@pytest.mark.parametrize("name", ["room_mission.yaml", "room.yaml", "room.pgm"])
def test_nothing_is_drawn_on_a_scenario_or_map_that_was_changed(tmp_path: Path, name: str) -> None:
    folder = write_run(tmp_path)
    path = tmp_path / name
    path.write_bytes(path.read_bytes() + b"\n")
    with pytest.raises(InputError, match=rf"{name} was changed since"):
        view_run(folder)


@pytest.mark.parametrize("key", ["rows", "free", "north_west_m"])
def test_a_plan_without_its_grid_is_refused(tmp_path: Path, key: str) -> None:
    folder = write_run(tmp_path)
    path = tmp_path / "plan" / "plan.json"
    document = json.loads(path.read_text())
    del document["grid"][key]
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match=key):
        view_run(folder)


def test_motion_between_logged_states_is_the_logged_motion(run: Run) -> None:
    from surefoot.viewer.sources.com_paths import halves

    for step in run.steps:
        (before, _), (after, speeds) = halves(step, 5)
        assert np.allclose(before[-1], step.switch_m, atol=1e-9)
        assert np.allclose(after[-1], step.next_com_m[:2], atol=1e-9)
        assert np.allclose(speeds[-1], step.next_velocity_mps, atol=1e-9)


def test_the_turn_that_is_shown_is_whole(run: Run) -> None:
    from surefoot.viewer.sources.steps import straight_stretch, turn_stretch

    turn = turn_stretch(run.steps)
    assert math.isclose(sum(step.heading_change_rad for step in turn), -math.pi / 2)
    assert not turn[0].heading_change_rad
    assert not turn[-1].heading_change_rad
    straight = straight_stretch(run.steps)
    assert len(straight) == 5
    assert not any(step.heading_change_rad for step in straight)


def turns(hidden: str) -> tuple[Turn, ...]:
    """Return turns; an ``h`` is one with a hidden obstacle."""
    common: dict[str, Any] = {"time_s": 0.0, "cell": (0, 0), "heading": "east", "goal": 0, "strategy": 0}
    common["order"] = "move east"
    cells = ((0, 0),)
    return tuple(
        Turn(
            turn=k,
            obstacles=cells,
            visible=(() if sign == "h" else cells,),
            hidden=(cells if sign == "h" else (),),
            **common,
        )
        for k, sign in enumerate(hidden)
    )


@pytest.mark.parametrize(
    ("hidden", "shown"),
    [
        ("..hhhhhhhhh..", (1, 2, 5, 7, 10, 11)),
        ("h...hh.......", (3, 4, 5, 6, 7, 8)),
        ("hhhhhh", (0, 1, 2, 3, 4, 5)),
        (".", (0,)),
        ("..........", (0, 2, 4, 5, 7, 9)),
    ],
)
def test_the_longest_hiding_is_shown(hidden: str, shown: tuple[int, ...]) -> None:
    from surefoot.viewer.maps.beliefs import chosen_turns

    assert chosen_turns(turns(hidden)) == shown

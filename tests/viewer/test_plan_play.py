"""A plan played cell by cell, tracks of obstacles, and pictures of plans and libraries."""

from __future__ import annotations

import json
import shutil
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from calling import surefoot
from quadruped_field import write_field
from surefoot.errors import InputError
from surefoot.frames import Cell
from surefoot.missions.biped.coarse_play import coarse_play
from surefoot.missions.biped.run_log import Turn
from surefoot.missions.scenario.scene import BipedScene, read_biped_scene
from surefoot.viewer import view_folder, view_plan, view_step
from surefoot.viewer.maps.beliefs import chosen_turns
from surefoot.viewer.maps.obstacle_tracks import way
from surefoot.viewer.maps.paths import draw_path
from surefoot.viewer.sources.plans import read_plan_source, read_run_source, strategy_of
from synthetic_run import write_run


def ink(picture: Path) -> float:
    with Image.open(picture) as image:
        return float((np.asarray(image.convert("L")) < 250).mean())


@pytest.fixture(scope="module")
def scene(scenes: Path) -> BipedScene:
    return read_biped_scene(scenes / "tutorial_mission.yaml")


@pytest.mark.parametrize("seed", range(5))
def test_a_play_goes_to_every_goal_by_the_rules(scene: BipedScene, tutorial_plan: Path, seed: int) -> None:
    play = coarse_play(scene, strategy_of(read_plan_source(tutorial_plan)), seed)
    grid, cells = scene.coarse.grid, [*(turn.cell for turn in play.turns), play.end]
    assert play.finished
    assert play.end == grid.cell(scene.problem.goals[0])
    assert {grid.cell(goal) for goal in scene.problem.goals} <= set(cells)
    for turn, after in zip(play.turns, cells[1:], strict=True):
        assert after == (turn.cell if turn.order.waits else turn.cell.neighbour(turn.order.direction))
        assert turn.cell not in turn.obstacles
    for (before,), (after,) in pairwise(turn.obstacles for turn in play.turns):
        assert way(grid, before, after, 1) is not None


def test_a_play_that_takes_too_long_ends(scene: BipedScene, tutorial_plan: Path) -> None:
    play = coarse_play(scene, strategy_of(read_plan_source(tutorial_plan)), 0, most_turns=3)
    assert len(play.turns) == 3
    assert not play.finished


def test_a_way_keeps_to_free_cells_and_to_the_moves(scene: BipedScene) -> None:
    grid = scene.coarse.grid  # a block stands in rows 2 and 3 of column 3
    assert way(grid, Cell(1, 1), Cell(1, 1), 0) == (Cell(1, 1),)
    assert way(grid, Cell(2, 2), Cell(1, 3), 2) == (Cell(2, 2), Cell(1, 2), Cell(1, 3))
    assert way(grid, Cell(2, 2), Cell(2, 4), 3) is None
    around = way(grid, Cell(2, 2), Cell(2, 4), 4)
    assert around is not None
    assert all(grid.is_free(cell) for cell in around)
    assert all(abs(a.row - b.row) + abs(a.column - b.column) == 1 for a, b in pairwise(around))


def test_a_plan_is_drawn_with_a_play(tutorial_plan: Path, tmp_path: Path) -> None:
    pictures = view_plan(tutorial_plan, tmp_path)
    assert [picture.name for picture in pictures] == ["plan.png", "play.png"]
    assert all(ink(picture) > 0.1 for picture in pictures)


def test_several_obstacles_have_colours_of_their_own(tmp_path: Path) -> None:
    folder = write_run(tmp_path, laps=1)
    twice(folder)
    with Image.open(draw_path(read_run_source(folder), tmp_path / "map.png")) as image:
        pixels = np.asarray(image.convert("RGB")).reshape(-1, 3)
    for hue in ((0xCC, 0x79, 0xA7), (0x5E, 0x3C, 0x99)):
        assert (np.abs(pixels.astype(int) - hue).max(axis=1) < 12).sum() > 100


def twice(folder: Path) -> None:
    """Let the log and the scenario of a run have their obstacle twice."""
    import hashlib

    log, scenario, plan = (
        folder / "run.jsonl",
        folder.parent / "room_mission.yaml",
        folder.parent / "plan" / "plan.json",
    )
    text = scenario.read_text()
    begin = text.index("obstacles: [") + len("obstacles: [")
    end = text.index("]\nsensor")
    scenario.write_text(f"{text[:begin]}{text[begin:end]}, {text[begin:]}")
    sha256 = hashlib.sha256(scenario.read_bytes()).hexdigest()
    records: list[dict[str, Any]] = [json.loads(line) for line in log.read_text().splitlines()]
    records[0]["scenario"]["sha256"] = sha256
    document = json.loads(plan.read_text())
    document["scenario"]["sha256"] = sha256
    plan.write_text(json.dumps(document))
    for record in records:
        if record["record"] == "turn":
            record["obstacles"] *= 2
    log.write_text("".join(json.dumps(record) + "\n" for record in records))


def test_the_turn_of_a_violation_is_shown() -> None:
    turns = [Turn(k, 0.0, (0, 0), "east", 0, ((0, 0),), (((0, 0),),), ((),), "move east", 0) for k in range(20)]
    assert chosen_turns(turns, broken=(11, 15)) == (9, 10, 11, 12, 13, 14)
    assert chosen_turns(turns, broken=(0,)) == (0, 1, 2, 3, 4, 5)
    assert chosen_turns(turns, broken=(19,)) == (14, 15, 16, 17, 18, 19)
    assert chosen_turns(turns[:3], broken=(1,)) == (0, 1, 2)


def test_a_library_is_drawn_with_its_classes(tmp_path: Path) -> None:
    field = write_field(tmp_path / "field.yaml")
    code, said = surefoot("skills", "synthesize", field, "-o", tmp_path / "library", "--jobs", 1, "--json")
    assert code == 0, said
    pictures = view_folder(tmp_path / "library", tmp_path)
    assert [picture.name for picture in pictures] == ["skills.png", "classes.png"]
    assert all(ink(picture) > 0.03 for picture in pictures)
    shutil.rmtree(tmp_path / "library" / "plans")
    (tmp_path / "library" / "library.json").write_text("{")
    with pytest.raises(InputError, match=r"library\.json"):
        view_folder(tmp_path / "library", tmp_path)


def test_a_step_that_nothing_pushed_shows_what_comes_next(tutorial_plan: Path, scenes: Path, tmp_path: Path) -> None:
    from surefoot.missions.biped.mission import run_mission

    run_mission(
        scenes / "tutorial_mission.yaml", tutorial_plan, steps=6, seed=0, obstacle="random", out=tmp_path / "run"
    )
    (picture,) = view_step(tmp_path / "run", 4, tmp_path)
    with Image.open(picture) as image:
        columns = (np.asarray(image.convert("L")) < 250).mean(axis=0)
    thirds = [part.mean() for part in np.array_split(columns, 3)]
    assert min(thirds) > 0.008


def test_a_plan_that_was_drawn_can_be_replaced(scenes: Path, tmp_path: Path) -> None:
    from surefoot.missions.plans.planning import plan_mission

    plan_mission(scenes / "tutorial_mission.yaml", tmp_path / "plan")
    assert (tmp_path / "plan" / "play.png") in view_plan(tmp_path / "plan")
    plan_mission(scenes / "tutorial_mission.yaml", tmp_path / "plan")
    assert not list((tmp_path / "plan").glob("*.png"))

"""The three reactions of the paper's two-room scene, each brought about by a script, and what a strategy answers."""

from __future__ import annotations

from pathlib import Path

import pytest

from surefoot.errors import InputError
from surefoot.frames import Cell, Direction
from surefoot.missions.biped.legs import Legs, fewest_moves
from surefoot.missions.biped.mission import run_mission
from surefoot.missions.scenario.scene import read_biped_scene
from surefoot.navigation import Order


@pytest.mark.parametrize("reaction", ["direct", "loop", "wait"])
def test_each_reaction_is_brought_about_by_a_script(
    reaction: str, two_rooms_plan: Path, scenes: Path, tmp_path: Path
) -> None:
    answer = run_mission(
        scenes / "two_rooms_mission.yaml",
        two_rooms_plan,
        steps=260,
        seed=0,
        obstacle="scripted",
        script=scenes / "scripts" / f"two_rooms_{reaction}.yaml",
        out=tmp_path / "run",
    )
    assert answer.succeeded, answer.findings
    assert answer.reactions[reaction] >= 1
    assert sum(answer.reactions.values()) == sum(answer.goals_reached)
    if reaction == "direct":
        assert answer.reactions == {"direct": sum(answer.goals_reached), "loop": 0, "wait": 0}


def test_a_leg_is_told_by_its_moves_and_waits(scenes: Path) -> None:
    scene = read_biped_scene(scenes / "tutorial_mission.yaml")
    start, heading = scene.problem.start, scene.problem.heading
    east, south = Order(Direction.EAST, waits=False), Order(Direction.SOUTH, waits=False)
    goal = scene.grid.index(Cell(scene.grid.cell(start).row, scene.grid.cell(start).column + 1))
    assert fewest_moves(scene.coarse, start, heading, goal) == 1
    for orders, reaction in (
        ([east], "direct"),
        ([Order(Direction.EAST, waits=True), east], "wait"),
        ([south, east, east], "loop"),
    ):
        legs = Legs(scene.coarse, start, heading)
        for order in orders:
            legs.order(order)
        legs.finish(goal, Direction.EAST)
        assert legs.counts == {"direct": 0, "loop": 0, "wait": 0} | {reaction: 1}


def test_the_fewest_moves_make_no_u_turn(scenes: Path) -> None:
    scene = read_biped_scene(scenes / "tutorial_mission.yaml")
    start = scene.problem.start
    goal = scene.grid.index(scene.grid.cell(start).neighbour(Direction.NORTH))
    assert fewest_moves(scene.coarse, start, Direction.EAST, goal) == 1
    assert fewest_moves(scene.coarse, start, Direction.SOUTH, goal) > 2


def test_the_answers_in_a_cell_are_drawn(two_rooms_plan: Path, tmp_path: Path) -> None:
    from surefoot.viewer.maps.answers import Asked, draw_answers

    (picture,) = draw_answers(two_rooms_plan, Asked(Cell(3, 4)), tmp_path)
    assert picture.stat().st_size > 10_000
    assert picture.name.startswith("answers_r3_c4_")
    with pytest.raises(InputError, match="the strategy never comes to"):
        draw_answers(two_rooms_plan, Asked(Cell(99, 4)), tmp_path)
    with pytest.raises(InputError, match="only with: heading"):
        draw_answers(two_rooms_plan, Asked(Cell(3, 4), goal=9), tmp_path)

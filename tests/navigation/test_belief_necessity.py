"""Automatic belief regions, and what a scene loses without belief."""

from __future__ import annotations

import json
from itertools import combinations
from pathlib import Path

import pytest
from art import crowd, two_rooms
from hypothesis import given, settings
from hypothesis import strategies as st

from surefoot.missions.scenario.scene import read_biped_scene
from surefoot.navigation import (
    automatic_regions,
    belief_study,
    build_navigation_game,
    coarse_map,
    solve_navigation,
    throughput,
)
from surefoot.navigation.benchmarks import hall

SCENES = Path(__file__).parents[2] / "scenes"


@settings(max_examples=20, deadline=None)
@given(precision=st.floats(0, 1), columns=st.integers(4, 9), rows=st.integers(4, 8))
def test_automatic_regions_partition_the_domains(precision: float, columns: int, rows: int) -> None:
    problem = hall(columns, rows, 1)
    regions = automatic_regions(problem.coarse, problem.obstacles, precision)
    assert frozenset().union(*regions) == frozenset(problem.obstacle_kinds.cells)
    assert not any(one & other for one, other in combinations(regions, 2))


def test_precision_goes_from_one_region_to_one_per_cell() -> None:
    problem = two_rooms()
    counts = [
        len(automatic_regions(problem.coarse, problem.obstacles, precision)) for precision in (0, 0.25, 0.4, 0.6, 1)
    ]
    assert counts == [1, 4, 7, 14, 19]


def test_without_obstacles_there_is_nothing_to_part() -> None:
    assert automatic_regions(two_rooms().coarse, ()) == ()


def test_few_automatic_regions_do_as_well_as_the_ones_drawn_by_hand() -> None:
    drawn = two_rooms()
    chosen = two_rooms(regions=automatic_regions(drawn.coarse, drawn.obstacles))
    games = [build_navigation_game(problem) for problem in (drawn, chosen)]
    assert games[1].turns < games[0].turns
    visits = []
    for problem, game in zip((drawn, chosen), games, strict=True):
        _, strategy = solve_navigation(game)
        assert strategy is not None
        visits.append(throughput(problem, strategy, 4000, seed=1).visits)
    assert visits[1] > 0.85 * visits[0]


def test_throughput_falls_with_every_obstacle() -> None:
    """A measured study counted 6.0 visits in 100 turns with one obstacle and 4.6 with two."""
    rates = []
    for starts in ((61,), (61, 62)):
        problem = two_rooms(obstacles=crowd(starts, problem_forbidden()))
        _, strategy = solve_navigation(build_navigation_game(problem))
        assert strategy is not None
        played = throughput(problem, strategy, 6000)
        assert len(played.path) == played.turns
        rates.append(100 * played.visits / played.turns)
    assert rates == pytest.approx([6.2, 4.7], abs=0.6)


def problem_forbidden() -> frozenset[int]:
    return two_rooms().obstacles[0].forbidden


def test_the_papers_claim_holds_in_two_cases() -> None:
    """Without belief: natural reading realizable when narrowed, not when unnarrowed; the paper's reading neither."""
    answers = belief_study(two_rooms(), two_rooms(corners="hidden").coarse, turns=500)
    verdicts = {(answer.reading, answer.belief): answer.realizable for answer in answers}
    assert verdicts == {
        ("natural", "regions"): True,
        ("natural", "single"): True,
        ("natural", "unnarrowed"): False,
        ("paper", "regions"): True,
        ("paper", "single"): False,
        ("paper", "unnarrowed"): False,
    }
    assert all((answer.throughput is not None) == answer.realizable for answer in answers)


def test_belief_decides_around_the_blind_corner() -> None:
    scene = read_biped_scene(SCENES / "blind_corner_mission.yaml")
    assert len(scene.grid.free_cells()) == 10
    corners_hide = coarse_map(scene.grid, scene.heights, scene.scenario.sensor.range_m, "hidden")
    answers = belief_study(scene.problem, corners_hide, turns=500)
    verdicts = {answer.belief: answer.realizable for answer in answers if answer.reading == "natural"}
    assert verdicts == {"exact": True, "single": False, "unnarrowed": False}


def test_the_command_answers_with_verdicts_and_pictures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from surefoot.cli.commands import app

    command = ["belief", str(SCENES / "blind_corner_mission.yaml"), "--turns", "200", "-o", str(tmp_path), "--json"]
    assert app(command, standalone_mode=False) == 0
    value = json.loads(capsys.readouterr().out)
    assert [row["realizable"] for row in value["answers"]][:3] == [True, False, False]
    assert [Path(path).name for path in value["pictures"]] == ["belief_natural.png", "belief_paper.png"]
    assert all(Path(path).stat().st_size > 5000 for path in value["pictures"])

"""The benchmark of quadruped missions: campaigns that go on, thinned and turned ground, both planners, tables."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from pydantic import TypeAdapter

from calling import surefoot
from quadruped_field import write_field
from surefoot.cli import main
from surefoot.cli.benchmarks.quadruped import quadruped_figures
from surefoot.errors import InputError
from surefoot.footholds import Gait
from surefoot.footholds.fields import bars_with_gap
from surefoot.footholds.gaits import NAMED
from surefoot.footholds.nearest import nearest_footholds
from surefoot.footholds.terrain import polygon
from surefoot.missions.bench.campaign import Campaign
from surefoot.missions.bench.detours import Detour
from surefoot.missions.bench.quadruped import Measured
from surefoot.missions.bench.quadruped_missions import Ended, Mission, Program, refuted
from surefoot.missions.bench.straight import (
    Heuristic,
    Steps,
    Straight,
    on_whole_ground,
    straight_ahead,
    thinned,
    widest_m,
)
from surefoot.missions.bench.tables import misses, nearest_rows, turned_rows
from surefoot.missions.bench.turned import SLOW_WALK, Turned, mat, measure_mat, turned
from surefoot.missions.quadruped.crossing import Certificate, Crossed, OnlineLimits, cross, crossing
from surefoot.missions.quadruped.stance import stance_about
from surefoot.missions.quadruped.world import World
from surefoot.robots.quadruped import CHOTU, quadruped
from surefoot.skills import generated, read_terrain

ENDED = Ended(
    reached=True, why_not="", verified=True, findings=(), transitions=9, repairs=1, new_skills=0, resynthesis_ms=1.0,
    repair_ms=0.0, contradictions=1, other_gaits=1, settled=0, limits=0, detours=0, idle_s=0.0, idle_for_checks_s=0.0,
    walked_s=20.0,
)  # fmt: skip
LOST = replace(ENDED, reached=False, why_not="no way", refuted=("(1, 2) to (0, 2): infeasible; reach lacks 4 cm",))
SOUND = Steps(footholds=40, out_of_reach=0, off_polygon=0, worst_out_m=0.0, worst_off_m=0.0)
TRAPPED = Steps(footholds=40, out_of_reach=10, off_polygon=4, worst_out_m=0.2, worst_off_m=0.1)


def crossed(file: Path, gait: Gait) -> Crossed:
    """Solve the way from the start of the field to the next cell in a gait."""
    terrain, limits = read_terrain(file), OnlineLimits()
    world, robot = World(terrain), quadruped(terrain.robot)
    stance = stance_about(robot, world, terrain.centre_m((3, 0)), 0)
    assert stance is not None
    problem = crossing(robot, world, stance, (2, 0), 0, gait, limits)
    return cross(problem, Certificate(gait, np.zeros((0, 3)), ()), limits)


def test_what_is_in_the_folder_is_not_measured_again(tmp_path: Path) -> None:
    campaign, reader, calls = Campaign(tmp_path), TypeAdapter(Mission), []
    program = Program(30.0, 80.0, 15, 5280, 120, None, None, 120)
    mission = Mission("rebar-7", 3, "", True, ENDED, (program,))

    def measure() -> Mission:
        calls.append(1)
        return mission

    path = campaign.place("rebar-7", 3) / "mission.json"
    assert campaign.once(reader, path, measure) == mission
    assert campaign.once(reader, path, measure) == mission
    assert len(calls) == 1
    path.write_text('{"scene": "rebar-7"}')
    with pytest.raises(InputError, match="remove the file"):
        campaign.once(reader, path, measure)


def test_taking_bars_away_leaves_one_wide_gap_and_all_other_bars() -> None:
    gaps = []
    for seed in range(6):
        drawn = straight_ahead(generated("rebar-7", seed))
        if drawn is None:
            continue
        thin = thinned(drawn)
        assert thin is not None
        gone = [one for one in drawn.polygons if not any(one is other for other in thin.polygons)]
        assert len(thin.polygons) == len(drawn.polygons) - len(gone)
        assert 1 <= len(gone) <= 2
        assert widest_m(thin) >= widest_m(drawn)
        gaps.append(widest_m(thin))
    assert len(gaps) >= 3
    assert np.median(gaps) == pytest.approx(0.48, abs=0.08)


def test_turned_ground_keeps_its_shape_and_its_heights() -> None:
    terrain, about = mat(2), (1.0, 0.5)
    other = turned(terrain, about, 15)
    back = turned(other, about, -15)
    for before, moved, after in zip(terrain.polygons, other.polygons, back.polygons, strict=True):
        assert np.allclose(before.vertices_m, after.vertices_m)
        assert not np.allclose(before.vertices_m, moved.vertices_m)
        spans = [np.linalg.norm(one.vertices_m[:, :2] - about, axis=1) for one in (before, moved)]
        assert np.allclose(*spans)
    assert other.measured == terrain.measured


def test_the_mat_is_crossed_in_two_cycles_of_the_walk_at_every_angle(tmp_path: Path) -> None:
    rows = measure_mat(Campaign(tmp_path), 0)
    assert [one.angle_deg for one in rows] == [0, 5, 10, 15]
    assert all(len(one.solve_ms) == 5 and not one.refuted_ms for one in rows)
    sizes = [one.polygons for one in rows]
    assert all(a <= b for a, b in pairwise(sizes))
    assert SLOW_WALK.horizon_s == pytest.approx(4.45)


def test_moves_that_no_gait_can_do_are_explained(tmp_path: Path) -> None:
    file = write_field(tmp_path / "field.yaml")
    failed, done = crossed(file, NAMED["walk-2.25s"]), crossed(file, NAMED["trot-2s"])
    assert failed.infeasible
    assert not done.reason
    (said,) = refuted(read_terrain(file), [failed])
    assert said.startswith("(3, 0) to (2, 0): the program is infeasible")
    assert "reach" in said
    assert refuted(read_terrain(file), [failed, done]) == ()


def test_the_heuristic_goes_with_its_start() -> None:
    bars = bars_with_gap(2.0, 0.3, 0)
    here = nearest_footholds(CHOTU, bars, NAMED["trot-2s"], 0.2, 2)
    away = np.array([3.0, -1.0, 0.0])
    moved = tuple(polygon((one.vertices_m + away).tolist()) for one in bars)
    there = nearest_footholds(CHOTU, moved, NAMED["trot-2s"], 0.2, 2, start_m=(3.0, -1.0, 0.0))
    for a, b in zip(here, there, strict=True):
        assert np.allclose(a.landed_m + away, b.landed_m)
        assert a.beyond_reach_m == pytest.approx(b.beyond_reach_m)


def test_the_walk_is_too_fast_at_02_on_any_ground_and_the_trot_is_not() -> None:
    shares = {
        (gait, speed): on_whole_ground(gait, speed).steps.out_of_reach > 0
        for gait in ("walk-2.25s", "trot-2s")
        for speed in (0.1, 0.2)
    }
    assert shares == {
        ("walk-2.25s", 0.1): False,
        ("walk-2.25s", 0.2): True,
        ("trot-2s", 0.1): False,
        ("trot-2s", 0.2): False,
    }


def measured() -> Measured:
    programs = tuple(Program(t, 80.0, 15, 5280, 376, 100.0, 25.0, 120) for t in (20.0, 30.0, 40.0))
    heuristic = (Heuristic("walk-2.25s", 0.1, SOUND), Heuristic("walk-2.25s", 0.2, TRAPPED))
    return Measured(
        missions=(
            Mission("unstructured-8", 0, "", True, ENDED, programs),
            Mission("unstructured-8", 1, "", True, LOST, ()),
            Mission("unstructured-8", 2, "", False, LOST, ()),
            Mission("unstructured-8", 3, "cannot stand", False, None, ()),
        ),
        detours=(
            Detour("unstructured-8", 0, True, 7, 0.8, 0, ENDED),
            Detour("unstructured-8", 1, True, 7, 7.0, 2, LOST),
        ),
        straight=(
            Straight("rebar-7", 0, True, 0.48, True, ENDED, True, SOUND, heuristic),
            Straight("rebar-7", 1, True, 0.48, False, LOST, False, SOUND, heuristic),
        ),
        turned=(
            Turned("mat", 0, 5, (10.0, 20.0), (1.0,), 0, 0, 8.0, 100.0, 60.0),
            Turned("mat", 1, 5, (60.0,), (), 1, 2, 10.0, 100.0, 80.0),
            Turned("mat", 1, 10, (), (1.0,), 0, 0, 10.0, 100.0, 80.0),
        ),
    )


def test_misses_count_only_where_there_is_a_way_and_say_what_refuted_them() -> None:
    found = tuple(misses(measured()))
    assert [one.what for one in found] == ["unstructured-8, seed 1", "unstructured-8, seed 1, an obstacle appears"]
    assert all(one.refuted == LOST.refuted and one.why == "no way" for one in found)


def test_figures_hold_the_numbers_of_the_issue() -> None:
    figures = {one.what.removeprefix("unstructured-8"): one for one in quadruped_figures(measured())}
    assert figures[": maps with a way"].measured == 2
    assert figures[": goals missed although there is a way"].met is False
    assert figures[": starts that are no place to stand"].measured == 1
    assert figures[": online program, mean CPU"].measured == 30
    assert figures[": online program, p95 CPU"].measured == pytest.approx(39)
    assert figures[": these with collision, mean CPU"].measured == 100
    assert figures[": the same without, mean CPU"].measured == 25
    assert figures[": binaries of the same without"].measured == 120
    appears = ", obstacle appears: other strategy,"
    assert figures[f"{appears} skills at hand (1), CPU, median"].measured == pytest.approx(0.8)
    assert figures[f"{appears} skills at hand (1), CPU, worst"].met is True
    assert figures[f"{appears} new skills (1), CPU, worst"].measured == 7
    assert figures[f"{appears} new skills (1), CPU, worst"].met is None


def test_the_tables_sum_over_seeds() -> None:
    rows = {(one.scene, one.planner): one for one in nearest_rows(measured().straight)}
    assert (rows["rebar-7", "mission"].whole, rows["rebar-7", "mission"].ways) == (1, 1)
    trapped = rows["rebar-7", "walk-2.25s, 0.2 m/s"]
    assert (trapped.whole, trapped.ways, trapped.out_of_reach, trapped.off_polygon) == (0, 2, 0.25, 0.1)
    assert rows["whole ground", "trot-2s, 0.2 m/s"].out_of_reach == 0
    five, ten = turned_rows(measured().turned)
    assert (five.programs, five.least_ms, five.mean_ms, five.most_ms) == (3, 10, 30, 60)
    assert (five.refuted, five.no_stance, five.limits, five.polygons) == (1, 2, 1, 9)
    assert (ten.programs, ten.mean_ms, ten.refuted) == (0, None, 1)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["quadruped", "--scene", "moon"], "there are: unstructured-4, unstructured-8, rebar-7, rebar-14"),
        (["quadruped", "--full", "--seeds", "3"], "give --seeds or --full"),
        (["footholds", "--seeds", "3"], "surefoot bench quadruped"),
    ],
)
def test_options_are_refused_with_a_sentence(options: list[str], message: str) -> None:
    with pytest.raises(InputError, match=message):
        surefoot("bench", *options)


@pytest.mark.campaign
def test_a_campaign_measures_draws_and_goes_on(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    line = ["bench", "quadruped", "--scene", "rebar-7", "--seeds", "1", "--keep", str(tmp_path / "kept"), "--json"]
    assert main([*line, "-o", str(tmp_path / "pictures")]) == 0
    first = json.loads(capsys.readouterr().out)
    assert {Path(one).name for one in first["pictures"]} == {"detour.png", "nearest.png", "turned.png"}
    assert all(Path(one).stat().st_size > 10_000 for one in first["pictures"])
    assert first["missed"] == []
    assert main(line) == 0
    again = json.loads(capsys.readouterr().out)
    assert again["figures"] == first["figures"]
    assert again["turned"] == first["turned"]

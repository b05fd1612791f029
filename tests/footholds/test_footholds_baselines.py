"""The planners that certified segments are compared with."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from surefoot.cli import main
from surefoot.errors import InputError
from surefoot.footholds.baselines import measure_horizons, measure_nearest
from surefoot.footholds.fields import FIELDS, Field, bars_with_gap, field, field_polygons, rectangle
from surefoot.footholds.gaits import NAMED
from surefoot.footholds.long_horizon import plan_segments, plan_whole, segments_s
from surefoot.footholds.nearest import nearest_footholds
from surefoot.robots.quadruped import CHOTU


@pytest.mark.parametrize("kind", FIELDS)
def test_neighbours_lie_as_far_apart_as_the_field_says(kind: Field) -> None:
    centres = np.array([one.vertices_m.mean(axis=0) for one in field_polygons(kind, 2.0, seed=3)])
    size = 0.03 if kind.bars else 0.2
    assert np.allclose(np.diff(np.unique(centres[:, 0].round(9))), size + kind.spacing_m)
    assert centres[:, 0].min() < -0.2
    assert centres[:, 0].max() > 2.2


def test_one_gap_between_bars_is_the_widest() -> None:
    for seed in range(10):
        ends = np.array(
            [[one.vertices_m[:, 0].min(), one.vertices_m[:, 0].max()] for one in bars_with_gap(2, 0.48, seed)]
        )
        gaps = ends[1:, 0] - ends[:-1, 1]
        assert gaps.max() == pytest.approx(0.48)
        assert (gaps > 0.31).sum() == 1


def test_an_unknown_field_lists_those_that_exist() -> None:
    with pytest.raises(InputError, match="sparse stones, dense stones"):
        field("lawn")


def test_the_heuristic_stays_in_reach_on_whole_ground_at_walking_pace() -> None:
    ground = (rectangle(1.0, 0.0, 6.0, 2.0),)
    found = nearest_footholds(CHOTU, ground, NAMED["walk-2.25s"], 0.1, cycles=4)
    assert len(found) == 16
    assert max(one.beyond_reach_m for one in found) == 0
    assert max(one.off_polygon_m for one in found) < 1e-9
    assert all(np.allclose(one.chosen_m, one.wished_m) for one in found)


def test_the_heuristic_walks_into_a_gap_that_certified_segments_refuse() -> None:
    heuristic, certified = measure_nearest(2, widest_m=(0.48,))
    assert all(row.off_polygon > 0 for row in heuristic)
    assert certified[0].crossed == 0
    assert certified[0].refused == 2


def test_segments_add_up_to_the_horizon() -> None:
    for horizon in range(1, 12):
        parts = segments_s(horizon)
        assert sum(parts) == horizon
        assert set(parts) <= ({2, 3} if horizon > 1 else {1})


def test_segments_go_as_far_as_one_program() -> None:
    whole, parts = (plan(field("dense stones"), 4, 0, 30.0) for plan in (plan_whole, plan_segments))
    assert whole.verdict == parts.verdict == "feasible"
    assert parts.programs == 2
    assert parts.distance_m == pytest.approx(whole.distance_m, abs=0.05)


@pytest.mark.campaign
def test_the_command_prints_both_tables_and_draws(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = ["footholds", "baselines", "--seeds", "1", "--horizon", "2", "-o", str(tmp_path), "--json"]
    assert main(command) == 0
    printed = json.loads(capsys.readouterr().out)
    assert len(printed["horizons"]) == 8
    assert {row["speed_mps"] for row in printed["nearest"]} == {0.1, 0.2}
    assert all(Path(picture).stat().st_size > 10_000 for picture in printed["pictures"])


def test_a_program_that_runs_out_of_time_is_counted_as_censored() -> None:
    rows = measure_horizons(1, 1e-3, (3,))
    assert sum(row.censored for row in rows) > 0

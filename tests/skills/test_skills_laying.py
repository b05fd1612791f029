"""Cells over scanned ground: edges fall on their sides, whatever the heading; and what is in the way is told."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surefoot.errors import InputError
from surefoot.footholds.terrain import Polygon, polygon
from surefoot.skills import class_set, read_terrain, write_terrain
from surefoot.skills.blocking import barriers
from surefoot.skills.crevices import crevices
from surefoot.skills.lattice_fit import ground_edges, headings_rad, offsets
from surefoot.skills.laying import Wish, lay_cells
from surefoot.skills.measures import NONE, SINGLE
from surefoot.skills.obstacles import Excess, excesses, why_obstacle
from surefoot.skills.values import OBSTACLE

MARGIN_M = 0.02
STAIRS = class_set("stairs")


def plate(west: float, south: float, east: float, north: float, height: float, yaw_rad: float = 0.0) -> Polygon:
    """Return a plate with the margin off, turned about the origin."""
    a, b, c, d = west + MARGIN_M, south + MARGIN_M, east - MARGIN_M, north - MARGIN_M
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    return polygon([[cos * x - sin * y, sin * x + cos * y, height] for x, y in ((a, b), (c, b), (c, d), (a, d))])


def flight(tread_m: float, riser_m: float, yaw_rad: float, steps: int = 4) -> tuple[Polygon, ...]:
    """Return stairs that rise along x between two landings of 0.9 m, 1.2 m wide."""
    edges = [0.0, *(0.9 + k * tread_m for k in range(steps)), 0.9 + (steps - 1) * tread_m + 0.9]
    return tuple(plate(edges[k], 0.0, edges[k + 1], 1.2, k * riser_m, yaw_rad) for k in range(steps + 1))


def place(x: float, y: float, yaw_rad: float) -> tuple[float, float]:
    return math.cos(yaw_rad) * x - math.sin(yaw_rad) * y, math.sin(yaw_rad) * x + math.cos(yaw_rad) * y


@settings(max_examples=5, deadline=None)
@given(
    tread_cm=st.integers(26, 38),
    riser_cm=st.integers(6, 19),
    yaw_deg=st.floats(-180, 180),
)
def test_cells_fit_the_treads_of_stairs_and_x_leads_up(tread_cm: int, riser_cm: int, yaw_deg: float) -> None:
    tread_m, riser_m, yaw = tread_cm / 100, riser_cm / 100, math.radians(yaw_deg)
    ground = flight(tread_m, riser_m, yaw)
    start, goal = place(0.4, 0.6, yaw), place(0.9 + 3 * tread_m + 0.5, 0.6, yaw)
    lay, tried = lay_cells(ground, MARGIN_M, Wish((STAIRS,), start_m=start, goal_m=goal))
    terrain = lay.terrain
    assert tried >= 4
    assert lay.arrives
    assert terrain.laid is not None
    assert math.cos(math.radians(terrain.laid.yaw_deg) - yaw) > math.cos(math.radians(6))
    assert terrain.start_m is not None
    assert terrain.goal_m is not None
    assert not barriers(terrain, terrain.cell_at(terrain.start_m), terrain.cell_at(terrain.goal_m))
    back = math.radians(terrain.laid.yaw_deg)
    assert np.allclose(place(*terrain.start_m, back), start, atol=1e-6)


def test_the_same_ground_gives_the_same_cells() -> None:
    ground = flight(0.3, 0.17, 0.2)
    first, second = (lay_cells(ground, MARGIN_M, Wish((STAIRS,), cell_m=0.3))[0].terrain for _ in range(2))
    assert (first.origin_m, first.cell_m, first.laid, first.start_m) == (
        second.origin_m,
        second.cell_m,
        second.laid,
        second.start_m,
    )
    assert first.start_m is not None
    assert first.goal_m is not None
    heights = [first.measured[first.cell_at(end)].height_m for end in (first.start_m, first.goal_m)]
    assert heights[1] > heights[0] + 0.3


@pytest.mark.parametrize(("riser_m", "tread_m", "measure"), [(0.25, 0.3, "rise_m"), (0.15, 0.12, "spread_m")])
def test_stairs_beyond_the_rules_name_cell_measure_and_limit(riser_m: float, tread_m: float, measure: str) -> None:
    ground = flight(tread_m, riser_m, 0.0)
    lay, _ = lay_cells(ground, MARGIN_M, Wish((STAIRS,), start_m=(0.4, 0.6), goal_m=(0.9 + 3 * tread_m + 0.5, 0.6)))
    terrain = lay.terrain
    assert not lay.arrives
    assert terrain.start_m is not None
    assert terrain.goal_m is not None
    found = barriers(terrain, terrain.cell_at(terrain.start_m), terrain.cell_at(terrain.goal_m))
    assert found
    every = [one for barrier in found for one in barrier.why]
    every += [one for cell in terrain.measured for one in why_obstacle(terrain, cell)]
    assert measure in {one.measure for one in every}
    if measure == "rise_m":
        step = found[0]
        assert step.coming_from is not None
        assert step.why[0].value == pytest.approx(riser_m, abs=1e-6)
        assert step.why[0].high == 0.201
        assert "its height above the robot's ground is 0.25 m, allowed is" in step.sentence


def test_a_single_bar_has_no_spacing_in_metres() -> None:
    one, none = Excess("across_m", SINGLE, 0.15, 0.35), Excess("along_m", NONE, 0.15, 0.35)
    assert one.text == "the spacing of its bars across the heading is that of a single one, allowed is 0.15 to 0.35"
    assert none.text == "the spacing of its bars along the heading is without end, allowed is 0.15 to 0.35"
    assert (one.stands_for, none.stands_for, Excess("spacing_m", math.inf, 0.05, 0.2).stands_for) == (
        "single",
        "none",
        "none",
    )
    assert Excess("slope_deg", SINGLE, 0.0, 10.0).stands_for == ""


def test_a_closed_move_is_a_barrier_like_an_obstacle() -> None:
    lay, _ = lay_cells(flight(0.3, 0.15, 0.0), MARGIN_M, Wish((STAIRS,), cell_m=0.3))
    cells = sorted(lay.part)
    here, there = next((a, b) for a in cells for b in cells if abs(a[0] - b[0]) + abs(a[1] - b[1]) == 1)
    assert barriers(lay.terrain, here, there) == ()
    every = barriers(lay.terrain, here, there, lambda _a, b: "refused" if b == there else "")
    assert [one.text for one in every] == ["refused"]
    assert every[0].cell == there


def test_floor_between_stones_is_left_out_but_not_a_tread() -> None:
    stones = [plate(0.25 * k, 0.25 * m, 0.25 * k + 0.2, 0.25 * m + 0.2, 0.12) for k in range(4) for m in range(4)]
    strip = plate(0.195, 0.0, 0.255, 0.95, 0.0)
    assert crevices((*stones, strip), MARGIN_M) == {16}
    assert crevices(flight(0.3, 0.15, 0.3), MARGIN_M) == frozenset()
    pit = plate(0.3, 0.0, 0.7, 0.6, -0.2)
    assert crevices((plate(0, 0, 0.3, 0.6, 0.0), pit, plate(0.7, 0, 1.0, 0.6, 0.0)), MARGIN_M) == frozenset()


def test_edges_give_heading_and_offset() -> None:
    yaw = math.radians(17)
    edges = ground_edges(flight(0.3, 0.15, yaw), MARGIN_M)
    assert math.degrees(headings_rad(edges, 1)[0]) == pytest.approx(17, abs=0.01)
    assert offsets(edges, yaw, 0, 0.3, 1)[0].offset_m == pytest.approx(0.0, abs=0.011)
    whole = ground_edges((plate(0, 0, 0.5, 1, 0), plate(0.46, 0, 1, 1, 0)), MARGIN_M)
    assert len(whole.lengths_m) == 6  # what pieces share is no edge


def test_what_no_class_claims_has_a_reason_and_what_one_claims_has_none() -> None:
    for rules in map(class_set, ("unstructured-8", "unstructured-4", "rebar-7", "rebar-14", "stairs")):
        ends = {name: [end for _, end in levels] for name, levels in rules.levels.items()}
        for combination, label in rules.claims.items():
            value = {}
            for (name, levels), level in zip(rules.levels.items(), combination, strict=True):
                k = [one for one, _ in levels].index(level)
                low = -1.0 if k == 0 and len(levels) > 1 and ends[name][0] <= 0 else (ends[name][k - 1] if k else -0.01)
                value[name] = low
            if rules.levels_of(value) != combination:
                continue
            why = excesses(rules, value)
            assert bool(why) == (label == OBSTACLE)
            changed = {**value, **{one.measure: max(one.low, -0.5) if one.low > -9 else one.high - 0.01 for one in why}}
            assert rules.classify(changed) != OBSTACLE


def test_a_laid_terrain_is_written_and_read(tmp_path: Path) -> None:
    lay, _ = lay_cells(flight(0.3, 0.15, 0.4), MARGIN_M, Wish((STAIRS,), cell_m=0.3))
    write_terrain(tmp_path / "mission.yaml", lay.terrain)
    read = read_terrain(tmp_path / "mission.yaml")
    assert read.laid == lay.terrain.laid
    assert (read.cell_m, read.cells, read.classes.name) == (lay.terrain.cell_m, lay.terrain.cells, "stairs")
    labels = [
        {cell: one.seen_from(one.height_m)["rise_m"] for cell, one in t.measured.items()} for t in (read, lay.terrain)
    ]
    assert labels[0] == labels[1]


def test_places_beside_the_ground_are_refused() -> None:
    with pytest.raises(InputError, match="--goal: lies beside the ground of the scan"):
        lay_cells(flight(0.3, 0.15, 0.0), MARGIN_M, Wish((STAIRS,), start_m=(0.4, 0.6), goal_m=(9.0, 0.6)))

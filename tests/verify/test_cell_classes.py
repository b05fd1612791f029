"""Classes that the checker measures are those that skills are made for, also where ground goes and things appear."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from surefoot.missions.quadruped.world import World
from surefoot.skills import generated, read_terrain, write_terrain
from surefoot.skills.patches import Rectangle
from surefoot.verify.terrain.cell_classes import CellClasses
from surefoot.verify.terrain.class_rules import OBSTACLE, SHIPPED, rules_of
from surefoot.verify.terrain.map import read_map


def compared(world: World, seen: CellClasses, turns: int) -> int:
    """Compare the classes about every cell; return how many were ambiguous."""
    ambiguous = 0
    for cell in world.terrain.measured:
        state = world.state(cell, turns)
        found = seen.labels(cell, turns)
        if state is None:
            assert OBSTACLE in found[1][1]
            continue
        for row, across in enumerate(state.labels):
            for column, label in enumerate(across):
                assert label in found[row][column], (cell, row, column)
                ambiguous += len(found[row][column]) > 1
    return ambiguous


@pytest.mark.parametrize("scene", ["unstructured-4", "unstructured-8", "rebar-7", "rebar-14", "zig-zag"])
def test_both_measure_the_same(tmp_path: Path, scene: str) -> None:
    file = tmp_path / "terrain.yaml"
    write_terrain(file, generated(scene, 5))
    terrain = read_terrain(file)
    world, seen = World(terrain), CellClasses(read_map(file), terrain.grid)
    rng = np.random.default_rng(5)
    assert sum(compared(world, seen, turns) for turns in (0, 1)) < 10
    for appears in (False, True):
        low = rng.uniform(0.5, 3.5, 2)
        high = low + rng.uniform(0.1, 0.9, 2)
        area = (float(low[0]), float(low[1]), float(high[0]), float(high[1]))
        world = world.with_obstacle(Rectangle(*area)) if appears else world.without_ground(Rectangle(*area))
        (seen.stands if appears else seen.gone)(area)
        assert compared(world, seen, 3) < 10


def test_a_measure_at_the_end_of_a_level_may_be_read_both_ways() -> None:
    rules = rules_of(SHIPPED)["unstructured-8"]
    whole = {"coverage": 1.0, "band_m": 0.0, "largest": 1.0, "spacing_m": np.inf, "spread_m": 0.0, "slope_deg": 0.0}
    assert rules.labels({**whole, "rise_m": 0.0}) == {"flat"}
    assert rules.labels({**whole, "rise_m": 0.05}) == {"flat", "high"}
    assert rules.labels({**whole, "rise_m": 0.06}) == {"high"}
    assert rules.labels({**whole, "rise_m": 1.0}) == {OBSTACLE}

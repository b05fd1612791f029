"""The shipped maps are what their script draws."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from world_scenes import SCENES

from surefoot.frames import Cell
from surefoot.world import make_grid, read_occupancy_map


@pytest.mark.parametrize(
    ("name", "cell_size_m", "rows", "columns", "free"), [("two_rooms", 2.70351, 7, 12, 34), ("tutorial", 2.7, 6, 8, 22)]
)
def test_maps_match_their_script(
    tmp_path: Path, name: str, cell_size_m: float, rows: int, columns: int, free: int
) -> None:
    subprocess.run([sys.executable, str(SCENES / "make_maps.py"), str(tmp_path)], check=True)
    for ending in (".pgm", ".yaml"):
        assert (tmp_path / (name + ending)).read_bytes() == (SCENES / (name + ending)).read_bytes()
    occupancy = read_occupancy_map(SCENES / f"{name}.yaml")
    assert occupancy.occupied.shape == (10 * rows, 10 * columns)
    assert not occupancy.unknown.any()
    grid = make_grid(occupancy, cell_size_m=cell_size_m)
    assert (grid.rows, grid.columns, len(grid.free_cells())) == (rows, columns, free)
    assert not grid.is_free(Cell(0, 0))

"""A scene that is small enough for the naive planner."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

PICTURE = [".....", ".#.#.", "....."]
SCENARIO = """
format: 1
kind: biped
map: map.yaml
grid: {cell_size_m: 1.0}
start: {position_m: [0.33, 2.45], heading: east}
goals: [{position_m: [4.5, 0.5]}, {position_m: [0.5, 2.5]}]
OBSTACLES
sensor: {range_m: 2.1}
EXTRA
walking:
  fine_cells: 14
  turn_angle_deg: 45
  straight_cells: [2, 1, 3]
  pre_step_cells: 1
  stop_cells: 1
  turn_a_cells: [1.4142135623730951, 1]
  turn_b_cells: [1.4142135623730951, 2]
  side_band_cells: 3
  sagittal_outcomes_cells: 1
  lateral_outcomes_cells: 1
  safety_distance_m: 0.1
"""
OBSTACLE = "obstacles: [{start_m: [4.5, 2.5]}]"
Planner = Callable[..., Path]

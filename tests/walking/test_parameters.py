from __future__ import annotations

from typing import Any

import pytest
from walks import CELL_M, DEFAULTS, DIGIT

from surefoot.errors import InputError
from surefoot.robots.biped import biped
from surefoot.walking import step_library, walking_parameters
from surefoot.walking.turns import default_lengths, quarter_turn_end


def test_defaults_are_those_of_the_format_page() -> None:
    assert DEFAULTS.fine_cells == 26
    assert DEFAULTS.fine_cell_m == pytest.approx(0.1039812, abs=1e-7)
    assert DEFAULTS.turn_steps == 4
    assert DEFAULTS.turn_a_cells == pytest.approx((3.90024, 2.69279, 3.90024, 3), abs=1e-5)
    assert DEFAULTS.turn_b_cells == pytest.approx((2.69279, 3.50965, 2.69279, 4), abs=1e-5)
    assert DEFAULTS.apex_speed_mps == (0.2, 0.7)
    assert DEFAULTS.cost_steering == (7.0, 4.0, 0.0, 0.0)


def test_none_means_the_default() -> None:
    assert walking_parameters(CELL_M, fine_cells=None, turn_a_cells=None, dy1_m=None) == DEFAULTS


def test_given_values_are_taken() -> None:
    given = walking_parameters(1.0, fine_cells=12, side_band_cells=3, turn_angle_deg=18, straight_cells=[3])
    assert given.fine_cell_m == pytest.approx(1 / 12)
    assert given.turn_steps == 5
    assert given.straight_cells == (3,)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("turn_angle_deg", 20),
        ("turn_angle_deg", float("nan")),
        ("turn_angle_deg", 0),
        ("fine_cells", 26.5),
        ("fine_cells", True),
        ("fine_cells", 1000),
        ("straight_cells", []),
        ("straight_cells", [4, 4]),
        ("straight_cells", 4),
        ("straight_cells", [0]),
        ("side_band_cells", 13),
        ("apex_speed_mps", [0.5, 0.4]),
        ("apex_speed_mps", [0.05, 0.4]),
        ("apex_speed_mps", [0.4]),
        ("cost_straight", [1, 1, 0, -1]),
        ("max_step_height_m", 0.3),
        ("safety_distance_m", "far"),
        ("turn_a_cells", [3.9, 2.7, 3.9]),
        ("turn_b_cells", [2.7, 3.5, 2.7, 5.1]),
        ("wings", 2),
    ],
)
def test_nonsense_is_refused_by_its_key(name: str, value: Any) -> None:
    with pytest.raises(InputError) as caught:
        walking_parameters(CELL_M, **{name: value})
    assert caught.value.key == f"walking.{name}"


def test_turn_that_ends_off_a_cell_centre_is_told_where() -> None:
    with pytest.raises(InputError, match=r"ends 7\.0\d+ fine cells forward and 10\.2\d+ sideways"):
        walking_parameters(CELL_M, turn_a_cells=[3.9, 2.7, 3.9, 3.2])


def test_rounded_turn_is_made_exact() -> None:
    rounded = walking_parameters(CELL_M, turn_a_cells=[3.9002, 2.6928, 3.9002, 3]).turn_a_cells
    assert quarter_turn_end(rounded) == pytest.approx((7, 10), abs=1e-12)
    assert rounded == pytest.approx((3.9002, 2.6928, 3.9002, 3), abs=1e-4)


@pytest.mark.parametrize("turn_type", ["A", "B"])
@pytest.mark.parametrize("steps", range(2, 19))
def test_default_turns_never_drift(steps: int, turn_type: str) -> None:
    lengths = default_lengths(steps, turn_type)
    end = quarter_turn_end(lengths)
    assert end == pytest.approx((round(end[0]), round(end[1])), abs=1e-9)
    assert all(1.5 < length < 5.5 for length in lengths)


def test_booked_displacements_of_both_turns() -> None:
    library = step_library(DEFAULTS, DIGIT)
    assert library.turn_a.booked == ((4, 1), (2, 2), (1, 4), (0, 3))
    assert library.turn_b.booked == ((2, 1), (3, 3), (1, 2), (0, 4))
    longer = step_library(walking_parameters(CELL_M, turn_b_cells=[2.69279, 3.50965, 2.69279, 5]), DIGIT)
    assert longer.turn_b.booked == ((2, 1), (3, 3), (1, 2), (0, 5))


@pytest.mark.parametrize(
    "given",
    [
        {"straight_cells": [4, 9]},
        {"pre_step_cells": 8},
        {"stop_cells": 7},
        {"turn_a_cells": [6.55, 2.0, 6.55, 8]},
    ],
)
def test_length_that_no_speeds_admit_is_refused_with_the_allowed_range(given: dict[str, Any]) -> None:
    (name,) = given
    if name == "turn_a_cells":
        first = (9 - 2.0 * 0.5**0.5) / 1.3065629648763766
        given = {name: [first, 2.0, first, 12]}
    with pytest.raises(InputError, match=r"step of .* m; .* \.\. .* m are allowed") as caught:
        step_library(walking_parameters(CELL_M, **given), DIGIT)
    assert caught.value.key == f"walking.{name}"


def test_turn_angle_that_theorem_iv_2_forbids_is_refused() -> None:
    slow = walking_parameters(CELL_M, turn_angle_deg=45, apex_speed_mps=[0.2, 0.4])
    with pytest.raises(InputError, match="up to 43") as caught:
        step_library(slow, biped("cassie"))
    assert caught.value.key == "walking.turn_angle_deg"

"""Scenario files at the boundary: what is read, what is refused, and how it is said."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from surefoot.errors import InputError
from surefoot.missions.scenario.file import Scenario, read_scenario, scenario_schema

GOOD = """\
format: 1
kind: biped
map: two_rooms.yaml
grid: {cell_size_m: 2.70351, origin_m: [0, 0], rotation_rad: 0, unknown: blocked}
robot: digit
start: {position_m: [1, 2], heading: east}
goals: [{position_m: [3, 4]}, {position_m: [5, 6]}]
obstacles: [{start_m: [1, 1], forbidden: [{rectangle_m: [0, 0, 1, 1]}]}]
sensor: {range_m: 10.82}
belief_regions: [{rectangles_m: [[0, 0, 3, 3]]}]
heights:
  floors: [{rectangles_m: [[0, 0, 3, 3]], height_m: 1.2}]
  stairs: [{rectangle_m: [3, 0, 6, 3], up: east, risers: 12, riser_m: 0.1, tread_m: 0.416, first_riser_m: 0.208}]
walking: {turn_angle_deg: 18, straight_cells: [4, 3], apex_speed_mps: [0.2, 7e-1]}
"""


def write(folder: Path, text: str) -> Path:
    path = folder / "scenario.yaml"
    path.write_text(text)
    return path


def read(folder: Path, text: str = GOOD) -> Scenario:
    return read_scenario(write(folder, text))


def refusal(folder: Path, text: str) -> list[str]:
    """Return the complaints, each without the path that it must start with."""
    path = write(folder, text)
    with pytest.raises(InputError) as caught:
        read_scenario(path)
    lines = str(caught.value).splitlines()
    assert all(line.startswith(f"{path}:") for line in lines)
    return [line.removeprefix(f"{path}:") for line in lines]


def changed(old: str, new: str) -> str:
    assert old in GOOD
    return GOOD.replace(old, new)


def test_reads_every_key(tmp_path: Path) -> None:
    scenario = read(tmp_path)
    assert scenario.grid.cell_size_m == 2.70351
    assert scenario.start.heading == "east"
    assert [goal.position_m for goal in scenario.goals] == [(3.0, 4.0), (5.0, 6.0)]
    assert scenario.obstacles[0].forbidden[0].rectangle_m == (0.0, 0.0, 1.0, 1.0)
    assert scenario.heights.stairs[0].risers == 12
    assert scenario.walking.given() == {
        "turn_angle_deg": 18,
        "straight_cells": (4, 3),
        "apex_speed_mps": (0.2, 0.7),
    }
    assert scenario.map_path == tmp_path / "two_rooms.yaml"


def test_defaults(tmp_path: Path) -> None:
    text = """{format: 1, kind: biped, map: m.yaml, grid: {cell_size_m: 1}, start: {position_m: [0, 0], heading: west},
              goals: [{position_m: [0, 0]}], sensor: {range_m: 4}, walking: , heights: }"""
    scenario = read(tmp_path, text)
    assert (scenario.grid.origin_m, scenario.grid.rotation_rad, scenario.grid.unknown) == ((0, 0), 0, "blocked")
    assert scenario.robot == "digit"
    assert not scenario.obstacles
    assert not scenario.belief_regions
    assert (scenario.navigation.view, scenario.navigation.corners, scenario.navigation.belief) == (
        "post",
        "visible",
        None,
    )
    assert scenario.walking.given() == {}


def test_belief_defaults_to_regions_when_there_are_some(tmp_path: Path) -> None:
    assert read(tmp_path).belief_regions
    assert read(tmp_path, GOOD + "navigation: {belief: exact}").navigation.belief == "exact"


def test_obstacles_have_a_speed_and_navigation_a_tracking(tmp_path: Path) -> None:
    assert read(tmp_path).obstacles[0].speed_cells == 1
    fast = read(tmp_path, changed("start_m: [1, 1],", "start_m: [1, 1], speed_cells: 3,"))
    assert fast.obstacles[0].speed_cells == 3
    assert fast.navigation.belief_tracking == "joint"
    chosen = read(tmp_path, GOOD + "navigation: {belief: automatic, belief_precision: 0.5, belief_tracking: separate}")
    assert (chosen.navigation.belief, chosen.navigation.belief_precision) == ("automatic", 0.5)
    assert chosen.navigation.belief_tracking == "separate"


def test_is_frozen_and_hashable(tmp_path: Path) -> None:
    scenario = read(tmp_path)
    with pytest.raises(ValueError, match="frozen"):
        scenario.grid.cell_size_m = 1.0
    assert hash(scenario.grid) == hash(read(tmp_path).grid)


def test_all_problems_at_once_with_lines_and_keys(tmp_path: Path) -> None:
    text = GOOD.replace("cell_size_m", "cell_sise_m").replace("heading: east", "heading: up")
    text = text.replace("range_m: 10.82", "range_m: -1").replace("risers: 12", "risers: 1.5") + "speed: 3\n"
    said = refusal(tmp_path, text)
    assert said[0] == "4: grid.cell_size_m: is required (side of a coarse cell)"
    assert said[1].startswith("4: grid.cell_sise_m: is not a known key (did you mean cell_size_m?); allowed are cell_")
    assert said[2] == "6: start.heading: needs 'north', 'east', 'south' or 'west', not 'up'"
    assert said[3] == "9: sensor.range_m: needs a number greater than 0, not -1"
    assert said[4] == "13: heights.stairs[0].risers: needs a whole number, not 1.5"
    assert said[5].startswith("15: speed: is not a known key; allowed are format, kind, map")
    assert len(said) == 6


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("origin_m: [0, 0]", "origin_m: [0, .nan]", "4: grid.origin_m[1]: needs a finite number, not nan"),
        ("origin_m: [0, 0]", "origin_m: [0, -.inf]", "4: grid.origin_m[1]: needs a finite number, not -inf"),
        ("origin_m: [0, 0]", "origin_m: [0, 1e999]", "4: grid.origin_m[1]: needs a finite number, not inf"),
        ("origin_m: [0, 0]", "origin_m: [0, 0, 0]", "4: grid.origin_m: needs a list of exactly 2 numbers"),
        ("origin_m: [0, 0]", "origin_m: [0]", "4: grid.origin_m: needs exactly 2 numbers"),
        ("origin_m: [0, 0]", "origin_m: 0", "4: grid.origin_m: needs a list of exactly 2 numbers"),
        ("cell_size_m: 2.70351", "cell_size_m: '2.7'", "4: grid.cell_size_m: needs a number, not '2.7'"),
        ("cell_size_m: 2.70351", "cell_size_m: yes", "4: grid.cell_size_m: needs a number, not 'yes'"),
        ("cell_size_m: 2.70351", "cell_size_m: true", "4: grid.cell_size_m: needs a number, not true"),
        ("format: 1", "format: 2", "1: format: needs 1, not 2"),
        ("kind: biped", "kind: quadruped", "2: kind: needs 'biped', not 'quadruped'"),
        (
            "kind: biped",
            "kind: biped\nkind: biped",
            "3: kind: is given a second time (first in line 2); once is allowed",
        ),
        ("kind: biped", "kind: !!python/name:os.system biped", "2: kind: has the tag tag:yaml.org,2002:python"),
        ("map: two_rooms.yaml", "map: a.png", "1: map_resolution_m: is required (metres per pixel)"),
        ("map: two_rooms.yaml", "map: a.yaml\nmap_resolution_m: 1", "4: map_resolution_m: is only for a picture"),
        ("goals: [{position_m: [3, 4]}, {position_m: [5, 6]}]", "goals: []", "7: goals: needs at least 1 item, not 0"),
        ("sensor: {range_m: 10.82}", "sensor: 10.82", "9: sensor: needs a mapping with keys among range_m, not 10.82"),
        ("[0, 0, 1, 1]", "[0, 0, 0, 1]", "8: obstacles[0].forbidden[0].rectangle_m: has no area"),
        (
            "start_m: [1, 1],",
            "start_m: [1, 1], speed_cells: 4,",
            "8: obstacles[0].speed_cells: needs a number not above 3",
        ),
        ("walking:", "navigation: {belief_tracking: both}\nwalking:", "14: navigation.belief_tracking: needs 'joint'"),
        ("walking:", "navigation: {belief_precision: 1}\nwalking:", "14: navigation.belief_precision: is only for"),
        ("turn_angle_deg: 18", "turn_angle_deg: 20", "14: walking.turn_angle_deg: must divide 90"),
        ("turn_angle_deg: 18", "turn_a_cells: [4, 3]", "14: walking.turn_a_cells: needs 4 lengths"),
        ("[0.2, 7e-1]", "[0.7, 0.2]", "14: walking.apex_speed_mps: needs [least, most] with least below most"),
    ],
)
def test_one_problem_one_sentence(tmp_path: Path, old: str, new: str, complaint: str) -> None:
    said = refusal(tmp_path, changed(old, new))
    assert any(line.startswith(complaint) for line in said), said


def test_overlapping_regions_are_refused_and_adjacent_ones_are_not(tmp_path: Path) -> None:
    regions = "belief_regions: [{rectangles_m: [[0, 0, 3, 3]]}]"
    overlap = "belief_regions:\n- {rectangles_m: [[0, 0, 3, 3]]}\n- {rectangles_m: [[6, 6, 9, 9], [1, 1, 2, 2]]}"
    (said,) = refusal(tmp_path, changed(regions, overlap))
    assert said.startswith("12: belief_regions[1]: overlaps belief_regions[0]")
    side = "belief_regions: [{rectangles_m: [[0, 0, 2.70351, 3]]}, {rectangles_m: [[2.70351, 0, 6, 3]]}]"
    assert len(read(tmp_path, changed(regions, side)).belief_regions) == 2


@given(angle=st.floats(-3, 3), x=st.floats(-5, 5), y=st.floats(-5, 5))
def test_overlap_is_judged_in_the_turned_grid(angle: float, x: float, y: float) -> None:
    def turned(gx: float, gy: float) -> tuple[float, float]:
        c, s = math.cos(angle), math.sin(angle)
        return x + c * gx - s * gy, y + s * gx + c * gy

    base = yaml.safe_load(GOOD.split("obstacles")[0])
    grid = {"cell_size_m": 1.0, "origin_m": (x, y), "rotation_rad": angle}
    west, east = (*turned(0, 0), *turned(2, 2)), (*turned(2, 0), *turned(4, 2))
    common = {
        **base,
        "start": {"position_m": (0.0, 0.0), "heading": "east"},
        "goals": ({"position_m": (0.0, 0.0)},),
        "sensor": {"range_m": 1.0},
        "grid": grid,
    }
    regions = tuple({"rectangles_m": (rectangle,)} for rectangle in (west, east))
    assert Scenario.model_validate({**common, "belief_regions": regions}).belief_regions
    wide = {"rectangles_m": ((*turned(1.4, 0), *turned(4, 2)),)}
    with pytest.raises(ValueError, match="overlaps"):
        Scenario.model_validate({**common, "belief_regions": (regions[0], wide)})


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("", "is empty"),
        ("# nothing\n", "is empty"),
        ("[1, 2]", "must be a mapping"),
        ("biped", "must be a mapping"),
        ("a: [1, 2", "is not YAML"),
        ("a: b: c", "is not YAML"),
        ("a: 1\n---\nb: 2\n", "is not YAML"),
        ("a: *b", "is not YAML"),
        ("a: \x01", "is not YAML"),
        ("[" * 5000, "is nested deeper than"),
        ("a: &a [*a]", "is nested deeper than"),
        ("a: " + "x" * 1_000_001, "is larger than"),
    ],
)
def test_what_is_no_mapping_of_keys(tmp_path: Path, text: str, complaint: str) -> None:
    path = write(tmp_path, text)
    with pytest.raises(InputError, match=complaint) as caught:
        read_scenario(path)
    assert str(caught.value).startswith(str(path))


def test_alias_bomb_is_refused_quickly(tmp_path: Path) -> None:
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 10)}]" for k in range(1, 12)]
    with pytest.raises(InputError, match="more than the 100000 values"):
        read(tmp_path, "\n".join(lines))


def test_honest_aliases_are_read(tmp_path: Path) -> None:
    text = changed("goals: [{position_m: [3, 4]}, {position_m: [5, 6]}]", "goals: [&g {position_m: [3, 4]}, *g]")
    assert read(tmp_path, text).goals[1].position_m == (3, 4)


def test_missing_files_folders_and_other_encodings(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist"):
        read_scenario(tmp_path / "none.yaml")
    with pytest.raises(InputError, match="is not a file"):
        read_scenario(tmp_path)
    path = tmp_path / "latin.yaml"
    path.write_bytes("a: 1\nb: Größe\n".encode("latin-1"))
    with pytest.raises(InputError, match=r"latin.yaml:2: is not UTF-8"):
        read_scenario(path)


def test_place_says_where_the_nearest_known_key_stands(tmp_path: Path) -> None:
    scenario = read(tmp_path)
    assert scenario.place("goals", 1, "position_m") == {
        "source": tmp_path / "scenario.yaml",
        "line": 7,
        "key": "goals[1].position_m",
    }
    assert scenario.place("walking", "dy1_m")["line"] == 14
    assert scenario.place("navigation")["line"] == 1


def test_schema_is_json_and_knows_every_key() -> None:
    schema = json.loads(json.dumps(scenario_schema()))
    assert schema["additionalProperties"] is False
    assert set(schema["required"]) == {"format", "kind", "map", "grid", "start", "goals", "sensor"}
    assert set(schema["properties"]) == set(Scenario.model_fields)


leaves = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5)
anything = st.recursive(
    leaves, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3)
)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(key=st.sampled_from(sorted(Scenario.model_fields)), value=anything)
def test_any_value_of_any_key_is_read_or_refused_in_sentences(tmp_path: Path, key: str, value: object) -> None:
    data = {**yaml.safe_load(GOOD), key: value}
    path = write(tmp_path, yaml.safe_dump(data))
    said = None
    try:
        read_scenario(path)
    except InputError as problem:
        said = str(problem)
    assert said is None or str(path) in said


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.binary(max_size=200))
def test_any_bytes_are_refused_in_sentences(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "bytes.yaml"
    path.write_bytes(data)
    with pytest.raises(InputError):
        read_scenario(path)

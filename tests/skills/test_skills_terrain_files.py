from __future__ import annotations

import json
from pathlib import Path

import pytest

from surefoot.errors import InputError
from surefoot.skills.classes import SHIPPED
from surefoot.skills.grid import LocalGrid, terrain_set
from surefoot.skills.terrain_file import overlaps, read_terrain, terrain_schema, write_terrain
from surefoot.skills.terrains import SCENES, generated
from surefoot.skills.values import OBSTACLE

TERRAIN = """\
format: 1
kind: quadruped-terrain
classes: unstructured-8
cells: [3, 3]
origin_m: [0, 0]
start_m: [0.4, 1.2]
polygons:
  - {vertices_m: [[0, 0, 0], [1.6, 0, 0], [1.6, 2.4, 0], [0, 2.4, 0]]}
  - {vertices_m: [[1.6, 0, 0.1], [2.4, 0, 0.1], [2.4, 2.4, 0.1], [1.6, 2.4, 0.1]], friction: 0.5}
"""


def written(folder: Path, text: str = TERRAIN) -> Path:
    path = folder / "terrain.yaml"
    path.write_text(text)
    return path


@pytest.mark.parametrize("scene", SCENES)
def test_a_scene_is_the_same_again_after_writing(scene: str, tmp_path: Path) -> None:
    made = generated(scene, 2)
    first, second = tmp_path / "first.yaml", tmp_path / "second.yaml"
    write_terrain(first, made)
    read = read_terrain(first)
    assert terrain_set(read).states == terrain_set(made).states
    write_terrain(second, generated(scene, 2))
    assert first.read_text() == second.read_text()
    write_terrain(second, generated(scene, 3))
    assert first.read_text() != second.read_text()


@pytest.mark.parametrize(
    ("scene", "least"),
    [("unstructured-4", 40), ("unstructured-8", 60), ("rebar-7", 25), ("rebar-14", 45), ("zig-zag", 15)],
)
def test_seeds_make_maps_of_about_the_papers_size(scene: str, least: int) -> None:
    for seed in range(4):
        terrain = generated(scene, seed)
        states = terrain_set(terrain).states
        assert least <= len(states) <= 90
        assert all(state.label(state.centre) != OBSTACLE for state in states)
        assert not overlaps(terrain.polygons)
        for place in (terrain.start_m, terrain.goal_m):
            assert place is not None
            assert LocalGrid(terrain, place).standing


@pytest.mark.parametrize("scene", ["unstructured-4", "unstructured-8", "rebar-7"])
def test_seeds_meet_every_class(scene: str) -> None:
    met: set[str] = set()
    for seed in range(6):
        terrain = generated(scene, seed)
        met |= {label for state in terrain_set(terrain).states for row in state.labels for label in row}
    assert met == {*terrain.classes.names, OBSTACLE}


def test_the_zig_zag_leads_from_start_to_goal() -> None:
    for seed in range(5):
        terrain = generated("zig-zag", seed)
        assert terrain.start_m is not None
        assert terrain.goal_m is not None
        solid = {cell for cell, measured in terrain.measured.items() if measured.values["coverage"] > 0.1}
        reached, fresh = set(), {terrain.cell_at(terrain.start_m)}
        while fresh:
            reached |= fresh
            near = {(r + dr, c + dc) for r, c in fresh for dr, dc in ((1, 0), (-1, 0), (0, 1), (0, -1))}
            fresh = (near & solid) - reached
        assert terrain.cell_at(terrain.goal_m) in reached
        assert reached == solid


def test_reads_what_people_write(tmp_path: Path) -> None:
    terrain = read_terrain(written(tmp_path))
    assert (terrain.robot, terrain.cell_m, terrain.grid, terrain.margin_m) == ("go2", 0.8, (3, 3), 0.02)
    assert terrain.polygons[1].friction == 0.5
    assert {state.labels[1][1] for state in terrain_set(terrain).states} == {"flat"}
    assert terrain_schema()["properties"]["cells"]


def test_map_and_origin_follow_from_the_polygons(tmp_path: Path) -> None:
    text = TERRAIN.replace("cells: [3, 3]\norigin_m: [0, 0]\n", "")
    terrain = read_terrain(written(tmp_path, text))
    assert (terrain.origin_m, terrain.cells) == ((0.0, 0.0), (3, 3))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "[[1.6, 0, 0.1], [2.4, 0, 0.1]",
            "[[1.5, 0, 0.1], [2.4, 0, 0.1]",
            r"polygons 0 and 1 overlap at heights 10.0 cm apart",
        ),
        ("start_m: [0.4, 1.2]", "start_m: [9, 1.2]", "lies outside of the map; allowed are x from 0 to 2.4"),
        (
            "[[0, 0, 0], [1.6, 0, 0], [1.6, 2.4, 0], [0, 2.4, 0]]",
            "[[1.2, 0, 0], [1.6, 0, 0], [1.6, 2.4, 0], [1.2, 2.4, 0]]",
            "own cell, about .* is an obstacle",
        ),
        (
            "cells: [3, 3]",
            "cells: [3, 3]\nrequests: [[0, 3]]",
            r"requests\[0\]: \[0, 3\] lies outside of the grid; allowed are rows 0 to 2",
        ),
        ("cells: [3, 3]", "cells: [3, 3]\ngrid: [4, 3]", "needs two odd numbers"),
        ("classes: unstructured-8", "classes: moon", "there is no set of classes 'moon'"),
        ("classes: unstructured-8", "classes: moon.yaml", "moon.yaml: does not exist"),
        ("classes: unstructured-8", "classes: unstructured-8\nrobot: spot", "there is no robot 'spot'"),
        ("[2.4, 2.4, 0.1], [1.6, 2.4, 0.1]]", "[1.9, 0.1, 0.1], [1.6, 2.4, 0.1]]", "not convex"),
        ("polygons:", "polygon:", "did you mean|polygons"),
        ("format: 1", "format: 2", "format"),
    ],
)
def test_bad_terrains_are_refused_in_a_sentence(tmp_path: Path, old: str, new: str, said: str) -> None:
    assert old in TERRAIN
    path = written(tmp_path, TERRAIN.replace(old, new, 1))
    with pytest.raises(InputError, match=said):
        read_terrain(path)


def test_bars_may_cross_a_little_above_each_other(tmp_path: Path) -> None:
    text = (
        TERRAIN.replace("0.1]", "0.02]")
        .replace("[[1.6, 0, 0.02]", "[[1.5, 0, 0.02]")
        .replace("[1.6, 2.4, 0.02]", "[1.5, 2.4, 0.02]")
    )
    assert len(read_terrain(written(tmp_path, text)).polygons) == 2


def test_rules_of_the_user(tmp_path: Path) -> None:
    text = SHIPPED.read_text()
    head, rest = text.split("  unstructured-8:\n")
    (tmp_path / "mine.yaml").write_text(head + "  mine:\n" + rest.split("  unstructured-4:")[0])
    path = written(tmp_path, TERRAIN.replace("unstructured-8", "mine.yaml"))
    terrain = read_terrain(path)
    assert terrain.classes.name == "mine"
    write_terrain(tmp_path / "again.yaml", terrain)
    assert read_terrain(tmp_path / "again.yaml").classes.digest == terrain.classes.digest
    (tmp_path / "mine.yaml").write_text(text)
    with pytest.raises(InputError, match="holds 5 sets"):
        read_terrain(path)


def segmented(folder: Path, **changes: object) -> Path:
    square = [[0, 0, 0.2], [2.4, 0, 0.2], [2.4, 2.4, 0.2], [0, 2.4, 0.2]]
    document = {
        "kind": "terrain", "format": 1, "options": {"margin_m": 0.03},
        "polygons": [{"vertices_m": square, "friction": 0.6}], **changes,
    }  # fmt: skip
    path = folder / "scan.json"
    path.write_text(json.dumps(document))
    return path


def test_a_segmented_terrain_is_read_as_it_is(tmp_path: Path) -> None:
    terrain = read_terrain(segmented(tmp_path), classes="unstructured-4")
    assert (terrain.cells, terrain.margin_m, terrain.classes.name) == ((3, 3), 0.03, "unstructured-4")
    assert len(terrain_set(terrain).states) == 9
    write_terrain(tmp_path / "terrain.yaml", terrain)
    assert terrain_set(read_terrain(tmp_path / "terrain.yaml")).states == terrain_set(terrain).states


def test_a_terrain_may_name_a_segmented_one(tmp_path: Path) -> None:
    segmented(tmp_path)
    text = TERRAIN.split("polygons:")[0] + "polygons: scan.json\n"
    assert len(read_terrain(written(tmp_path, text)).polygons) == 1


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"polygons": []}, "nothing to stand on"),
        ({"polygons": [{"vertices_m": [[0, 0, 0], [1, 0, 0]], "friction": 0.6}]}, "at least three"),
        ({"polygons": [{"vertices_m": [[0, 0], [1, 0]], "friction": 0.6}]}, "three numbers"),
        ({"polygons": [{"vertices_m": "all", "friction": 0.6}]}, "needs vertices_m"),
        ({"format": 3}, "format 1"),
        ({"options": {"margin_m": -1}}, "margin_m"),
    ],
)
def test_bad_segmented_terrains_are_refused(tmp_path: Path, changes: dict[str, object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        read_terrain(segmented(tmp_path, **changes))


@pytest.mark.parametrize(
    ("polygons", "said"),
    [
        ("[{vertices_m: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], friction: 20}]", "polygons[0].friction: needs a number not"),
        ("[{vertices_m: [[0, 0, 0], [1, 0, 0], [0, .inf, 0]]}]", "polygons[0].vertices_m[2][1]: needs a finite number"),
    ],
)
def test_a_place_with_two_choices_is_complained_about_in_the_words_of_the_file(
    tmp_path: Path, polygons: str, said: str
) -> None:
    with pytest.raises(InputError) as refused:
        read_terrain(written(tmp_path, TERRAIN.split("polygons:")[0] + f"polygons: {polygons}\n"))
    assert said in str(refused.value)
    assert len(str(refused.value).splitlines()) == 1

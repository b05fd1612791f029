"""Libraries with headings: terrain, physics of turns, synthesis, what is shown, what the checker refuses."""

from __future__ import annotations

import json
import math
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calling import printed
from surefoot.errors import InputError
from surefoot.skills import LocalGrid, generated, read_library, read_terrain, terrain_set, write_terrain
from surefoot.skills.classes import class_set
from surefoot.skills.headings import turn_primitives, turning_of
from surefoot.skills.library import LIBRARY
from surefoot.skills.next_skill import steps
from surefoot.skills.physics import Limits, PhysicsOfClasses, crossing_problem
from surefoot.skills.values import OBSTACLE, Direction, Physics, Primitive, TerrainState, Turn
from surefoot.verify import verify_path

CORNER = """format: 1
kind: quadruped-terrain
name: corner
classes: unstructured-4
origin_m: [0, 0]
cells: [2, 2]
{yaw}
polygons:
  - vertices_m: [[0, 0, 0], [1.6, 0, 0], [1.6, 0.8, 0], [0, 0.8, 0]]
  - vertices_m: [[0, 0.8, 0], [0.8, 0.8, 0], [0.8, 1.6, 0], [0, 1.6, 0]]
"""
YAW = "yaw: true\ndirections: [forward]"
Document = dict[str, Any]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a terrain of three flat cells around a hole, and its library: forward and turns only."""
    folder = tmp_path_factory.mktemp("turning")
    (folder / "terrain.yaml").write_text(CORNER.format(yaw=YAW))
    printed("skills", "synthesize", folder / "terrain.yaml", "-o", folder / "library", "--jobs", 1, "--json")
    return folder


def turned(state: TerrainState, name: Callable[[str], str]) -> TerrainState:
    """Return a grid as a robot sees it after a turn to the left: its front row was the left column."""
    rows, columns = state.rows, state.columns
    labels = tuple(tuple(name(state.labels[r][c]) for r in reversed(range(rows))) for c in range(columns))
    return TerrainState(labels)


@pytest.mark.parametrize("scene", ["rebar-14", "rebar-7", "unstructured-8", "zig-zag"])
def test_a_grid_seen_after_a_turn_is_the_turned_grid(scene: str) -> None:
    """What the map is measured as with a heading, and what labels become by their names, are the same."""
    terrain = generated(scene, 3)
    frame = turning_of(terrain.classes)
    places = [terrain.centre_m((row, column)) for row in range(terrain.cells[0]) for column in (1, 3)]
    standing = [place for place in places if LocalGrid(terrain, place).standing]
    assert standing
    for place in standing:
        seen = LocalGrid(terrain, place).state
        for heading in (1, 2, 3):
            seen = turned(seen, lambda label: frame.seen(label, 1))
            assert LocalGrid(terrain, place, heading).state == seen


def test_a_turning_robot_meets_every_state_from_four_sides(tmp_path: Path) -> None:
    terrain = generated("zig-zag", 0)
    once = terrain_set(terrain)
    states = terrain_set(replace(terrain, yaw=True, directions=(Direction.FORWARD,)))
    assert once.turning is None
    assert states.turning is not None
    assert states.turning.directions == (Direction.FORWARD,)
    every, frame = set(states.states), states.turning
    assert set(once.states) < every
    assert {turned(state, lambda label: frame.seen(label, 1)) for state in every} == every
    write_terrain(tmp_path / "t.yaml", replace(terrain, yaw=True, directions=(Direction.FORWARD,)))
    read = read_terrain(tmp_path / "t.yaml")
    assert (read.yaw, read.directions) == (True, (Direction.FORWARD,))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("directions: [forward]", "give `yaw: true` too"),
        ("yaw: true\ndirections: [forward, forward]", "choice of different directions"),
        ("yaw: true\ndirections: [north]", "directions"),
        ("yaw: perhaps", "yaw"),
    ],
)
def test_terrain_files_with_wrong_headings_are_refused(tmp_path: Path, given: str, message: str) -> None:
    path = tmp_path / "terrain.yaml"
    path.write_text(CORNER.format(yaw=given))
    with pytest.raises(InputError, match=message):
        read_terrain(path)


def test_sideways_is_a_choice_of_those_who_turn(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="give --yaw too"):
        printed("skills", "terrain", "zig-zag", "--no-sideways")
    path = tmp_path / "zig-zag.yaml"
    found = json.loads(printed("skills", "terrain", "zig-zag", "--yaw", "--no-sideways", "-o", path, "--json"))
    assert found["directions"] == ["forward", "backward"]
    assert read_terrain(path).yaw


def test_a_turn_is_certified_on_its_class_alone() -> None:
    """Its problem has one cell of ground, a goal above the start, and a quarter turn between them."""
    rules = class_set("rebar-14")
    physics = PhysicsOfClasses(rules, limits=Limits(gaits=("trot-2s", "trot-3s")), workers=1)
    left = Primitive.parse("turn-left sparse-dense->dense-sparse")
    problem = crossing_problem(physics.crossing(left), physics.limits)
    assert not isinstance(problem, str)
    corners = np.concatenate([one.vertices_m for one in problem.polygons])
    assert np.abs(corners[:, :2]).max() <= rules.cell_m / 2 + 1e-9
    assert np.linalg.norm(problem.goal_m[:2] - problem.start_m[:2]) < 0.05
    assert problem.goal_rpy_rad.tolist() == [0.0, 0.0, math.pi / 2]
    (result,) = physics([left])
    assert result.verdict is Physics.FEASIBLE
    assert left in turn_primitives(rules)
    with pytest.raises(InputError, match="sparse-dense is seen as dense-sparse after a quarter turn"):
        physics.crossing(Primitive(Turn.LEFT, "sparse-dense", "sparse-dense"))


def test_the_corner_is_turned_around(made: Path) -> None:
    library = read_library(made / "library")
    answer = library.answer
    assert answer["pairs"] == answer["realizable"] > 0
    assert answer["checks_feasible"] == answer["start_skills"] == 3
    assert answer["exhaustive"] == 1 * 4**2 + 2 * 4 - 3
    assert library.turning is not None
    assert library.turning.directions == (Direction.FORWARD,)
    walks = [[step.primitive.direction for step in steps(library.turning, pair)] for pair in library.pairs.values()]
    assert [Direction.FORWARD, Turn.LEFT, Direction.FORWARD] in walks
    assert [Turn.LEFT, Turn.LEFT, Direction.FORWARD, Turn.RIGHT, Direction.FORWARD] in walks
    report = verify_path(made / "library")
    assert report.accepted, report.findings
    assert report.counts["skills"] == 3


def test_what_is_shown_can_be_read(made: Path, tmp_path: Path) -> None:
    whole = printed("skills", "show", made / "library")
    assert "flat    LR" in whole
    assert "with headings; walks: forward" in whole
    library = read_library(made / "library")
    pair = next(one for one in library.pairs.values() if len(steps(library.turning, one)) == 3)  # type: ignore[arg-type]
    number, request = library.states.index(pair.state), f"{pair.request[0]},{pair.request[1]}"
    spec = tmp_path / "pair.structuredslugs"
    shown = printed("skills", "show", made / "library", "--state", number, "--request", request, "--spec", spec)
    assert "way: forward, turn-" in shown
    assert "facing ahead  facing left   facing back   facing right" in shown
    assert json.loads(printed("synth", spec, "--json"))["verdict"] == "realizable"
    empty = [k for k, state in enumerate(library.states) if state not in {one.state for one in library.pairs.values()}]
    assert not empty or "nothing can be asked for" in printed("skills", "show", made / "library", "--state", empty[0])


def test_the_setting_is_part_of_the_terrain(made: Path, tmp_path: Path) -> None:
    other = tmp_path / "terrain.yaml"
    other.write_text(CORNER.format(yaw="yaw: true"))
    with pytest.raises(InputError, match="another version of corner"):
        printed("skills", "synthesize", other, "-o", made / "library")


def row_that(value: Document, way: str | None) -> list[Any]:
    return next(row for pair in value["pairs"] for row in pair["strategy"] if row[3] == way)


def check_of(value: Document, name: str) -> Document:
    return next(check for check in value["checks"] if check["primitive"] == name)


def swap_plans(value: Document, one: str, other: str) -> None:
    first, second = check_of(value, one), check_of(value, other)
    first["plan"], second["plan"] = second["plan"], first["plan"]


def turn_back(value: Document) -> None:
    """Make the pose after some turn to the left turn to the right."""
    rows = value["pairs"][0]["strategy"]
    row, column, heading, _ = next(one for one in rows if one[3] == "turn-left")
    after = next(one for one in rows if one[:3] == [row, column, (heading + 1) % 4])
    after[3] = "turn-right"


BREAKS: dict[str, tuple[Callable[[Document], object], str]] = {
    "a turn that is taken back": (lambda v: turn_back(v), "does not come to"),
    "a robot that only turns": (
        lambda v: [row.__setitem__(3, "turn-left") for row in v["pairs"][0]["strategy"]],
        "does not come to",
    ),
    "a way that it does not walk": (lambda v: row_that(v, "forward").__setitem__(3, "backward"), "not as it may"),
    "a pose left out": (lambda v: v["pairs"][0]["strategy"].pop(0), "skills, strategy"),
    "turns that are swapped": (
        lambda v: swap_plans(v, "turn-left flat->flat", "turn-right flat->flat"),
        "turns by -90 degrees",
    ),
    "a turn that walks": (
        lambda v: swap_plans(v, "turn-left flat->flat", "forward flat->flat"),
        "is no turn-left in place",
    ),
    "a turn onto another class": (
        lambda v: check_of(v, "turn-left flat->flat").update(primitive="turn-left flat->gap"),
        "is no primitive",
    ),
    "a turn without certificate": (lambda v: check_of(v, "turn-left flat->flat").update(plan=None), "has no plan"),
}


def broken(made: Path, tmp_path: Path, edit: Callable[[Document], object]) -> Path:
    shutil.copytree(made / "library", tmp_path / "library")
    value = json.loads((made / "library" / LIBRARY).read_text())
    edit(value)
    (tmp_path / "library" / LIBRARY).write_text(json.dumps(value))
    return tmp_path / "library"


@pytest.mark.parametrize("name", BREAKS)
def test_a_broken_library_is_refused(made: Path, tmp_path: Path, name: str) -> None:
    edit, message = BREAKS[name]
    report = verify_path(broken(made, tmp_path, edit))
    assert not report.accepted
    assert any(message in str(finding) for finding in report.findings), report.findings


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (lambda v: row_that(v, None).__setitem__(2, 4), "heading from 0 to 3"),
        (lambda v: row_that(v, None).pop(2), "heading from 0 to 3"),
        (lambda v: v["headings"]["turned"].update(flat="gap"), "cannot be 'gap' after a quarter turn"),
        (lambda v: v["headings"].update(directions=["north"]), "has to hold some of forward"),
        (lambda v: v.pop("headings"), "one of forward, backward, left, right or null"),
    ],
)
def test_what_is_no_library_with_headings_is_bad_input(
    made: Path, tmp_path: Path, edit: Callable[[Document], object], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        verify_path(broken(made, tmp_path, edit))


def test_bars_have_to_turn_with_the_robot(made: Path, tmp_path: Path) -> None:
    """A library on rebar cannot say that bars look alike from all sides."""
    names = ["sparse-dense", "dense-sparse"]

    def claim(value: Document) -> None:
        value["made_with"]["classes"], value["classes"] = "rebar-14", names
        value["headings"]["turned"] = {name: name for name in names}

    with pytest.raises(InputError, match="cannot be 'sparse-dense' after a quarter turn"):
        verify_path(broken(made, tmp_path, claim))


def test_an_obstacle_is_one_from_every_side() -> None:
    frame = turning_of(class_set("rebar-7"))
    assert [frame.seen(OBSTACLE, heading) for heading in range(4)] == [OBSTACLE] * 4

"""The whole way with real physics on a small map: synthesize, show, verify, and what is refused."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from calling import printed
from surefoot.errors import InputError
from surefoot.skills.journal import CHECKS
from surefoot.skills.library import LIBRARY, read_library

FLAT = """format: 1
kind: quadruped-terrain
name: {name}
classes: unstructured-4
robot: {robot}
origin_m: [0, 0]
cells: [2, 2]
polygons:
  - vertices_m: [[0, 0, 0], [1.6, 0, 0], [1.6, 0.8, 0], [0, 0.8, 0]]
  - vertices_m: [[0, 0.8, 0], [0.8, 0.8, 0], [0.8, 1.6, 0], [0, 1.6, 0]]
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a terrain of three flat cells around a hole, and its library."""
    folder = tmp_path_factory.mktemp("made")
    (folder / "terrain.yaml").write_text(FLAT.format(name="corner", robot="go2"))
    printed("skills", "synthesize", folder / "terrain.yaml", "-o", folder / "library", "--jobs", 2, "--json")
    return folder


def test_a_corner_is_walked_around(made: Path) -> None:
    answer = json.loads((made / "library" / LIBRARY).read_text())["answer"]
    wanted = "terrain_states pairs start_skills realizable repaired unrepairable checks_feasible checks_infeasible"
    assert set(f"{wanted} checks_unknown time_s".split()) <= answer.keys()
    assert answer["terrain_states"] == 3
    assert answer["pairs"] == answer["realizable"]
    assert answer["checks_feasible"] == answer["start_skills"] == 4
    library = read_library(made / "library")
    assert {skill.gait for skill in library.skills.values()} <= {"trot-2s", "trot-3s"}
    report = json.loads(printed("verify", made / "library", "--json"))
    assert report["accepted"]
    assert report["counts"]["skills"] == 4


def test_a_complete_library_asks_physics_nothing_again(made: Path) -> None:
    before = (made / "library" / CHECKS).read_bytes()
    again = json.loads(printed("skills", "synthesize", made / "terrain.yaml", "-o", made / "library", "--json"))
    assert (made / "library" / CHECKS).read_bytes() == before
    assert again["start_skills"] == 4


def changed_robot(folder: Path) -> Path:
    path = folder / "other.yaml"
    path.write_text(FLAT.format(name="corner", robot="chotu"))
    return path


def changed_name(folder: Path) -> Path:
    path = folder / "renamed.yaml"
    path.write_text(FLAT.format(name="another", robot="go2"))
    return path


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (changed_robot, 'made with other rules: robot was "go2" and is now "chotu"'),
        (changed_name, "library of another terrain than another"),
    ],
)
def test_what_does_not_fit_is_refused_and_nothing_is_lost(
    made: Path, change: Callable[[Path], Path], message: str
) -> None:
    before = {path: path.read_bytes() for path in (made / "library").rglob("*") if path.is_file()}
    with pytest.raises(InputError, match=message):
        printed("skills", "synthesize", change(made), "-o", made / "library")
    assert {path: path.read_bytes() for path in (made / "library").rglob("*") if path.is_file()} == before


def test_an_interrupted_library_says_so(made: Path, tmp_path: Path) -> None:
    part = tmp_path / "part"
    part.mkdir()
    (part / CHECKS).write_bytes((made / "library" / CHECKS).read_bytes())
    for command in (["skills", "show"], ["verify"]):
        with pytest.raises(InputError, match="interrupted"):
            printed(*command, part)


def test_a_terrain_file_that_changed_is_noticed(made: Path, tmp_path: Path) -> None:
    import shutil

    copy = tmp_path / "copy"
    shutil.copytree(made, copy)
    (copy / "terrain.yaml").write_text(FLAT.format(name="corner", robot="go2") + "# touched\n")
    with pytest.raises(InputError, match="another version"):
        printed("verify", copy / "library")

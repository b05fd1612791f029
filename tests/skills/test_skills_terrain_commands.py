from __future__ import annotations

from pathlib import Path

import pytest

from calling import run, said
from surefoot.skills.classes import SHIPPED

PNG = b"\x89PNG"


def test_terrain_is_made_drawn_and_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, picture = tmp_path / "terrain.yaml", tmp_path / "terrain.png"
    assert run("skills", "terrain", "rebar-14", "--seed", "4", "-o", str(path), "--plot", str(picture), "--json") == 0
    made = said(capsys)
    assert picture.read_bytes()[:4] == PNG
    assert (made["robot"], made["classes"], made["cells"]) == ("chotu", "rebar-14", [9, 8])
    assert run("skills", "terrain", str(path), "--json") == 0
    read = said(capsys)
    assert {**read, "time_s": 0, "files": []} == {**made, "time_s": 0, "files": []}
    assert run("skills", "terrain", "unstructured-4", "--grid", "5x5", "--json") == 0
    assert said(capsys)["grid"] == [5, 5]


def test_the_schema_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("skills", "schema") == 0
    assert "cell_m" in said(capsys)["properties"]


def test_classes_are_shown_and_drawn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, count in (("unstructured-8", 8), ("rebar-14", 14)):
        picture = tmp_path / f"{name}.png"
        assert run("skills", "classes", name, "--plot", str(picture), "--json") == 0
        assert len(said(capsys)["classes"]) == count
        assert picture.read_bytes()[:4] == PNG
    assert run("skills", "classes", "unstructured-4") == 0
    assert "gap     a band of 22 to 30 cm without ground" in capsys.readouterr().out


def test_physics_answers_draws_and_explains(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture = tmp_path / "physics.png"
    asked = ["skills", "physics", "unstructured-4", "forward gap->flat"]
    assert run(*asked, "--plot", str(picture), "--why", "--json") == 1
    answer = said(capsys)
    assert (answer["checks_feasible"], answer["checks_infeasible"], answer["checks_unknown"]) == (0, 1, 0)
    assert "reach short by" in answer["checks"][0]["explanation"]
    assert picture.read_bytes()[:4] == PNG
    assert run(*asked, "--gait", "leap-1.5s") == 0
    assert "forward gap->flat: feasible (leap-1.5s)" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["terrain", "moon"], "there is no scene 'moon'; there are: unstructured-4"),
        (["terrain", "rebar-7", "--grid", "4x4"], "a local grid has odd sides"),
        (["terrain", "rebar-7", "--grid", "three"], "needs two odd numbers such as 3x3"),
        (["terrain", "missing.yaml"], "missing.yaml: does not exist"),
        (["classes", "moon"], "there is no set of classes 'moon'"),
        (["classes", str(SHIPPED)], "holds 5 sets of classes"),
        (["physics", "rebar-7", "forward"], "'forward' is no primitive"),
        (["physics", "rebar-7", "forward flat->flat"], "there is no class 'flat'; rebar-7 has: sparse-sparse"),
        (["physics", "rebar-7", "--gait", "moonwalk"], "there is no gait 'moonwalk'"),
    ],
)
def test_bad_input_gets_a_sentence(
    arguments: list[str], sentence: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert run("skills", *arguments) == 2
    assert sentence in capsys.readouterr().err


def test_terrain_that_nobody_can_stand_on_is_explained(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "terrain.yaml"
    path.write_text(
        "format: 1\nkind: quadruped-terrain\nclasses: unstructured-8\ncells: [2, 2]\norigin_m: [0, 0]\n"
        "polygons: [{vertices_m: [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]]}]\n"
    )
    assert run("skills", "terrain", str(path)) == 1
    told = capsys.readouterr().out
    assert "4 of 4 cells are obstacles" in told
    assert "the robot can stand in none of them" in told
    assert run("skills", "synthesize", str(path), "-o", str(tmp_path / "library")) == 2
    assert "the robot can stand in none of the 4 cells" in capsys.readouterr().err

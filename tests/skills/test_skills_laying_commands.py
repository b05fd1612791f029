"""From a scan of stairs to a verified run, through the commands; and what they say where that does not work."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from matplotlib.axes import Axes
from PIL import Image

from calling import run, said
from surefoot.compute import sha256_of
from surefoot.world.synthetic_terrain import stairs

PNG = b"\x89PNG"


def segmented(folder: Path, riser_m: float) -> Path:
    """Segment a scan of two steps between landings of 1 m, and return the terrain file."""
    scan = stairs(steps=3, riser_m=riser_m, width_m=0.9, seed=3, yaw_rad=0.2).elevation
    np.savez(folder / "scan.npz", heights=scan.height_m, resolution_m=0.02, origin_m=np.array(scan.origin_m))
    terrain = folder / "terrain.json"
    assert run("terrain", "segment", str(folder / "scan.npz"), "-o", str(terrain), "--json") == 0
    return terrain


def test_scanned_stairs_are_laid_verified_and_climbed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    terrain, mission, picture = segmented(tmp_path, 0.17), tmp_path / "mission.yaml", tmp_path / "mission.png"
    capsys.readouterr()
    arguments = ["--classes", "stairs", "--cell", "0.3", "--plot", str(picture), "--json"]
    assert run("terrain", "lay", str(terrain), "-o", str(mission), *arguments) == 0
    laid = said(capsys)
    assert laid["way"] is True
    assert (laid["classes"], laid["cell_m"], laid["blocked_by"]) == ("stairs", 0.3, [])
    assert laid["yaw_deg"] == pytest.approx(np.degrees(0.2), abs=1.5)
    assert len(laid["obstacles"]) == laid["cells"][0] * laid["cells"][1] - laid["standing"]
    assert picture.read_bytes()[:4] == PNG
    assert run("verify", str(mission), "--json") == 0
    assert said(capsys)["counts"]["polygons"] == laid["polygons"]
    assert run("run", str(mission), "-o", str(tmp_path / "run"), "--json") == 0
    walked = said(capsys)
    assert (walked["reached"], walked["verified"], walked["blocked_by"]) == (True, True, [])
    assert run("verify", str(tmp_path / "run")) == 0
    mission.write_text(mission.read_text().replace('"friction": 0.6', '"friction": 0.7', 1))
    capsys.readouterr()
    assert run("verify", str(mission)) == 1
    assert "is no polygon of the scan" in capsys.readouterr().out
    name_anew(tmp_path / "run", mission)
    assert run("verify", str(tmp_path / "run")) == 1
    assert "is no polygon of the scan" in capsys.readouterr().out
    terrain.write_text(terrain.read_text() + " ")
    assert run("verify", str(mission)) == 2
    assert "does not fit terrain.json" in capsys.readouterr().err
    assert run("verify", str(tmp_path / "run")) == 2
    assert "does not fit terrain.json" in capsys.readouterr().err


def name_anew(folder: Path, mission: Path) -> None:
    """Let the log of a run name the mission as it is now."""
    log = folder / "run.jsonl"
    first, *others = log.read_text().splitlines(keepends=True)
    header = json.loads(first)
    header["terrain"]["sha256"] = sha256_of(mission)
    log.write_text("".join([json.dumps(header) + "\n", *others]))


def _other_margin(document: dict[str, Any]) -> None:
    document["margin_m"] = 0.08


def _highest_forgotten(document: dict[str, Any]) -> None:
    document["polygons"].remove(max(document["polygons"], key=lambda one: one["vertices_m"][0][2]))


def _one_twice(document: dict[str, Any]) -> None:
    document["polygons"].append(document["polygons"][0])


@pytest.mark.parametrize(
    ("tamper", "sentence"),
    [
        (_other_margin, "is not what was taken off the polygons of the scan"),
        (_highest_forgotten, "is left out, and lies in no crevice of higher ground"),
        (_one_twice, "is there twice"),
    ],
)
def test_a_mission_laid_otherwise_than_its_scan_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], tamper: Callable[[dict[str, Any]], None], sentence: str
) -> None:
    terrain, mission = segmented(tmp_path, 0.17), tmp_path / "mission.yaml"
    assert run("terrain", "lay", str(terrain), "-o", str(mission), "--classes", "stairs", "--cell", "0.3") == 0
    assert run("verify", str(mission)) == 0
    document = yaml.safe_load(mission.read_text())
    tamper(document)
    mission.write_text(yaml.safe_dump(document))
    capsys.readouterr()
    assert run("verify", str(mission)) == 1
    assert sentence in capsys.readouterr().out


def test_stairs_too_high_without_start_and_goal_are_not_said_to_be_climbed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    terrain = segmented(tmp_path, 0.25)
    assert run("terrain", "lay", str(terrain), "--classes", "stairs", "--cell", "0.3") == 0
    assert "no way was looked for to the other" in capsys.readouterr().out


def test_steps_too_high_are_told_with_cell_measure_and_limit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    terrain, mission = segmented(tmp_path, 0.25), tmp_path / "mission.yaml"
    capsys.readouterr()
    arguments = ["--start", "0.4,0.5", "--goal", "1.9,0.9", "--cell", "0.3", "--classes", "stairs"]
    assert run("terrain", "lay", str(terrain), "-o", str(mission), *arguments, "--json") == 1
    blocked = said(capsys)["blocked_by"]
    assert blocked
    assert blocked[0]["why"][0]["measure"] == "rise_m"
    assert blocked[0]["why"][0]["value"] == pytest.approx(0.25, abs=0.02)
    assert run("run", str(mission), "-o", str(tmp_path / "run")) == 1
    told = capsys.readouterr().out
    assert "in the way: cell [" in told
    assert "its height above the robot's ground is 0.2" in told


def test_cells_that_fit_nowhere_are_explained_and_drawn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    terrain, picture = segmented(tmp_path, 0.17), tmp_path / "cells.png"
    rules = "format: 1\nkind: quadruped-terrain\nclasses: unstructured-8\npolygons: terrain.json\ncells: [3, 1]\n"
    (tmp_path / "mission.yaml").write_text(rules + "origin_m: [0.7, 0.2]\ncell_m: 0.4\n")
    capsys.readouterr()
    run("skills", "terrain", str(tmp_path / "mission.yaml"), "--plot", str(picture), "--json")
    found = said(capsys)
    assert terrain.exists()
    assert picture.read_bytes()[:4] == PNG
    measures = {one["measure"] for obstacle in found["obstacles"] for one in obstacle["why"]}
    assert "spread_m" in measures
    assert all(obstacle["text"] for obstacle in found["obstacles"])


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["missing.json"], "missing.json: cannot be read"),
        (["t.json", "--classes", "moon"], "there is no set of classes 'moon'"),
        (["t.json", "--start", "here"], "--start: 'here' is no place"),
        (["t.json", "--start", "90,90"], "--start: lies beside the ground"),
        (["t.json", "--yaw", "nan"], "--yaw: needs a finite number of degrees"),
        (["t.json", "--yaw", "inf"], "--yaw: needs a finite number of degrees"),
    ],
)
def test_bad_input_gets_a_sentence(
    arguments: list[str],
    sentence: str,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    document = {"kind": "terrain", "format": 1, "polygons": [{"vertices_m": square, "friction": 0.6}]}
    Path("t.json").write_text(json.dumps(document))
    assert run("terrain", "lay", *arguments) == 2
    assert sentence in capsys.readouterr().err


def test_terrain_that_was_not_laid_is_not_verified(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "terrain.yaml"
    assert run("skills", "terrain", "unstructured-4", "-o", str(path)) == 0
    capsys.readouterr()
    assert run("verify", str(path)) == 2
    assert "was not laid over a scan" in capsys.readouterr().err


def test_a_map_of_one_cell_has_a_way_and_is_walked_at_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    np.savez(tmp_path / "scan.npz", heights=np.zeros((50, 50)), resolution_m=0.02, origin_m=np.zeros(2))
    terrain, mission = tmp_path / "terrain.json", tmp_path / "mission.yaml"
    assert run("terrain", "segment", str(tmp_path / "scan.npz"), "-o", str(terrain)) == 0
    for ends in ([], ["--start", "0.5,0.5", "--goal", "0.55,0.5"]):
        capsys.readouterr()
        assert run("terrain", "lay", str(terrain), "--cell", "0.9", "-o", str(mission), *ends, "--json") == 0
        laid = said(capsys)
        assert (laid["way"], laid["standing"], laid["blocked_by"]) == (True, 1, [])
    assert run("run", str(mission), "-o", str(tmp_path / "run"), "--json") == 0
    assert said(capsys)["reached"] is True


@pytest.mark.parametrize(("cell_m", "inches"), [(1.0, 10.0), (0.25, 16.0)])
def test_cells_too_many_for_words_are_drawn_in_colours(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, cell_m: float, inches: float
) -> None:
    written: list[str] = []
    text = Axes.text

    def noted(axes: Axes, x: float, y: float, words: str, **looks: Any) -> Any:
        written.append(words)
        return text(axes, x, y, words, **looks)

    monkeypatch.setattr(Axes, "text", noted)
    ground = "polygons: [{vertices_m: [[0, 0, 0], [8, 0, 0], [8, 8, 0], [0, 8, 0]]}]"
    mission = tmp_path / "mission.yaml"
    mission.write_text(f"format: 1\nkind: quadruped-terrain\nclasses: unstructured-8\ncell_m: {cell_m}\n{ground}\n")
    run("skills", "terrain", str(mission), "--plot", str(tmp_path / "cells.png"))
    assert ("flat" in written) == (cell_m == 1.0)
    with Image.open(tmp_path / "cells.png") as picture:
        assert picture.width > 100 * inches

"""``surefoot terrain segment``: answers, files, pictures, and bad input."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from surefoot.cli import main
from surefoot.world.synthetic_terrain import stairs

Capture = pytest.CaptureFixture[str]


@pytest.fixture
def picture(tmp_path: Path) -> Path:
    heights = np.nan_to_num(stairs(steps=4, noise_m=0.002).elevation.height_m, nan=-1.0)
    rgba = np.zeros((*heights.shape, 4), np.uint8)
    rgba[..., :3] = np.clip(heights / 1.25 * 255, 0, 255)[..., None]
    rgba[..., 3] = np.where(heights < -0.5, 0, 255)
    path = tmp_path / "stairs.png"
    Image.fromarray(rgba).save(path)
    return path


READ = ["--resolution", "0.02", "--height-range", "0", "1.25"]


def test_help_has_examples(capsys: Capture) -> None:
    assert main(["terrain", "segment", "--help"]) == 0
    shown = capsys.readouterr().out
    assert "Examples:" in shown
    assert "--json" in shown


def test_a_picture_becomes_a_file_that_verifies(picture: Path, tmp_path: Path, capsys: Capture) -> None:
    out, plot = tmp_path / "terrain.json", tmp_path / "terrain.png"
    assert main(["terrain", "segment", str(picture), *READ, "-o", str(out), "--plot", str(plot), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    for key in ("polygons", "area_m2", "kept_share", "max_plane_error_m", "pieces_per_region", "time_s", "warnings"):
        assert key in answer
    assert answer["regions"] == 5
    assert answer["area_m2"] == pytest.approx((2 * 0.96 + 3 * 0.26) * 1.96, rel=0.05)
    assert answer["max_plane_error_m"] <= 0.02
    with Image.open(plot) as image:
        assert float((np.asarray(image.convert("L")) < 250).mean()) > 0.2
    assert main(["verify", str(out)]) == 0
    assert "terrain accepted" in capsys.readouterr().out


def test_nothing_to_stand_on_is_a_no(tmp_path: Path, capsys: Capture) -> None:
    np.save(tmp_path / "wall.npy", np.indices((40, 40))[1] * 0.1)
    assert main(["terrain", "segment", str(tmp_path / "wall.npy"), "--resolution", "0.02", "--json"]) == 1
    answer = json.loads(capsys.readouterr().out)
    assert answer["polygons"] == []
    assert "no ground" in " ".join(answer["warnings"])


@pytest.mark.parametrize(
    ("extra", "complaint"),
    [
        (["--resolution", "0", "--height-range", "0", "1"], "metres per cell"),
        (["--resolution", "0.02", "--height-range", "1", "0"], "lower one first"),
        (["--resolution", "0.02"], "height-range: is required"),
        ([*READ, "--margin", "-1"], "has to lie between"),
        ([*READ, "--topic", "/x"], "only allowed for bags"),
    ],
)
def test_bad_input_is_a_sentence(picture: Path, extra: list[str], complaint: str, capsys: Capture) -> None:
    assert main(["terrain", "segment", str(picture), *extra]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert complaint in said.err.splitlines()[-1]
    assert "Traceback" not in said.err


def test_planar_regions_are_no_scans(tmp_path: Path, capsys: Capture) -> None:
    path = tmp_path / "regions.yaml"
    path.write_text("planarRegions: []\n")
    assert main(["terrain", "segment", str(path), "--resolution", "0.02"]) == 2
    assert "only allowed for scans" in capsys.readouterr().err


def test_a_scan_is_not_replaced_by_its_polygons(tmp_path: Path, capsys: Capture) -> None:
    path = tmp_path / "regions.json"
    path.write_text("{}")
    assert main(["terrain", "segment", str(path), "-o", str(path)]) == 2
    assert "is named twice" in capsys.readouterr().err
    assert path.read_text() == "{}"


def test_a_scan_is_not_replaced_by_its_picture(picture: Path, capsys: Capture) -> None:
    before = picture.read_bytes()
    wish = ["--resolution", "0.02", "--height-range", "0", "1", "--plot", str(picture)]
    assert main(["terrain", "segment", str(picture), *wish]) == 2
    assert "is named twice" in capsys.readouterr().err
    assert picture.read_bytes() == before

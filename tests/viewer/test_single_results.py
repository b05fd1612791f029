"""Pictures of single results: regions, foothold plans, libraries of skills."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from surefoot.cli import main
from surefoot.footholds import read_problem, solve, write_plan
from surefoot.reach import load_region
from surefoot.viewer.steps.omegas import _bounds

Capture = pytest.CaptureFixture[str]


def ink(picture: Path) -> float:
    with Image.open(picture) as image:
        return float((np.asarray(image.convert("L")) < 250).mean())


def test_regions_are_drawn_with_their_omegas(tmp_path: Path, capsys: Capture) -> None:
    step = ["--step-length", "0.416", "--apex-velocity", "0.4", "0.6", "--disturbance", "rate"]
    assert main(["reach", *step, "--save", str(tmp_path / "step")]) == 0
    assert main(["view", str(tmp_path / "step.json"), "-o", str(tmp_path / "pictures")]) == 0
    pictures = sorted((tmp_path / "pictures").iterdir())
    assert [picture.name for picture in pictures] == ["step.png", "step_omegas.png"]
    assert all(ink(picture) > 0.05 for picture in pictures)
    region = load_region(tmp_path / "step.json")
    for half in (region.first, region.second):
        lowest, highest = _bounds(half)
        wins = half.masks.any(axis=2)
        assert np.array_equal(~np.isnan(lowest), wins)
        assert np.all(lowest[wins] <= highest[wins])
        x, v = np.argwhere(wins)[len(np.argwhere(wins)) // 2]
        held = [w for k, w in enumerate(half.omegas_radps) if int(half.masks[x, v, k // 64]) >> (k % 64) & 1]
        assert (lowest[x, v], highest[x, v]) == (min(held), max(held))


def test_a_foothold_plan_is_drawn_beside_it(tmp_path: Path, request: pytest.FixtureRequest) -> None:
    problem = read_problem(request.config.rootpath / "scenes" / "footholds" / "stones.yaml")
    write_plan(tmp_path / "stones.json", problem, solve(problem))
    assert main(["view", str(tmp_path / "stones.json")]) == 0
    assert ink(tmp_path / "stones.png") > 0.02


@pytest.mark.parametrize(
    ("content", "complaint"),
    [
        ('{"kind": "zebra"}', "is no kind that can be drawn; allowed are foothold-plan, step-region,"),
        ("[1, 2]", "holds no JSON object"),
        ("{", "is not whole JSON"),
        ('{"kind": "foothold-plan", "format": 9}', "is no foothold plan of format 1"),
    ],
)
def test_other_files_are_refused(content: str, complaint: str, tmp_path: Path, capsys: Capture) -> None:
    (tmp_path / "x.json").write_text(content)
    assert main(["view", str(tmp_path / "x.json")]) == 2
    said = capsys.readouterr().err
    assert complaint in said
    assert said.count("\n") == 1

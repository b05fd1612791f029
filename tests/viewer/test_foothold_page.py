"""The page of a foothold plan, opened in a browser."""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browsing import Opened, browser

from surefoot.cli import main
from surefoot.footholds import read_problem, solve, write_plan
from surefoot.viewer.robots.simple import quadruped_parts
from surefoot.viewer.sources.foothold_motion import read_motion

SAMPLE = 30
FEET = ("front_left", "front_right", "hind_left", "hind_right")


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Path:
    path = tmp_path_factory.mktemp("footholds") / "plan.json"
    problem = read_problem(request.config.rootpath / "scenes" / "footholds" / "stones.yaml")
    write_plan(path, problem, solve(problem))
    return path


@pytest.fixture(scope="module")
def document(plan: Path) -> dict[str, Any]:
    read: dict[str, Any] = json.loads(plan.read_text())
    return read


@pytest.fixture(scope="module")
def opened(plan: Path) -> Iterator[Opened]:
    page = plan.with_suffix(".html")
    assert main(["view", str(plan), "--html", str(page), "--body", "simple"]) == 0
    with browser() as one:
        one.open(page.as_uri(), "/robot/trunk")
        one.page.keyboard.press("Space")
        yield one


@pytest.mark.xdist_group("browser")
def test_the_scene_shows_a_sample_of_the_plan(opened: Opened, document: dict[str, Any]) -> None:
    motion, step_s = document["motion"], document["values"]["step_s"]
    opened.go_to((SAMPLE + 0.5) * step_s)
    x, y, z = motion["base_m"][SAMPLE]
    place = "window.__viserMutable.nodePoseData['/robot/trunk']?.position"
    opened.wait(f"(p => p && Math.hypot(p[0] - {x}, p[1] - {y}, p[2] - {z}) < 1e-4)({place})")
    for foot, name in enumerate(FEET):
        assert opened.place(f"/robot/{name}/foot") == pytest.approx(motion["feet_m"][SAMPLE][foot], abs=1e-4)
    carrying = [foot for foot in range(4) if motion["forces_n"][SAMPLE][foot][2] > 1e-3]
    assert 0 < len(carrying) < 4
    assert opened.nodes("/forces/") == {f"/forces/{FEET[foot]}" for foot in carrying}
    assert opened.nodes("/cones/") == {f"/cones/{FEET[foot]}" for foot in carrying}
    opened.wait(f"document.querySelector('#surefoot-caption').textContent.startsWith('Sample {SAMPLE}:')")
    assert opened.caption().count(" N") == len(carrying)


@pytest.mark.xdist_group("browser")
def test_every_polygon_and_foothold_is_there(opened: Opened, document: dict[str, Any]) -> None:
    assert len(opened.nodes("/terrain/")) == len(document["values"]["polygons"])
    for foot, name in enumerate(FEET):
        swings = [step for step in document["motion"]["footsteps"] if step["foot"] == foot]
        assert len(opened.nodes(f"/footholds/{name}/")) == 1 + len(swings)
    assert opened.errors == []
    assert all(url.startswith(("file:", "data:", "blob:")) for url in opened.requests)


@pytest.fixture
def run_folder(plan: Path, document: dict[str, Any], tmp_path: Path) -> Path:
    """Return a run of two segments, both with the same plan, the second after a push."""
    sha256 = hashlib.sha256(plan.read_bytes()).hexdigest()
    shutil.copy(plan, tmp_path / "segment.json")
    segment = {
        "record": "segment",
        "primitive": "forward flat->flat",
        "plan": {"path": "segment.json", "sha256": sha256},
    }
    records = [
        {"record": "header", "kind": "quadruped-run", "format": 1, "terrain": {"path": "gone", "sha256": "0" * 64}},
        {**segment, "number": 0, "start_s": 1.0},
        {"record": "event", "event": {"at_segment": 1, "push_m": [-0.6, 0.0]}},
        {**segment, "number": 1, "start_s": 5.0},
    ]
    (tmp_path / "run.jsonl").write_text("".join(json.dumps(record) + "\n" for record in records))
    return tmp_path


def test_a_run_of_a_quadruped_is_its_segments(run_folder: Path, document: dict[str, Any]) -> None:
    motion, samples = read_motion(run_folder), len(document["motion"]["base_m"])
    assert len(motion.time_s) == 2 * samples
    assert (motion.time_s[0], motion.time_s[samples]) == (1.0, 5.0)
    assert motion.feet_m[samples + SAMPLE].tolist() == document["motion"]["feet_m"][SAMPLE]
    assert len(motion.polygons_m) == len(document["values"]["polygons"])
    assert motion.words[0] == "segment 0: forward flat->flat"
    assert motion.words[-1] == "segment 1: forward flat->flat (before it: pushed by 0.60 m)"
    for option, name in (("--html", "run.html"), ("--mcap", "run.mcap")):
        assert main(["view", str(run_folder), option, str(run_folder / name)]) == 0
        assert (run_folder / name).stat().st_size > 10_000


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ('"format": 1', '"format": 2', "run.jsonl:1: kind: is no log of a quadruped's run of format 1"),
        ("segment.json", "other.json", "run.jsonl:2: the plan other.json is missing or was changed"),
        ("segment", "nothing", "holds no segment"),
        ('"push_m"', '"push"', "run.jsonl:3: lacks 'hole_m', or holds another type there"),
    ],
)
def test_bad_runs_of_quadrupeds_are_one_sentence(
    run_folder: Path, old: str, new: str, complaint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    log = run_folder / "run.jsonl"
    log.write_text(log.read_text().replace(old, new))
    assert main(["view", str(run_folder), "--html", str(run_folder / "run.html")]) == 2
    said = capsys.readouterr().err
    assert complaint in said
    assert said.count("\n") == 1


def test_a_plan_without_a_motion_is_refused(
    plan: Path, document: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "none.json").write_text(json.dumps({**document, "motion": None}))
    assert main(["view", str(tmp_path / "none.json"), "--html", str(tmp_path / "p.html")]) == 2
    assert "holds no motion" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("path", "value", "complaint"),
    [
        (("motion", "feet_m"), [[[0.0] * 3] * 4], "feet_m needs finite numbers of shape"),
        (("motion", "base_m"), [], "needs finite numbers"),
        (("motion", "rpy_rad"), [["x"] * 3], "could not convert"),
        (("values", "robot"), {}, "foot_reference_m"),
        (("values", "polygons"), 3, "not iterable"),
    ],
)
def test_a_plan_with_a_broken_motion_is_one_sentence(
    path: tuple[str, str],
    value: Any,
    complaint: str,
    document: dict[str, Any],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    block, key = path
    broken = {**document, block: {**document[block], key: value}}
    (tmp_path / "b.json").write_text(json.dumps(broken))
    assert main(["view", str(tmp_path / "b.json"), "--html", str(tmp_path / "p.html")]) == 2
    said = capsys.readouterr().err
    assert "b.json" in said
    assert complaint in said
    assert said.count("\n") == 1


def test_legs_reach_from_hips_to_feet() -> None:
    rng = np.random.default_rng(1)
    base, rpy = rng.normal(size=(5, 3)), rng.uniform(-0.5, 0.5, (5, 3))
    hips = np.array([(x, y, 0.0) for x in (0.2, -0.2) for y in (0.1, -0.1)])
    feet = base[:, None] + hips + np.array([0.0, 0.0, -0.3])
    parts, link_m = quadruped_parts(base, rpy, feet, hips)
    for leg in range(4):
        ends = [_ends(parts[f"{leg}/{link}"], link_m) for link in ("thigh", "shank")]
        assert np.abs(ends[1][1] - feet[:, leg]).max() < 1e-9
        assert np.abs(ends[0][1] - ends[1][0]).max() < 1e-9
        assert np.allclose(np.linalg.norm(parts["trunk"].wxyz, axis=1), 1.0)


def _ends(part: Any, link_m: float) -> tuple[Any, Any]:
    """Return both ends of a link from its centre and quaternion."""
    w, x, y, z = part.wxyz.T
    along = np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], axis=1)
    return part.position_m - link_m / 2 * along, part.position_m + link_m / 2 * along

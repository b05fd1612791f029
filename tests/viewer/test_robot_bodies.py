"""Bodies of robots on pages: meshes on joints whose feet are those of the log, stand-ins, and what is said of them."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browsing import Opened, browser
from own_robot import write_cassie, write_go2

from surefoot.cli import main
from surefoot.footholds import read_problem, solve, write_plan
from surefoot.viewer.browser.page import server
from surefoot.viewer.robots import mesh_files
from surefoot.viewer.robots.bodies import chosen_body
from surefoot.viewer.robots.cassie import SIDES, link_poses
from surefoot.viewer.robots.files import read_robot
from surefoot.viewer.robots.mesh_files import model_of, package_folder, parts_of
from surefoot.viewer.robots.model import RobotModel
from surefoot.viewer.scenes.run import RunScene
from surefoot.viewer.sources.timeline import read_timeline
from synthetic_run import write_run

SAMPLES = (7, 30, 61)
RODS = (("achilles-rod", "heel-spring", 0.5012, 2e-3), ("plantar-rod", "foot", 0.3501, 6e-3))
"""Their lengths [m], and how far their ends may wander on the link that holds them."""
LINKS = {"FL_foot": 0, "FR_foot": 1, "RL_foot": 2, "RR_foot": 3}
installed = pytest.mark.skipif(
    package_folder() is None, reason="the extra `meshes` is not installed, so none are shown"
)
missing = pytest.mark.skipif(package_folder() is not None, reason="the extra `meshes` is installed")


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Path:
    path = tmp_path_factory.mktemp("bodies") / "plan.json"
    problem = read_problem(request.config.rootpath / "scenes" / "footholds" / "stones.yaml")
    write_plan(path, problem, solve(problem))
    return path


@pytest.fixture
def share(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Put a package of robots with boxes in the place of the installed one."""
    write_go2(tmp_path / "share")
    monkeypatch.setattr(mesh_files, "package_folder", lambda: tmp_path / "share")
    return tmp_path / "share"


@pytest.fixture(scope="module")
def opened(plan: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Opened]:
    """Yield the page of a plan with the robot of boxes; the plan's 20th sample has a foot far out of reach."""
    folder = tmp_path_factory.mktemp("page")
    document = json.loads(plan.read_text())
    document["motion"]["feet_m"][20][1][2] -= 0.5
    (folder / "plan.json").write_text(json.dumps(document))
    write_go2(folder / "share")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(mesh_files, "package_folder", lambda: folder / "share")
        assert main(["view", str(folder / "plan.json"), "--html", str(folder / "plan.html")]) == 0
    with browser() as one:
        one.open((folder / "plan.html").as_uri(), "/robot/trunk")
        one.page.keyboard.press("Space")
        yield one


def world_m(opened: Opened, node: str) -> list[float]:
    """Return where a node is in the world, through all nodes that it hangs on."""
    script = """name => {
        const node = window.__viserMutable.nodeRefFromName[name], root = window.__viserMutable.nodeRefFromName[""];
        root.updateWorldMatrix(true, true);
        const matrix = root.matrixWorld.clone().invert().multiply(node.matrixWorld);
        return matrix.elements.slice(12, 15);
    }"""
    return [float(x) for x in opened.page.evaluate(script, node)]


@pytest.mark.xdist_group("browser")
def test_the_feet_of_the_meshes_are_those_of_the_plan(opened: Opened, plan: Path) -> None:
    document = json.loads(plan.read_text())
    step_s, motion = document["values"]["step_s"], document["motion"]
    for sample in SAMPLES:
        opened.go_to((sample + 0.5) * step_s)
        opened.wait(f"document.querySelector('#surefoot-caption').textContent.startsWith('Sample {sample}:')")
        opened.nodes("/robot/")
        for leg, foot in LINKS.items():
            name = leg.removesuffix("_foot")
            node = f"/robot/trunk/{name}_hip/{name}_thigh/{name}_calf/{leg}"
            assert world_m(opened, node) == pytest.approx(motion["feet_m"][sample][foot], abs=1e-3)
    assert opened.errors == []


@pytest.mark.xdist_group("browser")
def test_a_foot_out_of_reach_is_named_and_counted(opened: Opened, plan: Path) -> None:
    opened.go_to(20.5 * json.loads(plan.read_text())["values"]["step_s"])
    opened.wait("document.querySelector('#surefoot-caption').textContent.includes('out of its leg')")
    assert "front right" in opened.caption().partition("out of its leg's reach: ")[2]
    assert "are out of the legs' reach, by up to" in opened.page.inner_text("#surefoot-notes")


def test_without_a_wish_a_robot_without_meshes_has_the_simple_body(
    share: Path, plan: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    document = json.loads(plan.read_text())
    document["values"]["robot"]["name"] = "mule"
    (tmp_path / "mule.json").write_text(json.dumps(document))
    page, sizes = tmp_path / "p.html", {}
    for wish in ([], ["--body", "simple"], ["--body", "meshes"]):
        assert main(["view", str(tmp_path / "mule.json"), "--html", str(page), *wish, "--json"]) == 0
        sizes[wish[-1] if wish else ""] = (page.stat().st_size, json.loads(capsys.readouterr().out)["remarks"])
    assert sizes[""] == sizes["simple"]
    assert sizes["simple"][1] == []
    assert sizes["meshes"][1][0] == "there are no meshes of mule: those of go2 stand in"


@missing
@pytest.mark.parametrize("biped", [True, False])
def test_without_the_package_it_says_how_to_get_it(
    biped: bool, plan: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write_run(tmp_path, laps=1) if biped else plan
    assert main(["view", str(path), "--html", str(tmp_path / "p.html"), "--body", "meshes"]) == 2
    said = capsys.readouterr().err
    assert "example-robot-data is not installed; install it with: pip install 'surefoot[meshes]'" in said
    assert not (tmp_path / "p.html").exists()


def test_a_body_belongs_to_a_page_of_something_that_walks(
    tutorial_plan: Path, plan: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["view", str(plan), "--body", "simple"]) == 2
    assert "--body belongs to --html" in capsys.readouterr().err
    assert main(["view", str(tutorial_plan), "--html", str(tmp_path / "s.html"), "--body", "simple"]) == 2
    assert "--body belongs to runs and foothold plans" in capsys.readouterr().err


def cassie_feet() -> tuple[Any, Any]:
    """Return soles of feet that stand and swing below a pelvis, and their directions."""
    swing = np.linspace(-0.3, 0.3, 25)
    left = np.stack([swing, np.full(25, 0.14), -0.95 + 0.2 * np.cos(5 * swing) * (swing > 0)], axis=1)
    turned = 0.2 * swing
    ahead = np.stack([np.cos(turned), np.sin(turned), np.zeros(25)], axis=1)
    return np.stack([left, left[::-1] * (1, -1, 1)], axis=1), np.stack([ahead, ahead * (1, -1, 1)], axis=1)


def check_cassie(model: RobotModel) -> None:
    """Check that soles are at their places and level, and that the coupled joints keep the lengths of the rods."""
    feet_m, ahead = cassie_feet()
    poses, away_m = link_poses(model, feet_m, ahead)
    assert away_m.max() < 1e-3
    for number, side in enumerate(SIDES):
        foot = poses[f"{side}-foot"]
        ends = [foot @ np.array([x, y, 0.0, 1.0]) for x, y in ((0.08848, -0.00024), (-0.04619, 0.11282))]
        for end in ends:
            assert end[:, 2] == pytest.approx(feet_m[:, number, 2], abs=2e-3)
        along = (ends[1] - ends[0])[:, :2]
        turned = np.arctan2(ahead[:, number, 1], ahead[:, number, 0])
        assert np.arctan2(along[:, 1], along[:, 0]) == pytest.approx(turned, abs=1e-3)
        for rod, end, length_m, most_m in RODS:
            tip = poses[f"{side}-{rod}"] @ np.array([length_m, 0.0, 0.0, 1.0])
            held = np.linalg.inv(poses[f"{side}-{end}"]) @ tip[..., None]
            assert np.ptp(held[:, :3, 0], axis=0).max() < most_m


def test_soles_are_where_they_should_be_and_rods_are_as_long_as_ever(tmp_path: Path) -> None:
    check_cassie(read_robot(write_cassie(tmp_path), tmp_path))


@installed
def test_the_same_holds_for_the_published_cassie() -> None:
    check_cassie(model_of("cassie"))


def test_a_foot_that_cassie_cannot_reach_is_counted(tmp_path: Path) -> None:
    feet_m, ahead = cassie_feet()
    _, away_m = link_poses(read_robot(write_cassie(tmp_path), tmp_path), feet_m - (0.0, 0.0, 0.6), ahead)
    assert away_m.min() > 0.05


def test_a_biped_wears_cassies_meshes_when_it_is_asked_to(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The scene's numbers are those of a viser server without a browser."""
    write_cassie(tmp_path / "share")
    monkeypatch.setattr(mesh_files, "package_folder", lambda: tmp_path / "share")
    run = write_run(tmp_path, laps=1)
    command = ["view", str(run), "--html", str(tmp_path / "r.html"), "--body", "meshes", "--json"]
    assert main(command) == 0
    assert json.loads(capsys.readouterr().out)["remarks"][0] == "there are no meshes of digit: those of cassie stand in"
    source, times = read_timeline(run)
    with server() as running:
        scene = RunScene(running.scene, source, times, chosen_body("cassie", biped=True, asked=None))
        for frame in (0, times.frames // 2, times.frames - 1):
            scene.show(frame)
            nodes = scene.figure.body.body.nodes  # type: ignore[attr-defined]
            assert nodes["pelvis"].position == pytest.approx(times.com_m[frame])
            assert {"left-foot", "right-foot", "left-achilles-rod"} <= set(nodes)
    assert scene.notes() == () or "out of the legs' reach" in scene.notes()[0]


@installed
@pytest.mark.parametrize("robot", ["go2", "cassie"])
def test_the_meshes_of_a_robot_are_few_enough_for_a_page(robot: str) -> None:
    parts = parts_of(model_of(robot))
    assert 5_000 < sum(len(part.faces) for part in parts) < 40_000
    assert all(np.isfinite(part.vertices_m).all() and part.faces.max() < len(part.vertices_m) for part in parts)
    low, high = (np.min([part.vertices_m.min() for part in parts]), np.max([part.vertices_m.max() for part in parts]))
    assert -0.7 < low < high < 0.7

"""The live view of a quadruped's run, and the process of its own that serves a run while it is walked."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from browsing import Opened, followed

from calling import surefoot
from quadruped_field import write_field
from surefoot.cli import main
from surefoot.errors import InputError
from surefoot.skills.patches import Rectangle
from surefoot.viewer.browser.page import server
from surefoot.viewer.live.beside import watching
from surefoot.viewer.scenes.ground import GroundScene
from surefoot.viewer.sources.foothold_motion import read_motion
from surefoot.viewer.sources.ground import Phase, RunGround, WayPoint
from synthetic_run import write_run

TRUNK = "window.__viserMutable?.nodePoseData?.['/robot/trunk']"


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("field")
    code, _ = surefoot("run", write_field(folder / "field.yaml"), "-o", folder / "run", "--json")
    assert code == 0
    return folder / "run"


@pytest.fixture(scope="module")
def lines(run_folder: Path) -> list[str]:
    return (run_folder / "run.jsonl").read_text().splitlines(keepends=True)


@pytest.fixture(scope="module")
def opened(run_folder: Path, lines: list[str]) -> Iterator[Opened]:
    """Yield a browser that looks at the live view of a run that has walked one segment."""
    (run_folder / "run.jsonl").write_text("".join(lines[: 1 + next(_segments(lines))]))
    with followed(run_folder) as one:
        yield one


def _segments(lines: list[str]) -> Iterator[int]:
    return (number for number, line in enumerate(lines) if '"record": "segment"' in line)


def wait_for_base(opened: Opened, run_folder: Path) -> tuple[float, float, float]:
    """Wait until the trunk stands where the last segment ends; return the place."""
    x, y, z = (float(one) for one in read_motion(run_folder).base_m[-1])
    opened.wait(f"(p => p && Math.hypot(p[0] - {x}, p[1] - {y}, p[2] - {z}) < 0.1)({TRUNK}?.position)")
    return x, y, z


@pytest.mark.xdist_group("browser")
def test_the_scene_follows_the_segments(opened: Opened, run_folder: Path, lines: list[str]) -> None:
    before = wait_for_base(opened, run_folder)
    way_points, footholds = len(opened.nodes("/way_points/")), len(opened.nodes("/footholds/"))
    rest = "".join(lines[1 + next(_segments(lines)) :])
    with (run_folder / "run.jsonl").open("a") as stream:
        for part in (rest[:40], rest[40:]):  # first a record that is not whole yet
            stream.write(part)
            stream.flush()
            opened.page.wait_for_timeout(600)
    after = wait_for_base(opened, run_folder)
    assert after[0] > before[0] + 0.5
    assert len(opened.nodes("/way_points/")) >= way_points > 0
    assert opened.nodes("/ground/")
    assert len(opened.nodes("/footholds/")) > footholds


@pytest.mark.xdist_group("browser")
def test_nothing_leaves_the_machine_and_nothing_complains(opened: Opened) -> None:
    hosts = {url.split("/")[2].split(":")[0] for url in opened.requests if "://" in url and not url.startswith("data:")}
    assert hosts <= {"127.0.0.1"}
    assert opened.errors == []


@pytest.mark.xdist_group("browser")
def test_beside_a_run_another_process_serves_only_the_new_log(opened: Opened, tmp_path: Path) -> None:
    folder = write_run(tmp_path, laps=1)
    log = folder / "run.jsonl"
    content = log.read_text()
    with watching(folder, None) as view:
        assert view.process.pid not in (None, os.getpid())
        os.kill(int(view.process.pid or 0), signal.SIGINT)  # Ctrl-C reaches all processes, and is the caller's affair
        opened.page.goto(view.address)
        opened.wait("document.body.innerText.includes('waiting for the first step')")
        log.write_text("".join(content.splitlines(keepends=True)[:20]))
        opened.wait(f"{TRUNK} !== undefined")
        opened.page.goto("about:blank")
    assert not view.process.is_alive()


def test_a_port_in_use_is_known_before_the_run_begins(tmp_path: Path) -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        with pytest.raises(InputError, match=f"port {port} of 127.0.0.1 is in use"), watching(tmp_path, port):
            pytest.fail("the run began")


def test_a_quadruped_is_watched_until_ctrl_c(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "surefoot.cli", "run", str(write_field(tmp_path / "field.yaml")), "--view"]
    with subprocess.Popen([*command, "-o", str(tmp_path / "run")], stderr=subprocess.PIPE, text=True) as running:
        assert running.stderr is not None
        said = [running.stderr.readline()]
        while said[-1] and "goes on until Ctrl-C" not in said[-1]:
            said.append(running.stderr.readline())
        running.send_signal(signal.SIGINT)
        _, rest = running.communicate(timeout=60)
    assert said[0].startswith("open http://127.0.0.1:")
    assert running.returncode == 0
    assert rest == ""


def test_a_port_without_a_view_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for scenario in (write_field(tmp_path / "field.yaml"), tmp_path / "none.yaml"):
        assert main(["run", str(scenario), "--port", "8080", "-o", str(tmp_path / "run")]) == 2
        assert "--port belongs to --view; give both or only --view" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()


def test_the_ground_grows_with_what_happens() -> None:
    square = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    other, place = square + np.array([1.1, 0.0, 0.0]), np.array([0.5, 0.5, 0.0])
    before = RunGround((Phase(0.0, (square, other), ()),), (WayPoint(0.0, place),), place)
    after = RunGround(
        (*before.phases, Phase(2.0, (square,), (Rectangle(1.1, 0.0, 2.1, 1.0),))),
        (*before.way_points, WayPoint(3.0, place)),
        place,
    )
    with server() as running:
        scene = GroundScene(running.scene, before)
        scene.show(0.0)
        assert [node.visible for node in scene.boxes] == []
        scene.grow(after)
        for time_s, solids, boxes, way_points in ((1.0, 2, 0, 0), (2.5, 1, 1, 0), (3.5, 1, 1, 1)):
            scene.show(time_s)
            shown = [(first, last) for (first, last), node in scene.solids if node.visible]
            assert len(shown) == solids
            assert sum(node.visible for node in scene.boxes) == boxes
            assert [node.visible for node in scene.marks].index(True) == way_points
        assert running.scene.get_handle_by_name("/obstacles/0") is scene.boxes[0]

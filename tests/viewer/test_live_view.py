"""The live view: the scene of a run while its log grows, on this machine alone."""

from __future__ import annotations

import json
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from browsing import Opened, followed

from surefoot.cli import main
from surefoot.viewer.browser.page import server
from surefoot.viewer.sources.timeline import read_timeline
from synthetic_run import write_run

TRUNK_ABOVE_M = 0.13


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_run(tmp_path_factory.mktemp("live"), laps=1)


@pytest.fixture(scope="module")
def lines(run_folder: Path) -> list[str]:
    return (run_folder / "run.jsonl").read_text().splitlines(keepends=True)


@pytest.fixture(scope="module")
def opened(run_folder: Path, lines: list[str]) -> Iterator[Opened]:
    """Yield a browser that looks at the live view of a log of 20 records."""
    (run_folder / "run.jsonl").write_text("".join(lines[:20]))
    with followed(run_folder) as one:
        yield one


def wait_for_trunk(opened: Opened, com_m: np.ndarray) -> None:
    x, y, z = com_m
    place = "window.__viserMutable.nodePoseData['/robot/trunk']?.position"
    opened.wait(f"(p => p && Math.hypot(p[0] - {x}, p[1] - {y}, p[2] - {z + TRUNK_ABOVE_M}) < 1e-3)({place})")


@pytest.mark.xdist_group("browser")
def test_the_scene_follows_the_log(opened: Opened, run_folder: Path, lines: list[str]) -> None:
    wait_for_trunk(opened, read_timeline(run_folder)[1].com_m[-1])
    with (run_folder / "run.jsonl").open("a") as stream:
        for part in ("".join(lines[20:40]), lines[40][:30], lines[40][30:], "".join(lines[41:])):
            stream.write(part)
            stream.flush()
            opened.page.wait_for_timeout(600)
    wait_for_trunk(opened, read_timeline(run_folder)[1].com_m[-1])


@pytest.mark.xdist_group("browser")
def test_nothing_leaves_the_machine(opened: Opened) -> None:
    hosts = {url.split("/")[2].split(":")[0] for url in opened.requests if "://" in url and not url.startswith("data:")}
    assert hosts <= {"127.0.0.1"}
    assert opened.errors == []


def test_only_this_machine_reaches_it_and_nobody_can_share_it() -> None:
    from viser import _messages

    with server() as running:
        assert running.get_host() == "127.0.0.1"
        port = running.get_port()
        others = {str(info[4][0]) for info in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET)}
        for other in others - {"127.0.0.1"}:
            with pytest.raises(OSError, match="refused"):
                socket.create_connection((other, port), timeout=2)
        handlers = running._websock_server._incoming_handlers
        assert _messages.GuiUpdateMessage in handlers
        assert not {_messages.ShareUrlRequest, _messages.ShareUrlDisconnect} & set(handlers)


def test_a_port_in_use_is_one_sentence(run_folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        assert main(["view", str(run_folder), "--follow", "--port", str(port)]) == 2
    said = capsys.readouterr().err
    assert f"port {port} of 127.0.0.1 is in use; choose another one" in said
    assert said.count("\n") == 1


def test_what_cannot_be_followed_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["view", str(tmp_path), "--follow"]) == 2
    assert "is none of these: the folder of a run (run.jsonl)" in capsys.readouterr().err
    assert main(["view", str(tmp_path), "--port", "8080"]) == 2
    assert "--port belongs to --follow" in capsys.readouterr().err


def test_a_log_of_another_version_ends_the_view(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = write_run(tmp_path, laps=1)
    log = folder / "run.jsonl"
    log.write_text(log.read_text().replace('"format": 1', '"format": 2', 1))
    assert main(["view", str(folder), "--follow"]) == 2
    assert "run.jsonl:1: format: " in capsys.readouterr().err


def test_ctrl_c_ends_it(run_folder: Path) -> None:
    command = [sys.executable, "-m", "surefoot.cli", "view", str(run_folder), "--follow"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as running:
        assert running.stderr is not None
        assert "http://127.0.0.1:" in running.stderr.readline()
        running.send_signal(signal.SIGINT)
        out, err = running.communicate(timeout=60)
    assert running.returncode == 0
    assert out == "The view has ended\n"
    assert "Traceback" not in err


def test_a_run_is_watched_while_it_walks_and_until_ctrl_c(tutorial_plan: Path, scenes: Path, tmp_path: Path) -> None:
    scene, run = str(scenes / "tutorial_mission.yaml"), str(tmp_path / "run")
    command = [sys.executable, "-m", "surefoot.cli", "run", scene, "-p", str(tutorial_plan), "-o", run]
    command += ["--steps", "5", "--view", "--json"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as running:
        assert running.stderr is not None
        said = [running.stderr.readline()]
        while said[-1] and "goes on until Ctrl-C" not in said[-1]:
            said.append(running.stderr.readline())
        running.send_signal(signal.SIGINT)
        out, _ = running.communicate(timeout=60)
    assert said[0].startswith("open http://127.0.0.1:")
    answer = json.loads(out)
    assert answer["steps"] == 5
    assert answer["verified"]
    assert running.returncode in (0, 1)

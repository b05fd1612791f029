"""A replay of 500 steps: small, and quickly opened."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from browsing import browser

from surefoot.missions.biped.run_log import read_run
from surefoot.viewer.pages.replay import write_replay
from surefoot.viewer.robots.bodies import Body
from surefoot.viewer.robots.mesh_files import package_folder
from synthetic_run import write_run


@pytest.mark.campaign
@pytest.mark.xdist_group("browser")
@pytest.mark.parametrize("body", list(Body))
def test_a_replay_of_500_steps_is_small_and_opens_quickly(body: Body, tmp_path: Path) -> None:
    if body is Body.MESHES and package_folder() is None:
        pytest.skip("the extra `meshes` is not installed, so none are shown")
    folder = write_run(tmp_path, laps=7)
    assert len(read_run(folder).steps) >= 500
    page = write_replay(folder, tmp_path / "replay.html", body=body)
    assert page.stat().st_size < 10_000_000
    taken_s = []
    with browser() as opened:
        for _ in range(3):
            begin_s = time.perf_counter()
            opened.open(page.as_uri(), "/robot/trunk")
            taken_s.append(time.perf_counter() - begin_s)
    assert min(taken_s) < 5.0

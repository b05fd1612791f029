"""The replay of a run, opened in a browser: what the scene shows at moments of the log."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browsing import Opened, browser

from surefoot.cli import main
from surefoot.viewer.sources.timeline import Timeline, read_timeline
from synthetic_run import CELL_M, write_run

EAST_M = [3 * CELL_M, CELL_M, 5 * CELL_M, 4 * CELL_M]
PLATFORM = f"heights: {{floors: [{{rectangles_m: [{EAST_M}], height_m: 0.5}}]}}\n"
PUSHED = 5
TRUNK_ABOVE_M = 0.13


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a run with a second obstacle that hides too, a push, and a raised floor in the east."""
    folder = write_run(tmp_path_factory.mktemp("scene"), laps=1, more=PLATFORM)
    records = [json.loads(line) for line in (folder / "run.jsonl").read_text().splitlines()]
    (folder / "run.jsonl").write_text("".join(json.dumps(_richer(record)) + "\n" for record in records))
    return folder


def _richer(record: dict[str, Any]) -> dict[str, Any]:
    if record["record"] == "header":
        return {**record, "kinds": [[0], [1]]}
    if record["record"] == "turn":
        hidden = [[2, 1], [3, 1]] if record["turn"] < 3 else []
        more = {"obstacles": [[3, 1]], "visible": [[] if hidden else [[3, 1]]], "hidden": [hidden]}
        return {**record, **{key: record[key] + more[key] for key in more}}
    if record["record"] == "step" and record["step"] == PUSHED:
        first_s, second_s, omega = record["first_half_s"], record["second_half_s"], record["omega_radps"]
        names = ("next_foot_m", "next_waypoint_m", "next_apex_speed_mps", "first_half_s", "second_half_s")
        push = {
            "time_s": first_s / 2,
            "jump_mps": [0.1, 0.0],
            "recovery": "region",
            "window_mps": None,
            "omegas_before_switch": [[first_s / 2, omega]],
            "omegas_after_switch": [[second_s, omega]],
            "put_off": False,
            "planned": {name: record[name] for name in names},
        }
        return {**record, "push": push}
    return record


@pytest.fixture(scope="module")
def replay(run_folder: Path) -> Path:
    page = run_folder / "replay.html"
    assert main(["view", str(run_folder), "--html", str(page), "--json"]) == 0
    return page


@pytest.fixture(scope="module")
def times(run_folder: Path) -> Timeline:
    return read_timeline(run_folder)[1]


@pytest.fixture(scope="module")
def opened(replay: Path) -> Iterator[Opened]:
    with browser() as one:
        one.open(replay.as_uri(), "/robot/trunk")
        one.page.keyboard.press("Space")
        yield one


def frame_at(times: Timeline, time_s: float) -> int:
    return int(np.searchsorted(times.time_s - times.time_s[0], time_s, side="right")) - 1


def show(opened: Opened, times: Timeline, time_s: float) -> int:
    """Go to the middle of a frame, and wait until the trunk is above the CoM of the log."""
    frame = frame_at(times, time_s)
    while times.time_s[frame + 1] - times.time_s[frame] < 0.02:
        frame += 1
    opened.go_to(float((times.time_s[frame] + times.time_s[frame + 1]) / 2 - times.time_s[0]))
    x, y, z = times.com_m[frame]
    distance = f"Math.hypot(p[0] - {x:f}, p[1] - {y:f}, p[2] - {z + TRUNK_ABOVE_M:f})"
    opened.wait(f"(p => p && {distance} < 1e-3)(window.__viserMutable.nodePoseData['/robot/trunk']?.position)")
    return frame


@pytest.mark.xdist_group("browser")
@pytest.mark.parametrize("share", [0.8, 0.07, 0.35])
def test_the_scene_shows_the_log(opened: Opened, times: Timeline, run_folder: Path, share: float) -> None:
    frame = show(opened, times, share * float(np.ptp(times.time_s)))
    turn = times.turns[times.turn[frame]]
    step = read_timeline(run_folder)[0].run.steps[times.step[frame]]
    hidden = {f"/belief/{kind}/{r}_{c}" for kind, cells in enumerate(turn.hidden) for r, c in cells}
    assert {name for name in opened.nodes("/belief/") if name.count("/") == 3} == hidden
    for number, place in enumerate(times.obstacles_m[frame]):
        assert opened.place(f"/obstacles/{number}") == pytest.approx([*place[:2], place[2] + 0.55], abs=1e-3)
    assert opened.place("/robot/left/foot") == pytest.approx(times.left_foot_m[frame], abs=1e-3)
    assert opened.place("/robot/right/foot") == pytest.approx(times.right_foot_m[frame], abs=1e-3)
    opened.wait(f"document.querySelector('#surefoot-caption').textContent.startsWith('Step {step.step}:')")
    assert f"{turn.order}, to goal {turn.goal}" in opened.caption()


@pytest.mark.xdist_group("browser")
def test_raised_floors_carry_goals_and_obstacles(opened: Opened, times: Timeline) -> None:
    assert opened.place("/goals/0")[2] == pytest.approx(0.51)
    assert opened.place("/goals/1")[2] == pytest.approx(0.01)
    assert {round(float(z), 3) for z in times.obstacles_m[:, 0, 2]} >= {0.0, 0.5}


@pytest.mark.xdist_group("browser")
def test_a_push_is_marked_where_it_happened(opened: Opened, times: Timeline, run_folder: Path) -> None:
    step = read_timeline(run_folder)[0].run.steps[PUSHED]
    assert opened.nodes("/pushes/") == {f"/pushes/{PUSHED}"}
    show(opened, times, step.time_s + step.first_half_s)
    opened.wait("document.querySelector('#surefoot-caption').textContent.includes('pushed by 0.10 m/s')")


@pytest.mark.xdist_group("browser")
def test_plays_and_pauses(opened: Opened, times: Timeline) -> None:
    show(opened, times, 2.0)
    before_s, trunk = opened.time_s(), opened.place("/robot/trunk")
    opened.page.locator("button:has(svg.tabler-icon-player-play-filled)").click()
    opened.wait(f"document.querySelector('[role=slider]').ariaValueNow > {before_s + 0.5}")
    opened.page.locator("button:has(svg.tabler-icon-player-pause-filled)").click()
    assert opened.place("/robot/trunk") != trunk


@pytest.mark.xdist_group("browser")
def test_a_click_on_the_slider_goes_there(opened: Opened, times: Timeline) -> None:
    track = opened.page.locator(".mantine-Slider-track").bounding_box()
    opened.page.mouse.click(track["x"] + 0.75 * track["width"], track["y"] + track["height"] / 2)
    there_s = 0.75 * float(np.ptp(times.time_s))
    opened.wait(f"Math.abs(document.querySelector('[role=slider]').ariaValueNow - {there_s}) < {0.03 * there_s}")


@pytest.mark.xdist_group("browser")
def test_camera_buttons_move_the_camera(opened: Opened) -> None:
    seen = set()
    for name in ("from above", "follow", "from the side", "overview"):
        opened.page.get_by_role("button", name=name, exact=True).click()
        opened.wait(f"document.querySelector('#surefoot-cameras [aria-pressed=true]').textContent === '{name}'")
        target = "(e => [e.x, e.y, e.z])(window.__viserMutable.cameraControl.getTarget())"
        position = target.replace("getTarget", "getPosition")
        opened.page.wait_for_timeout(700)
        seen.add(tuple(round(float(x), 1) for x in opened.page.evaluate(f"[...{target}, ...{position}]")))
    assert len(seen) == 4


@pytest.mark.xdist_group("browser")
def test_nothing_leaves_the_machine_and_nothing_complains(opened: Opened, replay: Path) -> None:
    assert opened.requests
    assert {url for url in opened.requests if not url.startswith(("file:", "data:", "blob:"))} == set()
    assert opened.errors == []


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (lambda lines: [], "is empty"),
        (lambda lines: lines[:2], "holds no step"),
        (lambda lines: [lines[0].replace('"format": 1', '"format": 7'), *lines[1:]], "run.jsonl:1: format: "),
        (lambda lines: [lines[0].replace("biped-run", "plane"), *lines[1:]], "run.jsonl:1: "),
        (lambda lines: [*lines[:-1], lines[-1][:20]], "cut off"),
    ],
)
def test_bad_logs_are_one_sentence(
    change: Any, complaint: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = write_run(tmp_path, laps=1)
    log = folder / "run.jsonl"
    log.write_text("\n".join(change(log.read_text().splitlines())))
    assert main(["view", str(folder), "--html", str(tmp_path / "r.html")]) == 2
    said = capsys.readouterr().err
    assert complaint in said
    assert said.count("\n") == 1
    assert not (tmp_path / "r.html").exists()


def test_without_viser_it_says_how_to_get_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "viser", None)
    assert main(["view", str(write_run(tmp_path, laps=1)), "--html", str(tmp_path / "r.html")]) == 2
    assert "viser is not installed; install it with: pip install 'surefoot[view]'" in capsys.readouterr().err

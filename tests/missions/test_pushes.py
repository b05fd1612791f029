"""Pushes on a walking robot: sources, recovery, and what the log says."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

from surefoot.errors import InputError
from surefoot.frames import Foot
from surefoot.missions.biped.mission import RunAnswer, run_mission
from surefoot.missions.biped.run_log import read_run
from surefoot.missions.pushes.motion import Motion, Planned, flow, meeting_motion
from surefoot.missions.pushes.source import Pusher, RandomPushes, ScriptedPushes, StepPush, push_source, read_pushes
from surefoot.missions.pushes.step import transition
from surefoot.missions.scenario.scene import read_biped_scene
from surefoot.verify import verify_path
from surefoot.viewer import view_step
from surefoot.walking import StepCommand, StepKind, Unsafe, WalkingStep, plan_step, standing_state


def pushed(plan: Path, scenes: Path, out: Path, pushes: dict[int, StepPush], steps: int = 24) -> RunAnswer:
    script = out.parent / "pushes.yaml"
    lines = [
        f"  - {{step: {step}, instant: {push.instant}, sagittal_mps: {push.sagittal_mps}, "
        f"lateral_mps: {push.lateral_mps}}}\n"
        for step, push in pushes.items()
    ]
    script.write_text("format: 1\nkind: push-script\npushes:\n" + "".join(lines))
    scene = scenes / "tutorial_mission.yaml"
    return run_mission(scene, plan, steps=steps, seed=2, obstacle="random", out=out, pushes=read_pushes(script))


def records(run: Path, kind: str) -> list[dict[str, Any]]:
    lines = (run / "run.jsonl").read_text().splitlines()
    return [record for record in map(json.loads, lines) if record["record"] == kind]


def planned_step(scenes: Path) -> WalkingStep:
    scene = read_biped_scene(scenes / "tutorial_mission.yaml")
    start = standing_state((0.0, 0.0, 0.0), 0.3, Foot.LEFT, scene.walking, scene.robot)
    cell = scene.walking.fine_cell_m
    step = plan_step(start, StepCommand(StepKind.START, 2 * cell), scene.walking, scene.robot)
    assert isinstance(step, WalkingStep)
    step = plan_step(step.next_state(), StepCommand(StepKind.WALK, 4 * cell), scene.walking, scene.robot)
    assert isinstance(step, WalkingStep)
    return step


@pytest.mark.parametrize("instant", [0.0, 0.2, 0.4])
@pytest.mark.parametrize("jump", [-0.05, 0.08])
def test_the_region_recovers_a_small_push_within_the_step(
    instant: float, jump: float, tutorial_plan: Path, scenes: Path, tmp_path: Path
) -> None:
    answer = pushed(tutorial_plan, scenes, tmp_path / "run", {3: StepPush(instant, jump, 0.0)})
    assert answer.verified, answer.findings
    assert (answer.pushes, answer.recovered_in_region, answer.recovered_by_step, answer.falls) == (1, 1, 0, 0)
    step = records(answer.out, "step")[3]
    low, high = step["push"]["window_mps"]
    assert low - 0.01 <= step["next_apex_speed_mps"] <= high + 0.01
    assert step["transition"] == "nominal"
    omegas = [omega for part in ("before", "after") for _, omega in step["push"][f"omegas_{part}_switch"]]
    assert min(omegas) >= 2.8
    assert max(omegas) <= 3.5


def test_a_large_push_moves_the_foot_and_the_strategy_goes_on(
    tutorial_plan: Path, scenes: Path, tmp_path: Path
) -> None:
    for jump in (0.3, -0.25):
        answer = pushed(tutorial_plan, scenes, tmp_path / f"run{jump}", {3: StepPush(0.25, jump, 0.0)})
        assert answer.verified, answer.findings
        assert (answer.recovered_by_step, answer.falls) == (1, 0)
        assert answer.steps == 24
        step = records(answer.out, "step")[3]
        assert step["next_foot_m"] != step["push"]["planned"]["next_foot_m"]


@pytest.mark.parametrize("instant", [0.0, 0.2, 0.4])
@pytest.mark.parametrize("jump", [(-0.05, 0.0), (0.15, 0.03), (0.0, -0.04)])
def test_another_switch_leads_over_the_planned_foot(instant: float, jump: tuple[float, float], scenes: Path) -> None:
    step = planned_step(scenes)
    planned = Planned.of(step, instant * (step.first_half_s + step.second_half_s), jump)
    found = [meeting_motion(planned, planned.next_foot.ahead_m, 0.05 * k) for k in range(2, 16)]
    motions = {0.05 * (k + 2): motion for k, motion in enumerate(found) if isinstance(motion, Motion)}
    assert motions
    for speed, motion in motions.items():
        switch = flow(planned.pushed, planned.foot, motion.before)
        end = flow(switch, motion.foot, motion.after)
        assert min(duration for duration, _ in (*motion.before, *motion.after)) >= 0
        assert end.ahead_m == pytest.approx(planned.next_foot.ahead_m)
        assert end.ahead_mps == pytest.approx(speed)
        assert end.left_mps == pytest.approx(0.0, abs=1e-9)


def test_no_step_leads_to_an_apex_behind(scenes: Path) -> None:
    scene, step = read_biped_scene(scenes / "tutorial_mission.yaml"), planned_step(scenes)
    for length in (-0.3, -0.1, 0.0):
        back = plan_step(step.next_state(), StepCommand(StepKind.WALK, length), scene.walking, scene.robot)
        assert isinstance(back, Unsafe)


def test_a_fall_is_reported_with_its_margin(tutorial_plan: Path, scenes: Path, tmp_path: Path) -> None:
    answer = pushed(tutorial_plan, scenes, tmp_path / "run", {3: StepPush(0.3, -1.5, 0.0)})
    assert answer.falls == 1
    assert answer.verified, answer.findings
    assert not answer.succeeded
    assert answer.failures[0].startswith("the robot fell in step 3, ")
    report = verify_path(answer.out)
    assert [failure.message for failure in report.failures] == ["the robot fell after a push"]
    with pytest.raises(InputError, match="step 3 was not completed: the robot fell in it"):
        view_step(answer.out, 3)
    assert answer.steps == 3
    (fall,) = records(answer.out, "fall")
    assert -1.5 < fall["margin_mps"] < 0
    smaller = 1.5 + fall["margin_mps"]
    saved = pushed(tutorial_plan, scenes, tmp_path / "saved", {3: StepPush(0.3, -0.98 * smaller, 0.0)})
    assert saved.steps > 3
    assert not records(saved.out, "fall")


def test_a_push_in_the_second_half_is_left_to_the_next_foot(tutorial_plan: Path, scenes: Path, tmp_path: Path) -> None:
    answer = pushed(tutorial_plan, scenes, tmp_path / "run", {3: StepPush(0.8, 0.02, 0.03)})
    assert answer.verified, answer.findings
    assert answer.recovered_by_step == 1
    before, after = records(answer.out, "step")[3:5]
    assert before["next_side_speed_mps"] != 0
    across = [-math.sin(before["yaw_rad"]), math.cos(before["yaw_rad"])]
    left = sum(a * b for a, b in zip(after["velocity_mps"], across, strict=True))
    assert left == pytest.approx(before["next_side_speed_mps"])


def test_random_pushes_are_seeded_and_verified(tutorial_plan: Path, scenes: Path, tmp_path: Path) -> None:
    scene, logs = scenes / "tutorial_mission.yaml", []
    for name in ("one", "two"):
        source = RandomPushes(seed=4, size_mps=0.06, side_size_mps=0.01, rate=0.3)
        answer = run_mission(
            scene, tutorial_plan, steps=60, seed=4, obstacle="random", out=tmp_path / name, pushes=source
        )
        assert all("fell" in finding or "unsafe" in finding for finding in answer.findings)
        assert answer.pushes >= 5
        assert answer.pushes == answer.recovered_in_region + answer.recovered_by_step + answer.falls
        logs.append((tmp_path / name / "run.jsonl").read_text())
    assert logs[0] == logs[1]
    assert read_run(tmp_path / "one").header.pushes is not None


def test_walking_without_pushes_logs_none(tutorial_plan: Path, scenes: Path, tmp_path: Path) -> None:
    scene = scenes / "tutorial_mission.yaml"
    answer = run_mission(scene, tutorial_plan, steps=12, seed=4, obstacle="random", out=tmp_path / "run")
    assert (answer.pushes, answer.recovered_in_region, answer.recovered_by_step, answer.falls) == (0, 0, 0, 0)
    run = read_run(tmp_path / "run")
    assert all(step.push is None and step.moved_cells == (0, 0) for step in run.steps)
    for step in run.steps:
        flag = "forward" if step.outcome.sagittal > 0 else "backward" if step.outcome.sagittal < 0 else None
        assert flag is None or step.transition == flag


def test_the_flag_of_a_displacement() -> None:
    east = 0.0
    assert transition((0, 0), (0, 0), east) == "nominal"
    assert transition((1, 0), (0, 0), east) == "forward"
    assert transition((-1, 2), (0, 0), east) == "backward"
    assert transition((0, 2), (0, 0), east) == "left"
    assert transition((0, 0), (0, 1), east) == "forward"
    assert transition((0, 0), (1, 0), east) == "right"
    assert transition((1, 0), (0, -1), east) == "nominal"
    assert transition((0, 0), (-1, 0), math.pi / 2) == "forward"


@pytest.mark.parametrize(
    "pushes",
    [
        "[]",
        "7",
        "[{step: 1}]",
        "[{step: 1, instant: 0.5}]",
        "[{step: -1, instant: 0.5, sagittal_mps: 1}]",
        "[{step: 1, instant: 1, sagittal_mps: 1}]",
        "[{step: 1, instant: .nan, sagittal_mps: 1}]",
        "[{step: 1, instant: 0, sagittal_mps: 11}]",
        "[{step: 1, instant: 0, sagittal_mps: true}]",
        "[{step: 1, instant: 0, sagittal_mps: 1, power: 9}]",
        "[{step: 1, instant: 0, sagittal_mps: 1}, {step: 1, instant: 0.5, lateral_mps: 1}]",
    ],
)
def test_a_bad_script_is_one_sentence(pushes: str, tmp_path: Path) -> None:
    script = tmp_path / "pushes.yaml"
    script.write_text(f"format: 1\nkind: push-script\npushes: {pushes}\n")
    with pytest.raises(InputError, match=r"pushes\.yaml"):
        read_pushes(script)


def test_a_wrong_key_of_a_push_is_named_with_its_line(tmp_path: Path) -> None:
    script = tmp_path / "pushes.yaml"
    text = "format: 1\nkind: push-script\npushes:\n"
    text += "  - {step: 0, instant: 0, sagittal_mps: 1}\n  - {step: 1, instant: 0, sagital_mps: 1}\n"
    script.write_text(text)
    with pytest.raises(InputError, match=r":5: pushes\[1\]\.sagital_mps: is not .* \(did you mean sagittal_mps\?\)"):
        read_pushes(script)


def test_pushes_that_do_not_come_are_told(tutorial_plan: Path, scenes: Path, tmp_path: Path) -> None:
    answer = pushed(tutorial_plan, scenes, tmp_path / "run", {2: StepPush(0.3, 0.02, 0.0), 90: StepPush(0.3, 0.1, 0.0)})
    assert answer.pushes == 1
    assert [note for note in answer.notes if "1 of the pushes did not come" in note and "step 90" in note]


def test_sources_by_name(tmp_path: Path) -> None:
    assert push_source(None, 0, {}) is None
    assert push_source("random", 3, {"rate": 1.0}) == RandomPushes(3, rate=1.0)
    with pytest.raises(InputError, match="--pushes random"):
        push_source(None, 0, {"rate": 0.5})
    with pytest.raises(InputError, match="push-rate"):
        push_source("random", 0, {"rate": 0.0})
    with pytest.raises(InputError, match="push-size"):
        push_source("random", 0, {"size_mps": math.nan})
    with pytest.raises(InputError, match=r"nowhere\.yaml"):
        push_source(str(tmp_path / "nowhere.yaml"), 0, {})


def test_random_pushes_keep_their_bounds_and_their_rate() -> None:
    found = [RandomPushes(7, 0.3, 0.1, 0.25).at(step) for step in range(2000)]
    pushes = [push for push in found if push is not None]
    assert 400 < len(pushes) < 600
    assert all(0 <= push.instant < 1 for push in pushes)
    assert 0.29 < max(abs(push.sagittal_mps) for push in pushes) <= 0.3
    assert 0.09 < max(abs(push.lateral_mps) for push in pushes) <= 0.1


def test_an_unsafe_step_is_blamed_on_the_last_push() -> None:
    pusher = Pusher(ScriptedPushes(Path("none"), {2: StepPush(0.0, 1.0, 0.0)}))
    assert pusher.blamed() is None
    assert [pusher.at(step) is not None for step in range(4)] == [False, False, True, False]
    assert pusher.blamed() == 2
    assert pusher.falls == 1


@pytest.mark.campaign
def test_an_ensemble_of_pushes(two_rooms_plan: Path) -> None:
    from surefoot.missions.bench.pushes import push_ensemble

    rows = push_ensemble(((0.05, 0.0), (0.2, 0.05)), range(6), 150, two_rooms_plan)
    assert all(row.refused == 0 for row in rows)
    assert all(row.pushes == row.in_region + row.by_step + row.falls for row in rows)
    assert rows[0].falls <= 0.05 * rows[0].pushes
    assert rows[0].in_region > 0

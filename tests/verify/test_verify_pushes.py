"""Logs of pushed walks: sound ones are accepted, doctored ones are refused."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from surefoot.compute import sha256_of
from surefoot.verify import verify_path

Records = list[dict[str, Any]]
SCRIPT = """\
format: 1
kind: push-script
pushes:
  - {step: 3, instant: 0.2, sagittal_mps: 0.05}
  - {step: 7, instant: 0.8, sagittal_mps: 0.02, lateral_mps: 0.03}
"""


@pytest.fixture(scope="module")
def pushed(tutorial_plan: Path, scenes: Path) -> Path:
    """Return a run with two pushes, one that the region recovers and one that the next foot does."""
    from surefoot.missions.biped.mission import run_mission
    from surefoot.missions.pushes.source import read_pushes

    script = tutorial_plan.parent / "pushes.yaml"
    script.write_text(SCRIPT)
    out = tutorial_plan.parent / "pushed"
    scene = scenes / "tutorial_mission.yaml"
    run_mission(scene, tutorial_plan, steps=16, seed=2, obstacle="random", out=out, pushes=read_pushes(script))
    return out


@pytest.fixture
def run(pushed: Path) -> Path:
    """Return a copy of the run beside the plan and the script that it names."""
    copy = pushed.parent / "doctored"
    shutil.rmtree(copy, ignore_errors=True)
    return Path(shutil.copytree(pushed, copy))


def change(run: Path, doctor: Callable[[Records], object]) -> None:
    records = [json.loads(line) for line in (run / "run.jsonl").read_text().splitlines()]
    doctor(records)
    (run / "run.jsonl").write_text("".join(json.dumps(record) + "\n" for record in records))


def step(records: Records, number: int) -> dict[str, Any]:
    return next(record for record in records if record["record"] == "step" and record["step"] == number)


def test_a_sound_log_is_accepted(run: Path) -> None:
    report = verify_path(run)
    assert report.accepted, report.findings
    assert report.counts["pushes"] == 2
    assert report.counts["recovered_in_region"] == 1
    assert report.counts["recovered_by_step"] == 1


def jump(records: Records) -> None:
    step(records, 3)["push"]["jump_mps"][0] += 0.01


def later(records: Records) -> None:
    step(records, 3)["push"]["time_s"] += 0.01


def stiff(records: Records) -> None:
    """Hold a little more omega in an arc."""
    step(records, 3)["push"]["omegas_before_switch"][0][1] += 0.02


def beyond(records: Records) -> None:
    """Claim an omega that the law does not have; the arc lasts no time."""
    step(records, 3)["push"]["omegas_after_switch"].append([0.0, 4.0])


def shorter(records: Records) -> None:
    step(records, 3)["push"]["omegas_after_switch"].pop()


def narrow(records: Records) -> None:
    """Claim the region with a window that the apex speed misses."""
    step(records, 3)["push"]["window_mps"] = [0.65, 0.7]


def boast(records: Records) -> None:
    step(records, 7)["push"]["recovery"] = "region"


def modest(records: Records) -> None:
    step(records, 3)["push"]["recovery"] = "step"


def moved(records: Records) -> None:
    step(records, 3)["moved_cells"] = [0, 1]


def early(records: Records) -> None:
    """Move a waypoint before the first push."""
    step(records, 1)["moved_cells"] = [0, 1]


def flagged(records: Records) -> None:
    step(records, 3)["transition"] = "forward"


def unseen(records: Records) -> None:
    """Take the push out of the record."""
    del step(records, 3)["push"]


def still(records: Records) -> None:
    """Forget the lateral speed that is left."""
    step(records, 7)["next_side_speed_mps"] = 0.0


def swaying(records: Records) -> None:
    """Leave a lateral speed without a push."""
    step(records, 5)["next_side_speed_mps"] = 0.1


def planned(records: Records) -> None:
    step(records, 3)["push"]["planned"]["next_apex_speed_mps"] += 0.05


def put_off(records: Records) -> None:
    step(records, 3)["push"]["put_off"] = True


def silent(records: Records) -> None:
    """Say in the header that nobody pushed."""
    records[0]["pushes"] = None


def gentle(records: Records) -> None:
    """Say that the pushes were smaller random ones."""
    records[0]["pushes"] = {"kind": "random", "size_mps": 0.01, "side_size_mps": 0.01, "rate": 0.1}


def fallen(records: Records) -> None:
    """A fall is a fall, and the walk does not go on after it."""
    push = {"time_s": 0.1, "jump_mps": [1.0, 0.0]}
    records.insert(-1, {"record": "fall", "step": 16, "time_s": 99.0, "reason": "", "margin_mps": -0.1, "push": push})


PUSHES = "formats.md 3, pushes"


@pytest.mark.parametrize(
    ("doctor", "rule"),
    [
        (jump, PUSHES),
        (later, PUSHES),
        (stiff, PUSHES),
        (beyond, PUSHES),
        (shorter, PUSHES),
        (narrow, PUSHES),
        (boast, PUSHES),
        (modest, PUSHES),
        (moved, "rules.md 6"),
        (early, PUSHES),
        (flagged, PUSHES),
        (unseen, PUSHES),
        (still, "rules.md 6, pendulum"),
        (swaying, PUSHES),
        (planned, PUSHES),
        (put_off, PUSHES),
        (silent, PUSHES),
        (gentle, PUSHES),
        (fallen, PUSHES),
    ],
)
def test_doctored_logs_are_refused(run: Path, doctor: Callable[[Records], object], rule: str) -> None:
    change(run, doctor)
    report = verify_path(run)
    assert not report.accepted
    assert any(finding.rule.startswith(rule) for finding in report.findings), report.findings


@pytest.mark.parametrize(
    ("number", "margin", "finding"),
    [(16, -0.3, "lost by more than its jump"), (12, -0.1, "not the last step"), (16, -0.1, "not the script's")],
)
def test_what_a_fall_claims_is_checked(run: Path, number: int, margin: float, finding: str) -> None:
    fall = {"record": "fall", "step": number, "time_s": 99.0, "reason": "", "margin_mps": margin}
    fall["push"] = {"time_s": 0.1, "jump_mps": [0.2, 0.0]}
    change(run, lambda records: records.insert(-1, fall))
    assert any(finding in str(text) for text in verify_path(run).findings)


def test_a_straight_step_instead_of_a_turn_needs_a_push(run: Path) -> None:
    def straight(records: Records) -> None:
        step(records, 1)["action"] = 6 if step(records, 1)["action"] != 6 else 7

    change(run, straight)
    assert any("not the action of the action strategy" in str(text) for text in verify_path(run).findings)


def test_another_script_is_refused(run: Path) -> None:
    """A script with other pushes is not the one of the run, even when the header names its hash."""
    other = run.parent / "other.yaml"
    other.write_text(SCRIPT.replace("step: 3", "step: 4"))
    reference = {"kind": "scripted", "path": "../other.yaml", "sha256": sha256_of(other)}
    change(run, lambda records: records[0].update(pushes=reference))
    report = verify_path(run)
    assert {"the push is not the script's", "a push of the script is missing"} <= {f.message for f in report.findings}

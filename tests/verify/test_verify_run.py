"""Sound logs are accepted; doctored, truncated and stale ones are refused."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from surefoot.compute import sha256_of
from surefoot.errors import InputError
from surefoot.verify import verify_path

Records = list[dict[str, Any]]
Change = Callable[[Records], object]


@pytest.fixture
def run(walked: Path) -> Path:
    """Return a copy of the run beside the plan that it names."""
    copy = walked.parent / "doctored"
    shutil.rmtree(copy, ignore_errors=True)
    return Path(shutil.copytree(walked, copy))


def change(run: Path, doctor: Change) -> None:
    records = [json.loads(line) for line in (run / "run.jsonl").read_text().splitlines()]
    doctor(records)
    (run / "run.jsonl").write_text("".join(json.dumps(record) + "\n" for record in records))


def of(records: Records, kind: str, place: int = 0) -> dict[str, Any]:
    return [record for record in records if record["record"] == kind][place]


def test_sound_log_is_accepted(run: Path) -> None:
    report = verify_path(run)
    assert report.accepted, report.findings
    assert report.kind == "biped-run"
    assert report.counts["steps"] == 120
    assert report.counts["collisions"] == 0
    assert report.counts["complete"]


def shifted(record: dict[str, Any], name: str, by: float, axis: int = 1) -> None:
    record[name][axis] += by


def teleport(records: Records) -> None:
    turns = [record for record in records if record["record"] == "turn"]
    start = turns[0]["obstacles"][0]
    far = [
        turn for turn in turns if abs(turn["obstacles"][0][0] - start[0]) + abs(turn["obstacles"][0][1] - start[1]) > 1
    ]
    turns[1]["obstacles"] = far[0]["obstacles"]


def narrow(records: Records) -> None:
    hidden = next(record for record in records if any(record.get("hidden", [])))
    hidden["hidden"][0].pop()


def conceal(records: Records) -> None:
    """Drop the turn from the list before a turn."""
    steps = [record for record in records if record["record"] == "step"]
    turning = next(step for step in steps if step["heading_change_rad"])
    steps[turning["step"] - 1].update(next_heading_changes_rad=[0.0])


def drop(kind: str, place: int) -> Change:
    return lambda records: records.remove(of(records, kind, place))


def both(first: Change, second: Change) -> Change:
    return lambda records: (first(records), second(records))


DOCTORED: dict[str, tuple[Change, str]] = {
    "a moved foot": (lambda r: shifted(of(r, "step", 3), "next_foot_m", 0.01), "rules.md 6, pendulum"),
    "a foot moved in both its steps": (
        both(
            lambda r: shifted(of(r, "step", 3), "next_foot_m", 0.01),
            lambda r: shifted(of(r, "step", 4), "foot_m", 0.01),
        ),
        "rules.md 6, pendulum",
    ),
    "a teleported obstacle": (teleport, "rules.md 4, obstacle"),
    "an obstacle on the robot": (
        lambda r: of(r, "turn", 2).update(obstacles=[of(r, "turn", 2)["cell"]]),
        "rules.md 4, collision",
    ),
    "an obstacle in the cell just left": (
        lambda r: of(r, "turn", 1).update(obstacles=[of(r, "turn", 0)["cell"]]),
        "rules.md 4, collision",
    ),
    "an obstacle off the map": (lambda r: of(r, "turn", 1).update(obstacles=[[99, 99]]), "rules.md 4, obstacle domain"),
    "a changed speed": (lambda r: of(r, "step", 3).update(next_apex_speed_mps=0.55), "rules.md 6, pendulum"),
    "a changed velocity": (lambda r: shifted(of(r, "step", 3), "velocity_mps", 0.01, 0), "rules.md 6, pendulum"),
    "a dropped step": (drop("step", 3), "formats.md 3, step"),
    "a dropped decision": (drop("turn", 2), "formats.md 3, step"),
    "a dropped end": (drop("end", 0), "formats.md 3, end record"),
    "a narrowed belief": (narrow, "rules.md 4, belief"),
    "another order": (
        lambda r: of(r, "turn", 1).update(
            order="wait north" if of(r, "turn", 1)["order"] != "wait north" else "move north"
        ),
        "formats.md 3, order",
    ),
    "another action": (lambda r: of(r, "step", 3).update(action=99), "formats.md 3, action"),
    "another state": (lambda r: of(r, "step", 3)["fine"].update(row=0), "rules.md 5, state"),
    "an impossible outcome": (lambda r: of(r, "step", 3)["outcome"].update(lateral=3), "rules.md 5, outcomes"),
    "a longer step": (lambda r: of(r, "step", 3).update(length_m=0.6), "rules.md 6, commands"),
    "another heading": (lambda r: of(r, "step", 3).update(yaw_rad=0.1), "rules.md 6, commands"),
    "a moved waypoint": (lambda r: shifted(of(r, "step", 3), "next_waypoint_m", 0.1), "rules.md 6, waypoint"),
    "a later switch": (lambda r: of(r, "step", 3).update(first_half_s=0.9), "rules.md 6, pendulum"),
    "a negative time": (lambda r: of(r, "step", 3).update(second_half_s=-0.1), "rules.md 6, pendulum"),
    "a foot in the air": (lambda r: shifted(of(r, "step", 3), "next_foot_m", 0.1, 2), "rules.md 2, heights"),
    "another dy1": (lambda r: of(r, "step", 3).update(dy1_m=0.0), "rules.md 6, dy1 and dy2"),
    "another sign": (
        lambda r: of(r, "step", 3).update(sign_alternates=not of(r, "step", 3)["sign_alternates"]),
        "rules.md 6, Proposition V.1",
    ),
    "another range": (
        lambda r: of(r, "step", 3).update(dy2_in_range=not of(r, "step", 3)["dy2_in_range"]),
        "rules.md 6, Definition V.2",
    ),
    "a heading change that nobody can walk": (
        lambda r: of(r, "step", 3).update(next_heading_changes_rad=[1.5]),
        "rules.md 6, Theorem IV.2",
    ),
    "a clock that runs backwards": (lambda r: of(r, "step", 3).update(time_s=0.0), "formats.md 3, time_s"),
    "a rise without time": (lambda r: of(r, "step", 0).update(rise_s=1e-3), "formats.md 3, double support"),
    "an unsafe step that is not the next one": (
        lambda r: r.insert(-1, {"record": "unsafe", "step": 7, "time_s": 1e6, "reason": "none"}),
        "formats.md 3, unsafe",
    ),
    "a walk that goes on after an unsafe step": (
        lambda r: r.insert(9, {"record": "unsafe", "step": 120, "time_s": 1e6, "reason": "none"}),
        "formats.md 3, unsafe",
    ),
    "a swing foot elsewhere": (lambda r: shifted(of(r, "step", 3), "swing_from_m", 0.01), "formats.md 3, swing foot"),
    "a swing foot too low": (lambda r: shifted(of(r, "step", 3), "swing_from_m", -0.1, 2), "formats.md 3, swing foot"),
    "a faster swing foot": (
        lambda r: shifted(of(r, "step", 3), "swing_velocity_mps", 5, 0),
        "formats.md 3, swing foot",
    ),
    "a swing foot lifted elsewhere": (
        lambda r: shifted(of(r, "step", 3), "swing_lift_m", 1),
        "formats.md 3, swing foot",
    ),
    "a swing foot that rises from a stand": (
        lambda r: shifted(of(r, "step", 0), "swing_velocity_mps", 1, 2),
        "formats.md 3, standing posture",
    ),
    "another foot that stands elsewhere": (
        both(
            lambda r: shifted(of(r, "step", 0), "swing_from_m", 0.01, 0),
            lambda r: shifted(of(r, "step", 0), "swing_lift_m", 0.01, 0),
        ),
        "formats.md 3, standing posture",
    ),
    "a robot that leans at the start": (
        lambda r: shifted(of(r, "step", 0), "rise_com_m", 0.001),
        "formats.md 3, standing posture",
    ),
    "a start beside the cell's centre": (
        lambda r: shifted(of(r, "step", 0), "waypoint_m", 0.001),
        "formats.md 3, standing posture",
    ),
    "a sign that changes from none": (
        lambda r: of(r, "step", 0).update(sign_alternates=True),
        "formats.md 3, standing posture",
    ),
    "a foot set down without a stop": (
        lambda r: of(r, "step", 3).update(closing_foot_m=of(r, "step", 3)["foot_m"]),
        "rules.md 6, continuity",
    ),
    "no next heading change": (
        lambda r: of(r, "step", 3).update(next_heading_changes_rad=[]),
        "formats.md 3, next_heading_changes_rad",
    ),
    "a next heading change of junk": (
        lambda r: of(r, "step", 3)["next_heading_changes_rad"].append(1e-3),
        "formats.md 3, next_heading_changes_rad",
    ),
    "a concealed turn": (conceal, "formats.md 3, next_heading_changes_rad"),
    "fewer steps than the header says": (lambda r: r[0].update(steps=121), "formats.md 3, steps"),
    "more steps than the header says": (lambda r: r[0].update(steps=119), "formats.md 3, steps"),
    "more steps than walked": (lambda r: of(r, "end").update(steps=121), "formats.md 3, end record"),
    "more goals than reached": (lambda r: of(r, "end").update(goals_reached=[99, 99]), "formats.md 3, end record"),
}


@pytest.mark.parametrize("name", DOCTORED)
def test_doctored_log_is_refused(run: Path, name: str) -> None:
    doctor, rule = DOCTORED[name]
    change(run, doctor)
    report = verify_path(run / "run.jsonl")
    assert not report.accepted
    assert rule in {finding.rule for finding in report.findings}, report.findings


def test_log_that_just_ends_is_checked_as_far_as_it_goes(run: Path) -> None:
    lines = (run / "run.jsonl").read_text().splitlines(keepends=True)
    (run / "run.jsonl").write_text("".join(lines[:40]))
    report = verify_path(run)
    assert [finding.rule for finding in report.findings] == ["formats.md 3, end record"]
    assert not report.counts["complete"]
    assert int(str(report.counts["steps"])) > 20


def test_truncated_line_is_bad_input(run: Path) -> None:
    text = (run / "run.jsonl").read_bytes()
    (run / "run.jsonl").write_bytes(text[: len(text) // 2])
    with pytest.raises(InputError, match=r"run\.jsonl:\d+"):
        verify_path(run)


def test_log_of_another_plan_is_bad_input(run: Path) -> None:
    change(run, lambda records: records[0]["plan"].update(sha256="0" * 64))
    with pytest.raises(InputError, match=r"plan\.sha256"):
        verify_path(run)


@pytest.mark.parametrize(
    "doctor",
    [
        lambda r: r.pop(0),
        lambda r: r.append({"record": "turn"}),
        lambda r: of(r, "step", 1).pop("foot_m"),
        lambda r: of(r, "step", 1).update(foot_m=[0.0, 0.0]),
        lambda r: of(r, "step", 1).update(stance="middle"),
        lambda r: of(r, "turn", 1).update(order="fly"),
        lambda r: r.insert(1, {"record": "dream"}),
        lambda r: r[0].update(format=9),
        lambda r: r[0].update(format=1.0),
        lambda r: r[0].update(format=True),
        lambda r: r[0].update(seed=-1),
        lambda r: r[0].update(seed=1.5),
        lambda r: r[0].update(seed=True),
        lambda r: r[0].update(policy="kind"),
        lambda r: r[0].update(steps=-1),
    ],
)
def test_malformed_log_is_bad_input(run: Path, doctor: Change) -> None:
    change(run, doctor)
    with pytest.raises(InputError, match=r"run\.jsonl"):
        verify_path(run)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -float("inf")])
def test_number_that_is_not_finite_is_named_with_its_line(run: Path, value: float) -> None:
    change(run, lambda records: of(records, "step", 3)["foot_m"].__setitem__(0, value))
    name, lines = json.dumps(value), (run / "run.jsonl").read_text().splitlines()
    line = 1 + next(index for index, text in enumerate(lines) if name in text)
    with pytest.raises(InputError, match=rf"run\.jsonl:{line}: foot_m: holds {name}, which is no number of JSON"):
        verify_path(run)


@pytest.mark.parametrize(("key", "value"), [("verified", False), ("format", 1.0), ("format", True)])
def test_run_of_a_plan_that_is_none_is_bad_input(run: Path, key: str, value: object) -> None:
    plan = run.parent / "plan" / "plan.json"
    sound = plan.read_text()
    try:
        plan.write_text(json.dumps({**json.loads(sound), key: value}))
        change(run, lambda records: records[0]["plan"].update(sha256=sha256_of(plan)))
        with pytest.raises(InputError, match=rf"plan\.json.*{key}"):
            verify_path(run)
    finally:
        plan.write_text(sound)


def give_up(records: Records) -> None:
    """Let the walk end in many decisions to wait."""
    records[0]["steps"] += 1
    wait = {**of(records, "turn", -1), "order": "wait north"}
    end = records.pop()
    records.extend([wait] * 1001 + [end])


def test_walk_that_was_given_up_is_incomplete_without_blame_for_its_length(run: Path) -> None:
    change(run, give_up)
    report = verify_path(run)
    assert not report.counts["complete"]
    assert "formats.md 3, steps" not in {finding.rule for finding in report.findings}


def test_a_log_that_ends_early_with_an_unsafe_step_is_honest_and_its_mission_failed(run: Path) -> None:
    def stop(records: list[dict[str, Any]]) -> None:
        records[0]["steps"] = 200
        records.insert(-1, {"record": "unsafe", "step": 120, "time_s": 1e6, "reason": "none"})

    change(run, stop)
    report = verify_path(run)
    assert not report.counts["complete"]
    assert report.accepted, report.findings
    assert [failure.rule for failure in report.failures] == ["rules.md 6, unsafe step"]

"""Logs with several obstacles, and with obstacles that break their assumptions: sound ones and doctored ones."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from surefoot.compute import sha256_of
from surefoot.errors import InputError
from surefoot.verify import Report, verify_path

Records = list[dict[str, Any]]
Change = Callable[[Records], object]


@pytest.fixture(scope="module")
def pair(scenes: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a run with two obstacles, beside its plan."""
    from surefoot.missions.biped.mission import run_mission
    from surefoot.missions.plans.planning import plan_mission

    folder, scenario = tmp_path_factory.mktemp("pair"), scenes / "two_rooms_two_obstacles_mission.yaml"
    assert plan_mission(scenario, folder / "plan").realizable
    run_mission(scenario, folder / "plan", steps=120, seed=4, obstacle="adversarial", out=folder / "run")
    return folder / "run"


@pytest.fixture(scope="module")
def lawless(two_rooms_plan: Path, scenes: Path) -> Path:
    """Return a run in which the obstacle breaks its assumptions, and the robot plans again."""
    from surefoot.missions.biped.mission import run_mission

    out, script = two_rooms_plan.parent / "lawless", scenes / "scripts" / "two_rooms_appear.yaml"
    scenario = scenes / "two_rooms_mission.yaml"
    run_mission(scenario, two_rooms_plan, steps=60, seed=3, obstacle="scripted", script=script, out=out)
    return out


def copied(run: Path) -> Path:
    copy = run.parent / "doctored"
    shutil.rmtree(copy, ignore_errors=True)
    return Path(shutil.copytree(run, copy))


def doctored(run: Path, doctor: Change) -> Report:
    """Return the report on a changed copy of a run."""
    copy = copied(run)
    records = [json.loads(line) for line in (run / "run.jsonl").read_text().splitlines()]
    doctor(records)
    (copy / "run.jsonl").write_text("".join(json.dumps(record) + "\n" for record in records))
    return verify_path(copy)


def of(records: Records, kind: str, place: int = 0) -> dict[str, Any]:
    return [record for record in records if record["record"] == kind][place]


def turns(records: Records) -> Records:
    return [record for record in records if record["record"] == "turn"]


def teleport(records: Records) -> None:
    """Let the second obstacle be where it is long after."""
    start = of(records, "turn", 1)["obstacles"][1]
    gaps = [(abs(t["obstacles"][1][0] - start[0]) + abs(t["obstacles"][1][1] - start[1]), t) for t in turns(records)]
    of(records, "turn", 2)["obstacles"][1] = next(turn["obstacles"][1] for gap, turn in gaps if gap > 2)


def walk_into(records: Records) -> None:
    """Let an obstacle walk into the robot while that stands."""
    for before, after in pairwise(turns(records)):
        for number, (row, column) in enumerate(before["obstacles"]):
            beside = abs(row - before["cell"][0]) + abs(column - before["cell"][1]) == 1
            if beside and before["order"].startswith("wait"):
                after["obstacles"][number] = before["cell"]
                return
    raise AssertionError("nobody comes close")


def first_with(records: Records, name: str) -> list[Any]:
    """Return the first list under a name that is not empty."""
    return next(turn[name] for turn in turns(records) if turn[name][0])


PAIR: dict[str, tuple[Change, str]] = {
    "a second obstacle that jumps": (teleport, "rules.md 4, obstacle"),
    "obstacles that change places": (lambda r: of(r, "turn", 3)["obstacles"].reverse(), "rules.md 4, obstacle"),
    "obstacles that start in each other's place": (lambda r: of(r, "turn")["obstacles"].reverse(), "rules.md 4, start"),
    "a second obstacle in the upper room": (
        lambda r: of(r, "turn", 2)["obstacles"].__setitem__(1, [3, 9]),
        "rules.md 4, obstacle domain",
    ),
    "a second obstacle on the robot": (
        lambda r: of(r, "turn", 2)["obstacles"].__setitem__(1, of(r, "turn", 2)["cell"]),
        "rules.md 4, collision",
    ),
    "an obstacle that walks into the robot": (walk_into, "rules.md 4, assumption (a)"),
    "an obstacle less": (lambda r: of(r, "turn", 2)["obstacles"].pop(), "formats.md 3, turn"),
    "an obstacle that is seen and not listed": (lambda r: first_with(r, "visible")[0].pop(), "rules.md 4, belief"),
    "an obstacle that is listed and not seen": (
        lambda r: of(r, "turn", 2)["visible"][0].append([5, 5]),
        "rules.md 4, belief",
    ),
    "a narrowed belief": (lambda r: first_with(r, "hidden")[0].pop(), "rules.md 4, belief"),
    "a forgotten obstacle": (lambda r: first_with(r, "hidden")[0].clear(), "rules.md 4, belief"),
    "obstacles that are told apart": (lambda r: r[0].update(kinds=[[0], [1]]), "rules.md 4, kinds"),
    "a strategy of nobody": (lambda r: of(r, "turn", 2).update(strategy=1), "formats.md 3, strategy"),
    "a robot that stops for nothing": (
        lambda r: of(r, "turn", 2).update(strategy=-1, order="wait west"),
        "formats.md 3, strategy",
    ),
    "an invented violation": (
        lambda r: r.insert(
            r.index(of(r, "turn", 2)),
            {"record": "violation", "turn": 2, "time_s": 0.0, "violation": "jumps", "kind": 0, "cell": [3, 3]},
        ),
        "formats.md 3, violation",
    ),
}


def test_log_with_two_obstacles_is_accepted(pair: Path) -> None:
    report = verify_path(pair)
    assert report.accepted, report.findings
    assert report.counts["belief_violations"] == 0
    assert report.counts["assumption_violations"] == 0


@pytest.mark.parametrize("name", PAIR)
def test_doctored_log_with_two_obstacles_is_refused(pair: Path, name: str) -> None:
    change, rule = PAIR[name]
    report = doctored(pair, change)
    assert rule in {finding.rule for finding in report.findings}, report.findings


@pytest.mark.parametrize(
    "doctor",
    [
        lambda r: of(r, "turn", 1).update(visible=[[1, 1], [2, 2]]),
        lambda r: of(r, "turn", 1).update(hidden=None),
        lambda r: of(r, "turn", 1).pop("strategy"),
        lambda r: r[0].update(kinds=[0, 1]),
        lambda r: r[0].update(breaks_assumptions=True),
        lambda r: r[0].pop("breaks_assumptions"),
        lambda r: r.insert(1, {"record": "violation", "turn": 0}),
        lambda r: r.insert(1, {"record": "replan", "turn": 0, "strategy": 1, "path": "../plan", "sha256": ""}),
    ],
)
def test_malformed_log_with_two_obstacles_is_bad_input(pair: Path, doctor: Change) -> None:
    with pytest.raises(InputError, match=r"run\.jsonl"):
        doctored(pair, doctor)


def reached_goal_sooner(records: Records) -> None:
    of(records, "replan")["goal"] = 1 - of(records, "replan")["goal"]


def without(kind: str) -> Change:
    return lambda records: records.remove(of(records, kind))


def stopped(records: Records) -> dict[str, Any]:
    """Return the decision after the violation."""
    return next(turn for turn in turns(records) if turn["strategy"] < 0)


LAWLESS: dict[str, tuple[Change, str]] = {
    "no violation": (without("violation"), "formats.md 3, violation"),
    "another violation": (lambda r: of(r, "violation").update(violation="jumps"), "formats.md 3, violation"),
    "a violation elsewhere": (lambda r: of(r, "violation").update(cell=[5, 5]), "formats.md 3, violation"),
    "a violation of another turn": (lambda r: of(r, "violation").update(turn=1), "formats.md 3, violation"),
    "two violations": (lambda r: r.insert(r.index(stopped(r)), of(r, "violation")), "formats.md 3, violation"),
    "obstacles that keep the rules": (lambda r: r[0].update(breaks_assumptions=False), "rules.md 4, obstacle"),
    "a robot that walks on": (lambda r: stopped(r).update(strategy=0), "formats.md 3, strategy"),
    "a robot that does not stop": (lambda r: stopped(r).update(order="move west"), "formats.md 3, order"),
    "a belief from before": (lambda r: stopped(r)["hidden"][0].append([4, 1]), "rules.md 4, belief"),
    "no replan": (without("replan"), "formats.md 3, strategy"),
    "two replans": (lambda r: r.insert(r.index(of(r, "replan")), of(r, "replan")), "formats.md 3, replan"),
    "a replan too early": (
        lambda r: r.insert(1, {**of(r, "replan"), "turn": 0}),
        "formats.md 3, turn",
    ),
    "a replan of another number": (lambda r: of(r, "replan").update(strategy=2), "formats.md 3, replan"),
    "a replan from elsewhere": (lambda r: of(r, "replan").update(cell=[2, 6]), "formats.md 3, replan"),
    "a replan for another goal": (reached_goal_sooner, "formats.md 3, replan"),
    "a replan without the strange cell": (lambda r: of(r, "replan")["domains"][0].pop(0), "formats.md 3, replan"),
    "a replan of a narrower belief": (
        lambda r: of(r, "replan").update(visible=[[]], hidden=[[[5, 1]]]),
        "formats.md 3, replan",
    ),
}


def test_log_with_a_violation_is_accepted(lawless: Path) -> None:
    report = verify_path(lawless)
    assert report.accepted, report.findings
    assert (report.counts["assumption_violations"], report.counts["replans"]) == (1, 1)


@pytest.mark.parametrize("name", LAWLESS)
def test_doctored_log_with_a_violation_is_refused(lawless: Path, name: str) -> None:
    change, rule = LAWLESS[name]
    report = doctored(lawless, change)
    assert rule in {finding.rule for finding in report.findings}, report.findings


def test_log_that_ends_with_a_violation_is_refused(lawless: Path) -> None:
    def end_there(records: Records) -> None:
        place = records.index(of(records, "violation"))
        records[place + 1 : -1] = []

    assert "formats.md 3, violation" in {finding.rule for finding in doctored(lawless, end_there).findings}


@pytest.fixture
def replan(lawless: Path) -> tuple[Path, dict[str, Any]]:
    """Return a copy of the run, and the arrays of its second strategy."""
    copy = copied(lawless)
    with np.load(copy / "replan_1.npz", allow_pickle=False) as archive:
        return copy, {name: archive[name].copy() for name in archive.files}


def test_changed_second_strategy_is_bad_input(replan: tuple[Path, dict[str, Any]]) -> None:
    copy, arrays = replan
    np.savez(copy / "replan_1.npz", **{**arrays, "order": arrays["order"][::-1]})
    with pytest.raises(InputError, match="sha256"):
        verify_path(copy)


@pytest.mark.parametrize(
    ("rule", "wrong"),
    [
        ("rules.md 4, orders", lambda arrays: arrays["order"].__iadd__(2)),
        ("rules.md 4, obstacle domain", lambda arrays: arrays.update(domain=arrays["domain"][1:])),
        ("rules.md 4, belief", lambda arrays: arrays["hidden"].__setitem__(arrays["hidden"] == 255, 127)),
        ("formats.md 2, navigation.npz", lambda arrays: arrays["visible"].__iadd__(1)),
    ],
)
def test_wrong_second_strategy_is_refused(
    replan: tuple[Path, dict[str, Any]], rule: str, wrong: Callable[[dict[str, Any]], object]
) -> None:
    copy, arrays = replan
    wrong(arrays)
    np.savez(copy / "replan_1.npz", **arrays)
    text = (copy / "run.jsonl").read_text()
    record = next(json.loads(line) for line in text.splitlines() if '"replan"' in line)
    (copy / "run.jsonl").write_text(text.replace(record["sha256"], sha256_of(copy / "replan_1.npz")))
    report = verify_path(copy)
    assert rule in {finding.rule for finding in report.findings}, report.findings

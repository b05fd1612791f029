"""The checker of a quadruped's run: honest runs are accepted, doctored ones refused with the rule that they break."""

from __future__ import annotations

import contextlib
import hashlib
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from quadruped_field import doctored, make_field, records, walked
from surefoot.errors import InputError
from surefoot.verify import verify_path

Record = dict[str, Any]


@pytest.fixture(scope="module")
def honest(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with field, library and a run in which an obstacle appears and the robot is pushed."""
    folder = make_field(tmp_path_factory.mktemp("honest"))
    (folder / "events.yaml").write_text(
        "format: 1\nkind: quadruped-events\nevents:\n"
        "- {at_segment: 1, obstacle_m: [[1.8, 1.0], [2.2, 1.4]]}\n- {at_segment: 2, push_m: [0.0, 0.1]}\n"
    )
    walked(folder, folder / "run", "--events", folder / "events.yaml")
    return folder


@pytest.fixture
def run(honest: Path, tmp_path: Path) -> Path:
    copy = tmp_path / "copy"
    shutil.copytree(honest, copy)
    return copy / "run"


def rules(run: Path) -> set[str]:
    return {finding.rule for finding in verify_path(run).findings}


def test_an_honest_run_is_accepted(honest: Path) -> None:
    report = verify_path(honest / "run")
    assert report.kind == "quadruped-run"
    assert report.accepted, report.findings
    assert report.counts["reached"]


def _other_primitive(one: Record) -> None:
    one["primitive"] = "forward dense->dense"


def _other_cells(one: Record) -> None:
    one["cells"] = [one["cells"][0], [one["cells"][1][0], one["cells"][1][1] + 1]]


def _earlier(one: Record) -> None:
    one["start_s"] -= 1.0
    one["end_s"] -= 1.0


def _never_idle(one: Record) -> None:
    one["idle_s"] = 5.0


def _renumbered(one: Record) -> None:
    one["number"] += 1


@pytest.mark.parametrize(
    ("change", "rule"),
    [
        (_other_primitive, "quadruped, move"),
        (_other_cells, "quadruped, move"),
        (_earlier, "quadruped, time"),
        (_never_idle, "quadruped, time"),
        (_renumbered, "quadruped, segment"),
    ],
)
def test_doctored_segments_are_refused(run: Path, change: Callable[[Record], None], rule: str) -> None:
    doctored(run, "segment", 1, change)
    assert rule in rules(run)


def test_a_segment_that_is_left_out_breaks_continuity(run: Path) -> None:
    path = run / "run.jsonl"
    lines = path.read_text().splitlines()
    at = next(k for k, line in enumerate(lines) if '"record": "segment"' in line)
    path.write_text("\n".join(lines[:at] + lines[at + 1 :]) + "\n")
    assert "quadruped, continuity" in rules(run)


def _changed_plan(run: Path, number: int, change: Callable[[Record], None], *, honest_hash: bool) -> None:
    path = run / "plans" / f"segment-{number:04}.json"
    plan = json.loads(path.read_text())
    change(plan)
    path.write_text(json.dumps(plan))

    def rehash(one: Record) -> None:
        one["plan"]["sha256"] = hashlib.sha256(path.read_bytes()).hexdigest()

    if honest_hash:
        doctored(run, "segment", number, rehash)


def _slipped(plan: Record) -> None:
    plan["motion"]["feet_m"][-1][0][0] += 0.05


def _slippery(plan: Record) -> None:
    for one in plan["values"]["polygons"]:
        one["friction"] = 0.9


def _invented(plan: Record) -> None:
    for one in plan["values"]["polygons"]:
        middle = [sum(vertex[k] for vertex in one["vertices_m"]) / len(one["vertices_m"]) for k in (0, 1)]
        one["vertices_m"] = [
            [middle[0] + 1.2 * (x - middle[0]), middle[1] + 1.2 * (y - middle[1]), z] for x, y, z in one["vertices_m"]
        ]


def _stronger(plan: Record) -> None:
    plan["values"]["robot"]["foot_reach_m"] = [0.3, 0.3, 0.3]


@pytest.mark.parametrize(
    ("change", "rule"),
    [
        (_slipped, "quadruped, plan"),
        (_slippery, "quadruped, foothold"),
        (_invented, "quadruped, foothold"),
        (_stronger, "quadruped, robot"),
    ],
)
def test_doctored_plans_are_refused(run: Path, change: Callable[[Record], None], rule: str) -> None:
    _changed_plan(run, 0, change, honest_hash=True)
    assert rule in rules(run)


def test_a_plan_that_changed_is_noticed(run: Path) -> None:
    _changed_plan(run, 0, lambda plan: plan.update(made="later"), honest_hash=False)
    assert "quadruped, plan" in rules(run)


def test_an_uncertified_skill_is_refused(run: Path) -> None:
    path = run.parent / "library" / "library.json"
    library = json.loads(path.read_text())
    for check in library["checks"]:
        check["verdict"] = "infeasible"
    path.write_text(json.dumps(library))

    def rehash(one: Record) -> None:
        one["library"]["sha256"] = hashlib.sha256(path.read_bytes()).hexdigest()

    doctored(run, "header", 0, rehash)
    assert "quadruped, strategy" in rules(run)


def test_a_strategy_through_an_obstacle_is_refused(run: Path) -> None:
    def blind(one: Record) -> None:
        one["labels"] = [["flat"] * 3 for _ in range(3)]

    doctored(run, "request", -1, blind)
    assert "quadruped, labels" in rules(run)


@pytest.mark.parametrize(
    ("number", "cell", "label"), [(0, (0, 1), "dense"), (0, (2, 0), "gap"), (-1, (1, 1), "sparse")]
)
def test_a_class_that_is_not_measured_is_refused(run: Path, number: int, cell: tuple[int, int], label: str) -> None:
    def relabelled(one: Record) -> None:
        row, column = cell
        assert one["labels"][row][column] != label
        one["labels"][row][column] = label

    doctored(run, "request", number, relabelled)
    assert "quadruped, labels" in rules(run)


def test_ground_that_was_moved_has_other_classes(run: Path) -> None:
    path = run.parent / "field.yaml"
    text = path.read_text()
    assert text.count("[[0.8000, 0.8000, 0], [1.6000, 0.8000, 0]") == 1
    path.write_text(
        text.replace("[[0.8000, 0.8000, 0], [1.6000, 0.8000, 0]", "[[0.8000, 1.3000, 0], [1.6000, 1.3000, 0]")
    )

    def rehash(one: Record) -> None:
        one["terrain"]["sha256"] = hashlib.sha256(path.read_bytes()).hexdigest()

    doctored(run, "header", 0, rehash)
    assert "quadruped, labels" in rules(run)


def test_a_strategy_is_not_followed_after_the_ground_has_changed(run: Path) -> None:
    hole = {"at_segment": 0, "hole_m": [[0.9, 0.1], [1.5, 0.7]]}
    doctored(run, "header", 0, lambda one: one["events"].append(hole))
    path = run / "run.jsonl"
    lines = path.read_text().splitlines()
    first = next(k for k, line in enumerate(lines) if '"record": "segment"' in line)
    lines.insert(first, json.dumps({"record": "event", "before_segment": 0, "event": hole, "stands": None}))
    path.write_text("\n".join(lines) + "\n")
    assert "quadruped, assumption" in rules(run)


def test_an_event_has_its_place_in_the_log(run: Path) -> None:
    doctored(run, "event", 0, lambda one: one.update(before_segment=7))
    assert rules(run) == {"quadruped, event"}


def _every_event(run: Path, number: int, change: Callable[[Record], None]) -> None:
    """Change an event where the header names it, and where it is seen."""
    doctored(run, "header", 0, lambda one: change(one["events"][number]))
    doctored(run, "event", number, lambda one: change(one["event"]))


def test_an_event_that_was_due_has_to_be_seen(run: Path) -> None:
    unseen = {"at_segment": 1, "obstacle_m": [[0.1, 2.0], [0.3, 2.2]]}
    doctored(run, "header", 0, lambda one: one["events"].append(unseen))
    assert rules(run) == {"quadruped, event"}


@pytest.mark.parametrize("when", [{"at_segment": 9}, {"at_s": 900.0}])
def test_an_event_is_not_seen_before_it_is_due(run: Path, when: Record) -> None:
    def later(one: Record) -> None:
        del one["at_segment"]
        one.update(when)

    _every_event(run, 0, later)
    assert rules(run) == {"quadruped, event"}


def test_an_event_is_seen_once(run: Path) -> None:
    path = run / "run.jsonl"
    lines = path.read_text().splitlines()
    seen = next(k for k, line in enumerate(lines) if '"record": "event"' in line)
    path.write_text("\n".join([*lines[: seen + 1], *lines[seen:]]) + "\n")
    assert rules(run) == {"quadruped, event"}


def test_a_push_takes_the_robot_where_it_pushes(run: Path) -> None:
    _every_event(run, 1, lambda one: one.update(push_m=[0.0, -0.9]))
    assert rules(run) == {"quadruped, event"}


def test_only_pushes_move_the_robot(run: Path) -> None:
    stands = records(run, "event")[1]["stands"]
    doctored(run, "event", 0, lambda one: one.update(stands=stands))
    assert "quadruped, event" in rules(run)


def test_a_motion_is_not_sent_before_the_delay_is_over(run: Path) -> None:
    doctored(run, "header", 0, lambda one: one.update(delays_s=[50.0]))
    assert rules(run) == {"quadruped, time"}


@pytest.mark.parametrize(("primitive", "holds"), [("forward sparse->sparse", True), ("left flat->flat", False)])
def test_the_certificate_of_a_skill_goes_its_way(run: Path, primitive: str, holds: bool) -> None:
    first = next(one for one in records(run, "segment") if str(one["primitive"]).startswith("forward"))
    new = {"primitive": primitive, "plan": first["plan"]}
    doctored(run, "request", 0, lambda one: one["new"].append(new))
    assert rules(run) == (set() if holds else {"quadruped, skill"})


def test_a_plan_on_the_moon_is_refused(run: Path) -> None:
    _changed_plan(run, 1, lambda plan: plan["values"].update(gravity_mps2=1.62), honest_hash=True)
    assert any("gravity" in finding.message for finding in verify_path(run).findings)


def test_a_library_with_states_of_another_map_is_refused(run: Path) -> None:
    path = run.parent / "library" / "library.json"
    library = json.loads(path.read_text())
    state = next(one for one in library["states"] if any("dense" in row for row in one))
    state[:] = [["sparse" if label == "dense" else label for label in row] for row in state]
    path.write_text(json.dumps(library))
    report = verify_path(path)
    assert "skills, classes" in {finding.rule for finding in report.findings}


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("classes", ["flat", "dense", "sparse"]),
        ("made_with", {"robot": "chotu"}),
        ("terrain", {"grid": [5, 5]}),
        ("terrain", {"cell_m": 0.4}),
    ],
)
def test_what_a_library_says_about_its_terrain_is_checked(run: Path, key: str, value: Any) -> None:
    path = run.parent / "library" / "library.json"
    library = json.loads(path.read_text())
    library[key] = {**library[key], **value} if isinstance(value, dict) else value
    path.write_text(json.dumps(library))
    with contextlib.suppress(InputError):
        assert "skills, terrain" in {finding.rule for finding in verify_path(path).findings}


def test_strategies_are_not_said_to_be_from_the_library_in_vain(run: Path) -> None:
    sources = [one["source"] for one in records(run, "request")]
    doctored(run, "request", sources.index("synthesis"), lambda one: one.update(source="library"))
    assert rules(run) == {"quadruped, request"}


def test_a_request_for_an_obstacle_is_refused(run: Path) -> None:
    doctored(run, "request", -1, lambda one: one.update(request=[9, 9]))
    assert "quadruped, request" in rules(run)


def test_a_move_that_failed_may_not_be_made_again(run: Path) -> None:
    path = run / "run.jsonl"
    lines = path.read_text().splitlines()
    requests = [k for k, line in enumerate(lines) if '"record": "request"' in line]
    cells = records(run, "segment")[-1]["cells"]
    failed = {"record": "failed", "primitive": "forward flat->flat", "move": [[1, 1], [0, 1]], "cells": cells}
    failed["quarter_turns"] = [0, 0]
    lines.insert(requests[0], json.dumps(failed))
    path.write_text("\n".join(lines) + "\n")
    assert "quadruped, disallowed" in rules(run)


def test_claims_about_the_end_are_checked(run: Path) -> None:
    doctored(run, "end", 0, lambda one: one.update(reached=False))
    assert rules(run) == {"quadruped, end"}
    path = run / "run.jsonl"
    path.write_text("\n".join(path.read_text().splitlines()[:-1]) + "\n")
    assert rules(run) == {"quadruped, end"}


def test_ground_that_was_never_there_is_refused(run: Path) -> None:
    def elsewhere(one: Record) -> None:
        one["start"]["feet_m"][0][2] += 0.1

    doctored(run, "header", 0, elsewhere)
    assert {"quadruped, foothold", "quadruped, continuity"} <= rules(run)


def test_another_terrain_is_refused(run: Path) -> None:
    with (run.parent / "field.yaml").open("a") as stream:
        stream.write("# changed\n")
    with pytest.raises(InputError, match="another version"):
        verify_path(run)


@pytest.mark.parametrize("text", ["", "{}", '{"record": "header", "kind": "quadruped-run", "format": 2}', "[1]"])
def test_broken_logs_are_bad_input(tmp_path: Path, text: str) -> None:
    (tmp_path / "run.jsonl").write_text(text + "\n")
    with pytest.raises(InputError):
        verify_path(tmp_path)


@pytest.mark.parametrize("value", [None, "text", [[1]]])
def test_arbitrary_damage_never_crashes_the_checker(run: Path, value: object) -> None:
    path = run / "run.jsonl"
    lines = path.read_text().splitlines()[:3]
    for number, line in enumerate(lines):
        record = json.loads(line)
        for key in record:
            damaged = [*lines[:number], json.dumps({**record, key: value}), *lines[number + 1 :]]
            path.write_text("\n".join(damaged) + "\n")
            with contextlib.suppress(InputError):
                assert not verify_path(run).accepted

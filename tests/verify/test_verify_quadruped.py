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
from surefoot.missions.quadruped.crossing import OnlineLimits
from surefoot.missions.quadruped.mission import QuadrupedOrder, run_quadruped
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


@pytest.mark.parametrize(
    ("key", "value", "rule"),
    [
        ("shift_m", 0.3, "program"),
        ("polygons", 999, "program"),
        ("continuous", 1, "program"),
        ("binaries", 0, "program"),
        ("solve_ms", 1e6, "time"),
        ("retarget_ms", 1e6, "time"),
    ],
)
def test_what_a_segment_says_about_its_program_is_derived_again(run: Path, key: str, value: float, rule: str) -> None:
    doctored(run, "segment", 1, lambda one: one.update({key: value}))
    assert rules(run) == {f"quadruped, {rule}"}


@pytest.mark.parametrize("key", ["solve_ms", "retarget_ms", "clock_ms", "shift_m"])
@pytest.mark.parametrize("value", [-1.0, "soon", None])
def test_times_are_numbers(run: Path, key: str, value: object) -> None:
    doctored(run, "segment", 1, lambda one: one.update({key: value}))
    with pytest.raises(InputError, match=f"{key}: has to be a finite number, at least 0"):
        verify_path(run)


@pytest.mark.parametrize(("key", "value"), [("gap", 0.5), ("time_limit_s", 1.0), ("joint_reach", True)])
def test_the_header_has_the_options_of_the_plans(run: Path, key: str, value: float) -> None:
    doctored(run, "header", 0, lambda one: one.update({key: value}))
    assert rules(run) == {"quadruped, program"}


@pytest.mark.parametrize(
    "route",
    [
        lambda route: route[1:],
        lambda route: route[:-1],
        lambda route: [route[0], [9, 9], *route[1:]],
        lambda route: [route[0], route[0], *route[1:]],
    ],
)
def test_routes_lead_from_look_to_look(run: Path, route: Callable[[list[Any]], list[Any]]) -> None:
    doctored(run, "request", 0, lambda one: one.update(route=route(one["route"])))
    assert rules(run) == {"quadruped, route"}


def test_a_route_goes_around_what_has_appeared(run: Path) -> None:
    assert records(run, "request")[-1]["route"] != [[2, 1], [1, 1], [0, 1]]
    number = [one["cell"] for one in records(run, "request")].index([2, 1])
    doctored(run, "request", number, lambda one: one.update(route=[[2, 1], [1, 1], [0, 1]]))
    assert rules(run) == {"quadruped, route"}


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
    lines.insert(
        first, json.dumps({"record": "event", "before_segment": 0, "seen_s": 0.0, "event": hole, "stands": None})
    )
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


def _at_a_time(run: Path, number: int, at_s: float) -> None:
    """Give an event a time instead of a segment."""

    def timed(one: Record) -> None:
        del one["at_segment"]
        one["at_s"] = at_s

    _every_event(run, number, timed)


def test_what_happens_before_a_motion_begins_has_to_be_seen_before(run: Path) -> None:
    start_s = records(run, "segment")[1]["start_s"]
    _at_a_time(run, 1, start_s - 0.1)  # seen before the third motion
    assert rules(run) == {"quadruped, event"}
    report = "\n".join(map(str, verify_path(run).findings))
    assert "is due, and was not seen" in report


def test_an_event_is_seen_when_it_says_that_it_is(run: Path) -> None:
    doctored(run, "event", 0, lambda one: one.update(seen_s=900.0))
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

    def found(one: Record) -> None:
        one["new"].append(new)
        one["asked"].append({"primitive": primitive, "verdict": "feasible"})

    doctored(run, "request", 0, found)
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
    failed: Record = {"record": "failed", "primitive": "forward flat->flat", "move": [[1, 1], [0, 1]], "cells": cells}
    failed |= {"quarter_turns": [0, 0], "outcome": "limit", "reason": "limit: time", "contradiction": False}
    failed |= {"polygons": 3, "retarget_ms": 1.0, "solve_ms": 5.0}
    lines.insert(requests[0], json.dumps(failed))
    path.write_text("\n".join(lines) + "\n")
    assert "quadruped, disallowed" in rules(run)


@pytest.fixture(scope="module")
def stopped(honest: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with runs that do not arrive: one without time for any program, and one that walks alone."""
    folder = tmp_path_factory.mktemp("stopped") / "copy"
    shutil.copytree(honest, folder)
    limits = OnlineLimits(time_limit_s=0.0)
    run_quadruped(QuadrupedOrder(folder / "field.yaml", folder / "library", limits=limits), folder / "late")
    (folder / "leave.yaml").write_text(
        "format: 1\nkind: quadruped-events\nevents:\n"
        "- {at_s: 1.5, obstacle_m: [[1.9, 1.1], [2.1, 1.3]]}\n- {at_segment: 2, obstacle_m: [[1.1, 2.0], [1.3, 2.2]]}\n"
    )
    walked(folder, folder / "leave", "--events", folder / "leave.yaml")
    return folder


@pytest.fixture
def late(stopped: Path, tmp_path: Path) -> Path:
    shutil.copytree(stopped, tmp_path / "copy")
    return tmp_path / "copy" / "late"


@pytest.fixture
def leave(stopped: Path, tmp_path: Path) -> Path:
    shutil.copytree(stopped, tmp_path / "copy")
    return tmp_path / "copy" / "leave"


def test_runs_that_stop_or_leave_are_accepted(stopped: Path) -> None:
    for name in ("late", "leave"):
        report = verify_path(stopped / name)
        assert report.accepted, report.findings
    assert not verify_path(stopped / "late").counts["reached"]


@pytest.mark.parametrize(
    ("change", "rule"),
    [
        ({"outcome": "infeasible"}, "failed"),
        ({"outcome": "no pose", "reason": "no pose", "solve_ms": 7.0}, "failed"),
        ({"contradiction": True}, "failed"),
        ({"reason": ""}, "failed"),
        ({"primitive": "forward dense->dense"}, "move"),
        ({"move": [[1, 1], [1, 2]]}, "move"),
        ({"primitive": "leave forward", "move": None}, "leave"),
    ],
)
def test_what_failed_is_what_the_strategy_does_and_has_its_reason(late: Path, change: Record, rule: str) -> None:
    doctored(late, "failed", 0, lambda one: one.update(change))
    assert f"quadruped, {rule}" in rules(late)


@pytest.mark.parametrize("key", ["solve_ms", "retarget_ms", "polygons"])
def test_numbers_of_what_failed_are_numbers(late: Path, key: str) -> None:
    doctored(late, "failed", 0, lambda one: one.update({key: -3}))
    with pytest.raises(InputError, match=key):
        verify_path(late)


@pytest.mark.parametrize(
    "why_not",
    [
        "",
        "tired",
        "the limit of 48 segments was reached",
        "the limit of 1 segments was reached",
        "the ground below a foot of the robot has gone",
        "the robot's own cell has become an obstacle, and no motion leads out of it",
    ],
)
def test_the_reason_for_the_end_is_derived_again(late: Path, why_not: str) -> None:
    doctored(late, "end", 0, lambda one: one.update(why_not=why_not))
    assert rules(late) == {"quadruped, end"}


def test_there_is_a_way_if_nothing_failed(late: Path) -> None:
    path = late / "run.jsonl"
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    kept = [one for one in lines if one["record"] in ("header", "request", "end")][:2] + lines[-1:]
    path.write_text("".join(json.dumps(one) + "\n" for one in kept))
    assert "moves lead to the goal that nothing forbids" in str(verify_path(late).findings[0])


@pytest.mark.parametrize(
    ("change", "rule"),
    [
        ({"primitive": "leave left"}, "leave"),
        ({"primitive": "leave upwards"}, "leave"),
        ({"move": [[1, 1], [0, 1]]}, "leave"),
    ],
)
def test_a_cell_is_left_by_one_cell(leave: Path, change: Record, rule: str) -> None:
    names = [str(one["primitive"]) for one in records(leave, "segment")]
    number = next(k for k, name in enumerate(names) if name.startswith("leave"))
    doctored(leave, "segment", number, lambda one: one.update(change))
    assert f"quadruped, {rule}" in rules(leave)


def test_nobody_leaves_a_cell_without_need(leave: Path) -> None:
    doctored(leave, "segment", 0, lambda one: one.update(primitive="leave forward", move=None))
    assert "quadruped, leave" in rules(leave)


@pytest.mark.parametrize(
    "change", [{"primitive": "forward dense->dense"}, {"cells": [[0, 0], [0, 1]]}, {"seen_s": 0.5}]
)
def test_what_is_withdrawn_is_what_the_strategy_does(leave: Path, change: Record) -> None:
    doctored(leave, "withdrawn", 0, lambda one: one.update(change))
    assert rules(leave) == {"quadruped, withdrawn"}


@pytest.mark.parametrize(
    "change", [{"number": 7}, {"why": "why not"}, {"disallowed": [[[1, 1], [0, 1]]]}, {"outcome": "unrepairable"}]
)
def test_what_a_request_says_is_derived_again(run: Path, change: Record) -> None:
    doctored(run, "request", 0, lambda one: one.update(change))
    assert "quadruped, request" in rules(run)


def test_what_failed_is_disallowed_in_the_next_request(late: Path) -> None:
    asked = next(k for k, one in enumerate(records(late, "request")) if one["disallowed"])
    doctored(late, "request", asked, lambda one: one.update(disallowed=[]))
    assert rules(late) == {"quadruped, request"}


def test_a_motion_is_withdrawn_for_a_reason(leave: Path) -> None:
    assert len(records(leave, "withdrawn")) == 1
    doctored(leave, "withdrawn", 0, lambda one: one.update(seen_s=1.0))
    assert rules(leave) == {"quadruped, withdrawn"}


def test_a_motion_is_planned_after_the_one_before_was_withdrawn(leave: Path) -> None:
    doctored(leave, "segment", 1, lambda one: one.update(plan_start_s=one["plan_start_s"] - 0.3))
    assert rules(leave) == {"quadruped, event"}


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

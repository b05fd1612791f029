"""Sound plans are accepted; plans of games with a broken rule, and changed plans, are refused with the rule."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from naive_planner import Cheats, read_rows, rewrite, write_document
from small_scene import Planner

from surefoot.compute import sha256_of
from surefoot.errors import InputError
from surefoot.verify import Report, verify_path
from surefoot.verify.navigation.belief import Known, Obstacles, Turned
from surefoot.verify.plan.moves import booked

REGIONS = "belief_regions: [{rectangles_m: [[2, 0, 3, 3]]}]"


def rules(report: Report) -> set[str]:
    return {finding.rule for finding in report.findings}


@pytest.mark.parametrize("extra", ["", REGIONS, "navigation: {belief: single, view: post}", "navigation: {view: pre}"])
def test_sound_plan_is_accepted(planned: Planner, extra: str) -> None:
    report = verify_path(planned(extra=extra))
    assert report.accepted, report.findings
    assert report.kind == "biped-plan"
    assert report.counts["product_is_whole"]


def test_plan_without_an_obstacle_is_accepted(planned: Planner) -> None:
    assert verify_path(planned(obstacles="obstacles: []")).accepted


def test_plan_file_may_be_named_itself(any_plan: Path) -> None:
    assert verify_path(any_plan / "plan.json").accepted


def test_dropped_collision_rule_is_refused(planned: Planner) -> None:
    report = verify_path(planned(Cheats(collisions=False)))
    assert not report.accepted
    assert "rules.md 4, collision" in rules(report)


class Narrow(Obstacles):
    """Leaves the first cell out of every hidden set."""

    def turn(self, known: Known, robot: int, after: int, *, waits: bool) -> Turned:
        turned = super().turn(known, robot, after, waits=waits)
        kinds = (tuple(part._replace(hidden=part.hidden[1:] or part.hidden) for part in kind) for kind in turned.kinds)
        return turned._replace(kinds=tuple(kinds))


@pytest.mark.parametrize("extra", ["", REGIONS])
def test_narrowed_belief_is_refused(planned: Planner, extra: str) -> None:
    report = verify_path(planned(Cheats(obstacles=Narrow), extra=extra))
    assert not report.accepted
    assert "rules.md 4, belief" in rules(report)


def test_narrowed_row_is_refused(any_plan: Path) -> None:
    rows = read_rows(any_plan, "navigation.npz")
    wide = np.unpackbits(rows["hidden"][:, 0], axis=1).sum(axis=1) > 1
    row = int(np.flatnonzero(wide)[0])
    byte = int(np.flatnonzero(rows["hidden"][row, 0])[0])
    rows["hidden"][row, 0, byte] &= rows["hidden"][row, 0, byte] - 1
    rewrite(any_plan, "navigation.npz", rows)
    report = verify_path(any_plan)
    assert "rules.md 4, belief" in rules(report)


def shorter_ahead(lengths: tuple[float, ...]) -> Any:
    table = booked(lengths)
    table[0, 0] -= 4
    return table


def last_step_ahead(lengths: tuple[float, ...]) -> Any:
    table = booked(lengths)
    table[0, 0] -= 1
    table[-1, 0] += 1
    return table


@pytest.mark.parametrize("booking", [shorter_ahead, last_step_ahead])
def test_wrong_turn_table_is_refused(planned: Planner, booking: Any) -> None:
    report = verify_path(planned(Cheats(booking=booking)))
    assert not report.accepted
    assert any(rule.startswith("rules.md 5") for rule in rules(report))


def test_turn_off_the_cell_centres_is_refused(naive_plan: Path) -> None:
    change_document(naive_plan, lambda plan: plan["walking"].update(turn_a_cells=[1.5, 1]))
    report = verify_path(naive_plan)
    assert "rules.md 5, turn types" in rules(report)


def change_document(plan: Path, change: Any) -> None:
    document = json.loads((plan / "plan.json").read_text())
    change(document)
    write_document(plan, document)


CLAIMS = {
    "a blocked cell is called free": (lambda p: p["grid"]["free"].append([1, 1]), "rules.md 1, free cells"),
    "a free cell is left out": (lambda p: p["grid"]["free"].pop(), "rules.md 1, free cells"),
    "the grid is shifted": (lambda p: p["grid"].update(north_west_m=[0.0, 2.9]), "rules.md 1, grid"),
    "a context is left out": (lambda p: p["contexts"].pop(), "rules.md 5, contexts"),
    "a profile is invented": (
        lambda p: p["profiles"].append(
            {"up": "east", "heights_m": [0.0] * 14, "gain_m": 0.0, "admissible": [True] * 14}
        ),
        "rules.md 2, profiles",
    ),
    "the obstacle's domain is cut": (lambda p: p["obstacles"][0]["domain"].pop(), "rules.md 4, obstacle domain"),
    "the obstacle is faster": (lambda p: p["obstacles"][0].update(speed_cells=2), "formats.md 1, obstacles"),
    "the kinds are others": (lambda p: p.update(kinds=[[0], []]), "rules.md 4, kinds"),
    "the belief is another": (
        lambda p: p["belief"].update(abstraction="single", regions=[]),
        "rules.md 4, belief abstraction",
    ),
    "the regions are others": (
        lambda p: p["belief"].update(abstraction="regions", regions=[p["grid"]["free"][:1]]),
        "rules.md 4, belief abstraction",
    ),
    "the obstacle starts elsewhere": (lambda p: p["obstacles"][0].update(start=[2, 4]), "formats.md 1, obstacles"),
    "a goal is another one": (lambda p: p["goals"].reverse(), "formats.md 1, goals"),
    "the start is elsewhere": (lambda p: p["start"].update(cell=[0, 1]), "formats.md 1, start"),
    "the start is farther than it says": (lambda p: p["start"].update(moved_m=0.5), "formats.md 2, start"),
    "the heading is another one": (lambda p: p["start"].update(heading="south"), "formats.md 1, start"),
    "the side band is narrower": (lambda p: p["walking"].update(side_band_cells=2), "formats.md 1, walking"),
    "outcomes are left out": (lambda p: p["walking"].update(lateral_outcomes_cells=0), "formats.md 1, walking"),
    "the foot is smaller": (lambda p: p["robot"].update(foot_radius_m=0.01), "formats.md 2, robot"),
}


@pytest.mark.parametrize("name", CLAIMS)
def test_claim_that_differs_from_the_scene_is_refused(any_plan: Path, name: str) -> None:
    change, rule = CLAIMS[name]
    change_document(any_plan, change)
    report = verify_path(any_plan)
    assert not report.accepted
    assert rule in rules(report)


def test_changed_orders_are_refused(any_plan: Path) -> None:
    rows = read_rows(any_plan, "navigation.npz")
    sound = rows["order"].copy()
    for row in range(0, len(sound), 1 + len(sound) // 6):
        for order in {0, 1, 2, 3} - {int(sound[row]) % 4}:
            rows["order"] = sound.copy()
            rows["order"][row] = order
            rewrite(any_plan, "navigation.npz", rows)
            assert not verify_path(any_plan).accepted, (row, order)


def test_robot_that_waits_for_ever_is_refused(any_plan: Path) -> None:
    rows = read_rows(any_plan, "navigation.npz")
    rows["order"] = np.where(rows["order"] < 4, rows["order"] + 4, rows["order"]).astype(np.int8)
    rewrite(any_plan, "navigation.npz", rows)
    report = verify_path(any_plan)
    assert not report.accepted


def test_robot_that_circles_without_its_goal_is_refused(planned: Planner) -> None:
    plan = planned(obstacles="obstacles: []")
    # cell, heading, order: east, south, west and north again, around the western wall
    loop = [(0, 1, 1), (1, 1, 1), (2, 1, 2), (7, 2, 2), (12, 2, 3), (11, 3, 3), (10, 3, 0), (5, 0, 0), (0, 0, 1)]
    cells, headings, orders = zip(*loop, strict=True)
    rows = {
        "cell": np.array(cells, np.int32),
        "heading": np.array(headings, np.int8),
        "visible": np.zeros((len(loop), 0), np.int32),
        "hidden": np.zeros((len(loop), 0, 0), np.uint8),
        "goal": np.zeros(len(loop), np.int16),
        "order": np.array(orders, np.int8),
        "domain": np.zeros(0, np.int32),
    }
    rewrite(plan, "navigation.npz", rows)
    report = verify_path(plan)
    assert rules(report) == {"rules.md 4, goals"}


@pytest.mark.parametrize("name", ["navigation.npz", "action.npz"])
def test_missing_row_is_refused(any_plan: Path, name: str) -> None:
    rows = read_rows(any_plan, name)
    rewrite(any_plan, name, {key: values if key == "domain" else values[1:] for key, values in rows.items()})
    assert not verify_path(any_plan).accepted


@pytest.mark.parametrize("name", ["navigation.npz", "action.npz"])
def test_doubled_row_is_refused(any_plan: Path, name: str) -> None:
    rows = read_rows(any_plan, name)
    double = {k: v if k == "domain" else np.concatenate([v, v[:1]]) for k, v in rows.items()}
    rewrite(any_plan, name, double)
    report = verify_path(any_plan)
    assert f"formats.md 2, {name}" in rules(report)


def test_changed_actions_are_refused(any_plan: Path) -> None:
    rows = read_rows(any_plan, "action.npz")
    sound = rows["action"].copy()
    for before, action in [(5, 1), (5, 0), (2, 3), (0, 6), (4, 99), (3, -1)]:
        row = int(np.flatnonzero(sound == before)[0])
        rows["action"] = sound.copy()
        rows["action"][row] = action
        rewrite(any_plan, "action.npz", rows)
        assert not verify_path(any_plan).accepted, (row, action)


def test_walk_that_never_turns_is_refused(any_plan: Path) -> None:
    rows = read_rows(any_plan, "action.npz")
    rows["action"] = np.where(rows["action"] == 5, 6, rows["action"]).astype(np.int16)
    rewrite(any_plan, "action.npz", rows)
    assert not verify_path(any_plan).accepted


STAIRS = {
    "a foot may stand on a riser": lambda p: p["profiles"][1].update(admissible=[True] * 26),
    "a step is higher": lambda p: p["profiles"][1]["heights_m"].__setitem__(7, 0.5),
    "the stairs gain more": lambda p: p["profiles"][1].update(gain_m=0.7),
    "the stairs lead elsewhere": lambda p: p["profiles"][1].update(up="west"),
}


@pytest.mark.parametrize("name", STAIRS)
def test_changed_stairs_are_refused(two_rooms_plan: Path, name: str) -> None:
    copy = two_rooms_plan.parent / "changed"
    shutil.rmtree(copy, ignore_errors=True)
    shutil.copytree(two_rooms_plan, copy)
    change_document(copy, STAIRS[name])
    assert "rules.md 2, profiles" in rules(verify_path(copy))


def test_shorter_steps_on_stairs_are_refused(two_rooms_plan: Path) -> None:
    copy = two_rooms_plan.parent / "changed"
    shutil.rmtree(copy, ignore_errors=True)
    shutil.copytree(two_rooms_plan, copy)
    contexts = json.loads((copy / "plan.json").read_text())["contexts"]
    stairs = [number for number, context in enumerate(contexts) if context["here"]]
    rows = read_rows(copy, "action.npz")
    climbing = np.isin(rows["context"], stairs) & (rows["action"] == 6)
    rows["action"][climbing] = 7
    rewrite(copy, "action.npz", rows)
    assert "rules.md 5, stairs" in rules(verify_path(copy))


def test_plan_for_fewer_obstacles_is_bad_input(naive_plan: Path) -> None:
    scenario = naive_plan.parent / "scenario.yaml"
    scenario.write_text(scenario.read_text().replace("obstacles: [", "obstacles: [{start_m: [0.5, 0.5]}, "))
    change_document(naive_plan, lambda plan: plan["scenario"].update(sha256=sha256_of(scenario)))
    with pytest.raises(InputError, match="obstacles"):
        verify_path(naive_plan)


def test_stale_scenario_is_bad_input(naive_plan: Path) -> None:
    scenario = naive_plan.parent / "scenario.yaml"
    scenario.write_text(scenario.read_text() + "# changed\n")
    with pytest.raises(InputError, match=r"scenario\.sha256"):
        verify_path(naive_plan)


def test_stale_strategy_is_bad_input(any_plan: Path) -> None:
    rows = read_rows(any_plan, "navigation.npz")
    rows["order"][0] = 3
    np.savez(any_plan / "navigation.npz", **rows)
    with pytest.raises(InputError, match=r"navigation\.npz"):
        verify_path(any_plan)


@pytest.mark.parametrize(
    ("key", "value"),
    [("format", 2), ("format", True), ("kind", "biped-run"), ("realizable", False), ("profiles", []), ("contexts", 3)],
)
def test_other_document_is_bad_input(naive_plan: Path, key: str, value: object) -> None:
    change_document(naive_plan, lambda plan: plan.update({key: value}))
    with pytest.raises(InputError, match=key):
        verify_path(naive_plan)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.99])
def test_truncated_document_is_bad_input(any_plan: Path, share: float) -> None:
    text = (any_plan / "plan.json").read_bytes()
    (any_plan / "plan.json").write_bytes(text[: int(len(text) * share)])
    with pytest.raises(InputError):
        verify_path(any_plan)


@pytest.mark.parametrize("share", [0.0, 0.5, 0.99])
def test_truncated_arrays_are_bad_input(any_plan: Path, share: float) -> None:
    data = (any_plan / "action.npz").read_bytes()
    (any_plan / "action.npz").write_bytes(data[: int(len(data) * share)])
    write_document(any_plan, json.loads((any_plan / "plan.json").read_text()))
    with pytest.raises(InputError):
        verify_path(any_plan)


@pytest.mark.parametrize("constant", ["NaN", "Infinity", "1e999"])
def test_numbers_that_are_none_are_bad_input(naive_plan: Path, constant: str) -> None:
    path = naive_plan / "plan.json"
    path.write_text(path.read_text().replace('"rotation_rad": 0.0', f'"rotation_rad": {constant}'))
    with pytest.raises(InputError):
        verify_path(naive_plan)


def test_folder_without_artefact_is_bad_input(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"plan\.json"):
        verify_path(tmp_path)

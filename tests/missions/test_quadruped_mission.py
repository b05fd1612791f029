"""Missions of a quadruped on a small field: the library, the runtime repair, events, delays, bad input."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calling import surefoot
from quadruped_field import make_field, records, walked
from surefoot.errors import InputError

KEYS = {
    "reached", "transitions", "repairs", "resynthesis_ms", "contradictions", "idle_s", "solve_ms_mean", "solve_ms_p95",
    "verified",
}  # fmt: skip


@pytest.fixture(scope="module")
def field(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_field(tmp_path_factory.mktemp("field"))


def events(path: Path, *lines: str) -> Path:
    path.write_text("format: 1\nkind: quadruped-events\nevents:\n" + "".join(f"- {line}\n" for line in lines))
    return path


def test_the_library_meets_the_real_polygons(field: Path, tmp_path: Path) -> None:
    answer = walked(field, tmp_path / "run")
    assert answer.keys() >= KEYS
    assert answer["reached"]
    assert answer["verified"], answer["findings"]
    assert answer["transitions"] == 3
    assert answer["contradictions"] == 0
    assert (answer["repairs"], answer["repair_ms"], answer["prepared_ms"]) == (0, 0, 0)
    assert answer["idle_s"] == 0
    assert {one["source"] for one in records(tmp_path / "run", "request")} == {"library"}
    assert len(list((tmp_path / "run" / "plans").iterdir())) == 3


def test_the_same_inputs_walk_the_same_way(field: Path, tmp_path: Path) -> None:
    for name in "ab":
        walked(field, tmp_path / name)
    first, second = ([one["plan"]["path"] for one in records(tmp_path / name, "segment")] for name in "ab")
    assert first == second
    moves = [[(one["cells"], one["primitive"]) for one in records(tmp_path / name, "segment")] for name in "ab"]
    assert moves[0] == moves[1]


def test_without_a_library_the_runtime_repair_finds_what_is_needed(field: Path, tmp_path: Path) -> None:
    answer = walked(field, tmp_path / "run", library=False)
    assert answer["reached"]
    assert answer["verified"], answer["findings"]
    assert answer["repairs"] > 0
    assert answer["new_skills"] > 0
    assert answer["prepared_ms"] > 0
    assert answer["idle_s"] == 0
    new = [skill for one in records(tmp_path / "run", "prepared") for skill in one["new"]]
    assert len(new) == answer["new_skills"]
    assert all((tmp_path / "run" / skill["plan"]["path"]).is_file() for skill in new)


def test_an_obstacle_that_appears_leads_around(field: Path, tmp_path: Path) -> None:
    file = events(tmp_path / "events.yaml", "{at_segment: 1, obstacle_m: [[1.8, 1.0], [2.2, 1.4]]}")
    answer = walked(field, tmp_path / "run", "--events", file)
    assert answer["reached"]
    assert answer["verified"], answer["findings"]
    assert answer["repairs"] > 0
    assert answer["new_skills"] == 0
    cells = [one["cells"][1] for one in records(tmp_path / "run", "segment")]
    assert [1, 1] not in cells
    assert cells[-1] == [0, 1]


def test_a_wall_that_appears_is_a_reason_to_stop(field: Path, tmp_path: Path) -> None:
    file = events(tmp_path / "events.yaml", "{at_segment: 1, obstacle_m: [[1.7, 0.0], [2.3, 2.4]]}")
    answer = walked(field, tmp_path / "run", "--events", file)
    assert not answer["reached"]
    assert "no way" in answer["why_not"]
    assert answer["verified"], answer["findings"]


def test_ground_that_goes_and_a_push_break_assumptions(field: Path, tmp_path: Path) -> None:
    file = events(
        tmp_path / "events.yaml",
        "{at_segment: 1, hole_m: [[1.61, 0.81], [2.39, 1.59]]}",
        "{at_segment: 2, push_m: [-0.6, 0.0]}",
    )
    answer = walked(field, tmp_path / "run", "--events", file)
    assert answer["reached"]
    assert answer["verified"], answer["findings"]
    assert [one["event"] for one in records(tmp_path / "run", "event")][1]["push_m"] == [-0.6, 0.0]
    assert answer["transitions"] > 3


@pytest.mark.parametrize(
    ("event", "why"),
    [
        ("{at_segment: 1, hole_m: [[-9, -9], [9, 9]]}", "below a foot"),
        ("{at_segment: 1, hole_m: [[1.30, 1.28], [1.46, 1.44]]}", "below a foot"),
        ("{at_segment: 2, obstacle_m: [[2.7, 1.1], [2.9, 1.3]]}", "no way"),
    ],
)
def test_what_cannot_be_helped_ends_with_a_reason(field: Path, tmp_path: Path, event: str, why: str) -> None:
    answer = walked(field, tmp_path / "run", "--events", events(tmp_path / "events.yaml", event))
    assert answer.keys() >= KEYS
    assert not answer["reached"]
    assert why in answer["why_not"]
    assert answer["verified"], answer["findings"]
    assert records(tmp_path / "run", "end")[0]["why_not"] == answer["why_not"]


def test_a_cell_that_becomes_an_obstacle_is_left_at_once(field: Path, tmp_path: Path) -> None:
    file = events(tmp_path / "events.yaml", "{at_segment: 0, obstacle_m: [[0.3, 1.1], [0.5, 1.3]]}")
    answer = walked(field, tmp_path / "run", "--events", file)
    assert answer["reached"], answer["why_not"]
    assert answer["verified"], answer["findings"]
    assert answer["left"] == 1
    first = records(tmp_path / "run", "segment")[0]
    assert (first["primitive"], first["move"], first["cells"]) == ("leave forward", None, [[3, 1], [2, 1]])


def test_who_is_walled_in_says_that_no_motion_leads_out(field: Path, tmp_path: Path) -> None:
    boxes = ("[[1.1, 1.1], [1.3, 1.3]]", "[[0.3, 1.1], [0.5, 1.3]]", "[[1.9, 1.1], [2.1, 1.3]]")
    sides = ("[[1.1, 0.3], [1.3, 0.5]]", "[[1.1, 2.0], [1.3, 2.1]]")
    file = events(tmp_path / "events.yaml", *(f"{{at_segment: 1, obstacle_m: {box}}}" for box in (*boxes, *sides)))
    answer = walked(field, tmp_path / "run", "--events", file)
    assert not answer["reached"]
    assert "no motion leads out" in answer["why_not"]
    assert answer["verified"], answer["findings"]


def test_what_happens_before_a_motion_begins_withdraws_it(field: Path, tmp_path: Path) -> None:
    # the second motion, into the stones, is planned at 0.3 s and begins after 2 s
    file = events(tmp_path / "events.yaml", "{at_s: 1.5, obstacle_m: [[1.9, 1.1], [2.1, 1.3]]}")
    answer = walked(field, tmp_path / "run", "--events", file)
    assert answer["reached"], answer["why_not"]
    assert answer["verified"], answer["findings"]
    assert answer["withdrawn"] == 1
    assert answer["left"] == 0
    withdrawn = records(tmp_path / "run", "withdrawn")[0]
    assert withdrawn["cells"] == [[2, 1], [1, 1]]
    assert withdrawn["seen_s"] == 1.5
    assert surefoot("view", tmp_path / "run")[0] == 0
    assert (tmp_path / "run" / "timeline.png").is_file()
    assert [1, 1] not in [one["cells"][1] for one in records(tmp_path / "run", "segment")]


def test_what_happens_during_a_motion_is_seen_before_the_next_one(field: Path, tmp_path: Path) -> None:
    # an obstacle among the stones, while the robot walks onto them
    file = events(tmp_path / "events.yaml", "{at_s: 3.0, obstacle_m: [[1.9, 1.1], [2.1, 1.3]]}")
    answer = walked(field, tmp_path / "run", "--events", file)
    assert answer["reached"], answer["why_not"]
    assert answer["verified"], answer["findings"]
    assert (answer["withdrawn"], answer["left"]) == (1, 1)
    assert records(tmp_path / "run", "segment")[-1]["primitive"] == "leave forward"


def test_what_does_not_matter_withdraws_nothing(field: Path, tmp_path: Path) -> None:
    file = events(tmp_path / "events.yaml", "{at_s: 1.5, hole_m: [[3.0, 0.0], [3.1, 0.1]]}")
    answer = walked(field, tmp_path / "run", "--events", file)
    assert answer["reached"], answer["why_not"]
    assert answer["verified"], answer["findings"]
    assert (answer["withdrawn"], answer["transitions"]) == (0, 3)
    assert records(tmp_path / "run", "event")[0]["seen_s"] == 1.5


@pytest.mark.parametrize("event", ["{at_segment: 1, ", "{at_s: 0.5, "])
def test_the_planner_looks_after_a_step_in_place(
    field: Path, tmp_path: Path, event: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    from surefoot.missions.quadruped.crossing import cross

    asked = list[str]()

    def refuted_at_first(problem: Any, certificate: Any, limits: Any) -> Any:
        """Say of the first motion that it has no program from where the feet are, so that the robot settles."""
        asked.append("")
        crossed = cross(problem, certificate, limits)
        return replace(crossed, reason="the program is infeasible") if len(asked) == 1 else crossed

    monkeypatch.setattr("surefoot.missions.quadruped.walk.cross", refuted_at_first)
    monkeypatch.setattr("surefoot.missions.quadruped.walk._SETTLED_M", 0.0)
    file = events(tmp_path / "events.yaml", event + "obstacle_m: [[1.1, 1.1], [1.3, 1.3]]}")
    answer = walked(field, tmp_path / "run", "--events", file)
    assert answer["reached"], answer["why_not"]
    assert answer["verified"], answer["findings"]
    assert answer["settled"] == 1
    done = [(one["primitive"], one["cells"][1]) for one in records(tmp_path / "run", "segment")]
    assert done[0] == (None, [3, 1])
    assert [2, 1] not in [cell for _, cell in done]


def test_a_target_without_a_pose_is_no_contradiction(
    field: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from surefoot.footholds.retarget import Retargeted, retarget

    asked = list[str]()

    def nowhere_at_first(problem: Any) -> Retargeted:
        asked.append("")
        return Retargeted("infeasible", None, None, (), None, 0.0) if len(asked) == 1 else retarget(problem)

    monkeypatch.setattr("surefoot.missions.quadruped.crossing.retarget", nowhere_at_first)
    answer = walked(field, tmp_path / "run")
    assert answer["reached"]
    assert answer["verified"], answer["findings"]
    assert (answer["no_stance"], answer["contradictions"], answer["limits"]) == (1, 0, 0)
    failed = records(tmp_path / "run", "failed")[0]
    assert (failed["outcome"], failed["contradiction"], failed["solve_ms"]) == ("no pose", False, 0.0)


def test_pushes_out_of_the_map_and_to_the_goal(field: Path, tmp_path: Path) -> None:
    file = events(tmp_path / "events.yaml", "{at_segment: 1, push_m: [-9, 0]}", "{at_segment: 2, push_m: [0.8, 0]}")
    answer = walked(field, tmp_path / "run", "--events", file)
    assert answer["reached"]
    assert answer["verified"], answer["findings"]
    assert answer["transitions"] == 2
    assert answer["detours"] == 0
    assert [one["stands"] is None for one in records(tmp_path / "run", "event")] == [True, False]


def test_who_is_there_already_has_arrived(field: Path, tmp_path: Path) -> None:
    answer = walked(field, tmp_path / "run", "--goal", "0.7,1.0")
    assert answer.keys() >= KEYS
    assert answer["reached"]
    assert answer["transitions"] == 0
    assert answer["verified"], answer["findings"]


def test_nobody_starts_where_nobody_can_stand(field: Path, tmp_path: Path) -> None:
    text = (field / "field.yaml").read_text().replace("cells: [4, 3]", "cells: [4, 4]")
    (tmp_path / "wide.yaml").write_text(text.replace("origin_m: [0, 0]", "origin_m: [0, -0.8]"))
    with pytest.raises(InputError, match=r"cell \(3, 3\).*ground"):
        surefoot("run", tmp_path / "wide.yaml", "--start", "0.4,-0.4", "-o", tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_grids_of_five_by_five_see_the_whole_field(field: Path, tmp_path: Path) -> None:
    text = (field / "field.yaml").read_text()
    (tmp_path / "five.yaml").write_text(text.replace("cells: [4, 3]", "cells: [4, 3]\ngrid: [5, 5]"))
    ends = ("--library", field / "library", "--goal", "2.0,1.2")
    _, said = surefoot("run", tmp_path / "five.yaml", *ends, "-o", tmp_path / "run", "--json")
    answer = json.loads(said)
    assert answer["reached"], answer["why_not"]
    assert answer["verified"], answer["findings"]
    assert len(records(tmp_path / "run", "request")) == 1
    assert answer["new_skills"] == 0


def test_slopes_are_walked(tmp_path: Path) -> None:
    head = "format: 1\nkind: quadruped-terrain\nclasses: unstructured-8\norigin_m: [0, 0]\ncells: [3, 1]\n"
    corners = "[[0, 0, 0], [2.4, 0, 0.2], [2.4, 0.8, 0.2], [0, 0.8, 0]]"
    (tmp_path / "slope.yaml").write_text(f"{head}polygons:\n  - vertices_m: {corners}\n")
    ends = ("--start", "0.4,0.4", "--goal", "2.0,0.4")
    _, said = surefoot("run", tmp_path / "slope.yaml", *ends, "-o", tmp_path / "run", "--json")
    answer = json.loads(said)
    assert answer["reached"], answer["why_not"]
    assert answer["verified"], answer["findings"]
    assert records(tmp_path / "run", "segment")[-1]["primitive"] == "forward flat->high"


def test_a_program_that_fails_disallows_its_move_on_this_ground_only(field: Path, tmp_path: Path) -> None:
    from surefoot.missions.quadruped.crossing import OnlineLimits
    from surefoot.missions.quadruped.mission import QuadrupedOrder, walk_quadruped

    order = QuadrupedOrder(field / "field.yaml", field / "library", limits=OnlineLimits(time_limit_s=0.0))
    walk, answer = walk_quadruped(order, tmp_path / "run")
    assert not answer.reached
    assert answer.limits > 0
    assert answer.contradictions == 0
    assert walk.book.knowledge.refused == {}
    failed = {tuple(map(tuple, one["cells"])) for one in records(tmp_path / "run", "failed")}
    assert failed == {(before[0], after[0]) for before, after in walk.failed}
    assert answer.verified, answer.findings


def test_feet_keep_to_where_legs_reach(field: Path, tmp_path: Path) -> None:
    answer = walked(field, tmp_path / "run", "--joint-reach")
    assert answer["reached"], answer["why_not"]
    assert answer["verified"], answer["findings"]
    assert records(tmp_path / "run", "header")[0]["joint_reach"] is True
    plans = sorted((tmp_path / "run" / "plans").iterdir())
    assert all(json.loads(one.read_text())["values"]["options"]["joint_reach"] for one in plans)


def test_delays_make_the_robot_wait(field: Path, tmp_path: Path) -> None:
    answer = walked(field, tmp_path / "run", "--delay", "0,0,4")
    slots = records(tmp_path / "run", "segment")
    assert answer["reached"]
    assert answer["verified"], answer["findings"]
    assert answer["idle_s"] == pytest.approx(sum(one["idle_s"] for one in slots))
    assert [one["idle_s"] > 0 for one in slots] == [False, False, True]
    assert slots[2]["idle_s"] == pytest.approx(4 - (slots[1]["end_s"] - slots[1]["start_s"]), abs=1.0)


def test_a_robot_that_only_walks_ahead_turns(tmp_path: Path) -> None:
    plate = "[[0, 0, 0], [0.8, 0, 0], [0.8, 2.4, 0], [0, 2.4, 0]]"
    head = "format: 1\nkind: quadruped-terrain\nclasses: unstructured-4\norigin_m: [0, 0]\ncells: [1, 3]\n"
    file = tmp_path / "row.yaml"
    file.write_text(
        f"{head}yaw: true\ndirections: [forward]\nstart_m: [0.4, 0.4]\ngoal_m: [0.4, 2.0]\n"
        f"polygons:\n  - vertices_m: {plate}\n"
    )
    _, said = surefoot("run", file, "-o", tmp_path / "run", "--json")
    answer = json.loads(said)
    assert answer["reached"], answer["why_not"]
    assert answer["verified"], answer["findings"]
    done = [one["primitive"] for one in records(tmp_path / "run", "segment") if one["primitive"]]
    assert done == ["turn-left flat->flat", "forward flat->flat", "forward flat->flat"]
    assert records(tmp_path / "run", "segment")[-1]["quarter_turns"] == [1, 1]


def test_bars_have_other_names_after_a_turn(tmp_path: Path) -> None:
    def bar(west: float, south: float, east: float, north: float) -> str:
        corners = [[west, south, 0], [east, south, 0], [east, north, 0], [west, north, 0]]
        return f"  - vertices_m: {json.dumps(corners)}\n"

    across = [bar(0.12 * k + 0.015, 0.0, 0.12 * k + 0.045, 1.2) for k in range(5)]
    along = [bar(0.0, 0.2 * k + 0.085, 0.6, 0.2 * k + 0.115) for k in range(6)]
    head = "format: 1\nkind: quadruped-terrain\nclasses: rebar-7\norigin_m: [0, 0]\ncells: [1, 2]\nyaw: true\n"
    ends = "directions: [forward]\nstart_m: [0.3, 0.3]\ngoal_m: [0.3, 0.9]\npolygons:\n"
    (tmp_path / "bars.yaml").write_text(head + ends + "".join((*across, *along)))
    _, said = surefoot("run", tmp_path / "bars.yaml", "-o", tmp_path / "run", "--json")
    answer = json.loads(said)
    assert answer["reached"], answer["why_not"]
    assert answer["verified"], answer["findings"]
    done = [one["primitive"] for one in records(tmp_path / "run", "segment") if one["primitive"]]
    assert done == ["turn-left dense-sparse->sparse-dense", "forward sparse-dense->sparse-dense"]


def test_a_scan_becomes_a_mission(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    x = (np.arange(120) + 0.5) * 0.02
    heights = np.where(x > 1.6, 0.12, 0.0) + rng.normal(0, 0.004, (40, 120))
    heights[:2, :3] = np.nan
    np.save(tmp_path / "scan.npy", heights)
    surefoot("terrain", "segment", tmp_path / "scan.npy", "--resolution", 0.02, "-o", tmp_path / "scan.json")
    (tmp_path / "scan.yaml").write_text(
        "format: 1\nkind: quadruped-terrain\nclasses: unstructured-8\npolygons: scan.json\norigin_m: [0, 0]\n"
        "cells: [3, 1]\n"
    )
    ends = ("--start", "0.4,0.4", "--goal", "2.0,0.4")
    _, said = surefoot("run", tmp_path / "scan.yaml", *ends, "-o", tmp_path / "run", "--json")
    answer = json.loads(said)
    assert answer["reached"], answer["why_not"]
    assert answer["verified"], answer["findings"]
    assert "forward flat->high" in {one["primitive"] for one in records(tmp_path / "run", "segment")}
    assert answer["binaries_mean"] > 100


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--goal", "9,9"], "outside of the map"),
        (["--goal", "here"], "X,Y"),
        (["--delay", "-1"], "seconds"),
        (["--steps", "5"], "biped"),
        (["--events", "field.yaml"], "events"),
    ],
)
def test_bad_input_is_refused_with_a_sentence(field: Path, tmp_path: Path, options: list[str], message: str) -> None:
    given = [str(field / "field.yaml") if one == "field.yaml" else one for one in options]
    with pytest.raises(InputError, match=message):
        surefoot("run", field / "field.yaml", "--library", field / "library", "-o", tmp_path / "run", *given)


def test_options_of_a_quadruped_are_none_of_a_biped(tmp_path: Path) -> None:
    scenario = tmp_path / "biped.yaml"
    scenario.write_text("format: 1\nkind: biped\n")
    with pytest.raises(InputError, match="quadruped"):
        surefoot("run", scenario, "--goal", "1,1")


@pytest.mark.parametrize(
    "line",
    [
        "{at_segment: 1}",
        "{at_segment: 1.5, push_m: [0, 0]}",
        "{at_segment: 1, at_s: 2, push_m: [0, 0]}",
        "{at_s: -1, push_m: [0, 0]}",
        "{at_s: 1, push_m: [0]}",
        "{at_s: 1, obstacle_m: [[1, 1], [0, 2]]}",
        "{at_s: 1, hole_m: [[1, 1], [.nan, 2]]}",
        "5",
    ],
)
def test_events_are_checked(field: Path, tmp_path: Path, line: str) -> None:
    file = events(tmp_path / "events.yaml", line)
    with pytest.raises(InputError, match="needs"):
        walked(field, tmp_path / "run", "--events", file)
    assert not (tmp_path / "run").exists()

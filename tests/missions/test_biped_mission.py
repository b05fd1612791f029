"""The biped's main job, end to end: plan, walk, verify."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from surefoot.errors import InputError
from surefoot.missions.biped.mission import RunAnswer, run_mission
from surefoot.missions.plans.planning import plan_mission
from surefoot.missions.plans.writer import replaced_plan_folder

SCENES = {
    "two_rooms": Path("scenes/two_rooms_mission.yaml"),
    "tutorial": Path("scenes/tutorial_mission.yaml"),
    "depot": Path("tests/scenes/depot_mission.yaml"),
}


def check(answer: RunAnswer, *, steps: int, visits: int) -> None:
    assert answer.verified, answer.findings
    assert answer.steps == steps
    assert answer.collisions == 0
    assert answer.unsafe_steps == 0
    assert min(answer.goals_reached) >= visits


@pytest.mark.parametrize("policy", ["random", "adversarial"])
@pytest.mark.parametrize("scene", SCENES)
def test_walks_every_scene(
    scene: str, policy: str, request: pytest.FixtureRequest, scenes: Path, tmp_path: Path
) -> None:
    plan = request.getfixturevalue(f"{scene}_plan")
    answer = run_mission(scenes.parent / SCENES[scene], plan, steps=500, seed=3, obstacle=policy, out=tmp_path / "run")
    check(answer, steps=500, visits=2)


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("policy", ["random", "adversarial"])
@pytest.mark.parametrize("scene", SCENES)
def test_ensemble(
    scene: str, policy: str, seed: int, request: pytest.FixtureRequest, scenes: Path, tmp_path: Path
) -> None:
    plan = request.getfixturevalue(f"{scene}_plan")
    answer = run_mission(
        scenes.parent / SCENES[scene], plan, steps=500, seed=seed, obstacle=policy, out=tmp_path / "run"
    )
    check(answer, steps=500, visits=2)


def test_the_same_seed_gives_the_same_run(tutorial_plan: Path, scenes: Path, tmp_path: Path) -> None:
    logs = []
    for name in ("one", "two"):
        out = tmp_path / name
        run_mission(scenes / "tutorial_mission.yaml", tutorial_plan, steps=60, seed=11, obstacle="random", out=out)
        logs.append((out / "run.jsonl").read_text())
    assert logs[0] == logs[1]


def test_a_goal_that_the_very_last_step_reaches_counts(tutorial_plan: Path, scenes: Path, tmp_path: Path) -> None:
    scenario = scenes / "tutorial_mission.yaml"
    run_mission(scenario, tutorial_plan, steps=120, seed=11, obstacle="random", out=tmp_path / "long")
    records = [json.loads(line) for line in (tmp_path / "long" / "run.jsonl").read_text().splitlines()]
    changed = next(at for at, one in enumerate(records) if one["record"] == "turn" and one["goal"] == 1)
    steps = sum(one["record"] == "step" for one in records[:changed])
    answer = run_mission(scenario, tutorial_plan, steps=steps, seed=11, obstacle="random", out=tmp_path / "short")
    assert answer.verified, answer.findings
    assert answer.goals_reached == (1, 0)


def test_the_log_has_a_header_turns_steps_and_an_end(tutorial_plan: Path, scenes: Path, tmp_path: Path) -> None:
    run_mission(
        scenes / "tutorial_mission.yaml", tutorial_plan, steps=40, seed=1, obstacle="random", out=tmp_path / "run"
    )
    records = [json.loads(line) for line in (tmp_path / "run" / "run.jsonl").read_text().splitlines()]
    assert records[0]["record"] == "header"
    assert records[-1]["record"] == "end"
    assert sum(record["record"] == "step" for record in records) == 40


def test_a_plan_for_another_scenario_is_refused(tutorial_plan: Path, scenes: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"was made for .*tutorial_mission\.yaml, not for .*two_rooms_mission"):
        run_mission(
            scenes / "two_rooms_mission.yaml", tutorial_plan, steps=5, seed=1, obstacle="random", out=tmp_path / "run"
        )
    assert not (tmp_path / "run").exists()


def test_a_plan_whose_scenario_was_edited_or_that_is_not_whole_is_refused(
    tutorial_plan: Path, scenes: Path, tmp_path: Path
) -> None:
    for name in ("tutorial_mission.yaml", "tutorial.yaml", "tutorial.pgm"):
        shutil.copy(scenes / name, tmp_path / name)
    scenario, plan = tmp_path / "tutorial_mission.yaml", Path(shutil.copytree(tutorial_plan, tmp_path / "plan"))
    document = json.loads((plan / "plan.json").read_text())
    document["scenario"]["path"] = "../tutorial_mission.yaml"
    (plan / "plan.json").write_text(json.dumps(document))

    def refused(message: str) -> None:
        with pytest.raises(InputError, match=message):
            run_mission(scenario, plan, steps=5, seed=1, obstacle="random", out=tmp_path / "run")

    (plan / "action.npz").unlink()
    refused(r"action\.npz is missing; plan again")
    scenario.write_text(scenario.read_text() + "\n")
    refused(r"tutorial_mission\.yaml was edited since the plan was made")


def test_an_older_run_leaves_no_pictures_behind(tutorial_plan: Path, scenes: Path, tmp_path: Path) -> None:
    out = tmp_path / "run"
    for _ in range(2):
        run_mission(scenes / "tutorial_mission.yaml", tutorial_plan, steps=3, seed=1, obstacle="random", out=out)
        assert [path.name for path in out.iterdir()] == ["run.jsonl"]
        for name in ("map.png", "step_2.png", "replan_1.npz"):
            (out / name).touch()
    (out / "mine.png").touch()
    run_mission(scenes / "tutorial_mission.yaml", tutorial_plan, steps=3, seed=1, obstacle="random", out=out)
    assert sorted(path.name for path in out.iterdir()) == ["mine.png", "run.jsonl"]


def test_cells_too_small_for_the_steps_name_the_smallest(scenes: Path, tmp_path: Path) -> None:
    text = (scenes / "tutorial_mission.yaml").read_text().replace("cell_size_m: 2.7", "cell_size_m: 0.3")
    scenario = tmp_path / "mission.yaml"
    scenario.write_text(text.replace("map: tutorial.yaml", f"map: {scenes / 'tutorial.yaml'}"))
    with pytest.raises(InputError, match=r"grid\.cell_size_m: 0\.3 is not allowed.* cells from 0\.\d+ m on"):
        plan_mission(scenario, tmp_path / "plan")


def test_an_unrealizable_scenario_names_the_goal_and_leaves_no_plan(scenes: Path, tmp_path: Path) -> None:
    text = (scenes / "two_rooms_mission.yaml").read_text()
    lines = [line for line in text.splitlines() if "upper room" not in line]
    scenario = tmp_path / "mission.yaml"
    scenario.write_text("\n".join(lines).replace("two_rooms.yaml", str(scenes / "two_rooms.yaml")))
    answer = plan_mission(scenario, tmp_path / "plan")
    assert not answer.realizable
    assert answer.witness is not None
    assert "goal" in answer.witness
    assert not (tmp_path / "plan").exists()
    assert [path.name for path in tmp_path.iterdir()] == ["mission.yaml"]
    assert answer.play is not None
    assert answer.play.turns[0].turn == 0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("position_m: [22.97984, 6.75877]", "position_m: [1.0, 1.0]"), "blocked cell"),
        (("position_m: [22.97984, 6.75877]", "position_m: [-50, 1.0]"), "off the grid"),
        (("position_m: [4.05527, 6.75877]", "position_m: [100, 6.75877]"), "off the grid"),
        (("map: two_rooms.yaml", "map: nowhere.yaml"), "nowhere.yaml"),
        (("cell_size_m: 2.70351", "cell_size_m: -1"), "cell_size_m"),
        (("range_m: 10.82", "range_m: .nan"), "range_m"),
        (("risers: 12", "risers: 11"), r"between \(2, 8\) and \(2, 7\)"),
        (("walking: {}", "walking: {straight_cells: [25]}"), "walking.straight_cells"),
    ],
)
def test_bad_input_is_one_sentence(change: tuple[str, str], message: str, scenes: Path, tmp_path: Path) -> None:
    text = (scenes / "two_rooms_mission.yaml").read_text()
    assert change[0] in text
    scenario = tmp_path / "mission.yaml"
    text = text.replace(*change)
    scenario.write_text(text.replace("map: two_rooms.yaml", f"map: {scenes / 'two_rooms.yaml'}"))
    with pytest.raises(InputError, match=message):
        plan_mission(scenario, tmp_path / "plan")
    assert not (tmp_path / "plan").exists()


def test_an_unreachable_goal_names_the_cells_in_between(scenes: Path, tmp_path: Path) -> None:
    picture = tmp_path / "map.pgm"
    rows = ["#######", "#..#..#", "#..#..#", "#..#..#", "#######"]
    pixels = bytes(0 if sign == "#" else 255 for row in rows for sign in row)
    picture.write_bytes(b"P5\n7 5\n255\n" + pixels)
    scenario = tmp_path / "mission.yaml"
    scenario.write_text(
        "format: 1\nkind: biped\nmap: map.pgm\nmap_resolution_m: 2.7\ngrid: {cell_size_m: 2.7}\n"
        "start: {position_m: [4.0, 6.7], heading: east}\ngoals: [{position_m: [14.8, 6.7]}]\nsensor: {range_m: 8}\n"
    )
    with pytest.raises(InputError, match=r"blocked cells \(2, 3\) separate"):
        plan_mission(scenario, tmp_path / "plan")


def test_planning_never_touches_a_folder_with_other_files(scenes: Path, tmp_path: Path) -> None:
    (tmp_path / "plan.json").write_text("{}")
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(InputError, match=r"thesis\.tex"):
        plan_mission(scenes / "tutorial_mission.yaml", tmp_path)
    assert (tmp_path / "thesis.tex").read_text() == "years of work"


def test_a_plan_json_of_another_kind_is_not_replaced(scenes: Path, tmp_path: Path) -> None:
    (tmp_path / "plan.json").write_text('{"kind": "something else"}')
    with pytest.raises(InputError, match="not a plan"):
        plan_mission(scenes / "tutorial_mission.yaml", tmp_path)
    assert (tmp_path / "plan.json").read_text() == '{"kind": "something else"}'


def test_an_older_plan_is_replaced(scenes: Path, tmp_path: Path) -> None:
    first = plan_mission(scenes / "tutorial_mission.yaml", tmp_path / "plan")
    second = plan_mission(scenes / "tutorial_mission.yaml", tmp_path / "plan")
    assert first.verified
    assert second.verified
    assert sorted(path.name for path in tmp_path.iterdir()) == ["plan"]


def test_walking_numbers_that_do_not_walk_for_ever_are_announced(scenes: Path, tmp_path: Path) -> None:
    """Turns of 30 degrees win both games, but the planner runs into steps without a safe candidate."""
    scenario = tmp_path / "mission.yaml"
    text = (scenes / "tutorial_mission.yaml").read_text().replace("map: ", f"map: {scenes}/")
    scenario.write_text(text + "walking: {turn_angle_deg: 30}\n")
    answer = plan_mission(scenario, tmp_path / "plan")
    assert answer.realizable
    assert any("trial walks" in note for note in answer.notes)


def test_a_script_is_followed_and_checked(tutorial_plan: Path, scenes: Path, tmp_path: Path) -> None:
    scenario = scenes / "tutorial_mission.yaml"
    script = tmp_path / "script.yaml"
    script.write_text("{format: 1, kind: obstacle-script, positions_m: [[4.05, 9.45], [4.05, 9.45], [4.05, 12.15]]}")
    answer = run_mission(
        scenario, tutorial_plan, steps=60, seed=0, obstacle="scripted", script=script, out=tmp_path / "run"
    )
    assert answer.verified, answer.findings
    log = (tmp_path / "run" / "run.jsonl").read_text().splitlines()
    turns = [record for record in map(json.loads, log) if record["record"] == "turn"]
    assert [turn["obstacles"] for turn in turns[:5]] == [[[1, 1]], [[2, 1]], [[2, 1]], [[1, 1]], [[1, 1]]]


@pytest.mark.parametrize(
    "positions", ["[[17.55, 4.05]]", "[[1, 1]]", "[[1e400, 1]]", "[[.nan, 1]]", "[[true, 1]]", "7", "[[4.05]]"]
)
def test_a_bad_script_leaves_no_log(positions: str, tutorial_plan: Path, scenes: Path, tmp_path: Path) -> None:
    script = tmp_path / "script.yaml"
    script.write_text(f"format: 1\nkind: obstacle-script\npositions_m: {positions}\n")
    scenario = scenes / "tutorial_mission.yaml"
    with pytest.raises(InputError, match=r"script\.yaml"):
        run_mission(scenario, tutorial_plan, steps=9, seed=0, obstacle="scripted", script=script, out=tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_an_older_plan_of_a_scenario_that_is_lost_now_is_mentioned(scenes: Path, tmp_path: Path) -> None:
    plan = tmp_path / "plan"
    assert plan_mission(scenes / "tutorial_mission.yaml", plan).out == plan
    before = (plan / "plan.json").read_text()
    text = (scenes / "two_rooms_mission.yaml").read_text()
    lines = [line for line in text.splitlines() if "upper room" not in line]
    scenario = tmp_path / "mission.yaml"
    scenario.write_text("\n".join(lines).replace("two_rooms.yaml", str(scenes / "two_rooms.yaml")))
    answer = plan_mission(scenario, plan)
    assert any("older plan" in note for note in answer.notes)
    assert (plan / "plan.json").read_text() == before


def test_a_folder_that_cannot_be_made_is_told_before_any_work(scenes: Path, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    told: list[str] = []
    with pytest.raises(InputError, match="cannot be written"):
        plan_mission(scenes / "tutorial_mission.yaml", tmp_path / "file" / "plan", told.append)
    assert told == []


def test_a_plan_that_fails_leaves_no_folders(tmp_path: Path) -> None:
    with pytest.raises(KeyError), replaced_plan_folder(tmp_path / "new" / "plan"):
        raise KeyError
    assert list(tmp_path.iterdir()) == []

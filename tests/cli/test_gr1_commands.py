"""synth, explain, simulate, export and verify on specifications, from the command line."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import pytest

from surefoot.cli import main

Capture = pytest.CaptureFixture[str]
SPECS = Path(__file__).parents[3] / "shared" / "data" / "specs"

DOOR = """[INPUT]
knock
[OUTPUT]
angle:0...3
[ENV_INIT]
!knock
[SYS_INIT]
angle = 0
[SYS_TRANS]
angle' <= angle + 1
knock' -> angle' >= angle
[ENV_LIVENESS]
!knock
[SYS_LIVENESS]
angle = 3
angle = 0
"""
DOOR_STUCK = DOOR.replace("[ENV_LIVENESS]", "angle' != 2\n[ENV_LIVENESS]")
COUNTER = """[INPUT]
up
[OUTPUT]
n:0...2
idle
[SYS_INIT]
n = 0
[SYS_TRANS]
up' -> n' = n + 1
!up' -> n' = n
idle | !idle
"""


def spec(folder: Path, text: str, name: str = "door.structuredslugs") -> str:
    path = folder / name
    path.write_text(text)
    return str(path)


def answered(arguments: list[str], capsys: Capture, code: int = 0) -> dict[str, Any]:
    assert main([*arguments, "--json"]) == code
    found = json.loads(capsys.readouterr().out)
    assert isinstance(found, dict)
    return found


@pytest.mark.parametrize("command", ["synth", "explain", "simulate", "export", "verify"])
def test_help_has_examples_and_exit_codes(command: str, capsys: Capture) -> None:
    assert main([command, "--help"]) == 0
    shown = capsys.readouterr().out
    for part in ("Examples:", f"surefoot {command}", "--json", "Exit code 0"):
        assert part in shown


def test_from_a_specification_to_a_verified_strategy_and_its_plays(tmp_path: Path, capsys: Capture) -> None:
    strategy = str(tmp_path / "out" / "strategy.json")
    found = answered(["synth", spec(tmp_path, DOOR), "-o", strategy], capsys)
    assert (found["verdict"], found["verified"], found["files"], found["warnings"]) == (
        "realizable",
        True,
        [strategy],
        [],
    )
    for name in ("engine", "why_engine", "states", "solve_s", "strategy_s", "verify_s", "time_s", "peak_mb"):
        assert name in found
    verified = answered(["verify", strategy], capsys)
    assert verified["holds"] is True
    assert verified["checked_states"] == found["strategy_states"]
    assert verified["violation"] is None
    played = answered(["simulate", strategy, "--steps", "60", "--seed", "3"], capsys)
    assert len(played["steps"]) == 60
    assert all(goal["times"] >= 2 for goal in played["goals_met"])
    again = answered(["simulate", strategy, "--steps", "60", "--seed", "3"], capsys)
    assert again == played
    assert main(["simulate", strategy, "--steps", "2"]) == 0
    assert "0: environment !knock; system angle = 0" in capsys.readouterr().out


def test_without_an_output_nothing_is_left_behind(tmp_path: Path, capsys: Capture) -> None:
    found = answered(["synth", spec(tmp_path, DOOR)], capsys)
    assert (found["verified"], found["files"]) == (True, [])
    assert [path.name for path in tmp_path.iterdir()] == ["door.structuredslugs"]
    quick = answered(["synth", spec(tmp_path, DOOR), "--realizability-only"], capsys)
    assert (quick["verdict"], quick["strategy_states"], quick["verified"]) == ("realizable", None, None)


def test_an_unrealizable_specification_is_explained(tmp_path: Path, capsys: Capture) -> None:
    path = spec(tmp_path, DOOR_STUCK)
    found = answered(["explain", path], capsys, code=1)
    assert found["verdict"] == "unrealizable"
    assert [(line["section"], line["line"], line["text"]) for line in found["core"]] == [
        ("SYS_TRANS", 10, "angle' <= angle + 1"),
        ("SYS_TRANS", 12, "angle' != 2"),
        ("SYS_LIVENESS", 16, "angle = 3"),
        ("SYS_LIVENESS", 17, "angle = 0"),
    ]
    assert found["play"]["loop_from"] is not None
    assert [line["text"] for line in found["play"]["never_met"]] in (["angle = 3"], ["angle = 0"])
    assert all(set(step["outputs"]) == {"angle"} for step in found["play"]["steps"])
    assert main(["explain", path]) == 1
    shown = capsys.readouterr().out
    assert "SYS_TRANS, line 12: angle' != 2" in shown
    assert "for ever; never met:" in shown


def test_a_play_into_a_dead_end_names_the_lines_that_block(tmp_path: Path, capsys: Capture) -> None:
    found = answered(["explain", spec(tmp_path, COUNTER)], capsys, code=1)
    assert [line["text"] for line in found["core"]] == ["up' -> n' = n + 1"]
    assert found["play"]["last_move"] == {"up": True}
    assert [line["text"] for line in found["play"]["because"]] == ["up' -> n' = n + 1"]
    assert all("idle" not in step["outputs"] for step in found["play"]["steps"])


def test_a_counter_strategy_is_saved_verified_and_simulated(tmp_path: Path, capsys: Capture) -> None:
    strategy = str(tmp_path / "counter.json")
    found = answered(["synth", spec(tmp_path, DOOR_STUCK), "-o", strategy], capsys, code=1)
    assert (found["verdict"], found["verified"]) == ("unrealizable", True)
    assert answered(["verify", strategy], capsys)["about"]["player"] == "environment"
    played = answered(["simulate", strategy, "--steps", "20"], capsys)
    assert played["player"] == "environment"
    assert min(goal["times"] for goal in played["goals_met"]) <= 1


def test_typed_moves_are_played_and_wrong_ones_explained(
    tmp_path: Path, capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    strategy = str(tmp_path / "strategy.json")
    answered(["synth", spec(tmp_path, DOOR), "-o", strategy], capsys)
    typed = "knock=1\n\nknok=1\nknock=x\nknock\nknock=0, \nknock=7\n"
    monkeypatch.setattr("sys.stdin", io.StringIO(typed))
    assert main(["simulate", strategy, "--typed"]) == 0
    shown = capsys.readouterr()
    assert "not allowed here; allowed are for instance: knock=0" in shown.err
    assert "knok is no variable; there are: knock, angle" in shown.err
    assert "knock=x is no move; write name=value" in shown.err
    assert "1: environment knock;" in shown.out
    assert "2: environment !knock;" in shown.out
    assert "ended: no more moves were typed" in shown.out


@pytest.mark.parametrize(
    ("name", "begins"), [("hoa", "HOA: v1"), ("dot", "digraph"), ("slugs-json", "{"), ("aiger", "aag ")]
)
def test_exports(tmp_path: Path, capsys: Capture, name: str, begins: str) -> None:
    strategy, other = str(tmp_path / "strategy.json"), tmp_path / "other"
    answered(["synth", spec(tmp_path, DOOR), "-o", strategy], capsys)
    assert main(["export", strategy, "--format", name]) == 0
    text = capsys.readouterr().out
    assert text.startswith(begins)
    found = answered(["export", strategy, "--format", name, "-o", str(other)], capsys)
    assert found["characters"] == len(text)
    assert other.read_text() == text


@pytest.mark.parametrize("name", ["tank.npz", "tank"])
def test_a_strategy_is_not_written_over_its_own_arrays(tmp_path: Path, capsys: Capture, name: str) -> None:
    path = tmp_path / name
    assert main(["synth", spec(tmp_path, DOOR), "--strategy", "ranking", "-o", str(path)]) == 2
    assert capsys.readouterr().err == f"error: {path}: has to end with .json\n"
    assert not path.exists()


def test_an_export_does_not_replace_its_strategy(tmp_path: Path, capsys: Capture) -> None:
    strategy = tmp_path / "s.json"
    answered(["synth", spec(tmp_path, DOOR), "-o", str(strategy)], capsys)
    before = strategy.read_bytes()
    assert main(["export", str(strategy), "--format", "dot", "-o", str(tmp_path / "." / "s.json")]) == 2
    assert "is named twice" in capsys.readouterr().err
    assert strategy.read_bytes() == before


def test_a_ranking_is_saved_verified_played_and_exported(
    tmp_path: Path, capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, text = str(tmp_path / "r.json"), "[INPUT]\na\n[OUTPUT]\nx:0...3\n[ENV_INIT]\n!a\n[SYS_LIVENESS]\nx = 3 & a\n"
    text += "[ENV_LIVENESS]\na\n[SYS_TRANS]\nx' <= x + 1\n"
    found = answered(["synth", spec(tmp_path, text), "--strategy", "ranking", "-o", path], capsys)
    assert (found["strategy"], found["certificate"], found["strategy_states"]) == ("ranking", "full", None)
    assert answered(["verify", path], capsys)["holds"]
    played = answered(["simulate", path, "--steps", "40"], capsys)
    assert len(played["steps"]) == 40
    assert played["goals_met"][0]["times"] > 5
    monkeypatch.setattr("sys.stdin", io.StringIO("a=1\nx=2\na=0\na=1\n"))
    typed = answered(["simulate", path, "--typed"], capsys)
    assert [step["values"]["a"] for step in typed["steps"]] == [0, 1]
    assert typed["ended"] == "no more moves were typed"
    assert answered(["export", path, "--format", "dot"], capsys)["text"].startswith("digraph")
    assert answered(["view", path, "--html", str(tmp_path / "r.html")], capsys)["page"].endswith("r.html")
    assert "a strategy of the" in (tmp_path / "r.html").read_text()


def test_a_ranking_of_many_moves_shows_its_layers(tmp_path: Path, capsys: Capture) -> None:
    path, page = str(tmp_path / "r.json"), tmp_path / "r.html"
    text = "[INPUT]\nx:0...200\n[OUTPUT]\ny:0...200\n[SYS_TRANS]\ny' = x'\n[SYS_LIVENESS]\ny < 100 & x > 2\n"
    text += "[ENV_LIVENESS]\nx < 100 & x > 2\n"
    answered(["synth", spec(tmp_path, text), "--strategy", "ranking", "-o", path], capsys)
    answered(["view", path, "--html", str(page)], capsys)
    shown = page.read_text()
    assert "Winning states: 40,401 of 40,401." in shown
    assert "y &lt; 100 &amp; x &gt; 2" in shown
    assert shown.count("<tr><td>") > 60
    error = answered(["export", path, "--format", "dot"], capsys, code=2)["error"]
    assert "more than 30000 moves" in error
    assert "--strategy listed" in error


def test_a_damaged_strategy_is_refused_with_exit_code_1(tmp_path: Path, capsys: Capture) -> None:
    path = tmp_path / "strategy.json"
    answered(["synth", spec(tmp_path, DOOR), "-o", str(path)], capsys)
    value = json.loads(path.read_text())
    value["arrays"]["values"][-1][1] = 3
    value["arrays"]["values"][0][1] = 3
    path.write_text(json.dumps(value))
    found = answered(["verify", str(path)], capsys, code=1)
    assert found["holds"] is False
    assert "line 8: angle = 0" in found["violation"]


@pytest.mark.parametrize(
    ("text", "kind", "lines"),
    [
        ("[INPUT]\na\n[OUTPUT]\nc\n[ENV_INIT]\na\n!a\n", "false_initial", [6, 7]),
        ("[INPUT]\nx:0...2\nb\n[OUTPUT]\nc\n[ENV_TRANS]\nb' | !b'\nx' = x + 1\n", "env_dead_end", [8]),
        (
            "[INPUT]\nseen\n[OUTPUT]\nhide\n[ENV_TRANS]\nhide -> !seen'\n[ENV_LIVENESS]\nseen\n"
            "[SYS_LIVENESS]\nhide & !hide\n",
            "falsified_assumption",
            [8],
        ),
    ],
)
def test_vacuity_is_warned_of_with_its_lines(
    tmp_path: Path, capsys: Capture, text: str, kind: str, lines: list[int]
) -> None:
    found = answered(["synth", spec(tmp_path, text)], capsys)
    assert found["verdict"] == "realizable"
    (warning,) = found["warnings"]
    assert warning["kind"] == kind
    assert [line["line"] for line in warning["lines"]] == lines
    assert main(["explain", spec(tmp_path, text)]) == 0
    assert "warning: " in capsys.readouterr().out


def test_a_limit_gives_unknown_and_exit_code_3(tmp_path: Path, capsys: Capture) -> None:
    found = answered(["synth", spec(tmp_path, DOOR), "--time-limit", "0"], capsys, code=3)
    assert found["verdict"] == "unknown"
    assert "time limit" in found["limit"]


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        (
            "[INPUT]\na\n[OUTPUT]\nc\n[ENV_TRANS]\nc'\n",
            "bad.structuredslugs:6: column 1: ENV_TRANS may use primed inputs",
        ),
        ("[INPUT]\na\n[OUTPUT]\nc:0...3\n[SYS_TRANS]\nc = 4\n", "bad.structuredslugs:6: column 5: 4 is out of range"),
        ("[INPUT]\n", "bad.structuredslugs:1: column 1: no variable is declared"),
    ],
)
@pytest.mark.parametrize("command", ["synth", "explain"])
def test_bad_specifications_are_one_line_and_exit_code_2(
    tmp_path: Path, capsys: Capture, command: str, text: str, complaint: str
) -> None:
    path = spec(tmp_path, text, "bad.structuredslugs")
    assert main([command, path]) == 2
    (shown,) = capsys.readouterr().err.splitlines()
    assert complaint in shown


def test_a_strategy_for_another_specification_is_bad_input(tmp_path: Path, capsys: Capture) -> None:
    strategy = str(tmp_path / "strategy.json")
    answered(["synth", spec(tmp_path, DOOR), "-o", strategy], capsys)
    other = spec(tmp_path, DOOR_STUCK, "other.structuredslugs")
    for arguments in (["verify", strategy, "--spec", other], ["simulate", strategy, "--spec", other]):
        assert main(arguments) == 2
        assert "the hashes differ" in capsys.readouterr().err


@pytest.mark.skipif(not SPECS.is_dir(), reason="../shared/data/specs is absent")
@pytest.mark.parametrize(
    ("name", "slugs", "robotics"),
    [
        ("simple_safety_example.slugsin", 0, 0),
        ("water_reservoir.structuredslugs", 0, 0),
        ("maximallyPermissiveTest.structuredslugs", 0, 0),
        ("twoDimensionalCost_simple1.slugsin", 0, 0),
        ("specification_debugging_examples_single_robot_scenario.structuredslugs", 0, None),
        ("unrealizable1.slugsin", 1, 1),
        ("abstract_counterstrategy_example.structuredslugs", 1, 1),
        ("semantics_diference.slugsin", 0, 1),
        ("optimisticRecoveryTest.slugsin", 0, 1),
    ],
)
def test_recorded_verdicts(capsys: Capture, name: str, slugs: int, robotics: int | None) -> None:
    path = str(SPECS / "slugs" / name)
    assert answered(["synth", path], capsys, code=slugs)["verified"] is True
    if robotics is not None:
        assert answered(["synth", path, "--semantics", "robotics"], capsys, code=robotics)["verified"] is True

"""docs/answers.md names the keys that commands print."""

from __future__ import annotations

import json
import re
from dataclasses import fields
from pathlib import Path

import pytest

from surefoot.cli import main
from surefoot.missions.quadruped.mission import QuadrupedAnswer
from synthetic_run import write_run

DOCS = Path(__file__).parents[2] / "docs" / "answers.md"
SPECIFICATION = "[INPUT]\nknock\n\n[OUTPUT]\ndoor\n\n[SYS_LIVENESS]\ndoor\n"


def documented(command: str) -> set[str]:
    """Return the keys in the first column of a command's table."""
    sections = re.split(r"^## ", DOCS.read_text(), flags=re.MULTILINE)
    (section,) = (text for text in sections if text.split()[0] == command)
    rows = (line.split("|")[1] for line in section.splitlines() if line.startswith("| `"))
    return {key for row in rows for key in re.findall(r"`(\w+)`", row)}


def printed(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> dict[str, object]:
    """Return the object that a command prints."""
    main([*arguments, "--json"])
    answer = json.loads(capsys.readouterr().out)
    assert isinstance(answer, dict)
    return answer


def test_the_keys_of_plan_run_and_verify(scenes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scenario, plan, run = str(scenes / "tutorial_mission.yaml"), str(tmp_path / "plan"), str(tmp_path / "run")
    assert set(printed(["plan", scenario, "-o", plan], capsys)) == documented("plan")
    assert set(printed(["run", scenario, "--plan", plan, "--steps", "3", "-o", run], capsys)) == documented("run")
    of_strategies = {"holds", "checked_states", "violation"}
    assert set(printed(["verify", run], capsys)) == documented("verify") - of_strategies


def test_the_keys_of_a_run_of_a_quadruped() -> None:
    assert {one.name for one in fields(QuadrupedAnswer)} == documented("Run")


def test_the_keys_of_synth_explain_simulate_and_verify(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec, strategy = tmp_path / "door.slugsin", str(tmp_path / "door.json")
    spec.write_text(SPECIFICATION)
    assert set(printed(["synth", str(spec), "-o", strategy], capsys)) == documented("synth")
    assert set(printed(["explain", str(spec)], capsys)) == documented("explain")
    assert set(printed(["simulate", strategy], capsys)) == documented("simulate")
    found = printed(["verify", strategy], capsys)
    assert set(found) == documented("verify")
    assert found["about"] == {"player": "system", "semantics": "slugs"}


def test_the_keys_of_reach(capsys: pytest.CaptureFixture[str]) -> None:
    asked = [
        "reach",
        "--step-length",
        "0.416",
        "--apex-velocity",
        "0.4",
        "0.6",
        "--disturbance",
        "rate",
        "--tau",
        "0.02",
    ]
    assert set(printed(asked, capsys)) == documented("reach")


def test_the_keys_of_view(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run, files = (
        str(write_run(tmp_path, laps=1)),
        ["--html", str(tmp_path / "a.html"), "--mcap", str(tmp_path / "a.mcap")],
    )
    found = set(printed(["view", run], capsys)) | set(printed(["view", run, *files], capsys))
    assert found | {"followed"} == documented("view")

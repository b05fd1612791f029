"""The command line: answers, exit codes, JSON, and what is said about bad input."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from surefoot.cli import main
from surefoot.cli.failures import explained
from surefoot.errors import AssumptionViolated, BackendMissing, InputError, LimitExceeded, SurefootError
from synthetic_run import write_run, write_scene

Capture = pytest.CaptureFixture[str]


def test_no_arguments_show_the_help(capsys: Capture) -> None:
    assert main([]) == 0
    shown = capsys.readouterr().out
    for command in ("scenario", "plan", "run", "view", "verify", "demo", "bench", "doctor"):
        assert command in shown


@pytest.mark.parametrize(
    "command",
    ["scenario init", "scenario schema", "plan", "run", "view", "verify", "demo", "bench", "doctor"],
)
def test_every_command_has_help_with_examples_and_json(command: str, capsys: Capture) -> None:
    assert main([*command.split(), "--help"]) == 0
    shown = capsys.readouterr().out
    assert "Examples:" in shown
    assert f"surefoot {command}" in shown
    assert "--json" in shown


def test_version(capsys: Capture) -> None:
    from surefoot import __version__

    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"surefoot {__version__}\n"


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["fly"], "No such command 'fly'"),
        (["plan"], "Missing argument"),
        (["run", "s.yaml", "--steps", "0"], "greater than or equal to 1"),
        (["run", "s.yaml", "--obstacle", "kind"], "'kind' is not one of"),
        (["run", "s.yaml", "--obstacle", "scripted"], "--script FILE and --obstacle scripted belong together"),
        (["plan", "none.yaml"], "none.yaml: does not exist"),
        (["view", "nowhere"], "nowhere: does not exist"),
        (["verify", "nowhere"], "nowhere: does not exist"),
        (["terrain", "segment", "nowhere.png", "--resolution", "0.02"], "nowhere.png: does not exist"),
        (["scenario", "init", "none.yaml"], "none.yaml: "),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(
    arguments: list[str], complaint: str, capsys: Capture, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    said = capsys.readouterr()
    assert said.out == ""
    last = said.err.splitlines()[-1]
    assert last.startswith("error: ")
    assert complaint in last
    assert "Traceback" not in said.err
    assert main([*arguments, "--json"]) == 2
    answer = json.loads(capsys.readouterr().out)
    assert answer["exit_code"] == 2
    assert complaint in answer["error"]
    assert list(tmp_path.iterdir()) == []


def test_every_problem_of_a_scenario_is_a_line(capsys: Capture, tmp_path: Path) -> None:
    scenario = write_scene(tmp_path)
    text = scenario.read_text().replace("heading: east", "heading: up").replace("range_m: 10.82", "range_m: -1")
    scenario.write_text(text)
    assert main(["plan", str(scenario), "-o", str(tmp_path / "plan")]) == 2
    lines = [line for line in capsys.readouterr().err.splitlines() if line.startswith("error: ")]
    assert [line.startswith(f"error: {scenario}:") for line in lines] == [True, True]


def fail(problem: BaseException) -> None:
    raise problem


@pytest.mark.parametrize(
    ("problem", "code"),
    [
        (InputError("is wrong", source="a.yaml", line=3), 2),
        (BackendMissing("piqp", "pip install piqp"), 2),
        (PermissionError(13, "Permission denied", "/root/x"), 2),
        (LimitExceeded("the time limit was reached"), 3),
        (MemoryError(), 3),
        (AssumptionViolated("an obstacle jumped"), 1),
        (SurefootError("odd"), 4),
        (KeyError("odd"), 4),
        (KeyboardInterrupt(), 130),
    ],
)
def test_exit_codes(problem: BaseException, code: int, capsys: Capture, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SUREFOOT_DEBUG", raising=False)
    with explained(as_json=False) as outcome:
        fail(problem)
    assert outcome.code == code
    said = capsys.readouterr().err
    assert len(said.splitlines()) == 1
    assert ("SUREFOOT_DEBUG=1" in said) == (code == 4)


def test_the_traceback_comes_when_it_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SUREFOOT_DEBUG", "1")
    with pytest.raises(KeyError), explained(as_json=False):
        fail(KeyError("odd"))


def test_schema_is_printed(capsys: Capture) -> None:
    assert main(["scenario", "schema"]) == 0
    plain = json.loads(capsys.readouterr().out)
    assert main(["scenario", "schema", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == plain
    assert plain["additionalProperties"] is False


def test_doctor(capsys: Capture) -> None:
    assert main(["doctor", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["complete"] is True
    assert found["versions"]["numpy"]
    assert found["cores"] >= 1
    assert main(["doctor"]) == 0
    assert "Everything that the core needs is there." in capsys.readouterr().out


def test_doctor_names_what_is_missing(capsys: Capture, monkeypatch: pytest.MonkeyPatch) -> None:
    from surefoot.cli import surroundings

    monkeypatch.setattr(surroundings, "_CORE", ("numpy", "no-such-package"))
    assert main(["doctor"]) == 1
    shown = capsys.readouterr().out
    assert "Missing: no-such-package (pip install no-such-package)" in shown


def test_view_prints_the_pictures(capsys: Capture, tmp_path: Path) -> None:
    run = write_run(tmp_path, laps=1)
    assert main(["view", str(run), "-o", str(tmp_path / "out"), "--json"]) == 0
    pictures = json.loads(capsys.readouterr().out)["pictures"]
    assert all(Path(picture).is_file() for picture in pictures)
    assert {Path(picture).parent for picture in pictures} == {tmp_path / "out"}


def _python(code: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)


def test_nothing_heavy_is_loaded_for_help() -> None:
    code = (
        "import sys; from surefoot.cli import main; main(['--help']); "
        "print([name for name in ('numpy', 'numba', 'scipy', 'matplotlib', 'pydantic') if name in sys.modules])"
    )
    assert _python(code).stdout.splitlines()[-1] == "[]"


def test_a_reader_that_leaves_early_is_no_error() -> None:
    command = f"{sys.executable} -m surefoot.cli scenario schema | true"
    done = subprocess.run(command, shell=True, capture_output=True, text=True, check=True)
    assert done.stderr == ""

"""``surefoot reach``: answers, exit codes, files, bad input."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from surefoot.cli import main

Capture = pytest.CaptureFixture[str]
GOLDEN = ["reach", "--step-length", "0.416", "--apex-velocity", "0.4", "0.6", "--disturbance", "rate", "--tau", "0.02"]


def test_the_golden_case(capsys: Capture, tmp_path: Path) -> None:
    assert main([*GOLDEN, "--json", "--save", str(tmp_path / "step"), "--plot", str(tmp_path / "step.png")]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["cells"] == {"target": 343, "shws": 5529, "guard": 829, "fhws": 14848}
    assert len(found["sha256"]) == 64
    assert found["time_s"] > 0
    assert found["area"]["fhws"] == pytest.approx(0.118784)
    assert (tmp_path / "step.png").stat().st_size > 10_000
    assert main(["verify", str(tmp_path / "step.json")]) == 0
    assert "accepted" in capsys.readouterr().out


def test_pictures(capsys: Capture, tmp_path: Path) -> None:
    assert main([*GOLDEN, "--pictures", str(tmp_path), "--json"]) == 0
    files = json.loads(capsys.readouterr().out)["files"]
    assert len(files) == 6
    assert all(Path(file).stat().st_size > 5_000 for file in files)


def test_an_empty_region_is_an_answer(capsys: Capture) -> None:
    assert main([*GOLDEN[:6], "--disturbance", "jump", "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert found["cells"]["guard"] == 0
    assert "no omega" in found["empty"]


def test_a_wide_sample_is_a_warning(capsys: Capture) -> None:
    assert main([*GOLDEN[:8], "--tau", "0.03", "--first-only"]) == 0
    shown = capsys.readouterr()
    assert "jump over" in shown.out
    assert "jump over" in shown.err


@pytest.mark.parametrize(
    ("more", "complaint"),
    [
        (["--omega", "3.5", "2.8", "0.02"], "reversed or empty"),
        (["--omega", "2.8", "3.5", "0"], "above 0"),
        (["--grid", "1e-6", "1e-6"], "GB"),
        (["--step-length", "0"], "step-length"),
        (["--step-length", "nan"], "step-length"),
        (["--tau", "-1"], "tau"),
        (["--apex-velocity", "0.6", "0.4"], "reversed"),
        (["--disturbance", "noise"], "noise"),
        (["--guard-velocity", "0.7", "0.1"], "guard-velocity"),
        (["--disturbance-bound", "-1", "0"], "disturbance-bound"),
    ],
)
def test_bad_input_is_one_sentence(more: list[str], complaint: str, capsys: Capture) -> None:
    assert main([*GOLDEN, *more]) == 2
    shown = capsys.readouterr()
    lines = [line for line in shown.err.splitlines() if line.startswith("error:")]
    assert len(lines) == 1
    assert complaint in lines[0]
    assert shown.out == ""


def test_the_reading_has_no_default(capsys: Capture) -> None:
    assert main(GOLDEN[:6]) == 2
    assert "--disturbance" in capsys.readouterr().err


def test_table_1_says_its_reading(capsys: Capture, monkeypatch: pytest.MonkeyPatch) -> None:
    from surefoot.reach import benchmarks

    whole = benchmarks.table
    monkeypatch.setattr(benchmarks, "table", lambda say: whole(say, runs=300))
    code = main(["bench", "table1", "--json"])
    found = json.loads(capsys.readouterr().out)
    assert code == (0 if found["met"] else 1)
    assert "2 m/s and 5 m/s^2" in found["reading"]
    assert len(found["table"]) == len(found["barrier"]) == len(found["random_instant"]) == 6
    assert found["barrier_mean_percent"] > found["table_mean_percent"] > 85
    main(["bench", "table1"])
    shown = capsys.readouterr().out
    assert "0.2-0.45" in shown
    assert "92.0" in shown

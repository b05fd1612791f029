"""Reading run logs."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from surefoot.errors import InputError
from surefoot.missions.biped.run_log import read_run
from synthetic_run import write_run


@pytest.fixture
def log(tmp_path: Path) -> Path:
    return write_run(tmp_path, laps=1) / "run.jsonl"


def edit(log: Path, line: int, change: Callable[[dict[str, Any]], None]) -> None:
    """Change the record in a line, counted from 1."""
    lines = log.read_text().splitlines()
    record = json.loads(lines[line - 1])
    change(record)
    lines[line - 1] = json.dumps(record)
    log.write_text("".join(f"{text}\n" for text in lines))


def test_reads_all_records(log: Path) -> None:
    run = read_run(log.parent)
    assert run.header.policy == "random"
    assert [turn.turn for turn in run.turns] == list(range(10))
    assert [step.step for step in run.steps] == list(range(len(run.steps)))
    assert run.end is not None
    assert run.end.steps == len(run.steps)
    assert run.steps[0].rise_s is None
    assert run.unsafe == ()


def test_a_log_that_just_ends_is_whole(log: Path) -> None:
    lines = log.read_text().splitlines(keepends=True)
    log.write_text("".join(lines[:-3]))
    run = read_run(log)
    assert run.end is None
    assert len(run.steps) == len(read_run(log).steps)


def test_a_log_cut_in_the_middle_of_a_line_is_refused(log: Path) -> None:
    text = log.read_text()
    log.write_text(text[: len(text) - 10])
    with pytest.raises(InputError, match=rf"run.jsonl:{text.count(chr(10))}: is not a whole JSON record"):
        read_run(log)


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (lambda step: step.pop("com_m"), r":3: com_m: field required"),
        (lambda step: step.update(com_m=[0, 0]), r":3: com_m"),
        (lambda step: step.update(omega_radps="fast"), r":3: omega_radps: .* number"),
        (lambda step: step.update(step=7), r":3: step: must be 0, the next number, not 7"),
        (lambda step: step.update(record="jump"), r":3: the record is of no known kind; allowed are header, turn"),
        (lambda step: step.update(length_m=float("nan")), r":3: "),
    ],
)
def test_a_wrong_record_is_named(log: Path, change: Callable[[dict[str, Any]], None], complaint: str) -> None:
    edit(log, 3, change)
    with pytest.raises(InputError, match=complaint):
        read_run(log)


def test_the_header_comes_first(log: Path) -> None:
    lines = log.read_text().splitlines(keepends=True)
    log.write_text("".join(lines[1:]))
    with pytest.raises(InputError, match=":1: the first record has to be the header"):
        read_run(log)
    log.write_text("")
    with pytest.raises(InputError, match="is empty"):
        read_run(log)
    edited = json.loads(lines[0])
    log.write_text(json.dumps({**edited, "format": 2}))
    with pytest.raises(InputError, match=":1: format"):
        read_run(log)


def test_a_missing_log_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist"):
        read_run(tmp_path / "run.jsonl")

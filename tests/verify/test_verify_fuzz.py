"""Whatever stands in an artefact, the checker answers with a report or one sentence, never with a traceback."""

from __future__ import annotations

import contextlib
import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from naive_planner import read_rows, rewrite, write_document

from surefoot.errors import InputError
from surefoot.verify import verify_path

JUNK: st.SearchStrategy[object] = st.sampled_from(
    [
        None,
        True,
        -1,
        0,
        7,
        10**12,
        0.5,
        -1e300,
        "",
        "east",
        "../..",
        [],
        [[]],
        [1, 2],
        [[0, 0]],
        [["a", 1]],
        {},
        {"a": 1},
    ]
)
FUZZ = settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow]
)


def places(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Return the paths of all values inside a JSON value."""
    inside: list[tuple[Any, ...]] = []
    if isinstance(value, dict):
        inside = [place for key in value for place in places(value[key], (*path, key))]
    if isinstance(value, list):
        inside = [place for index, item in enumerate(value[:3]) for place in places(item, (*path, index))]
    return [path, *inside] if path else inside


def put(value: Any, path: tuple[Any, ...], junk: object) -> None:
    for key in path[:-1]:
        value = value[key]
    value[path[-1]] = junk


@FUZZ
@given(data=st.data())
def test_junk_in_a_plan_is_answered(naive_plan: Path, data: st.DataObject) -> None:
    sound = (naive_plan / "plan.json").read_text()
    document = json.loads(sound)
    path = data.draw(st.sampled_from([place for place in places(document) if place[0] != "files"]))
    put(document, path, data.draw(JUNK))
    write_document(naive_plan, document)
    with contextlib.suppress(InputError):
        verify_path(naive_plan)
    (naive_plan / "plan.json").write_text(sound)


@FUZZ
@given(data=st.data())
def test_junk_in_strategies_is_answered(naive_plan: Path, data: st.DataObject) -> None:
    name = data.draw(st.sampled_from(["navigation.npz", "action.npz"]))
    sound = read_rows(naive_plan, name)
    rows = {key: values.copy() for key, values in sound.items()}
    key = data.draw(st.sampled_from(sorted(rows)))
    limits = np.iinfo(rows[key].dtype)
    rows[key].flat[data.draw(st.integers(0, rows[key].size - 1))] = data.draw(
        st.integers(int(limits.min), int(limits.max))
    )
    rewrite(naive_plan, name, rows)
    with contextlib.suppress(InputError):
        verify_path(naive_plan)
    rewrite(naive_plan, name, sound)


@FUZZ
@given(data=st.data())
def test_broken_bytes_are_answered(naive_plan: Path, data: st.DataObject) -> None:
    name = data.draw(st.sampled_from(["navigation.npz", "action.npz"]))
    sound = (naive_plan / name).read_bytes()
    broken = bytearray(sound)
    for _ in range(data.draw(st.integers(1, 6))):
        broken[data.draw(st.integers(0, len(broken) - 1))] = data.draw(st.integers(0, 255))
    (naive_plan / name).write_bytes(broken)
    document = json.loads((naive_plan / "plan.json").read_text())
    write_document(naive_plan, document)
    with contextlib.suppress(InputError):
        verify_path(naive_plan)
    (naive_plan / name).write_bytes(sound)


@FUZZ
@given(data=st.data())
def test_junk_in_a_log_is_answered(walked: Path, data: st.DataObject) -> None:
    copy = walked.parent / "junk"
    shutil.copytree(walked, copy, dirs_exist_ok=True)
    lines = (walked / "run.jsonl").read_text().splitlines()[:30]
    line = data.draw(st.integers(0, len(lines) - 1))
    record = json.loads(lines[line])
    put(record, data.draw(st.sampled_from(places(record))), data.draw(JUNK))
    lines[line] = json.dumps(record)
    (copy / "run.jsonl").write_text("\n".join(lines) + "\n")
    with contextlib.suppress(InputError):
        verify_path(copy)


@pytest.mark.parametrize("text", ["", "a: [", "- 1\n", "format: 1\nkind: biped\nnonsense: 1\n", "a: &a [*a]\n", "\x00"])
def test_scenario_that_is_none_is_answered(naive_plan: Path, text: str) -> None:
    (naive_plan.parent / "scenario.yaml").write_text(text)
    document = json.loads((naive_plan / "plan.json").read_text())
    from surefoot.compute import sha256_of

    document["scenario"]["sha256"] = sha256_of(naive_plan.parent / "scenario.yaml")
    write_document(naive_plan, document)
    with pytest.raises(InputError, match=r"scenario\.yaml"):
        verify_path(naive_plan)

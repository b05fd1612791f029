"""What goes into JSON."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from surefoot.cli.output import facts, jsonable


@dataclass(frozen=True, slots=True)
class Answer:
    out: Path | None
    times: tuple[float, ...]
    inner: Answer | None = None


def test_dataclasses_become_objects() -> None:
    value = Answer(Path("a/b"), (1.0, float("nan")), Answer(None, (float("inf"),)))
    assert jsonable(value) == {
        "out": "a/b",
        "times": [1.0, None],
        "inner": {"out": None, "times": [None], "inner": None},
    }


def test_numbers_of_numpy_become_plain() -> None:
    assert json.dumps(jsonable({"a": np.int64(3), "b": np.array([1.5, np.nan])})) == '{"a": 3, "b": [1.5, null]}'


leaves = st.none() | st.booleans() | st.integers() | st.floats() | st.text()


@settings(deadline=None)
@given(st.recursive(leaves, lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner), max_leaves=20))
def test_whatever_it_is_json_takes_it(value: object) -> None:
    json.loads(json.dumps(jsonable(value), allow_nan=False))


def test_facts_stand_in_one_column() -> None:
    assert facts({"a": 1, "long name": 0.12345, "ok": True, "none": ()}) == [
        "  a          1",
        "  long name  0.123",
        "  ok         yes",
        "  none       none",
    ]

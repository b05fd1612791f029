"""Whatever stands in a problem file or a plan file: an answer, or one InputError; never anything else."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from surefoot.errors import InputError
from surefoot.footholds import read_problem, solve, write_plan
from surefoot.footholds.generators import strips
from surefoot.verify import verify_path

PROBLEM: dict[str, Any] = {
    "format": 1,
    "robot": "go2",
    "gait": {"modes": ["LF_RH", "STANCE"], "switching_times_s": [0, 0.5, 1.0]},
    "step_s": 0.05,
    "start": {"position_m": [0, 0, 0.29], "rpy_rad": [0, 0, 0]},
    "goal": {"position_m": [0.1, 0, 0.29], "rpy_rad": [0, 0, 0]},
    "polygons": [{"vertices_m": [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], "friction": 0.6}],
    "free_regions": [{"A": [[0, 0, -1]], "b": [0.1]}],
    "options": {"collision": True, "collision_windows": 4},
}
ODD = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-3, 3),
    st.floats(),
    st.text(max_size=5),
    st.just([]),
    st.just({}),
    st.just([[]]),
)


def places(value: Any, at: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Return every place in a document."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [at, *(place for key, one in inner for place in places(one, (*at, key)))]


def changed(document: Any, place: tuple[Any, ...], odd: Any) -> Any:
    if not place:
        return odd
    copied = copy.deepcopy(document)
    here = copied
    for key in place[:-1]:
        here = here[key]
    here[place[-1]] = odd
    return copied


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_problem_files(tmp_path: Path, data: st.DataObject) -> None:
    place = data.draw(st.sampled_from(places(PROBLEM)))
    path = tmp_path / "problem.json"
    path.write_text(json.dumps(changed(PROBLEM, place, data.draw(ODD))))
    try:
        problem = read_problem(path)
    except InputError:
        return
    assert problem.samples >= 4


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> Any:
    path = tmp_path_factory.mktemp("plan") / "plan.json"
    problem = strips(2, bands=2, goal_x_m=0.25)
    write_plan(path, problem, solve(problem))
    return json.loads(path.read_text())


@settings(max_examples=80, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_plan_files(tmp_path: Path, plan: Any, data: st.DataObject) -> None:
    small = {key: value for key, value in plan.items() if key not in {"motion", "made", "surefoot"}}
    place = data.draw(st.sampled_from(places(small)))
    path = tmp_path / "changed.json"
    path.write_text(json.dumps(changed(plan, place, data.draw(ODD))))
    try:
        report = verify_path(path)
    except InputError:
        return
    assert isinstance(report.accepted, bool)

"""The flat interface: everything it promises exists, and works with plain strings as paths."""

from __future__ import annotations

from pathlib import Path

import pytest

import surefoot


def test_everything_that_is_exported_exists() -> None:
    assert set(surefoot.__all__) - {"__version__"} == set(surefoot._HOMES)
    for name in surefoot.__all__:
        assert getattr(surefoot, name) is not None


def test_an_unknown_name_lists_those_that_exist() -> None:
    with pytest.raises(AttributeError, match="plan_mission"):
        surefoot.plan_missoin  # noqa: B018


def test_the_example_of_the_docstring(scenes: Path, tmp_path: Path) -> None:
    scenario, plan, run = str(scenes / "tutorial_mission.yaml"), str(tmp_path / "plan"), str(tmp_path / "run")
    planned = surefoot.plan_mission(scenario, plan)
    assert planned.realizable
    walked = surefoot.run_mission(scenario, plan, steps=60, seed=1, obstacle="random", out=run)
    assert walked.verified
    assert surefoot.verify_path(run).accepted

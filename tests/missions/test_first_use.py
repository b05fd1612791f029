"""Planning says where it compiles first, and only where it does."""

from __future__ import annotations

from pathlib import Path

import pytest

from surefoot.missions.plans.planning import plan_mission

COMPILED_PARTS = (
    "building the navigation game",
    "building the action game",
    "saving and verifying the plan",
)


def messages_of_a_plan(scenes: Path, out: Path) -> list[str]:
    messages: list[str] = []
    plan_mission(scenes / "tutorial_mission.yaml", out, messages.append)
    return messages


def test_says_nothing_of_compiling_where_the_code_is_kept(tutorial_plan: Path, scenes: Path, tmp_path: Path) -> None:
    assert tutorial_plan.is_dir()
    messages = messages_of_a_plan(scenes, tmp_path / "plan")
    assert set(COMPILED_PARTS) <= set(messages)
    assert not any("compil" in message for message in messages)


def test_says_which_parts_compile_where_none_is_kept(
    scenes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, tutorial_plan: Path
) -> None:
    assert tutorial_plan.is_dir()
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "nothing"))
    messages = messages_of_a_plan(scenes, tmp_path / "plan")
    assert any(message.startswith("compiling the solver (only the first run") for message in messages)
    for part in COMPILED_PARTS:
        assert any(message.startswith(f"compiling, then {part} (only the first run") for message in messages)

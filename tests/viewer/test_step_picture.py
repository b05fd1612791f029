"""The picture of one step with its push and the strategy around it."""

from __future__ import annotations

from pathlib import Path

import pytest
from PIL import Image

from surefoot.errors import InputError
from surefoot.missions.biped.mission import run_mission
from surefoot.missions.pushes.source import ScriptedPushes, StepPush, read_pushes
from surefoot.viewer import view_run, view_step


def test_draws_pushed_and_other_steps(tutorial_plan: Path, scenes: Path, tmp_path: Path) -> None:
    script = tmp_path / "pushes.yaml"
    script.write_text("{format: 1, kind: push-script, pushes: [{step: 3, instant: 0.2, sagittal_mps: 0.05}]}")
    source: ScriptedPushes = read_pushes(script)
    assert source.at(3) == StepPush(0.2, 0.05, 0.0)
    run, scene = tmp_path / "run", scenes / "tutorial_mission.yaml"
    run_mission(scene, tutorial_plan, steps=8, seed=2, obstacle="random", out=run, pushes=source)
    for number in (2, 3):
        (picture,) = view_step(run, number)
        with Image.open(picture) as image:
            assert image.width > 1500
    assert all(path.is_file() for path in view_run(run, tmp_path / "all"))
    with pytest.raises(InputError, match="0 to 7"):
        view_step(run, 8)

"""Plans that the checker's tests start from; each is made once and copied where it is changed."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from naive_planner import Cheats, write_map, write_plan
from small_scene import OBSTACLE, PICTURE, SCENARIO, Planner


@pytest.fixture
def planned(tmp_path: Path) -> Planner:
    """Return a function that plans a scene with the naive planner, cheating if it is told to."""

    def plan(cheats: Cheats | None = None, obstacles: str = OBSTACLE, extra: str = "") -> Path:
        write_map(tmp_path, PICTURE, pixels=10, resolution_m=0.1)
        text = SCENARIO.replace("OBSTACLES", obstacles).replace("EXTRA", extra)
        (tmp_path / "scenario.yaml").write_text(text)
        return write_plan(tmp_path / "scenario.yaml", tmp_path / "plan", cheats)

    return plan


@pytest.fixture(scope="session")
def naive_world(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with map, scenario and plan."""
    folder = tmp_path_factory.mktemp("naive")
    write_map(folder, PICTURE, pixels=10, resolution_m=0.1)
    (folder / "scenario.yaml").write_text(SCENARIO.replace("OBSTACLES", OBSTACLE).replace("EXTRA", ""))
    write_plan(folder / "scenario.yaml", folder / "plan")
    return folder


@pytest.fixture
def naive_plan(naive_world: Path, tmp_path: Path) -> Path:
    """Return a copy of a sound plan, to be changed."""
    return Path(shutil.copytree(naive_world, tmp_path / "world")) / "plan"


@pytest.fixture(params=["naive", "two rooms"])
def any_plan(request: pytest.FixtureRequest) -> Path:
    """Return a copy of a sound plan, naive or real, to be changed."""
    if request.param == "naive":
        return Path(request.getfixturevalue("naive_plan"))
    real = Path(request.getfixturevalue("two_rooms_plan"))
    copy = real.parent / "changed"
    shutil.rmtree(copy, ignore_errors=True)
    return Path(shutil.copytree(real, copy))


@pytest.fixture(scope="session")
def walked(tutorial_plan: Path, scenes: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the run of a mission."""
    from surefoot.missions.biped.mission import run_mission

    out = tutorial_plan.parent / "run"
    run_mission(scenes / "tutorial_mission.yaml", tutorial_plan, steps=120, seed=5, obstacle="adversarial", out=out)
    return out

"""Shared inputs: the scenes of the repository, and plans of them that are made once."""

from __future__ import annotations

from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[1]
SCENES = REPOSITORY / "scenes"
DEPOT_SCENE = REPOSITORY / "tests" / "scenes" / "depot_mission.yaml"
DEPOT = REPOSITORY.parent / "shared" / "data" / "maps" / "depot.yaml"


@pytest.fixture(scope="session")
def scenes() -> Path:
    """Return the folder of the shipped scenes."""
    return SCENES


@pytest.fixture(scope="session")
def two_rooms_plan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a plan of the two-room scene."""
    return _planned(SCENES / "two_rooms_mission.yaml", tmp_path_factory)


@pytest.fixture(scope="session")
def tutorial_plan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a plan of the tutorial's scene."""
    return _planned(SCENES / "tutorial_mission.yaml", tmp_path_factory)


@pytest.fixture(scope="session")
def depot_plan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a plan of the real depot."""
    if not DEPOT.is_file():
        pytest.skip("the depot map in ../shared/data is absent")
    return _planned(DEPOT_SCENE, tmp_path_factory)


def _planned(scenario: Path, folders: pytest.TempPathFactory) -> Path:
    from surefoot.missions.plans.planning import plan_mission

    out = folders.mktemp("plan") / "plan"
    answer = plan_mission(scenario, out)
    assert answer.realizable, answer.witness
    assert answer.verified
    return out

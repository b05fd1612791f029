"""What several pages show: the plan of the tutorial's scene, and its strategy."""

from __future__ import annotations

from pathlib import Path

import pytest

from surefoot.navigation import NavigationStrategy
from surefoot.viewer.sources.plans import PlanSource, read_plan_source, strategy_of


@pytest.fixture(scope="session")
def source(tutorial_plan: Path) -> PlanSource:
    """Return the plan of the tutorial's scene, with its scenario and map."""
    return read_plan_source(tutorial_plan)


@pytest.fixture(scope="session")
def strategy(source: PlanSource) -> NavigationStrategy:
    """Return its strategy."""
    return strategy_of(source)

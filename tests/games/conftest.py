from __future__ import annotations

import pytest

from surefoot.games import warm_up


@pytest.fixture(scope="session", autouse=True)
def _compiled_engine() -> None:
    """Compile before the first test, so that no test is slow for that reason."""
    warm_up()

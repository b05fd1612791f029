"""``surefoot view plan/ --html``: a page that shows which order the strategy gives for what the robot knows."""

from __future__ import annotations

import base64
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from surefoot.compute import write_text_whole
from surefoot.errors import InputError
from surefoot.navigation import NavigationStrategy, ObstacleState
from surefoot.viewer.browser.page import script
from surefoot.viewer.scenes.belief_tiles import KIND_HUES
from surefoot.viewer.sources.plans import PlanSource, read_plan_source, strategy_of

MOST_DECISIONS = 500_000

_ARRAYS = {"cell": "<i4", "state": "<i4", "goal": "<i2", "heading": "<i1", "order": "<i1"}


def write_strategy_page(plan_dir: Path, path: Path) -> Path:
    """Write the navigation strategy of a plan as one page that opens from a file.

    Args:
        plan_dir: the folder of the plan.
        path: of the HTML file.

    Raises:
        InputError: the plan cannot be read, or has too many decisions for a page.
    """
    source = read_plan_source(plan_dir)
    strategy = strategy_of(source)
    if strategy.size > MOST_DECISIONS:
        raise InputError(
            f"has {strategy.size} decisions, and a page holds at most {MOST_DECISIONS}; use --cell instead",
            source=plan_dir,
        )
    page = files("surefoot.viewer.pages").joinpath("strategy.html").read_text("utf-8")
    write_text_whole(path, page.replace("/*DATA*/", script(_data(source, strategy))))
    return path


def _data(source: PlanSource, strategy: NavigationStrategy) -> dict[str, Any]:
    grid = source.grid
    arrays = {
        name: base64.b64encode(np.ascontiguousarray(getattr(strategy, name), kind).tobytes()).decode()
        for name, kind in _ARRAYS.items()
    }
    return {
        "rows": grid.rows,
        "columns": grid.columns,
        "free": [int(index) for index in np.flatnonzero(grid.free)],
        "goals": list(strategy.goals),
        "states": [_known(strategy, state) for state in strategy.states],
        "sizes": [len(members) for members in strategy.kinds],
        "hues": [KIND_HUES[kind % len(KIND_HUES)] for kind in range(len(strategy.kinds))],
        **arrays,
    }


def _known(strategy: NavigationStrategy, state: ObstacleState) -> dict[str, Any]:
    hidden = [[strategy.domain[bit] for bit in range(mask.bit_length()) if mask >> bit & 1] for mask in state.hidden]
    return {"visible": [list(map(int, cells)) for cells in state.visible], "hidden": hidden}

"""What a plan file holds to prove a bound over all gaits (docs/formats.md 6)."""

from __future__ import annotations

from typing import Any

import numpy as np

from surefoot.footholds.branching import Branch
from surefoot.footholds.rows import Array
from surefoot.footholds.sharing import Prices
from surefoot.footholds.solve import FreeAnswer

_DIGITS = 7


def bound_document(free: FreeAnswer) -> dict[str, Any] | None:
    """Return the multipliers that prove a bound over all gaits."""
    proof = free.proof
    if proof is None:
        return None
    return {
        "first": _prices(proof.first),
        "turning": list(free.turning),
        "worth": None if proof.tree is None else proof.worth,
        "tree": None if proof.tree is None else _tree(proof.tree),
    }


def _tree(branch: Branch) -> dict[str, Any]:
    if branch.cut is None or branch.parts is None:
        return _prices(branch.prices)
    below, above = branch.parts
    cut = [branch.cut.sample, branch.cut.axis, branch.cut.at_m]
    return {"cut": cut, "below": _tree(below), "above": _tree(above)}


def _prices(prices: Prices) -> dict[str, Any]:
    """Return prices, rounded: any multipliers are sound."""
    reach, walls = prices.reach, prices.walls
    pressed = [] if walls is None else np.argwhere(walls).tolist()
    return {
        "reach": [[i, j, a, 0, _short(reach[i, j, a])] for i, j, a in np.argwhere(reach).tolist()],
        "pull": _shorts(prices.pull),
        "contact": _shorts(prices.contact),
        "split": prices.split,
        **({"walls": [[i, a, _short(walls[i, a])] for i, a in pressed]} if walls is not None else {}),
    }


def _short(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")


def _shorts(values: Array) -> Any:
    return np.vectorize(_short)(values).tolist()

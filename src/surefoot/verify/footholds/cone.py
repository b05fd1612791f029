"""The upright pyramid that holds all friction pyramids of a ground, and what of a pull a force in it can follow."""

from __future__ import annotations

import numpy as np

from surefoot.verify.footholds.file import Array
from surefoot.verify.footholds.rows import Surface

_STEEP, _LEAST = 0.05, 1e-3


def leans(ground: list[Surface]) -> Array | None:
    """Return how much of its height a force may lean, shape (2, 2): axis, backwards and forwards; None: anything."""
    rays = np.array(
        [one.normal + one.slope * (a * one.t1 + b * one.t2) for one in ground for a in (1, -1) for b in (1, -1)]
    )
    if rays[:, 2].min() < _STEEP:
        return None
    lean = rays[:, :2] / rays[:, 2:]
    return np.asarray(np.maximum(np.stack([-lean.min(axis=0), lean.max(axis=0)], axis=1), _LEAST))


def pressed_into(pulls: Array, lean: Array | None) -> Array:
    """Return the squared lengths of the nearest points of the pyramid to some pulls.

    The nearest point is at one of a few heights: which sides it lies on decides which.
    """
    squares = (pulls**2).sum(axis=1)
    if lean is None:
        return np.asarray(squares)
    steep = np.where(pulls[:, :2] < 0, lean[:, 0], lean[:, 1])
    away = np.full(len(pulls), np.inf)
    for sides in ((0, 0), (1, 0), (0, 1), (1, 1)):
        k = steep * sides
        height = np.maximum((pulls[:, 2] + (k * np.abs(pulls[:, :2])).sum(axis=1)) / (1 + (k**2).sum(axis=1)), 0.0)
        beside = np.maximum(np.abs(pulls[:, :2]) - steep * height[:, None], 0.0)
        away = np.minimum(away, (beside**2).sum(axis=1) + (height - pulls[:, 2]) ** 2)
    return np.asarray(squares - away)

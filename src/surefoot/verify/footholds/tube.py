"""Between which paths the base stays: what its ends, cuts and the cost of cheap plans tell."""

from __future__ import annotations

from typing import Any

import numpy as np

from surefoot.verify.footholds.file import Array

Span = tuple[Array, Array]
"""Least and largest coordinates of the base by sample, shape (N, 3) each."""

_MOST_LEAVES, _DEEPEST = 2000, 200
_EPS_M = 1e-9


def ends_of(known: Array) -> Span:
    """Return what is known of every base: where it is at sample 0 and at the last two."""
    low, high = np.full(known.shape, -np.inf), np.full(known.shape, np.inf)
    for at in (0, -2, -1):
        low[at] = high[at] = known[at]
    return low, high


def leaves_of(tree: Any, size: int) -> list[tuple[Span, dict[str, Any]]]:
    """Return the leaves of a tree of cuts: between which paths their base stays, and their multipliers.

    A cut parts what is below some place at a sample from what is above it, so that the leaves leave nothing out.
    """
    found: list[tuple[Span, dict[str, Any]]] = []
    pending = [(tree, (np.full((size, 3), -np.inf), np.full((size, 3), np.inf)), 0)]
    while pending:
        node, (low, high), depth = pending.pop()
        if "cut" not in node:
            found.append(((low, high), node))
            continue
        sample, axis, at = int(node["cut"][0]), int(node["cut"][1]), float(node["cut"][2])
        if not (0 < sample < size - 2 and 0 <= axis < 3 and np.isfinite(at)) or depth >= _DEEPEST:
            raise ValueError("cut")
        less, more = high.copy(), low.copy()
        less[sample, axis], more[sample, axis] = min(at, high[sample, axis]), max(at, low[sample, axis])
        pending += [(node["below"], (low, less), depth + 1), (node["above"], (more, high), depth + 1)]
        if len(pending) + len(found) > _MOST_LEAVES:
            raise ValueError("tree")
    return found


def tube_of(path: Array, square: Array, slack: float, cuts: Span) -> Span | None:
    """Return between which paths the base of plans stays that cost at most so much more than is proved; None: nowhere.

    Their deviations d from the best path have d' square d <= 2 slack. Where one or two of them are known to lie
    in intervals, the others follow up to what the rest of the slack allows.

    Args:
        path: the best one, shape (N, 3).
        square: second derivatives, shape (N, N).
        slack: how much dearer.
        cuts: between which paths the base is.
    """
    spread = np.zeros_like(square)
    spread[1:-2, 1:-2] = np.linalg.inv(square[1:-2, 1:-2])
    radius = 2 * max(slack, 0.0)
    low, high = path.copy(), path.copy()
    for axis in range(3):
        lower, upper = cuts[0][:, axis] - path[:, axis], cuts[1][:, axis] - path[:, axis]
        away = np.sqrt(radius * np.diag(spread))
        least, most = np.maximum(-away, lower), np.minimum(away, upper)
        marks = np.flatnonzero(np.isfinite(lower) | np.isfinite(upper))
        below, above = least.copy(), most.copy()
        for at in range(len(path)):
            about = np.concatenate([marks[marks <= at][-1:], marks[marks > at][:1]])
            for known in (*marks[:, None], about):
                if len(known) == 0 or (len(known) == 1 and known[0] == at):
                    continue
                among = spread[np.ix_(known, known)]
                follow = np.linalg.solve(among, spread[known, at])
                free = np.sqrt(radius * max(spread[at, at] - float(follow @ spread[known, at]), 0.0))
                reach = follow * least[known], follow * most[known]
                below[at] = max(below[at], float(np.minimum(*reach).sum()) - free)
                above[at] = min(above[at], float(np.maximum(*reach).sum()) + free)
        low[:, axis] += below
        high[:, axis] += above
    return None if (low > high + _EPS_M).any() else (low, high)

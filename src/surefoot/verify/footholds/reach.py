"""Which polygons a footstep may reach, by intervals: a transcription of its own."""

from __future__ import annotations

from typing import Any

import numpy as np

from surefoot.verify.footholds.file import Array, FootholdFile
from surefoot.verify.footholds.rows import nominal, references, surfaces

_EPS_M = 1e-9


def left_to_steps(plan: FootholdFile) -> list[tuple[int, ...]] | None:
    """Return the polygons that every footstep may reach; None when a step, or the base somewhere, has no place at all.

    In contact, and at the last swing sample before it, foot and base keep each other in the box of Eq. (16), taken here
    with its sides parallel to the world's axes.
    """
    values, size = plan.values, len(plan.contacts)
    turns = references(plan)[2]
    arm = np.einsum("iab,jb->ija", turns, nominal(plan))
    half = np.abs(turns) @ np.array(values["robot"]["foot_reach_m"], dtype=float) + _EPS_M
    low, high = np.full((size, 3), -np.inf), np.full((size, 3), np.inf)
    low[0] = high[0] = np.array(values["start"]["position_m"], dtype=float)
    low[-2:] = high[-2:] = np.array(values["goal"]["position_m"], dtype=float)
    stays: list[tuple[int, Any, list[int] | None, Any, Any]] = []
    for foot in range(4):
        lifts = [step.lift for step in plan.steps if step.foot == foot]
        swings = np.flatnonzero(~plan.contacts[:, foot])
        end = min(lifts, default=int(swings[0]) if len(swings) else size)
        point = np.array(values["start"]["feet_m"][foot], dtype=float)
        stays.append((foot, np.arange(end), None, point, point))
    ground = surfaces(plan)
    for step in plan.steps:
        far = np.full(3, np.inf)
        stays.append((step.foot, np.arange(step.touch - 1, step.leave), list(range(len(ground))), -far, far))
    for _ in range(200):
        before = [kept if kept is None else list(kept) for _, _, kept, _, _ in stays]
        edges = np.concatenate([low, high]).copy()
        for number, (foot, samples, kept, least, most) in enumerate(stays):
            reach_low, reach_high = (
                low[samples] + arm[samples, foot] - half[samples],
                high[samples] + arm[samples, foot] + half[samples],
            )
            least, most = np.maximum(least, reach_low.max(axis=0)), np.minimum(most, reach_high.min(axis=0))
            if kept is not None:
                kept = [r for r in kept if _touches(ground[r].corners, ground[r].normal, least, most)]
                if not kept:
                    return None
                corners = np.concatenate([ground[r].corners for r in kept])
                least = np.maximum(least, corners.min(axis=0) - _EPS_M)
                most = np.minimum(most, corners.max(axis=0) + _EPS_M)
            low[samples] = np.maximum(low[samples], least - arm[samples, foot] - half[samples])
            high[samples] = np.minimum(high[samples], most - arm[samples, foot] + half[samples])
            if (low[samples] > high[samples] + _EPS_M).any():
                return None
            stays[number] = (foot, samples, kept, least, most)
        settled = np.array_equal(edges, np.concatenate([low, high]))
        if settled and before == [kept for _, _, kept, _, _ in stays]:
            break
    return [tuple(kept) for _, _, kept, _, _ in stays if kept is not None]


def _touches(corners: Array, normal: Array, least: Array, most: Array) -> bool:
    """Return False when an axis of the box or a side of the polygon separates the two."""
    if (corners.min(axis=0) > most + _EPS_M).any() or (corners.max(axis=0) < least - _EPS_M).any():
        return False
    sides = np.roll(corners, -1, axis=0) - corners
    outward = np.cross(sides, normal)
    outward /= np.linalg.norm(outward, axis=1)[:, None]
    with np.errstate(invalid="ignore"):
        nearest = np.nansum(np.minimum(outward * least, outward * most), axis=1)
    return bool((nearest <= (outward * corners).sum(axis=1) + _EPS_M).all())

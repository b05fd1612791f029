"""Refutes free gaits: branch and bound over the skeleton, every leaf of which is closed by a checked ray."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from surefoot.footholds.form import StandardForm
from surefoot.footholds.problem import Problem
from surefoot.footholds.qp import solve_qp
from surefoot.footholds.rows import FAMILIES, Array, Index, Rows
from surefoot.footholds.skeleton import cost_limit, outside_m
from surefoot.footholds.solvers import run_highs

_CERTAIN = 10.0
_DROP = 1e-14
_FAR_M = 1e-4
_NONE = np.zeros(0, dtype=np.int64)
_NAMES = (("dynamics", "newton", 2), ("torque", "limit", 2), ("contact", "cover", 1), ("reach", "near", 4))


@dataclass(frozen=True, slots=True, eq=False)
class Leaf:
    """Pinned binaries below which multipliers prove that there is nothing.

    Attributes:
        pinned: places of binaries and their values.
        multipliers: one per row.
    """

    pinned: dict[int, int]
    multipliers: Array


@dataclass(frozen=True, slots=True, eq=False)
class Refuted:
    """A tree of pinned binaries whose leaves are all refuted.

    Attributes:
        form: what is refuted.
        leaves: they leave nothing out.
        nodes: convex programs solved.
    """

    form: StandardForm
    leaves: tuple[Leaf, ...]
    nodes: int


def refuted(problem: Problem, form: StandardForm, stop: Callable[[], bool], most_nodes: int) -> Refuted | None:
    """Return a checked refutation of a skeleton, or None when there is none within limits.

    Every leaf has multipliers that prove a cost above what any point of the skeleton costs; rays of the solver are
    stretched until they do (``qp.scaled_ray``).
    """
    limit = cost_limit(problem, form)
    ranges = _ranges(form)
    pending: list[dict[int, int]] = [{}]
    leaves: list[Leaf] = []
    nodes = 0
    while pending:
        if stop() or nodes >= most_nodes:
            return None
        pinned, nodes = pending.pop(), nodes + 1
        answer = solve_qp(form.cost, _with(form.rows, ranges, pinned), certain=_CERTAIN * limit)
        if answer.feasible is not True and answer.bound > limit:
            leaves.append(Leaf(pinned, answer.multipliers))
            continue
        place = _unexplained(problem, form.binaries, answer.unknowns, pinned)
        if place is None:
            return None
        pending += [{**pinned, place: 0}, {**pinned, place: 1}]
    return Refuted(form, tuple(leaves), nodes)


def refutation_document(found: Refuted) -> list[dict[str, Any]]:
    """Return the leaves as plain values (docs/formats.md); ranges of single unknowns are left to whoever checks."""
    return [_leaf_document(found.form, leaf) for leaf in found.leaves]


def _leaf_document(form: StandardForm, leaf: Leaf) -> dict[str, Any]:
    rows, first = form.rows, int(form.binaries[0])
    scaled = leaf.multipliers / max(float(np.abs(leaf.multipliers).max(initial=0.0)), 1e-300)
    document: dict[str, Any] = {"pinned": [[place - first, value] for place, value in sorted(leaf.pinned.items())]}
    for family, name, size in _NAMES:
        chosen = np.flatnonzero((rows.family == FAMILIES.index(family)) & (np.abs(scaled) > _DROP))
        document[name] = [[*(int(k) for k in rows.where[row][:size]), _short(scaled[row])] for row in chosen]
    cone = rows.family == FAMILIES.index("friction")
    pressed = np.zeros((int(rows.where[:, 0].max()) + 1, 3))
    entries = rows.matrix[cone].tocoo()
    samples, axes = rows.where[cone][entries.row, 0], (entries.col - first) % 3
    np.add.at(pressed, (samples, axes), entries.data * scaled[cone][entries.row])
    document["cone"] = [[int(i), *map(_short, pressed[i])] for i in np.flatnonzero(np.abs(pressed).max(axis=1) > _DROP)]
    return document


def _short(number: float) -> float:
    return float(f"{float(number):.13g}")


def _ranges(form: StandardForm) -> dict[int, int]:
    """Return the row that bounds every binary from 0 to 1."""
    matrix = form.rows.matrix
    lone = np.flatnonzero((np.diff(matrix.indptr) == 1) & (form.rows.lower == 0) & (form.rows.upper == 1))
    return {int(matrix.indices[matrix.indptr[row]]): int(row) for row in lone}


def _with(rows: Rows, ranges: dict[int, int], pinned: dict[int, int]) -> Rows:
    if not pinned:
        return rows
    lower, upper = rows.lower.copy(), rows.upper.copy()
    chosen = [ranges[place] for place in pinned]
    lower[chosen] = upper[chosen] = list(pinned.values())
    return replace(rows, lower=lower, upper=upper)


def confirmed(found: Refuted, time_limit_s: float) -> bool:
    """Return whether HiGHS finds no point in any leaf: a second method, by simplex instead of rays."""
    form, ranges = found.form, _ranges(found.form)
    nothing = np.zeros(len(form.cost.linear))
    leaves = (replace(form, rows=_with(form.rows, ranges, leaf.pinned), binaries=_NONE) for leaf in found.leaves)
    return all(run_highs(leaf, nothing, time_limit_s)[0] is False for leaf in leaves)


def _unexplained(problem: Problem, binaries: Index, unknowns: Array, pinned: dict[int, int]) -> int | None:
    """Return a binary of the cell that is carried where the base is farthest from all polygons that may be near.

    That is "carried" first, and then the nearest polygon. Where nothing is far there is none: with "carried" rounded up
    and the polygons in reach taken as near, this is a point of the skeleton.
    """
    away = outside_m(problem, unknowns)
    count, polygons = away.shape
    first = int(binaries[0])
    for place, value in pinned.items():
        if value == 0 and place >= first + count:
            away.flat[place - first - count] = np.inf
    far = away.min(axis=1) * np.maximum(unknowns[binaries[:count]], 0.0)
    for cell in np.argsort(-far, kind="stable"):
        if not far[cell] > _FAR_M:
            return None
        ends = cell in (0, count - 1)
        for place in (first + int(cell), first + count + int(cell) * polygons + int(away[cell].argmin())):
            if place not in pinned and not (ends and place < first + count):
                return place
    return None

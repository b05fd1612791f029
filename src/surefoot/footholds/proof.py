"""Proofs of bounds and of infeasibility: the tree of the search, and multipliers for every leaf of it.

Multipliers of equations are not kept: whoever checks a proof minimises the Lagrangian over the equations himself. Rows
of the same half-space or cone are added up to one vector, which can be checked against the polygons that are left.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from surefoot.footholds.model import Choice, Motion
from surefoot.footholds.orientation import Turning
from surefoot.footholds.problem import Problem
from surefoot.footholds.rows import FAMILIES, Array, Rows
from surefoot.footholds.search import Branch, Outcome

_DROP = 1e-5
_DROP_RELATIVE = 1e-12
_PLAIN = ("reach", "clearance", "torque", "base torque", "support", "collision", "tilt", "leg")


@dataclass(frozen=True, slots=True)
class Proof:
    """What proves a bound, as plain values (docs/formats.md).

    Attributes:
        root: what interval propagation leaves to every footstep and window.
        tree: nodes ``{"split", "children"}`` or ``{"leaf"}``; the first is the root.
        multipliers: what the leaves refer to.
        turning: multipliers of the orientation's program, rows ``[sample, axis, multiplier]``.
    """

    root: Choice
    tree: list[dict[str, Any]]
    multipliers: list[dict[str, list[list[float]]]]
    turning: list[list[float]]


def proof_of(problem: Problem, outcome: Outcome, turned: Turning | None) -> Proof:
    """Return the proof that a search leaves behind."""
    tree: list[dict[str, Any]] = []
    kept: list[dict[str, list[list[float]]]] = []
    numbers: dict[int, int] = {}

    def prove(branch: Branch) -> int:
        source = branch.proof
        if source is None or source.node is None or source.node.motion is None:
            return -1
        if id(source) not in numbers:
            numbers[id(source)] = len(kept)
            kept.append(multipliers_of(problem, source.node.motion, source.node.rows, source.node.answer.multipliers))
        return numbers[id(source)]

    pending = [(outcome.root, 0)]
    tree.append({})
    while pending:
        branch, place = pending.pop()
        if branch.children:
            entry: dict[str, Any] = {"split": branch.split, "children": []}
            for child in branch.children:
                entry["children"].append({"left": list(child.choice[branch.split]), "node": len(tree)})
                pending.append((child, len(tree)))
                tree.append({})
            tree[place] = entry
        else:
            tree[place] = {"leaf": prove(branch)}
    return Proof(outcome.root.choice, tree, kept, [] if turned is None else turning_multipliers(turned))


def turning_multipliers(turned: Turning) -> list[list[float]]:
    """Return the multipliers of the orientation's program as rows ``[sample, axis, multiplier]``."""
    pressing = zip(turned.where, turned.multipliers, strict=True)
    return [[int(i), int(a), _short(m)] for (i, a), m in pressing if abs(m) > _DROP]


def multipliers_of(problem: Problem, motion: Motion, rows: Rows, multipliers: Array) -> dict[str, list[list[float]]]:
    """Return the multipliers of one solved program, by family."""
    least = max(_DROP, _DROP_RELATIVE * float(np.abs(multipliers).max(initial=0.0)))
    found: dict[str, list[list[float]]] = {}
    for name in _PLAIN:
        chosen = np.flatnonzero((rows.family == FAMILIES.index(name)) & (np.abs(multipliers) > least))
        if len(chosen):
            found[name] = [[*(int(x) for x in rows.where[k]), _short(multipliers[k])] for k in chosen]
    pushed = _pushed(rows, multipliers, "region")
    regions = [
        [number, *pushed[motion.feet.index[step.touch, step.foot]]] for number, step in enumerate(problem.footsteps)
    ]
    found["region"] = [[row[0], *map(_short, row[1:])] for row in regions if any(row[1:])]
    if motion.force is not None:
        pushed = _pushed(rows, multipliers, "friction")
        found["friction"] = [
            [int(i), int(j), *map(_short, pushed[motion.force.index[i, j]])]
            for i, j in np.argwhere(problem.contacts)
            if float(np.abs(pushed[motion.force.index[i, j]]).max()) > least
        ]
    return found


def _pushed(rows: Rows, multipliers: Array, family: str) -> Array:
    """Return what the multipliers of a family press on the unknowns."""
    chosen = rows.family == FAMILIES.index(family)
    pushed: Array = rows.matrix[chosen].T @ multipliers[chosen]
    return pushed


def _short(number: float) -> float:
    return float(f"{float(number):.13g}")

"""Checks that a closed play reaches its goals under assumption (c), and that the obstacles can always keep (c)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from surefoot.frames import Direction
from surefoot.verify.findings import Ledger
from surefoot.verify.graphs import can_reach, components, cyclic
from surefoot.verify.navigation.assumption import Assumption, blocked_rows
from surefoot.verify.navigation.decisions import WAIT, Table, describe
from surefoot.verify.navigation.play import Play


def check_liveness(play: Play, ledger: Ledger) -> None:
    """Refuse cycles that starve a goal while assumption (c) holds, and decisions in which (c) cannot be kept."""
    table, scene = play.table, play.table.obstacles.scene
    if play.turns is None:
        return
    fair = _fair(table)
    goes_on = np.repeat(~play.turns.advances, np.diff(play.first))
    component = components(play.first, play.successors, goes_on)
    starving = cyclic(play.first, play.successors, goes_on, component) & _all_fair(component, fair)
    for number in np.flatnonzero(starving):
        node = int(np.flatnonzero(component == number)[0])
        text = "the obstacles can keep the robot from its next goal for ever without breaking assumption (c)"
        ledger.refuse("rules.md 4, goals", text, describe(scene, table.decision(node)))
    every = np.ones(len(play.successors), np.bool_)
    component = components(play.first, play.successors, every)
    kept = cyclic(play.first, play.successors, every, component) & _all_fair(component, fair)
    forced = ~can_reach(play.first, play.successors, kept[component])
    if forced.any():
        text = "the obstacles are forced to break assumption (c)"
        where = describe(scene, table.decision(int(np.flatnonzero(forced)[0])))
        ledger.refuse("rules.md 4, check (1)", text, where, times=int(forced.sum()))


def _fair(table: Table) -> NDArray[np.bool_]:
    """Return (4, N) whether a row satisfies the justice of each direction."""
    scene, assumption = table.obstacles.scene, Assumption(table.obstacles)
    fair = np.ones((4, len(table.orders)), np.bool_)
    waiting = np.flatnonzero(table.orders >= WAIT)
    waits, number = np.unique(np.stack([table.cells, table.orders], axis=1)[waiting], axis=0, return_inverse=True)
    pairs = [
        (int(cell), scene.index(scene.target(scene.cell(int(cell)), Direction(order - WAIT)))) for cell, order in waits
    ]
    if not pairs:
        return fair
    for kind, states in enumerate(table.kinds):
        known = table.keys[waiting, kind + 1]
        hidden = states.sets[states.keys[known, 1]]
        blocked = blocked_rows(assumption.ways(kind, pairs), number.ravel(), states.visible[known], hidden)
        fair[table.orders[waiting] - WAIT, waiting] &= ~blocked
    return fair


def _all_fair(component: NDArray[np.int64], fair: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return which components hold, for every direction, a decision that satisfies its justice."""
    met = np.ones(int(component.max()) + 1, np.bool_)
    for row in fair:
        some = np.zeros_like(met)
        some[component[row]] = True
        met &= some
    return met

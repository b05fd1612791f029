"""Verifies a plan folder: the scene derived again, both strategies, and their composition."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from surefoot.errors import InputError
from surefoot.verify.action import ActionTable, check_action, read_action_table
from surefoot.verify.artefacts import PlanFile, read_plan
from surefoot.verify.belief import Obstacle
from surefoot.verify.claims import Claims, compare
from surefoot.verify.composition import check_composition, context_of
from surefoot.verify.findings import Ledger
from surefoot.verify.navigation import Table, check_liveness, explore, read_table
from surefoot.verify.scenario import read_scenario
from surefoot.verify.scene import Scene, derive_scene
from surefoot.verify.true_product import check_true_obstacle


@dataclass(frozen=True, slots=True)
class Opened:
    """A plan folder after its claims have been compared with the scene."""

    plan: PlanFile
    scene: Scene
    claims: Claims


def open_plan(folder: Path, ledger: Ledger) -> Opened:
    """Read a plan folder and its inputs, and compare what it claims with the scene that they describe."""
    plan = read_plan(folder)
    scenario = read_scenario(plan.scenario_path)
    try:
        scene = derive_scene(scenario)
    except InputError as problem:
        if problem.source is not None:
            raise
        raise InputError(problem.message, source=scenario.path, key=problem.key) from problem
    return Opened(plan, scene, compare(plan, scene, ledger))


def check_plan(folder: Path, ledger: Ledger) -> None:
    """Verify a plan folder.

    Raises:
        InputError: a file is missing, truncated, stale or malformed.
        LimitExceeded: a product is too large to be walked.
    """
    opened = open_plan(folder, ledger)
    scene, claims = opened.scene, opened.claims
    if ledger.total:
        return
    obstacle, table = Obstacle(scene), read_table(opened.plan, scene, ledger)
    action = read_action_table(opened.plan, claims, ledger)
    if ledger.total or action is None:
        return
    _check_games(scene, claims, obstacle, table, action, ledger)


def _check_games(
    scene: Scene, claims: Claims, obstacle: Obstacle, table: Table, action: ActionTable, ledger: Ledger
) -> None:
    """Check both strategies; what builds on a closed play waits for one."""
    play = explore(scene, claims, obstacle, table, ledger)
    ledger.counts["navigation_decisions"] = len(play.decisions)
    if play.closed:
        check_liveness(scene, obstacle, play, ledger)
        if claims.obstacle is not None:
            check_true_obstacle(scene, obstacle, play, scene.index(claims.obstacle), ledger)
    order = int(play.orders[0])
    first = context_of(scene, claims, play.decisions[0].cell, order) if order >= 0 else -1
    check_action(claims, action, [first] if first >= 0 else [], ledger)
    if play.closed:
        check_composition(scene, claims, play, action, ledger)
